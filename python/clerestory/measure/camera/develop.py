"""Pictures of a camera-based goniophotometer to scans: BSDF = L₂/E₁ on an exit grid.

Source: IEA SHC Task 61 report C.2.2 (2021), sections 2.4 and 2.5 (screens in six positions, projected illuminance,
5° and 2° exit grids); Andersen, Roecker and Scartezzini 2005 (doi:10.1016/j.solmat.2004.11.010) for the principle.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.directions import angles, outgoing_side
from clerestory.files import named
from clerestory.measure.camera.gather import (
    covered,
    covered_directly,
    direct_footprint,
    exit_grid,
    screen_footprints,
)
from clerestory.measure.camera.screen import screens_of
from clerestory.measure.camera.seams import seams_of
from clerestory.measure.scan import Measurement, Scan
from clerestory.picture.image import Picture
from clerestory.picture.view import View
from clerestory.trace.reading import reading

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from clerestory.basis import Basis
    from clerestory.directions import Side
    from clerestory.measure.camera.gather import Footprint
    from clerestory.measure.camera.rig import Incidence, Rig
    from clerestory.measure.camera.screen import Screen
    from clerestory.measure.camera.seams import Seam

    Floats = NDArray[np.float64]

_PIXELS = 4
"""A mean of fewer pixels than this says little of a patch."""
_COVERED = 0.5
"""A direction of the exit grid counts as seen if so much of its patch is."""


@dataclass(frozen=True)
class Developed:
    """What the pictures came to."""

    measurement: Measurement
    """A scan for each incident direction, with the directions that were seen."""
    directions: int
    """Of the exit grid."""
    missing: int
    """Of them, seen by no position: they are absent from the scans, not zero."""
    seams: tuple[tuple[Seam, ...], ...]
    """For each incident direction."""


def develop(rig: Rig, *, progress: Callable[[float], None] | None = None) -> Developed:
    """Make scans of the pictures of a rig.

    Parameters
    ----------
    rig
        Geometry and pictures.
    progress
        Called with the share that is done.

    Raises
    ------
    ClerestoryError
        A picture does not fit the geometry, or no direction of the exit grid is seen.
    OSError
        A picture cannot be read.
    """
    side = outgoing_side(rig.incident_side, rig.scatter)
    basis = exit_grid(rig.grid_deg)
    screens = screens_of(rig.screens)
    warnings: list[str] = []
    scans, seams = [], []
    kept: tuple[list[tuple[int, int]], list[Footprint], Floats] | None = None
    for n, incidence in enumerate(rig.incidences):
        with reading(f"incidences[{n + 1}].pictures"):
            pictures, marks = zip(*(_luminance(rig, Path(path), warnings) for path in incidence.pictures), strict=True)
        shapes = [(int(p.shape[0]), int(p.shape[1])) for p in pictures]
        if kept is None or kept[0] != shapes:
            kept = (shapes, *_geometry(rig, screens, shapes, basis, side, warnings))
        _, footprints, share = kept
        found, joints = _one(rig, incidence, pictures, screens, footprints, share, basis, warnings)
        theta, phi = _centres(basis, side)
        seen = np.isfinite(found)
        conditions = {
            "instrument": "camera-based goniophotometer",
            "detector": "luminance camera",
            "pictures": "; ".join(marks),
            "exit grid": f"{rig.grid_deg:g}°, {len(basis)} directions, {int((~seen).sum())} not seen",
        }
        if rig.laboratory:
            conditions["laboratory"] = rig.laboratory
        scans.append(
            Scan(
                rig.incident_side,
                rig.scatter,
                incidence.theta_deg,
                incidence.phi_deg % 360.0,
                theta[seen],
                phi[seen],
                found[seen, None],
                conditions=conditions,
            )
        )
        seams.append(tuple(joints))
        if progress is not None:
            progress((n + 1) / len(rig.incidences))
    missing = len(basis) - len(scans[0])
    return Developed(
        Measurement(rig.sample, tuple(scans), tuple(dict.fromkeys(warnings))), len(basis), missing, tuple(seams)
    )


def _geometry(
    rig: Rig,
    screens: list[Screen],
    shapes: list[tuple[int, int]],
    basis: Basis,
    side: Side,
    warnings: list[str],
) -> tuple[list[Footprint], Floats]:
    """Footprints of all positions, and how much of each patch is seen."""
    if rig.direct is not None:
        view = View(rig.direct.view)
        footprints, share = [direct_footprint(view, shapes[0], basis, side)], covered_directly(view, basis, side)
    else:
        sizes = [t.camera.size_pixels if t.camera else None for t in rig.screens for _ in t.turned_deg]
        for screen, size, (height, width) in zip(screens, sizes, shapes, strict=True):
            if size is not None and size != [width, height]:
                raise ClerestoryError(
                    f"{screen.name}: a picture of {width} × {height} pixels is not the camera's of "
                    f"{size[0]} × {size[1]} (correct size_pixels, or the picture)"
                )
        footprints = screen_footprints(screens, shapes, basis, side, rig.feather)
        share = covered(screens, shapes, basis, side)
        _check_width(rig, screens, warnings)
    for screen, footprint in zip(screens, footprints, strict=False):
        if not len(footprint.pixels):
            raise ClerestoryError(
                f"{screen.name}: no pixel shows light that leaves to the {side} "
                "(check its corners, marks and the sign of z)"
            )
    counts = np.bincount(np.concatenate([f.patches for f in footprints]), minlength=len(basis))
    share = np.where(counts > 0, share, 0.0)
    few = int(((counts < _PIXELS) & (share >= _COVERED)).sum())
    if few:
        warnings.append(
            f"{counted(few, 'direction')} of {len(basis)} are the mean of fewer than {_PIXELS} pixels "
            "(larger pictures, or a coarser exit grid)"
        )
    missing = share < _COVERED
    if missing.all():
        raise ClerestoryError("no direction of the exit grid is seen (check the screens' corners and the pictures)")
    if missing.any():
        warnings.append(f"{_missing_words(basis, side, missing)} (absent, not zero)")
    return footprints, share


def _one(
    rig: Rig,
    incidence: Incidence,
    pictures: Sequence[Floats],
    screens: list[Screen],
    footprints: list[Footprint],
    share: Floats,
    basis: Basis,
    warnings: list[str],
) -> tuple[Floats, list[Seam]]:
    """BSDF of each patch, NaN where it was not seen, and the seams."""
    cosine = float(np.cos(np.radians(incidence.theta_deg)))
    per_lux = 1.0 / (incidence.illuminance_lx * (cosine if rig.illuminance_on == "beam" else 1.0))
    if rig.aperture_mm2 is not None and screens:
        per_lux /= rig.aperture_mm2 / (cosine if rig.aperture_on == "beam" else 1.0)
    scaled = [picture * per_lux for picture in pictures]
    total, weight = np.zeros(len(basis)), np.zeros(len(basis))
    for picture, footprint in zip(scaled, footprints, strict=True):
        values = picture.ravel()[footprint.pixels] * footprint.factor
        weight += np.bincount(footprint.patches, footprint.weights, minlength=len(basis))
        total += np.bincount(footprint.patches, footprint.weights * values, minlength=len(basis))
    with np.errstate(invalid="ignore", divide="ignore"):
        found = np.where((share >= _COVERED) & (weight > 0.0), total / weight, np.nan)
    joints = seams_of(screens, scaled)
    faulty = [seam for seam in joints if seam.mismatch > rig.largest_mismatch]
    if faulty:
        place = f"{incidence.theta_deg:g},{incidence.phi_deg:g}"
        warnings.append(_seam_words(faulty, joints, place))
    return found, joints


def _luminance(rig: Rig, path: Path, warnings: list[str]) -> tuple[Floats, str]:
    """Luminance (height, width) of a picture without the dark and the lens's darkening, and the mark of its bytes."""
    picture = Picture.read(path)
    mark = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    warnings += [f"{path.name}: {text}" for text in picture.warnings]
    values = np.asarray(picture.luminance, dtype=np.float64) - rig.dark_cd_m2
    if not np.isfinite(values).all():
        raise ClerestoryError(f"{path}: a pixel is not a number (make the picture anew)")
    if rig.vignetting is not None:
        from clerestory.photo.vignetting import Vignetting

        with named(path):
            height, width = values.shape
            x, y = np.arange(width) + 0.5 - 0.5 * width, np.arange(height) + 0.5 - 0.5 * height
            away = np.arctan(np.hypot(x[None, :], y[:, None]) / rig.vignetting.focal_pixels)
            values = values / Vignetting(tuple(rig.vignetting.coefficients)).at(away)
    return values, f"{path.name} {mark}"


