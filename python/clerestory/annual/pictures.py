"""Pictures of a room over a year, as the five-phase method makes them.

A picture is put together of what is known at different resolutions. Surfaces have the light of the windows' patches,
but for what they get of the sun from a window without another surface: that comes from the sun itself, not from its
patch of the sky. Windows show the sky's light through the system and the sun's at the data set's own resolution, for
the direction of each pixel; beams show the sky behind them, and the sun's disc. So pictures can be rated
as photographs are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.cells import SkyThrough
from clerestory.annual.glare import SOLAR_SOLID_ANGLE
from clerestory.annual.phases import Transfer, leaving
from clerestory.annual.sun import Outgoing, SunThrough
from clerestory.glare import evaluate
from clerestory.picture import Picture

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from clerestory.annual.arrivals import Arrivals, Light
    from clerestory.bsdf import Bsdf
    from clerestory.glare import Settings
    from clerestory.picture import View

    Doubles = NDArray[np.float64]
    Floats = NDArray[np.float32]

_TOGETHER = 16
"""Steps that are in memory at a time."""
_STEPS = 64
"""Along each axis of the square of a window's directions, by which the sun's light in a patch is found."""


class YearPictures:
    """Pictures of a room under the skies of a year.

    Parameters
    ----------
    arrivals
        What arrives at the windows of the room.
    view
        Where the eye is, and how the picture is projected.
    size_px
        Width and height.
    samples
        Paths of a pixel, for the light on surfaces; a multiple of 16.
    returned
        Paths of a patch of the windows into the room.
    """

    def __init__(
        self,
        arrivals: Arrivals,
        view: View,
        size_px: tuple[int, int],
        *,
        samples: int = 64,
        returned: int = 4096,
    ) -> None:
        from scipy.sparse import csr_array

        width, height = size_px
        matrices = arrivals.matrices
        self.arrivals, self.matrices, self.view, self.size_px = arrivals, matrices, view, size_px
        groups = range(len(matrices))
        self._returned = [matrices.returned(g, samples=returned).all for g in groups]
        self._surfaces = matrices.surfaces(view, size_px, samples=samples)
        seen = matrices.windows_seen(view, size_px)
        frames = np.stack([matrices.frame(g) for g in groups])[seen.group]
        self._outgoing = Outgoing(seen.group, -np.einsum("nij,nj->ni", frames, seen.direction))
        parts = (seen.share, (seen.pixel, np.arange(len(seen.pixel))))
        self._windows = csr_array(parts, shape=(width * height, len(seen.pixel)))
        origins, directions = view.rays(_centres(width, height))
        self._eye = origins[np.isfinite(directions).all(axis=1)][0]
        self._directions = directions
        self._solid_angles = view.solid_angles(width, height).ravel()
        share = 1.0 - np.asarray(self._windows.sum(axis=1))
        self._on_surfaces = np.flatnonzero(np.isfinite(directions).all(axis=1) & (share > 1e-9))
        self._share = share[self._on_surfaces].astype(np.float32)

    def of(self, systems: Sequence[Bsdf]) -> SystemPictures:
        """With what stands in each group of windows; beams are as they are (see `Bsdf.separate_peaks`)."""
        if len(systems) != len(self.matrices):
            raise ClerestoryError(f"{len(systems)} systems for {len(self.matrices)} groups of windows (give one each)")
        return SystemPictures(self, systems)


class SystemPictures:
    """Pictures of a year with one choice of systems: made by `YearPictures.of`."""

    def __init__(self, year: YearPictures, systems: Sequence[Bsdf]) -> None:
        self._year = year
        transfers = [Transfer.of(bsdf, year.matrices.basis) for bsdf in systems]
        from scipy.sparse import csr_array

        self._once = leaving(transfers)
        self._whole = leaving(transfers, year._returned)
        self._beams = np.concatenate([transfer.beam for transfer in transfers])
        self._through = SunThrough(year.matrices, tuple(systems))
        self._sky = SkyThrough.of(self._through, year._outgoing, year.arrivals.sky.patches._core)
        self._returns = (self._whole - self._once)[self._sky.patch]
        groups, patches = len(systems), len(year.matrices.basis)
        self._cells = Outgoing.of_cells(np.arange(groups * _STEPS**2), _STEPS)
        patch = year.matrices.basis._core.patch_of(np.ascontiguousarray(self._cells.direction[:, :2]))
        patch = patch + self._cells.group * patches
        shares = 1.0 / np.bincount(patch, minlength=groups * patches)[patch]
        self._mean = csr_array((shares, (patch, np.arange(len(patch)))), shape=(groups * patches, len(patch)))

    def at(self, steps: Sequence[int] | NDArray[np.int64]) -> Iterator[tuple[int, Picture]]:
        """Steps, each with its picture [W/(m² sr)], of visible watts of 179 lm; grey, and black where it is dark."""
        width, height = self._year.size_px
        for step in steps:
            light = self._year.arrivals.at(slice(int(step), int(step) + 1))
            dark = np.zeros(width * height, dtype=np.float32)
            yield int(step), self._picture(self._radiance(light)[:, 0] if light.steps else dark)

    def rated(self, light: Light, settings: Settings, indices: Sequence[str]) -> dict[str, Doubles]:
        """Illuminance at the eye [lx] and indices (steps) by name, of pictures; not a number where it is dark."""
        found = {"illuminance": np.zeros(light.steps)} | {name: np.full(light.steps, np.nan) for name in indices}
        for first in range(0, light.steps, _TOGETHER):
            for number, values in enumerate(self._radiance(light.part(slice(first, first + _TOGETHER))).T, first):
                if not values.any():
                    continue
                rated = evaluate(self._picture(values), settings)
                found["illuminance"][number] = rated.vertical_illuminance
                for name in indices:
                    found[name][number] = getattr(rated, name)
        return found

    def _picture(self, radiance: Floats) -> Picture:
        from clerestory import __version__

        width, height = self._year.size_px
        grey = np.repeat(radiance.reshape(height, width, 1), 3, axis=2)
        return Picture(grey, self._year.view, header=[f"SOFTWARE= clerestory {__version__}"])

    def _radiance(self, light: Light) -> Floats:
        """Of pixels (pixels, steps)."""
        year = self._year
        beams = self._through.beams(light.suns, light.irradiance)
        surfaces = year._surfaces.all @ (self._whole @ light.arrives)
        # What comes from the sun's patch of the sky, and without another surface, is found again for the sun itself.
        scattered = self._mean @ self._through.radiance(self._cells, light.suns, light.irradiance)
        surfaces += year._surfaces.direct @ (scattered - self._once @ light.directly)
        if self._beams.any():
            directions = year._directions[year._on_surfaces]
            sunlit = self._through.on_surfaces(year._eye, directions, light.suns, beams)
            surfaces[year._on_surfaces] += year._share[:, None] * sunlit
        windows = self._sky.radiance(light.diffuse, light.sky) + self._returns @ light.arrives
        windows += self._through.radiance(year._outgoing, light.suns, light.irradiance)
        pixels: Floats = np.maximum(surfaces, 0.0) + (year._windows @ windows).astype(np.float32)
        self._add_suns(pixels, light, beams)
        return pixels

    def _add_suns(self, pixels: Floats, light: Light, beams: Doubles) -> None:
        """The sun's disc where it is seen straight: its light in as many whole pixels as have its size.

        A disc that is smeared over the pixels that it touches would lose a part of its glare, which goes with the
        square of the luminance.
        """
        year = self._year
        straight = self._through.through(year._eye[None], light.suns, light.irradiance, beams)[0]
        for step in np.flatnonzero(straight > 0.0):
            if np.isnan(year.view.locate(light.suns[step])).any():
                continue
            near = np.where(
                year._solid_angles > 0.0, np.nan_to_num(year._directions @ light.suns[step], nan=-1.0), -1.0
            )
            nearest = np.argsort(-near)[: 1 + int(2.0 * SOLAR_SOLID_ANGLE / year._solid_angles.max())]
            size = np.cumsum(year._solid_angles[nearest])
            count = 1 + int(np.abs(size - SOLAR_SOLID_ANGLE).argmin())
            pixels[nearest[:count], step] += straight[step] / size[count - 1]


def _centres(width: int, height: int) -> Doubles:
    """Of pixels (pixels, 2), row by row from the top left."""
    x, y = (np.arange(width) + 0.5) / width, 1.0 - (np.arange(height) + 0.5) / height
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
