"""The control law of conditions, as a table of a study."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from clerestory._core import ClerestoryError
from clerestory.annual.control import rules
from clerestory.annual.control.checks import complete, known, known_sensors
from clerestory.annual.control.expression import Expression
from clerestory.annual.control.stage import AT_EYE, READINGS
from clerestory.trace.keys import Keys, RecipeError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.annual.control.stage import Stage

    States = NDArray[np.int64]


class Condition(Keys):
    """A state, and when."""

    state: str
    """The state."""
    when: str | None = None
    """A condition; without one it always holds."""


NAMES = {
    "sun_altitude_deg": "altitude of the sun [°]",
    "sun_azimuth_deg": "compass azimuth of the sun [°]",
    "profile_angle_deg": "profile angle of the sun before the façade [°]; nothing compares with it behind the façade",
    "incidence_deg": "angle of the sun to the façade's normal [°], 0 to 180",
    "facade_irradiance": "irradiance of the façade by sun, sky and ground [W/m²]",
    "facade_direct": "the sun's part of it [W/m²]",
    "direct_normal": "direct normal irradiance [W/m²]",
    "diffuse_horizontal": "diffuse horizontal irradiance [W/m²]",
    "hour": "time of day at the middle of the step [h], on the study's clock",
    "weekday": "0, Monday, to 6, Sunday",
    "month": "1 to 12",
    "day": "of the month, from 1",
    rules.STATE: "name of the group's state in the step before",
}
"""Names in conditions."""


class Rules(Keys):
    """The first rule whose condition holds."""

    kind: Literal["expression"]
    rules: Annotated[list[Condition], Field(min_length=1)]
    """Rules in order."""

    def check(self, stage: Stage, key: str) -> None:
        """Fail if it does not go with the room, its windows or the weather."""
        for k, rule in enumerate(self.rules):
            place = f"{key}.rules[{k + 1}]"
            known(rule.state, stage.states, f"{place}.state", "state")
            try:
                made = None if rule.when is None else _expression(rule.when)
            except ClerestoryError as error:
                raise RecipeError(f"{place}.when: {error}") from None
            for function, texts in set() if made is None else made.calls:
                if function == AT_EYE:
                    known(texts[0], stage.room.recipe.views, f"{place}.when", "view")
                else:
                    known_sensors([texts[0]], stage, f"{place}.when")
                for state in texts[1:]:
                    known(state, stage.states, f"{place}.when", "state")

    def chosen(self, stage: Stage, key: str) -> States:
        """States (groups, steps)."""
        made = [
            rules.Rule(stage.states.index(rule.state), None if rule.when is None else _expression(rule.when))
            for rule in self.rules
        ]
        calls = {(function, texts[0]) for rule in made if rule.when is not None for function, texts in rule.when.calls}
        measured = stage.readings(sorted({name for function, name in calls if function != AT_EYE}))
        if views := sorted({name for function, name in calls if function == AT_EYE}):
            at_eye, _ = stage.at_eyes(views)
            measured |= {(AT_EYE, name): at_eye[k].sum(axis=0) for k, name in enumerate(views)}
        series = _series(stage)
        found = []
        for group in range(len(stage.groups)):
            own = {name: values[group] if values.ndim == 2 else values for name, values in series.items()}
            try:
                found.append(rules.chosen(made, stage.states, own, measured, len(stage.weather)))
            except ClerestoryError as error:
                raise RecipeError(f"{key}.rules: {error}") from None
        return complete(np.stack(found), stage, f"{key}.rules", "add a rule without when as the last")


def _series(stage: Stage) -> dict[str, NDArray[np.float64]]:
    """Of `NAMES` but for the state: (steps,) or (groups, steps)."""
    seen = stage.outdoors
    days = seen.times.astype("datetime64[D]")
    return {
        "sun_altitude_deg": seen.altitude_deg,
        "sun_azimuth_deg": seen.azimuth_deg,
        "profile_angle_deg": np.degrees(seen.profile),
        "incidence_deg": seen.incidence_deg,
        "facade_irradiance": seen.irradiance,
        "facade_direct": seen.direct,
        "direct_normal": seen.direct_normal,
        "diffuse_horizontal": seen.diffuse_horizontal,
        "hour": (seen.times - days).astype("timedelta64[s]").astype(np.float64) / 3600.0,
        "weekday": (days.astype(np.int64) + 3) % 7 + 0.0,
        "month": seen.times.astype("datetime64[M]").astype(np.int64) % 12 + 1.0,
        "day": (days - seen.times.astype("datetime64[M]").astype("datetime64[D]")).astype(np.int64) + 1.0,
    }


def _expression(text: str) -> Expression:
    return Expression(text, frozenset(NAMES), frozenset({*READINGS, AT_EYE}))
