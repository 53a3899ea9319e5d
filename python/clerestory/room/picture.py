"""Pictures of a room."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.photometry import EFFICACY, LUMINANCE

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from clerestory.picture import Picture
    from clerestory.room import recipe as keys

PROJECTIONS = {
    "perspective": "v",
    "parallel": "l",
    "hemispherical": "h",
    "angular": "a",
    "planispheric": "s",
    "cylindrical": "c",
}
"""Radiance's letters."""
PASS = 4
"""Paths a pixel of a pass."""
MOST = 1 << 20
"""Paths a pixel, at most."""


@dataclass(frozen=True)
class Rendering:
    """A picture of radiance."""

    radiance: NDArray[np.float64]
    """(height, width, 3) [W/(m² sr)] of Radiance's channels, top row first; 0 outside of the projection."""
    noise: NDArray[np.float64]
    """(height, width) standard error of the luminance [cd/m²], by the spread of the pixel's paths: an upper bound, as
    they are stratified."""
    view: str
    """Radiance's options of the view."""
    samples: int
    """Paths a pixel."""
    seconds: float
    """That it took."""

    @property
    def luminance(self) -> NDArray[np.float64]:
        """(height, width) [cd/m²]."""
        return np.asarray(EFFICACY * self.radiance @ LUMINANCE)

    def picture(self) -> Picture:
        """The same as a picture that can be written and rated."""
        from clerestory import __version__
        from clerestory.picture import Picture, View

        header = [f"SOFTWARE= clerestory {__version__}", f"SAMPLES= {self.samples} paths a pixel"]
        return Picture(self.radiance, View(self.view), header=header)

    @property
    def relative_noise(self) -> float:
        """Mean noise over mean luminance."""
        mean = float(self.luminance.mean())
        return float(self.noise.mean()) / mean if mean > 0.0 else 0.0


def options(view: keys.View) -> str:
    """Radiance's options of a view."""

    def numbers(values: list[float]) -> str:
        return " ".join(f"{v:.10g}" for v in values)

    letter = PROJECTIONS[view.projection]
    return (
        f"-vt{letter} -vp {numbers(view.point_m)} -vd {numbers(view.direction)} -vu {numbers(view.up)} "
        f"-vh {view.angle_deg[0]:.10g} -vv {view.angle_deg[1]:.10g}"
    )


def render(
    core: _core.Room,
    view: keys.View,
    *,
    noise: float,
    samples: int | None,
    seconds: float | None,
    seed: int,
    progress: Callable[[float], object] | None,
) -> Rendering:
    """See `Room.picture`."""
    if samples is not None and not 1 <= samples <= MOST:
        raise ClerestoryError(f"{samples} paths a pixel cannot be (give 1 to {MOST})")
    if not 0.0 < noise < 10.0:
        raise ClerestoryError(f"a noise of {noise:g} is not one to reach (give 0.05 for five per cent)")
    if seconds is not None and seconds <= 0.0:
        raise ClerestoryError(f"{seconds:g} seconds are no time (give more than 0)")
    start = time.perf_counter()
    width, height = view.size_px
    picture = _core.RoomPicture(core, options(view), width, height, seed)
    sun = picture.sun()
    while True:
        done = picture.samples()
        paths = min(PASS, (samples or MOST) - done)

        def share(part: float, done: int = done, paths: int = paths) -> None:
            if progress is not None and samples is not None:
                progress((done + part * paths) / samples)

        picture.add(paths, share)
        taken = time.perf_counter() - start
        over = seconds is not None and taken >= seconds
        if samples is not None:
            if over or picture.samples() >= samples:
                return _rendering(picture, sun, view, taken)
            continue
        found = _rendering(picture, sun, view, taken)
        reached = found.relative_noise
        if over or reached <= noise or found.samples >= MOST:
            return found
        if progress is not None:
            parts = [(noise / reached) ** 2]
            parts += [taken / seconds] if seconds is not None else []
            progress(max(parts))


def _rendering(picture: _core.RoomPicture, sun: NDArray[np.float64], view: keys.View, seconds: float) -> Rendering:
    width, height = view.size_px
    sums, squares = picture.sums()
    n = picture.samples()
    mean = sums / n
    variance = np.maximum(squares / n - (mean.mean(axis=1)) ** 2, 0.0) / max(n - 1, 1)
    return Rendering(
        radiance=(mean + sun).reshape(height, width, 3),
        noise=EFFICACY * np.sqrt(variance).reshape(height, width),
        view=options(view),
        samples=n,
        seconds=seconds,
    )
