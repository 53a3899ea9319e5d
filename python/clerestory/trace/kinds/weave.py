"""Woven fabrics: yarns of elliptical section that pass over and under each other."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field, model_validator

from clerestory.trace.keys import Keys, Number, Positive, wrong
from clerestory.trace.kinds.common import Kind
from clerestory.trace.shapes import Mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.trace.shapes import Face
    from clerestory.trace.workshop import Workshop

    Floats = NDArray[np.float64]

SECTION = 16
"""Corners of a yarn's section; two of them lie at its widest place, so that the open area is exact."""
STEPS = 12
"""Sections from crossing to crossing."""

# Where the warp lies on the side of the room: [end][pick], repeated.
_PATTERNS: dict[str, tuple[str, ...]] = {
    "plain": ("10", "01"),
    "twill-2/1": ("110", "011", "101"),
    "twill-2/2": ("1100", "0110", "0011", "1001"),
    "twill-3/1": ("1110", "0111", "1011", "1101"),
    "basket-2/2": ("1100", "1100", "0011", "0011"),
    "satin-5": ("01111", "11011", "11110", "10111", "11101"),
    "satin-8": (
        "01111111",
        "11101111",
        "11111101",
        "10111111",
        "11110111",
        "11111110",
        "11011111",
        "11111011",
    ),
}


class Yarn(Keys):
    """The yarns of one direction."""

    per_cm: Positive
    """Yarns a centimetre."""
    width_mm: Positive | None = None
    """Width [mm]; found from the openness where it is left out."""
    thickness_mm: Positive
    """Thickness [mm]."""
    material: str
    """What its surface does with light; one that light passes makes a translucent yarn, whose walls it passes twice."""

    @property
    def pitch_mm(self) -> float:
        """Distance from yarn to yarn [mm]."""
        return 10.0 / self.per_cm


class WovenFabric(Kind):
    """A woven fabric: the warp runs upwards (along y), the weft to the side (along x)."""

    kind: Literal["woven-fabric"]
    weave: Literal["plain", "twill-2/1", "twill-2/2", "twill-3/1", "basket-2/2", "satin-5", "satin-8"]
    """How the yarns pass over and under each other."""
    warp: Yarn
    """The upright yarns: ends."""
    weft: Yarn
    """The level yarns: picks."""
    openness: float | None = Field(default=None, gt=0.0, lt=1.0)
    """Open share of the area, seen along the normal; the widths that are left out are found so that it is met."""
    crimp: Literal["sine", "arc"] = "sine"
    """The way of a yarn from one side to the other: a sine, or two circular arcs."""
    warp_crimp: Number = Field(default=0.5, ge=0.0, le=1.0)
    """Share of the way from side to side that the warp makes; the weft makes the rest."""

    @model_validator(mode="after")
    def _sound(self) -> WovenFabric:
        missing = [name for name in ("warp", "weft") if getattr(self, name).width_mm is None]
        if missing and self.openness is None:
            raise wrong(f"{missing[0]}.width_mm", "is missing (give it, or the openness)")
        if not missing and self.openness is not None:
            raise wrong("openness", "both widths are given already (leave one of them out, or the openness)")
        self.widths_mm  # noqa: B018 (what cannot be is found here)
        for name, width in zip(("warp", "weft"), self.widths_mm, strict=True):
            yarn: Yarn = getattr(self, name)
            if width >= yarn.pitch_mm:
                raise wrong(
                    f"{name}.width_mm",
                    f"yarns of {width:g} mm touch at a distance of {yarn.pitch_mm:g} mm (lower it or {name}.per_cm)",
                )
        return self

    @property
    def widths_mm(self) -> tuple[float, float]:
        """Widths of warp and weft [mm]."""
        widths = [self.warp.width_mm, self.weft.width_mm]
        if self.openness is None or None not in widths:
            return (widths[0] or 0.0, widths[1] or 0.0)
        pitches = [self.warp.pitch_mm, self.weft.pitch_mm]
        if widths == [None, None]:
            cover = 1.0 - math.sqrt(self.openness)
            return (cover * pitches[0], cover * pitches[1])
        known = 0 if widths[0] is not None else 1
        free = 1.0 - (widths[known] or 0.0) / pitches[known]
        if not free > self.openness:
            names = ("warp", "weft")
            raise wrong(
                "openness",
                f"{self.openness:g} is met by no yarn width: the {names[known]} alone leaves {max(free, 0.0):.3g} open "
                f"(lower the openness or {names[known]}.width_mm)",
            )
        found = (1.0 - self.openness / free) * pitches[1 - known]
        return (widths[0] or found, widths[1] or found)

    @property
    def open_fraction(self) -> float:
        """Open share of the area, seen along the normal."""
        warp, weft = self.widths_mm
        return (1.0 - warp / self.warp.pitch_mm) * (1.0 - weft / self.weft.pitch_mm)

    def shapes(self, shop: Workshop, key: str) -> list[Mesh]:
        """Its yarns, over one repeat of the weave."""
        for name in ("warp", "weft"):
            yarn: Yarn = getattr(self, name)
            self._warn_of_size(shop, f"{key}.{name}.thickness_mm", yarn.thickness_mm, "mm", 10.0)
        pattern = np.array([[c == "1" for c in row] for row in _PATTERNS[self.weave]])
        pitches = self.warp.pitch_mm / 1000.0, self.weft.pitch_mm / 1000.0
        ends, picks = pattern.shape
        periods = ends * pitches[0], picks * pitches[1]
        sway = 0.5 * (self.warp.thickness_mm + self.weft.thickness_mm) / 1000.0
        parts = []
        for across, (yarn, name, width_mm, over, share) in enumerate(
            (
                (self.warp, "warp", self.widths_mm[0], pattern, self.warp_crimp),
                (self.weft, "weft", self.widths_mm[1], ~pattern.T, 1.0 - self.warp_crimp),
            )
        ):
            face = shop.yarn(f"{key}.{name}.material", yarn.material)
            for k, sides in enumerate(over):
                heights = np.where(sides, 1.0, -1.0) * sway * share
                centre = (k + 0.5) * pitches[across]
                tube = _tube(heights, pitches[1 - across], width_mm / 1000.0, yarn.thickness_mm / 1000.0, self.crimp)
                parts.append(_laid(*tube, centre, face, upright=across == 0))
        return [Mesh.joined(parts, periods)]


