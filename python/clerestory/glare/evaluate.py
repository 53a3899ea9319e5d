"""Glare of pictures and of known sources."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory import _core
from clerestory.glare.classes import dgi_class, dgp_class
from clerestory.glare.settings import Settings
from clerestory.picture.view import View

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

    from clerestory.picture.image import Picture

FULL_DEG = 179.0
"""A view at least this wide counts as one of 180°."""


@dataclass(frozen=True)
class Source:
    """A glare source."""

    direction: tuple[float, float, float]
    """Toward it, in the world."""
    luminance: float
    """Mean [cd/m²]."""
    largest: float
    """Largest luminance [cd/m²]."""
    solid_angle: float
    """[sr]"""
    illuminance: float
    """Its part of the illuminance at the eye [lx]."""
    sigma_deg: float
    """Angle from the line of sight [°]."""
    position_index: float
    pixels: int
    """Number of its pixels; 0 without a picture."""
    peak: bool
    """Whether it was cut out of a larger one as a peak."""


@dataclass(frozen=True)
class Evaluation:
    """What was found, with the settings that it depends on.

    Indices that rate sources only are 0 where there are none, and the visual comfort probability is 100.
    """

    dgp: float
    """Daylight glare probability."""
    dgps: float
    """Simplified daylight glare probability; not for direct sun."""
    dgi: float
    dgi_mod: float
    ugr: float
    ugr_exp: float
    ugp: float
    ugp2: float
    cgi: float
    vcp: float
    """Visual comfort probability [%]."""
    dgr: float
    veiling_luminance: float
    """[cd/m²], Stiles and Holladay."""
    vertical_illuminance: float
    """[lx], sources included."""
    direct_illuminance: float
    """[lx], of the sources."""
    background_luminance: float
    """[cd/m²]"""
    mean_luminance: float
    """[cd/m²]"""
    sources: tuple[Source, ...]
    """The most glaring first."""
    settings: Settings
    threshold: float | None = None
    """Luminance [cd/m²] above which pixels are sources."""
    task_luminance: float | None = None
    """Mean luminance of the task area [cd/m²]."""
    solid_angle: float | None = None
    """Of the pixels that count [sr]."""
    warnings: tuple[str, ...] = ()
    """What makes the result doubtful."""
    labels: NDArray[np.uint32] | None = field(default=None, repr=False, compare=False)
    """Number of the source of each pixel (height, width), from 1; 0 for none."""

    @property
    def dgp_class(self) -> str:
        """Imperceptible, perceptible, disturbing or intolerable, by the DGP."""
        return dgp_class(self.dgp)

    @property
    def dgi_class(self) -> str:
        """The same by the DGI."""
        return dgi_class(self.dgi)


def evaluate(picture: Picture, settings: Settings | None = None, *, view: View | None = None) -> Evaluation:
    """Find and rate the glare sources of a picture.

    Parameters
    ----------
    picture
        A fisheye of 180°, angular or hemispherical, for all indices to mean what they say.
    settings
        Those of `evalglare` 3.06 by default.
    view
        What the picture shows, if it does not say so itself, or wrongly.

    Raises
    ------
    ClerestoryError
        There is no view, it is parallel, it is a perspective without a measured illuminance at the eye, the picture is
        black, or a pixel is not a number.
    """
    settings = Settings() if settings is None else settings
    shown = picture.view if view is None else view
    if shown is None:
        raise _core.MissingDataError(
            "the picture does not say what it shows (give a view, such as -vta -vh 180 -vv 180)"
        )
    warnings = view_doubts(shown, settings)
    if any(line.startswith("DENOISED=") for line in picture.header):
        warnings.append("the picture is denoised: small sources may be smoothed away (rate it as it was before)")
    height, width = picture.shape
    lens = _lens(shown, width, height)
    sources, values, threshold, task, solid_angle, labels, more = lens.evaluate(picture._core, settings)
    indices: dict[str, Any] = dict(values)
    return Evaluation(
        **indices,
        sources=_sources(sources),
        settings=settings,
        threshold=threshold,
        task_luminance=task,
        solid_angle=solid_angle,
        warnings=(*warnings, *more),
        labels=labels,
    )


@lru_cache(maxsize=2)
def _lens(view: View, width: int, height: int) -> _core.GlareLens:
    """Geometry that pictures of one view and size share."""
    return _core.GlareLens(view._core, width, height)


def view_doubts(view: View, settings: Settings) -> list[str]:
    """What a view is not good for.

    Raises
    ------
    ClerestoryError
        Its pictures cannot be rated at all.
    """
    measured = settings.vertical_illuminance is not None
    if view.projection in "vl" and not measured:
        raise _core.ClerestoryError(
            f"a {view.projection_name} picture does not hold the illuminance at the eye (give a fisheye of 180°, "
            "or the measured vertical illuminance)"
        )
    if min(view.size_deg) < FULL_DEG:
        across, down = view.size_deg
        what = "all indices but the DGP miss light" if measured else "the illuminance at the eye misses light"
        return [f"the view of {across:g}° × {down:g}° is narrower than 180°, so {what}"]
    return []


def rate(
    sources: Iterable[tuple[ArrayLike, float, float]],
    view: View,
    vertical_illuminance: float,
    *,
    mean_luminance: float | None = None,
    background_luminance: float | None = None,
    settings: Settings | None = None,
) -> Evaluation:
    """Rate sources that are known, without a picture.

    Parameters
    ----------
    sources
        Direction (3,), luminance [cd/m²] and solid angle [sr] of each. Those behind the eye do not count.
    view
        Where the eye looks.
    vertical_illuminance
        At the eye, sources included [lx].
    mean_luminance
        Of the whole field of view [cd/m²]; without it DGR and VCP are NaN.
    background_luminance
        Mean outside of the sources [cd/m²], for settings with the background `mean`.
    settings
        Those of `evalglare` 3.06 by default.
    """
    settings = Settings() if settings is None else settings
    given = [[*np.asarray(direction, dtype=np.float64), lum, omega] for direction, lum, omega in sources]
    lights = np.array(given, dtype=np.float64).reshape(-1, 5)
    nothing = math.nan
    table, values = _core.rate_glare(
        lights,
        view._core,
        vertical_illuminance,
        nothing if mean_luminance is None else mean_luminance,
        nothing if background_luminance is None else background_luminance,
        settings,
    )
    indices: dict[str, Any] = dict(values)
    return Evaluation(**indices, sources=_sources(table), settings=settings)


def _sources(table: NDArray[np.float64]) -> tuple[Source, ...]:
    return tuple(
        Source(
            direction=(x, y, z),
            luminance=luminance,
            largest=largest,
            solid_angle=solid_angle,
            illuminance=illuminance,
            sigma_deg=math.degrees(sigma),
            position_index=index,
            pixels=int(pixels),
            peak=peak > 0.0,
        )
        for x, y, z, luminance, largest, solid_angle, illuminance, sigma, index, pixels, peak in table.tolist()
    )
