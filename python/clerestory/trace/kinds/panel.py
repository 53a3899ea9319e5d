"""Flat things: panes, laser-cut panels, light shelves."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from pydantic import model_validator

from clerestory.trace.keys import NotNegative, Number, Positive, Slope, wrong
from clerestory.trace.kinds.common import Kind
from clerestory.trace.shapes import Section, Way, turned

if TYPE_CHECKING:
    from clerestory.trace.workshop import Workshop


class Pane(Kind):
    """A plane-parallel pane, infinite in its plane."""

    kind: Literal["pane"]
    thickness_mm: NotNegative
    """Thickness [mm]; 0 for a sheet without thickness, which has materials and no medium."""
    medium: str | None = None
    """What it is made of."""
    exterior: str | None = None
    """Material of its exterior face; the smooth border of its medium by default."""
    interior: str | None = None
    """Material of its interior face."""

    @model_validator(mode="after")
    def _sound(self) -> Pane:
        if self.thickness_mm > 0.0 and self.medium is None:
            raise wrong("medium", "is missing (say what the pane is made of, or give thickness_mm = 0)")
        if self.thickness_mm == 0.0 and self.medium is not None:
            raise wrong("medium", "a sheet without thickness holds no medium (give thickness_mm, or leave it out)")
        if self.thickness_mm == 0.0 and self.exterior is None:
            raise wrong("exterior", "is missing (say what the sheet does with light)")
        return self

    def shapes(self, shop: Workshop, key: str) -> list[Section]:
        """Its section, counted from the exterior face."""
        self._warn_of_size(shop, f"{key}.thickness_mm", self.thickness_mm or 1.0, "mm", 200.0)
        thickness = self.thickness_mm / 1000.0
        # The period is anything: long ones cost least where light runs far inside.
        period = 1.0
        if thickness == 0.0:
            outside = self.exterior or ""
            face = shop.sheet(key, outside, self.interior or outside, names=("exterior", "interior"))
            return [Section(tuple(Way((0.0, 0.0), face).line((0.0, period)).pieces), period, everywhere=True)]
        medium = self.medium or ""
        outer = shop.body(key, medium, self.exterior, surface_key="exterior")
        inner = shop.body(key, medium, self.interior, surface_key="interior")
        pieces = Way((0.0, 0.0), outer).line((0.0, period)).pieces
        pieces += Way((thickness, period), inner).line((thickness, 0.0)).pieces
        return [Section(tuple(pieces), period, everywhere=True)]


class LaserCutPanel(Kind):
    """A laser-cut panel: a sheet with parallel cuts along x, thin gaps of air that reflect light totally."""

    kind: Literal["laser-cut-panel"]
    thickness_mm: Positive
    """Thickness of the sheet [mm]."""
    pitch_mm: Positive
    """Distance from cut to cut [mm]."""
    cut_mm: Positive
    """Width of a cut [mm]."""
    cut_depth_mm: Positive | None = None
    """Depth of the cuts from the exterior face [mm]; right through by default."""
    tilt_deg: Slope = 0.0
    """Angle of the cuts [°]: 0 level, positive with the outer end below the inner one."""
    medium: str
    """What the sheet is made of."""

    @model_validator(mode="after")
    def _sound(self) -> LaserCutPanel:
        if self.cut_mm >= self.pitch_mm * math.cos(math.radians(self.tilt_deg)):
            raise wrong("cut_mm", f"cuts of {self.cut_mm:g} mm leave nothing of a pitch of {self.pitch_mm:g} mm")
        if self.cut_depth_mm is not None and self.cut_depth_mm > self.thickness_mm:
            raise wrong("cut_depth_mm", "is more than the sheet's thickness (leave it out for cuts right through)")
        return self

    def shapes(self, shop: Workshop, key: str) -> list[Section]:
        """Its section, counted from the exterior face."""
        self._warn_of_size(shop, f"{key}.thickness_mm", self.thickness_mm, "mm", 200.0)
        face = shop.body(key, self.medium)
        deep, pitch = self.thickness_mm / 1000.0, self.pitch_mm / 1000.0
        tilt = math.radians(self.tilt_deg)
        half = 0.5 * self.cut_mm / 1000.0 / math.cos(tilt)
        cut = deep if self.cut_depth_mm is None else self.cut_depth_mm / 1000.0
        rise = cut * math.tan(tilt)
        if cut == deep:
            way = Way((0.0, half), face).line((0.0, pitch - half))
            way.line((deep, pitch - half + rise)).line((deep, half + rise)).line((0.0, half))
            return [Section(tuple(way.pieces), pitch)]
        way = Way((0.0, half), face).line((0.0, pitch - half)).line((cut, pitch - half + rise))
        way.line((cut, pitch + half + rise)).line((0.0, pitch + half))
        back = Way((deep, pitch), face).line((deep, 0.0))
        return [Section((*way.pieces, *back.pieces), pitch)]


class LightShelf(Kind):
    """A light shelf: one level board in each storey, before and behind the plane of the façade."""

    kind: Literal["light-shelf"]
    pitch_mm: Positive
    """Height of the window that the shelf belongs to [mm]: shelves are repeated at this distance."""
    exterior_mm: NotNegative
    """How far it reaches out [mm]."""
    interior_mm: NotNegative
    """How far it reaches into the room [mm]."""
    thickness_mm: NotNegative = 0.0
    """Thickness [mm]."""
    tilt_deg: Slope = 0.0
    """Angle [°], positive with the outer edge below the inner one."""
    upper: str
    """Material of the upper side and of the edges."""
    lower: str | None = None
    """Material of the lower side; that of the upper one by default."""

    @model_validator(mode="after")
    def _sound(self) -> LightShelf:
        if self.exterior_mm + self.interior_mm <= 0.0:
            raise wrong("exterior_mm", "the shelf has no depth (give exterior_mm or interior_mm above 0)")
        return self

    def shapes(self, shop: Workshop, key: str) -> list[Section]:
        """Its section, counted from the façade's plane."""
        self._warn_of_size(shop, f"{key}.pitch_mm", self.pitch_mm, "mm", 20_000.0)
        outer, inner, thickness = (mm / 1000.0 for mm in (-self.exterior_mm, self.interior_mm, self.thickness_mm))
        lower = self.lower or self.upper
        if thickness == 0.0:
            pieces = Way((outer, 0.0), shop.sheet(key, self.upper, lower)).line((inner, 0.0)).pieces
        else:
            above, below = shop.skin(f"{key}.upper", self.upper), shop.skin(f"{key}.lower", lower)
            way = Way((outer, 0.0), above).line((inner, 0.0)).line((inner, -thickness))
            way.face = below
            way.line((outer, -thickness))
            way.face = above
            pieces = way.line((outer, 0.0)).pieces
        return [Section(tuple(turned(pieces, math.radians(self.tilt_deg))), self.pitch_mm / 1000.0)]


