"""The figures of one data set that a comparison shows beside those of the others.

All data sets are treated alike, whatever their resolution: incident light fills a patch of Klems' full basis, and
direct-direct is what leaves through the outgoing patch of the same number, as the Task 61 report (2021, C.2.2, section
3.4) tabulates it. A matrix on Klems full answers by its own values; everything else is averaged.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.basis import Basis
from clerestory.bsdf import Region
from clerestory.counts import counted
from clerestory.directions import angles
from clerestory.integrals import continued, cut_off, hemispherical, own_basis, patch_directions

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.compare.result import Settings
    from clerestory.directions import Scatter

AZIMUTHS_DEG = {90.0: "light from above", 0.0: "light from the right"}
"""Planes of incidence of the cut-off angle."""


@dataclass(frozen=True)
class Figure:
    """A figure of one data set."""

    key: str
    group: str
    symbol: str
    of: str
    patch: int | None
    unit: str
    words: str
    value: float | None
    standard_error: float | None = None
    resolved: bool = True


def klems() -> Basis:
    """The basis of all incident patches."""
    return Basis.named("klems-full")


def theta_words(patch: int) -> str:
    """Polar angle of a patch, and its number: `30° (Klems 41)`."""
    theta, _ = angles(klems().incident_centres("exterior")[patch - 1])
    return f"{float(theta):.3g}° (Klems {patch})"


def figures(bsdf: Bsdf, settings: Settings, *, reflection: bool) -> list[Figure]:
    """All figures of a data set.

    Parameters
    ----------
    reflection
        Also the reflectance of the side that the light comes from.
    """
    scatter = settings.scatter
    letter = "T" if scatter == "transmission" else "R"
    made = _hemispherical(bsdf, settings, scatter, letter, "hemispherical")
    for patch in settings.patches:
        made += _at_patch(bsdf, settings, patch, letter)
    for patch in settings.patches:
        made += _cones(bsdf, settings, patch, letter)
    if scatter == "transmission":
        made += _cut_offs(bsdf, settings)
    if reflection:
        made += _hemispherical(bsdf, settings, "reflection", "R", "reflection")[:1]
        for patch in settings.patches:
            points, words = _incident(bsdf, settings, patch, "reflection")
            value, error = _mean(bsdf, settings, points, "reflection", None)
            made.append(
                Figure(
                    f"R_d-h, Klems {patch}",
                    "reflection",
                    "R_d-h",
                    theta_words(patch),
                    patch,
                    "%",
                    f"direct-hemispherical reflectance, {words}",
                    value,
                    error,
                )
            )
    return made


def _hemispherical(bsdf: Bsdf, settings: Settings, scatter: Scatter, letter: str, group: str) -> list[Figure]:
    uniform = hemispherical(bsdf, scatter, side=settings.side, band=settings.band, samples=settings.samples)
    overcast = hemispherical(
        bsdf,
        scatter,
        side=settings.side,
        band=settings.band,
        sky="overcast",
        ground_reflectance=settings.ground_reflectance,
        samples=settings.samples,
    )
    symbol = f"{letter}_h-h"
    return [
        Figure(
            f"{symbol}, {name}", group, symbol, name, None, "%", integral.words, integral.value, integral.standard_error
        )
        for name, integral in (("uniform", uniform), ("CIE overcast sky", overcast))
    ]


def _incident(bsdf: Bsdf, settings: Settings, patch: int, scatter: Scatter) -> tuple[NDArray[np.float64], str]:
    """Incident directions of a patch, and words for them."""
    points = patch_directions(bsdf, patch, scatter, side=settings.side, band=settings.band, samples=settings.samples)
    if len(points) == 1 and own_basis(bsdf, scatter, settings.side, settings.band) == klems():
        return points, "incident Klems full patch, the data's own"
    return points, f"mean over {counted(len(points), 'direction')} of the incident Klems full patch"


def _mean(
    bsdf: Bsdf, settings: Settings, points: NDArray[np.float64], scatter: Scatter, region: Region | None
) -> tuple[float, float | None]:
    """Mean over incident directions; their errors are taken as one."""
    values, errors = bsdf.integrate_with_error(points, scatter, region, settings.band)
    error = float(np.mean(errors))
    return float(np.mean(values)), error if np.isfinite(error) else None


def _at_patch(bsdf: Bsdf, settings: Settings, patch: int, letter: str) -> list[Figure]:
    scatter = settings.scatter
    points, words = _incident(bsdf, settings, patch, scatter)
    total, total_error = _mean(bsdf, settings, points, scatter, None)
    same = Region.patches(klems(), [patch - 1])
    direct, direct_error = _mean(bsdf, settings, points, scatter, same)
    of = theta_words(patch)
    return [
        Figure(
            f"{letter}_d-h, Klems {patch}",
            "direct-hemispherical",
            f"{letter}_d-h",
            of,
            patch,
            "%",
            f"direct-hemispherical, {words}",
            total,
            total_error,
        ),
        Figure(
            f"{letter}_d-d, Klems {patch}",
            "direct-direct",
            f"{letter}_d-d",
            of,
            patch,
            "%",
            f"direct-direct, into the outgoing Klems full patch of the same number, {words}",
            direct,
            direct_error,
        ),
    ]


def _cones(bsdf: Bsdf, settings: Settings, patch: int, letter: str) -> list[Figure]:
    incident = klems().incident_centres(settings.side)[patch - 1]
    resolution = float(bsdf.resolution_deg(incident, settings.scatter, settings.band))
    axis = continued(incident, settings.scatter)
    made = []
    for half in settings.cones_deg:
        value, error = bsdf.integrate_with_error(incident, settings.scatter, Region.cone(axis, half), settings.band)
        resolved = 2.0 * half >= resolution
        words = f"direct-direct, within {half:g}° of the continued direction, centre of the incident Klems full patch"
        if not resolved:
            words += ", narrower than the data resolve"
        made.append(
            Figure(
                f"{letter}_d-d within {half:g}°, Klems {patch}",
                "cone",
                f"{letter}_d-d",
                f"within {half:g}°, {theta_words(patch)}",
                patch,
                "%",
                words,
                float(value),
                float(error) if np.isfinite(error) else None,
                resolved,
            )
        )
    return made


def _cut_offs(bsdf: Bsdf, settings: Settings) -> list[Figure]:
    made = []
    for azimuth, name in AZIMUTHS_DEG.items():
        found = cut_off(bsdf, azimuth, side=settings.side, band=settings.band)
        # Where no light passes, none is cut off.
        angle = found.angle_deg if found.values[0] > 0.0 else None
        made.append(
            Figure(f"cut-off, {name}", "cut-off", "θ_co", name, None, "°", f"cut-off angle, {found.words}", angle)
        )
    return made
