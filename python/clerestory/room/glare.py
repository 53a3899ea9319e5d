"""Glare in a room without a picture: sources are found in the windows and in what the sun lights."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.glare import Evaluation, Settings, evaluate, rate
from clerestory.photometry import EFFICACY, LUMINANCE
from clerestory.picture import Picture, View
from clerestory.room.picture import options

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from clerestory.room import recipe as keys
    from clerestory.room.world import Room

STEPS = 360
"""Directions across the hemisphere: half a degree; windows' edges are seen finer."""
LEAST_PATHS, MOST_PATHS = 2, 4096
"""Paths a direction of the illuminance: at first, and at most."""
FISHEYE: dict[str, object] = {"projection": "angular", "angle_deg": [180.0, 180.0]}
"""What an eye sees."""
LEAST = 1e-6
"""Luminance [cd/m²] of what no light is left for: none, but a picture is not black."""


def of_room(
    room: Room,
    view: keys.View,
    *,
    error: float,
    samples: int | None,
    seed: int,
    settings: Settings | None,
    progress: Callable[[float], object] | None,
) -> Evaluation:
    """See `Room.glare`."""
    settings = Settings() if settings is None else settings
    if settings.threshold_of != "absolute" or settings.task is not None:
        raise ClerestoryError(
            "a threshold by the mean or by a task area needs a picture (give a luminance, or render a picture)"
        )
    eye = View(options(view.model_copy(update=FISHEYE)))
    forward = np.array(view.direction, dtype=float) / np.linalg.norm(view.direction)
    radiance = room._core.glance(eye.options, STEPS, STEPS).reshape(STEPS, STEPS, 3)
    luminance = EFFICACY * radiance @ LUMINANCE
    solid_angle = eye.solid_angles(STEPS, STEPS)
    projected = solid_angle * np.maximum(np.nan_to_num(eye.pixel_directions(STEPS, STEPS) @ forward), 0.0)
    sun = _sun(room, view)
    followed = _followed(room, view, projected, error, samples, seed, progress)
    illuminance = followed + (0.0 if sun is None else sun.luminance * sun.solid_angle * float(sun.direction @ forward))
    # What comes over several surfaces, as windows' reflections too, is spread over the whole view.
    rest = followed - float((luminance * projected).sum())
    luminance += np.where(solid_angle > 0.0, max(rest / float(projected.sum()), LEAST), 0.0)
    pixels = np.repeat((luminance / EFFICACY)[..., None], 3, axis=2)
    seen = evaluate(Picture(pixels, eye), settings).sources
    sources: list[tuple[ArrayLike, float, float]] = [(s.direction, s.luminance, s.solid_angle) for s in seen]
    direct = sum(s.illuminance for s in seen)
    light, field = float((luminance * solid_angle).sum()), float(solid_angle.sum())
    if sun is not None:
        light += sun.luminance * sun.solid_angle
        if sun.luminance > settings.threshold:
            sources.append((sun.direction, sun.luminance, sun.solid_angle))
            direct += illuminance - followed
    mean = light / field
    # Windows are too large for their illuminance to be that of their middle: what is not of sources is known here.
    background = max(illuminance - direct, 0.0) / math.pi if settings.background == "without-sources" else mean
    known = replace(settings, background="mean") if settings.background == "without-sources" else settings
    found = rate(sources, eye, illuminance, mean_luminance=mean, background_luminance=background, settings=known)
    return replace(found, direct_illuminance=direct, settings=settings)


def _followed(
    room: Room,
    view: keys.View,
    weight: NDArray[np.float64],
    error: float,
    samples: int | None,
    seed: int,
    progress: Callable[[float], object] | None,
) -> float:
    """Illuminance [lx] at the eye without the sun's disc: of a small picture, each pixel by its weight [sr]."""
    from clerestory.room.state import State

    small = view.model_copy(update={**FISHEYE, "size_px": [STEPS, STEPS]})
    state = State.new(room, small, seed=seed)
    paths = LEAST_PATHS if samples is None else samples
    while True:
        picture = room.picture(small, samples=paths, seed=seed, state=state, progress=progress)
        reached = float(np.sqrt(np.sum((picture.noise * weight) ** 2)))
        sums, _ = state.core.sums()
        value = float((EFFICACY * (sums / state.samples) @ LUMINANCE) @ weight.ravel())
        if samples is not None or reached <= error * value or paths >= MOST_PATHS:
            return value
        paths *= 2


@dataclass(frozen=True)
class _Sun:
    """What is seen of the sun's disc."""

    direction: NDArray[np.float64]
    luminance: float
    """Mean [cd/m²]."""
    solid_angle: float
    """[sr]"""


def _sun(room: Room, view: keys.View) -> _Sun | None:
    """The sun before the eye, directly or through the beams of windows."""
    x, y, z = view.point_m
    seen = room._core.sun_seen((x, y, z))
    if seen is None:
        return None
    direction, radiance, solid_angle = seen
    luminance = EFFICACY * float(np.array(radiance) @ LUMINANCE)
    if np.dot(direction, view.direction) <= 0.0 or luminance <= 0.0:
        return None
    return _Sun(np.array(direction), luminance, solid_angle)