class Honeycomb(Kind):
    """A cellular shade: cells of folded fabric along x, one above the other, glued to each other."""

    kind: Literal["honeycomb"]
    pitch_mm: Positive
    """Height of a cell [mm]."""
    depth_mm: Positive
    """From fold to fold of a cell [mm]."""
    joint_mm: Positive
    """Width of the glued joint between cells [mm]."""
    exterior: str
    """Material of the fabric on the exterior side."""
    interior: str | None = None
    """Material of the fabric on the side of the room; that of the exterior by default."""
    joint: str | None = None
    """Material of the joints; that of the exterior fabric by default."""
    sag_deg: Number = 0.0
    """Angle that each side of a fold is bent outwards by [°], as fabric under tension is not; 0 for straight sides."""

    @model_validator(mode="after")
    def _sound(self) -> Honeycomb:
        if self.joint_mm >= self.depth_mm:
            raise wrong("joint_mm", "is as wide as the cell is deep (give the width of the glued strip)")
        if not 0.0 <= self.sag_deg <= 90.0:
            raise wrong("sag_deg", f"{self.sag_deg:g}° is not between 0 and 90 (give 0 for straight sides)")
        return self

    def shapes(self, shop: Workshop, key: str) -> list[Section]:
        """Its section, counted from its middle."""
        self._warn_of_size(shop, f"{key}.depth_mm", self.depth_mm, "mm", 300.0)
        inside = self.interior or self.exterior
        # The front of both fabrics is outside of the cells.
        outer = shop.sheet(key, self.exterior, self.exterior, names=("exterior", "exterior"))
        inner = shop.sheet(key, inside, inside, names=("interior", "interior"))
        glue = self.joint or self.exterior
        joint = shop.sheet(key, glue, glue, names=("joint", "joint"))
        high, half = self.pitch_mm / 1000.0, 0.5 * self.joint_mm / 1000.0
        fold = 0.5 * self.depth_mm / 1000.0
        sag = math.radians(self.sag_deg)
        pieces = Way((-half, 0.0), joint).line((half, 0.0)).pieces
        pieces += Way((-half, 0.0), outer).arc((-fold, 0.5 * high), -sag).arc((-half, high), -sag).pieces
        pieces += Way((half, high), inner).arc((fold, 0.5 * high), -sag).arc((half, 0.0), -sag).pieces
        return [Section(tuple(pieces), high)]
