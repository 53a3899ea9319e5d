"""Pixels to directions: which light of the sample each pixel shows, and how much of the hemisphere it stands for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.basis import Basis

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Side
    from clerestory.measure.camera.screen import Screen
    from clerestory.picture.view import View

    Floats = NDArray[np.float64]

_LEAST_COSINE = 1e-3
"""Light closer to the horizon (0.06°) reaches no screen."""


@dataclass(frozen=True)
class Footprint:
    """The pixels of one position that show light of the sample."""

    pixels: NDArray[np.int64]
    """Their numbers in the picture, row by row (n,)."""
    patches: NDArray[np.int64]
    """The patch of the exit grid that each belongs to (n,)."""
    factor: Floats
    """What a pixel's luminance is multiplied by to be the sample's: [mm²] for a screen, whose lit area it is then
    divided by; 1 for a camera that sees the sample (n,)."""
    weights: Floats
    """Projected solid angle [sr] that each stands for, less where another position sees the same (n,)."""


def exit_grid(step_deg: float) -> Basis:
    """The patches of an exit grid; of 5° IEA Task 21's."""
    if step_deg == 5.0:
        return Basis.named("iea21")
    rings, around = round(90.0 / step_deg), round(360.0 / step_deg)
    half = 0.5 * step_deg
    made = [(0.0, half, 0.0, 1)]
    made += [(k * step_deg - half, min(k * step_deg + half, 90.0), k * step_deg, around) for k in range(1, rings + 1)]
    return Basis.from_rings(f"{step_deg:g}° exit grid", made)


def screen_footprints(
    screens: Sequence[Screen], shapes: Sequence[tuple[int, int]], basis: Basis, side: Side, feather: float
) -> list[Footprint]:
    """The pixels of every position; where screens overlap, their weights add up to one and fade toward their edges."""
    return [_screen(n, screens, shapes, basis, side, feather) for n in range(len(screens))]


def _screen(
    n: int, screens: Sequence[Screen], shapes: Sequence[tuple[int, int]], basis: Basis, side: Side, feather: float
) -> Footprint:
    screen, (height, width) = screens[n], shapes[n]
    rows, columns = np.indices((height, width))
    centres = np.column_stack([columns.ravel() + 0.5, rows.ravel() + 0.5])
    places, area = screen.places(centres)
    with np.errstate(invalid="ignore"):
        inside = np.flatnonzero(screen.edge_distance(places) >= 0.0)
    factor, d, per_area = screen.factor(places[inside])
    leaving = d[:, 2] * _sign(side) > _LEAST_COSINE
    inside, factor, d, per_area = inside[leaving], factor[leaving], d[leaving], per_area[leaving]
    shares = np.array([_share(other, d, shape, feather) for other, shape in zip(screens, shapes, strict=True)])
    weight = np.maximum(shares[n], 1e-9)
    blended = weight / np.maximum(shares.sum(axis=0), weight)
    projected = area[inside] * per_area * np.abs(d[:, 2])
    return Footprint(inside, basis.index_of_outgoing(d), factor, projected * blended)


def _share(screen: Screen, directions: Floats, shape: tuple[int, int], feather: float) -> Floats:
    """How much a screen has to say of directions (n,): 1 well inside, falling to 0 at its edges, 0 outside."""
    places = screen.hit(directions)
    with np.errstate(invalid="ignore"):
        distance = np.nan_to_num(screen.edge_distance(places), nan=-1.0)
    inside = distance >= 0.0
    reach = max(feather * screen.size, 1e-9)
    made = np.where(inside, np.clip(distance / reach, 1e-6, 1.0), 0.0)
    return np.where(in_picture(screen, places, shape), made, 0.0)


def in_picture(screen: Screen, places: Floats, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Whether places (n, 2) are seen in a picture of some height and width."""
    pixels = screen.pixels(places)
    with np.errstate(invalid="ignore"):
        return np.asarray((pixels >= 0.0).all(axis=1) & (pixels[:, 0] <= shape[1]) & (pixels[:, 1] <= shape[0]))


def direct_footprint(view: View, shape: tuple[int, int], basis: Basis, side: Side) -> Footprint:
    """The pixels of a camera that sees the sample itself, one direction each."""
    height, width = shape
    d = view.pixel_directions(width, height).reshape(-1, 3)
    solid = view.solid_angles(width, height, exact=True).ravel()
    with np.errstate(invalid="ignore"):
        seen = np.flatnonzero((d[:, 2] * _sign(side) > _LEAST_COSINE) & (solid > 0.0))
    return Footprint(seen, basis.index_of_outgoing(d[seen]), np.ones(len(seen)), solid[seen] * np.abs(d[seen, 2]))


def covered(
    screens: Sequence[Screen], shapes: Sequence[tuple[int, int]], basis: Basis, side: Side, *, across: int = 4
) -> Floats:
    """Share of each patch (patches,) that any screen catches."""
    d = _inside_patches(basis, side, across)
    flat = d.reshape(-1, 3)
    seen = np.zeros(len(flat), dtype=bool)
    for screen, shape in zip(screens, shapes, strict=True):
        seen |= _share(screen, flat, shape, 0.0) > 0.0
    return np.asarray(seen.reshape(d.shape[:2]).mean(axis=1))


def covered_directly(view: View, basis: Basis, side: Side, *, across: int = 4) -> Floats:
    """Share of each patch (patches,) that a camera sees."""
    at = view.locate(_inside_patches(basis, side, across))
    with np.errstate(invalid="ignore"):
        return np.asarray(((at >= 0.0) & (at <= 1.0)).all(axis=-1).mean(axis=1))


def _inside_patches(basis: Basis, side: Side, across: int) -> Floats:
    steps = (np.arange(across) + 0.5) / across
    u = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    return np.stack([basis.sample_outgoing(n, u, side) for n in range(len(basis))])


def _sign(side: Side) -> float:
    return 1.0 if side == "interior" else -1.0
