"""Critical moments: the hours in which glare can occur, found at little cost, for detailed rendering afterwards.

A coarse year of every view (few patches of the sky, few cells of the windows, the sun through beams exactly) says when
glare can be. Hours in which the sun stands at nearly the same place and glares in the same way are told by the worst
of them.
"""

from __future__ import annotations

import csv
import io
from dataclasses import astuple, dataclass, fields
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory.annual.arrivals import Arrivals
from clerestory.annual.frequencies import simplified_dgp
from clerestory.annual.glare import SOLAR_SOLID_ANGLE
from clerestory.annual.sun import SunThrough
from clerestory.annual.year import RoomYear, Sampling
from clerestory.photometry import EFFICACY
from clerestory.trace.keys import RecipeError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from clerestory.annual.study import Study

    Doubles = NDArray[np.float64]

Cause = Literal["sun in view", "bright", "contrast"]

_COARSE = Sampling(view=1024, returned=256, eye_cells=40)
_PATCHES = "reinhart:1"
_PATHS = 256
"""Of a patch of the windows, outwards."""
_SUN = 50_000.0
"""Luminance of a sun that is seen [cd/m²], above which it is a source of its own: the peak extraction of evalglare."""


@dataclass(frozen=True)
class Moment:
    """An hour that stands for others."""

    data_set: str
    """Its name."""
    view: str
    """Its name."""
    step: int
    """Of the weather."""
    time: str
    """Standard time of its middle."""
    dgp: float
    """Estimated daylight glare probability."""
    cause: Cause
    """The sun's disc through a beam, much light at the eye, or contrast."""
    sun_altitude_deg: float
    """Where the sun stands [°]."""
    sun_azimuth_deg: float
    """From north over east [°]."""
    direct: float
    """Direct normal irradiance [W/m²], or illuminance [lx], as the weather has it."""
    diffuse: float
    """Diffuse horizontal irradiance [W/m²], or illuminance [lx]."""
    hours: float
    """That it stands for [h], itself among them."""


def moments(
    study: Study,
    *,
    limit: float = 0.35,
    within_deg: float = 8.0,
    most: int = 12,
    progress: Callable[[float], object] | None = None,
) -> list[Moment]:
    """The critical moments of a study's views, the worst first, of each data set and view.

    Parameters
    ----------
    study
        With at least one view.
    limit
        DGP from which an hour is critical; hours that do not count are left out.
    within_deg
        Hours with the sun within this angle [°] of each other, and one cause, are one moment.
    most
        Moments of a data set and view.
    progress
        Called with the share that is done.
    """
    if not study.views:
        raise RecipeError("views: critical moments are of views, and there are none (add some to the room)")
    arrivals = Arrivals(study.matrices, study.sky(_PATCHES), samples=_PATHS, value="centre", facade=study.facade)
    eyes = {name: (study.room.view(name).point_m, study.room.view(name).direction) for name in study.views}
    year = RoomYear(arrivals, eyes=eyes, sampling=_COARSE)
    steps = len(study.weather)
    found = {(name, view): np.full((2, steps), np.nan) for name in study.names for view in eyes}
    counts = study.hours.weights(study.weather)
    systems = {key: choice.systems for key, choice in study.choices.items()}
    asked = {
        key: counts > 0.0 if choice.when is None else choice.when & (counts > 0.0)
        for key, choice in study.choices.items()
    }
    for key, part in year.of(systems, progress, when=asked):
        for view, values in part.eyes.items():
            found[study.choices[key].data_set, view][:, part.steps] = values["dgp"], values["illuminance"]
    made = []
    for (name, view), (dgp, illuminance) in found.items():
        seen = _sun_seen(study, arrivals, name, np.asarray(eyes[view][0]))
        bright = simplified_dgp(illuminance) >= limit
        causes = np.where(seen > _SUN, 0, np.where(bright, 1, 2))
        critical = np.flatnonzero((np.nan_to_num(dgp) >= limit) & (counts > 0.0))
        worst = _chosen(
            critical, dgp, illuminance, causes, arrivals.sky.suns.directions, np.cos(np.radians(within_deg)), counts
        )
        made += [_moment(study, name, view, step, dgp, causes, hours) for step, hours in worst[:most]]
    return made


def _sun_seen(study: Study, arrivals: Arrivals, name: str, point: Doubles) -> Doubles:
    """Luminance of the sun's disc that a point (3) sees at every step [cd/m²]; 0 where it is hidden."""
    suns = arrivals.sky.suns
    straight = np.zeros(len(suns.irradiance))
    for choice in study.choices.values():
        if choice.data_set == name:
            through = SunThrough(study.matrices, tuple(choice.systems))
            shines = suns.irradiance if choice.when is None else np.where(choice.when, suns.irradiance, 0.0)
            beams = through.beams(suns.directions, shines)
            straight += through.through(point.reshape(1, 3), suns.directions, shines, beams)[0]
    return EFFICACY * straight / SOLAR_SOLID_ANGLE


def _chosen(
    critical: NDArray[np.int64],
    dgp: Doubles,
    illuminance: Doubles,
    causes: NDArray[np.int64],
    suns: Doubles,
    cosine: float,
    hours: Doubles,
) -> list[tuple[int, float]]:
    """Steps that stand for others, the worst first, and the hours that each stands for."""
    left = critical[np.lexsort((-illuminance[critical], -dgp[critical]))]
    made = []
    while len(left):
        step = int(left[0])
        alike = (suns[left] @ suns[step] >= cosine) & (causes[left] == causes[step])
        alike[0] = True
        made.append((step, float(hours[left[alike]].sum())))
        left = left[~alike]
    return made


_CAUSES: tuple[Cause, ...] = ("sun in view", "bright", "contrast")


def _moment(
    study: Study, name: str, view: str, step: int, dgp: Doubles, causes: NDArray[np.int64], hours: float
) -> Moment:
    weather = study.weather
    altitude, azimuth = weather.sun_positions()
    return Moment(
        data_set=name,
        view=view,
        step=step,
        time=str(weather.times[step].astype("datetime64[m]")).replace("T", " "),
        dgp=float(dgp[step]),
        cause=_CAUSES[causes[step]],
        sun_altitude_deg=float(altitude[step]),
        sun_azimuth_deg=float(azimuth[step]),
        direct=float(weather.direct[step]),
        diffuse=float(weather.diffuse[step]),
        hours=hours,
    )


def to_csv(found: list[Moment]) -> str:
    """The moments as a table with a head."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in fields(Moment)])
    writer.writerows(astuple(moment) for moment in found)
    return text.getvalue()
