"""Slats one above the other: venetian blinds and louvres."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from pydantic import model_validator

from clerestory.trace.keys import Keys, NotNegative, Number, Positive, Slope, wrong
from clerestory.trace.kinds.common import Kind
from clerestory.trace.shapes import Piece, Section, Way, turned

if TYPE_CHECKING:
    from clerestory.trace.shapes import Face
    from clerestory.trace.workshop import Workshop


class Slat(Keys):
    """A slat, as it lies at a tilt of 0°."""

    width_mm: Positive
    """From edge to edge, beads included [mm]."""
    crown_mm: Number = 0.0
    """Height of the slat's middle over its edges [mm]; negative for a hollow slat, 0 for a flat one."""
    thickness_mm: NotNegative = 0.0
    """Thickness of the material [mm]; 0 for a surface without thickness."""
    bead_mm: NotNegative = 0.0
    """Diameter of the beads along both edges [mm]; 0 for none."""
    upper: str
    """Material of the upper side."""
    lower: str | None = None
    """Material of the lower side; that of the upper one by default."""

    @model_validator(mode="after")
    def _sound(self) -> Slat:
        if abs(self.crown_mm) > 0.5 * self.width_mm:
            raise wrong(
                "crown_mm",
                f"{self.crown_mm:g} mm is more than a half circle over {self.width_mm:g} mm (give half or less)",
            )
        if 2.0 * self.bead_mm >= self.width_mm:
            raise wrong("bead_mm", f"two beads of {self.bead_mm:g} mm fill the whole slat (give the diameter)")
        if 0.0 < self.bead_mm <= self.thickness_mm:
            raise wrong("bead_mm", "a bead is thicker than the slat (give 0 for none)")
        if self.thickness_mm >= 0.5 * self.width_mm:
            raise wrong("thickness_mm", f"{self.thickness_mm:g} mm is half the width or more (give the thickness)")
        return self

    def pieces(self, shop: Workshop, key: str) -> list[Piece]:
        """The slat's section, its front outside or above [m]."""
        lower = self.lower or self.upper
        if self.thickness_mm > 0.0:
            above = shop.skin(f"{key}.upper", self.upper)
            below = shop.skin(f"{key}.lower", lower)
        else:
            above = below = shop.sheet(key, self.upper, lower)
        rim = shop.skin(f"{key}.upper", self.upper) if self.bead_mm > 0.0 else above
        width, crown, thickness, bead = (
            mm / 1000.0 for mm in (self.width_mm, self.crown_mm, self.thickness_mm, self.bead_mm)
        )
        # The middle line runs from bead centre to bead centre, or from edge to edge.
        middle = _Line(width - bead, crown)
        if thickness == 0.0 and bead == 0.0:
            return Way(middle.at(-1.0), above).arc(middle.at(1.0), middle.turn(1.0)).pieces
        if bead == 0.0:
            return _plate(middle, thickness, above, below)
        return _beaded(middle, thickness, bead / 2.0, above, below, rim)


class _Line:
    """The middle line of a slat: a chord, or an arc over it."""

    def __init__(self, chord: float, crown: float) -> None:
        self.chord = chord
        self.half = 2.0 * math.atan(2.0 * crown / chord)
        """Half of the angle that the line turns through, to the right."""
        self.radius = math.inf if crown == 0.0 else 0.5 * chord / math.sin(self.half)
        """Negative for a hollow slat."""
        self.centre = 0.0 if crown == 0.0 else crown - self.radius
        """Height of the circle's centre."""

    def at(self, share: float, off: float = 0.0) -> tuple[float, float]:
        """A point: share of the half from the middle, −1 at the outer edge; off above the line [m]."""
        if self.half == 0.0:
            return (0.5 * self.chord * share, off)
        angle = self.half * share
        radius = self.radius + off
        return (radius * math.sin(angle), self.centre + radius * math.cos(angle))

    def turn(self, share: float) -> float:
        """How much the way from −share to share turns."""
        return -2.0 * self.half * share


def _plate(middle: _Line, thickness: float, above: Face, below: Face) -> list[Piece]:
    """A closed plate with square edges, run clockwise."""
    up, down = 0.5 * thickness, -0.5 * thickness
    way = Way(middle.at(-1.0, up), above).arc(middle.at(1.0, up), middle.turn(1.0)).line(middle.at(1.0, down))
    way.face = below
    way.arc(middle.at(-1.0, down), -middle.turn(1.0))
    way.face = above
    return way.line(middle.at(-1.0, up)).pieces


