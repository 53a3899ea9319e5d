"""What a round robin comes to, measure by measure, and how laboratories and methods share its variance."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory.annual import en17037
from clerestory.annual.frequencies import DGI_CLASSES, DGP_CLASSES, class_shares
from clerestory.roundrobin.transmittance import labelled
from clerestory.roundrobin.variance import analyse

if TYPE_CHECKING:
    from collections.abc import Mapping

    from clerestory.roundrobin.run import Found
    from clerestory.roundrobin.study import Case
    from clerestory.roundrobin.variance import Variance

Kind = Literal["transmittance", "illuminance", "glare"]
Place = tuple[str, str, int]
"""Laboratory, method (a treatment, or a file's resolution) and seed."""


@dataclass(frozen=True)
class Measure:
    """One figure of all laboratories and methods."""

    key: str
    words: str
    unit: str
    """`lx`, `%` (values are fractions), or none."""
    kind: Kind
    values: Mapping[Place, float]
    variance: Variance = field(init=False)

    def __post_init__(self) -> None:
        laboratories, methods, _ = zip(*self.values, strict=True)
        object.__setattr__(self, "variance", analyse(list(self.values.values()), laboratories, methods))

    @property
    def is_judged(self) -> bool:
        """Whether laboratories and methods can be held against each other."""
        v = self.variance
        return v.laboratory_spread is not None and v.method_spread is not None

    @property
    def resolution_effect(self) -> float | None:
        """Mean difference high − klems of laboratories and peaks that have both."""
        return self._effect(lambda m: m.replace("high", "klems") if m.startswith("high") else None)

    @property
    def peaks_effect(self) -> float | None:
        """Mean difference with − without peak extraction of laboratories and resolutions that have both."""
        return self._effect(lambda m: m.removesuffix("-peaks") if m.endswith("-peaks") else None)

    def _effect(self, other_of: object) -> float | None:
        assert callable(other_of)
        found = []
        for (laboratory, method, seed), value in self.values.items():
            other = other_of(method)
            if other is not None and (laboratory, other, seed) in self.values:
                found.append(value - self.values[laboratory, other, seed])
        return float(np.mean(found)) if found else None


def measures(found: Found) -> list[Measure]:
    """All measures of a system."""
    return [*_transmittances(found), *_moments(found), *_years(found)]


def _transmittances(found: Found) -> list[Measure]:
    if found.transmittance is None:
        return []
    files = labelled(found.system)
    places: list[Place] = [(files[label][0], files[label][1].resolution, 0) for label in found.transmittance.labels]
    made = []
    for quantity in found.transmittance.quantities("hemispherical", "direct-hemispherical", "direct-direct"):
        values = {p: float(v) for p, v in zip(places, quantity["values"], strict=True) if v is not None}
        if values:
            words = f"{quantity['symbol']}, {quantity['of']}"
            made.append(Measure(str(quantity["key"]), words, "%", "transmittance", values))
    return made


def _moments(found: Found) -> list[Measure]:
    if not found.moments:
        return []
    times = list(dict.fromkeys(time for values in found.moments.values() for time, _ in values))
    made = []
    for key, words, unit, kind in (
        ("illuminance", "E_v", "lx", "illuminance"),
        ("dgp", "DGP", "", "glare"),
        ("dgi", "DGI", "", "glare"),
    ):
        series: dict[Place, dict[str, float]] = {}
        for case, values in found.moments.items():
            for (time, seed), moment in values.items():
                series.setdefault(_place(case, seed), {})[time] = getattr(moment, key)
        first = {place: values[times[0]] for place, values in series.items()}
        made.append(Measure(f"{key} {times[0]}", f"{words}, {times[0]}", unit, kind, first))  # type: ignore[arg-type]
        if len(times) > 1:
            mean = {place: float(np.mean(list(values.values()))) for place, values in series.items()}
            made.append(Measure(f"{key} mean", f"{words}, mean of {len(times)} times", unit, kind, mean))  # type: ignore[arg-type]
    return made


def _years(found: Found) -> list[Measure]:
    if not found.years:
        return []
    made = []
    rows = {_place(case, seed): found.annual(case, seed) for case, years in found.years.items() for seed in years}
    for key, words, unit, kind in next(iter(rows.values())).names:
        values = {place: row.values[key] for place, row in rows.items()}
        made.append(Measure(key, words, unit, kind, values))
    return made


def _place(case: Case, seed: int) -> Place:
    return case.laboratory, case.treatment, seed


@dataclass(frozen=True)
class Annual:
    """What the year of a case comes to."""

    values: dict[str, float]
    names: list[tuple[str, str, str, Kind]]
    """Key, words, unit and kind of each value."""
    dgp_classes: list[float]
    """Share of the hours in each class."""
    dgi_classes: list[float]
    autonomy: dict[float, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]
    """Of each point (n,), by threshold [lx]."""


def annual_of(found: Found, case: Case, seed: int) -> Annual:
    """What the year of a case comes to, over the hours that count."""
    years = found.years_of
    year = found.years[case][seed]
    assert years is not None
    at_eye = years.hours.weights(years.weather)
    in_daylight = years.daylight
    values: dict[str, float] = {}
    names: list[tuple[str, str, str, Kind]] = []
    autonomy = {}
    for threshold in years.recipe.thresholds_lx:
        reached = (in_daylight @ (year.illuminance >= threshold)) / in_daylight.sum()
        autonomy[threshold] = np.asarray(reached, dtype=np.float64)
        key = f"daylight autonomy {threshold:g} lx"
        values[key] = float(reached.mean())
        names.append((key, f"daylight autonomy at {threshold:g} lx, mean of the points", "%", "illuminance"))
    values["mean E_v"] = float(np.average(year.eye_illuminance, weights=at_eye))
    names.append(("mean E_v", "mean E_v", "lx", "illuminance"))
    classes = []
    for index, division in (("dgp", DGP_CLASSES), ("dgi", DGI_CLASSES)):
        series = np.asarray(getattr(year, index), dtype=np.float64)[:, None]
        shares = class_shares(series, at_eye, division)[:, 0].tolist()
        classes.append(shares)
        if index == "dgp":
            values["DGP exceeded in 5 %"] = float(en17037.exceeded(series, at_eye)[0])
            names.append(("DGP exceeded in 5 %", "DGP exceeded in 5 % of the hours", "", "glare"))
        # Above the second limit: disturbing or uncomfortable, and worse.
        limit = division.limits[1]
        key = f"hours with {division.index} above {limit:g}"
        values[key] = float(sum(shares[2:]))
        names.append((key, key, "%", "glare"))
    return Annual(values, names, classes[0], classes[1], autonomy)
