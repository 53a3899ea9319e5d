"""Pictures of a room."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.photometry import EFFICACY, LUMINANCE

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from clerestory import _core
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
PASS, PASS_PATHS = 4, 1 << 20
"""Paths a pixel of a pass, at most; and about how many in all, so that an interruption loses little."""
LEAST = 2
"""Paths a pixel of the first pass, from which noise is known."""
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
    denoised: bool = False
    """Neighbours were averaged, see `Room.denoise`."""

    @property
    def luminance(self) -> NDArray[np.float64]:
        """(height, width) [cd/m²]."""
        return np.asarray(EFFICACY * self.radiance @ LUMINANCE)

    def picture(self) -> Picture:
        """The same as a picture that can be written and rated."""
        from clerestory import __version__
        from clerestory.picture import Picture, View

        header = [f"SOFTWARE= clerestory {__version__}", f"SAMPLES= {self.samples} paths a pixel"]
        if self.denoised:
            header.append("DENOISED= non-local means within surfaces")
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
    picture: _core.RoomPicture,
    view: keys.View,
    *,
    noise: float,
    samples: int | None,
    seconds: float | None,
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
    sun = picture.sun()
    begun = picture.samples()
    one_pass = min(max(PASS_PATHS // (view.size_px[0] * view.size_px[1]), 1), PASS)
    while True:
        done, taken = picture.samples(), time.perf_counter() - start
        over = done >= MOST or (seconds is not None and done > begun and taken >= seconds)
        if over or (samples is not None and done >= samples):
            break
        if samples is None and done > 0:
            reached = _rendering(picture, sun, view, taken).relative_noise
            if reached <= noise:
                break
            if progress is not None:
                progress(max((noise / reached) ** 2, taken / seconds if seconds is not None else 0.0))
        paths = min(max(one_pass, LEAST - done), (samples or MOST) - done)

        def share(part: float, done: int = done, paths: int = paths) -> None:
            if progress is not None and samples is not None:
                progress((done + part * paths) / samples)

        picture.add(paths, share)
    return _rendering(picture, sun, view, time.perf_counter() - start)


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