def _centres(basis: Basis, side: Side) -> tuple[Floats, Floats]:
    """Nominal polar angles and azimuths [°] of the exit grid."""
    nominal = np.concatenate([np.full(count, theta) for _, _, theta, count in basis.rings])
    _, phi = angles(basis.outgoing_centres(side))
    return nominal, np.where(nominal > 0.0, np.round(phi, 6) % 360.0, 0.0)


def _check_width(rig: Rig, screens: list[Screen], warnings: list[str]) -> None:
    """A lit patch that is wide as seen from a screen blurs directions."""
    nearest = min(abs(float(s.origin @ s.normal)) for s in screens)
    wide = 2.0 * np.sqrt(float(rig.aperture_mm2 or 0.0) / np.pi)
    seen = float(np.degrees(2.0 * np.arctan(0.5 * wide / nearest)))
    if seen > rig.grid_deg:
        warnings.append(
            f"the lit patch is {seen:.1f}° wide as seen from the nearest screen, more than the exit grid of "
            f"{rig.grid_deg:g}°: directions are blurred by that (a smaller aperture or a larger screen)"
        )


def _missing_words(basis: Basis, side: Side, missing: NDArray[np.bool_]) -> str:
    """How many directions are missing, and where: the sectors of 30° that lack most of theirs, or the angles."""
    theta, phi = _centres(basis, side)
    words = f"{counted(int(missing.sum()), 'direction')} of {len(basis)} were seen by no position"
    sectors = np.floor(phi / 30.0).astype(int)
    whole = [k for k in range(12) if missing[(sectors == k) & (theta > 0)].mean() > 0.8]
    if whole and len(whole) < 12:
        return f"{words}: azimuths " + ", ".join(f"{30 * k} to {30 * k + 30}°" for k in whole)
    return f"{words}: polar angles {theta[missing].min():g} to {theta[missing].max():g}°"


def _seam_words(faulty: list[Seam], joints: list[Seam], place: str) -> str:
    worst = max(faulty, key=lambda seam: seam.mismatch)
    much = f"{100.0 * worst.mismatch:.1f} %"
    words = f"light from {place}: {worst.first} and {worst.second} differ by {much} along their seam"
    # A screen all of whose seams are faulty, and whose neighbours agree with the rest, is the misplaced one.
    names = {name for seam in joints for name in (seam.first, seam.second)}
    alone = [
        name
        for name in sorted(names)
        if all(seam in faulty for seam in joints if name in (seam.first, seam.second))
        and all(name in (seam.first, seam.second) for seam in faulty)
        and len(joints) > len(faulty)
    ]
    if len(alone) == 1:
        return f"{words}; only seams of {alone[0]} do (check where it stands, its marks and its picture)"
    return f"{words} (check corners, marks, reflectances and the camera's exposure)"