def _tube(
    heights: Floats, pitch: float, width: float, thickness: float, crimp: str
) -> tuple[Floats, NDArray[np.int64]]:
    """A yarn over one repeat: corners (n, 3) as (across, along, z) [m], and triangles whose front is outside."""
    count = len(heights)
    share = np.arange(STEPS) / STEPS
    along, level, slope = [], [], []
    for k in range(count):
        low, high = heights[k], heights[(k + 1) % count]
        way, rise = _rise(share, high - low, pitch, crimp)
        along.append((k + 0.5 + share) * pitch)
        level.append(low + way)
        slope.append(rise)
    s, z, m = (np.concatenate(v) for v in (along, level, slope))
    s, z, m = np.append(s, s[0] + count * pitch), np.append(z, z[0]), np.append(m, m[0])
    angle = np.arctan(m)
    around = 2.0 * np.pi * np.arange(SECTION) / SECTION
    # The section stands at right angles to the way.
    across = np.broadcast_to(0.5 * width * np.cos(around), (len(s), SECTION))
    off = 0.5 * thickness * np.sin(around)
    points = np.stack(
        [across, s[:, None] - np.sin(angle)[:, None] * off, z[:, None] + np.cos(angle)[:, None] * off], axis=-1
    )
    i, j = np.meshgrid(np.arange(len(s) - 1), np.arange(SECTION), indexing="ij")
    a, b = i * SECTION + j, i * SECTION + (j + 1) % SECTION
    c, d = a + SECTION, b + SECTION
    triangles = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, c, b), (b, c, d))])
    return points.reshape(-1, 3), triangles


def _rise(share: Floats, height: float, pitch: float, crimp: str) -> tuple[Floats, Floats]:
    """Height and slope of a yarn's middle between two crossings."""
    if height == 0.0:
        return np.zeros_like(share), np.zeros_like(share)
    if crimp == "sine":
        return 0.5 * height * (1.0 - np.cos(np.pi * share)), 0.5 * np.pi * height / pitch * np.sin(np.pi * share)
    # Two arcs that join in the middle; each rises by half the height over half the pitch.
    radius = (0.25 * pitch * pitch + 0.25 * height * height) / abs(height)
    x = np.where(share <= 0.5, share, 1.0 - share) * pitch
    drop = radius - np.sqrt(np.maximum(radius * radius - x * x, 0.0))
    way = np.where(share <= 0.5, drop, abs(height) - drop)
    slope = x / np.sqrt(np.maximum(radius * radius - x * x, 1e-300))
    return math.copysign(1.0, height) * way, math.copysign(1.0, height) * slope


def _laid(
    points: Floats, triangles: NDArray[np.int64], centre: float, face: Face, *, upright: bool
) -> tuple[Floats, NDArray[np.int64], Face]:
    """A yarn at its place: along y if upright, along x otherwise."""
    across, along, z = points.T
    if upright:
        return np.column_stack([across + centre, along, z]), triangles, face
    # Both axes change places, which turns the triangles round.
    return np.column_stack([along, across + centre, z]), triangles[:, ::-1], face
