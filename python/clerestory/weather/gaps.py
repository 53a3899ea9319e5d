"""Gaps of weather, filled only where someone asks for it."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.finding import Finding
from clerestory.weather.calendar import spells

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.weather.weather import Weather


def filled(weather: Weather, hours: float) -> Weather:
    """Weather without gaps.

    Missing light is put in by a straight line between the last and the next step that is known, or as the nearest of
    them at the ends; at night it is 0. Steps that the file lacks altogether are not made up.

    Parameters
    ----------
    hours
        Longest run of daylight steps without light that is filled [h].

    Raises
    ------
    ClerestoryError
        A run is longer, or nothing is known.
    """
    missing = weather.is_missing
    unknown = ~np.isfinite(weather.direct + weather.diffuse)
    if not unknown.any():
        return weather
    steps = np.flatnonzero(missing)
    for _, run in groupby(enumerate(steps), key=lambda pair: pair[1] - pair[0]):
        run_steps = np.array([k for _, k in run])
        length = float(weather.interval[run_steps].sum())
        if length > hours + 1e-9:
            raise ClerestoryError(
                f"a gap of {length:g} h is longer than the {hours:g} h that are to be filled, "
                f"{spells(weather, run_steps)} (allow longer gaps, or mend the file)"
            )
    known = ~unknown
    if not known.any():
        raise ClerestoryError("no step has both direct and diffuse light (take a file with sunshine data)")
    note = Finding("note", "filled", spells(weather, steps), "light that was missing was interpolated", "")
    return replace(
        weather,
        direct=_line(weather, weather.direct, unknown),
        diffuse=_line(weather, weather.diffuse, unknown),
        notes=(*weather.notes, note) if len(steps) else weather.notes,
    )


def _line(weather: Weather, values: NDArray[np.float64], unknown: NDArray[np.bool_]) -> NDArray[np.float64]:
    at = weather.times.astype("datetime64[s]").astype(np.float64)
    order = np.argsort(at[~unknown], kind="stable")
    made = np.interp(at, at[~unknown][order], values[~unknown][order])
    return np.where(unknown, np.where(weather.is_daylight, made, 0.0), values)