def _beaded(middle: _Line, thickness: float, bead: float, above: Face, below: Face, rim: Face) -> list[Piece]:
    """A slat with a bead about each end of its middle line."""

    def share(off: float) -> float:
        """Where a line off the middle one enters the beads."""
        reach = math.sqrt(bead * bead - off * off)
        if middle.half == 0.0:
            return 1.0 - 2.0 * reach / middle.chord
        # The triangle of both circles' centres and the point where they meet.
        big, side = abs(middle.radius), abs(middle.radius + off)
        angle = math.acos((big * big + side * side - bead * bead) / (2.0 * big * side))
        return 1.0 - angle / abs(middle.half)

    up, down = 0.5 * thickness, -0.5 * thickness
    upper, lower = share(up), share(down)
    inner, outer = middle.at(1.0), middle.at(-1.0)

    def round_bead(way: Way, centre: tuple[float, float], to: tuple[float, float]) -> None:
        angles = [math.atan2(p[1] - centre[1], p[0] - centre[0]) for p in (way.at, to)]
        way.arc(to, -((angles[0] - angles[1]) % math.tau or math.tau))

    if thickness == 0.0:
        pieces = Way(middle.at(-upper), above).arc(middle.at(upper), middle.turn(upper)).pieces
        for centre, end in ((inner, middle.at(upper)), (outer, middle.at(-upper))):
            opposite = (2.0 * centre[0] - end[0], 2.0 * centre[1] - end[1])
            pieces += Way(end, rim).arc(opposite, -math.pi).arc(end, -math.pi).pieces
        return pieces
    way = Way(middle.at(-upper, up), above).arc(middle.at(upper, up), middle.turn(upper))
    way.face = rim
    round_bead(way, inner, middle.at(lower, down))
    way.face = below
    way.arc(middle.at(-lower, down), -middle.turn(lower))
    way.face = rim
    round_bead(way, outer, middle.at(-upper, up))
    return way.pieces


class VenetianBlind(Kind):
    """A venetian blind: slats along x, one above the other."""

    kind: Literal["venetian-blind"]
    pitch_mm: Positive
    """Distance from slat to slat [mm]."""
    tilt_deg: Slope = 0.0
    """Slat angle [°]: 0 level, positive with the outer edge below the inner one, ±90 closed."""
    slat: Slat
    """The slat."""

    def shapes(self, shop: Workshop, key: str) -> list[Section]:
        """Its section."""
        self._warn_of_size(shop, f"{key}.slat.width_mm", self.slat.width_mm, "mm", 200.0)
        pieces = turned(self.slat.pieces(shop, f"{key}.slat"), math.radians(self.tilt_deg))
        return [Section(tuple(pieces), self.pitch_mm / 1000.0)]


class Louvre(Kind):
    """Fixed louvres: thick blades along x, one above the other."""

    kind: Literal["louvre"]
    pitch_mm: Positive
    """Distance from blade to blade [mm]."""
    depth_mm: Positive
    """From edge to edge of a blade [mm]."""
    thickness_mm: Positive
    """Thickness of a blade, in its middle [mm]."""
    shape: Literal["plate", "lens"] = "plate"
    """plate with square edges, or lens: two arcs that meet in sharp edges."""
    tilt_deg: Slope = 0.0
    """Angle of the blades [°]: positive with the outer edge below the inner one."""
    upper: str
    """Material of the upper side and of the edges."""
    lower: str | None = None
    """Material of the lower side; that of the upper one by default."""

    @model_validator(mode="after")
    def _sound(self) -> Louvre:
        if self.thickness_mm >= self.depth_mm:
            raise wrong("thickness_mm", f"{self.thickness_mm:g} mm is the blade's depth or more (swap both)")
        return self

    def shapes(self, shop: Workshop, key: str) -> list[Section]:
        """Its section."""
        self._warn_of_size(shop, f"{key}.depth_mm", self.depth_mm, "mm", 2000.0)
        above = shop.skin(f"{key}.upper", self.upper)
        below = shop.skin(f"{key}.lower", self.lower or self.upper)
        depth, thickness = self.depth_mm / 1000.0, self.thickness_mm / 1000.0
        if self.shape == "plate":
            pieces = _plate(_Line(depth, 0.0), thickness, above, below)
        else:
            turn = _Line(depth, 0.5 * thickness).turn(1.0)
            way = Way((-0.5 * depth, 0.0), above).arc((0.5 * depth, 0.0), turn)
            way.face = below
            pieces = way.arc((-0.5 * depth, 0.0), turn).pieces
        return [Section(tuple(turned(pieces, math.radians(self.tilt_deg))), self.pitch_mm / 1000.0)]
