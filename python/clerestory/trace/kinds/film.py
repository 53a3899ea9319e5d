"""Films with grooves along x: prismatic films, sections that were scanned, and sections of one's own."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, model_validator

from clerestory.trace.keys import Keys, Number, Positive, RecipeError, wrong
from clerestory.trace.kinds.common import Kind
from clerestory.trace.kinds.scan import read_scan, simplified
from clerestory.trace.shapes import Section, Way

if TYPE_CHECKING:
    from clerestory.trace.shapes import Face, Piece, Point
    from clerestory.trace.workshop import Workshop

FacetAngle = Annotated[Number, Field(ge=0.0, lt=90.0)]


class _Film(Kind):
    """A film whose one face is grooved and whose other one is flat."""

    medium: str
    """What it is made of."""
    base_um: Positive
    """Thickness of the film under the deepest groove [µm]."""
    grooves: Literal["interior", "exterior"] = "interior"
    """The side that the grooves are on."""

    def _section(self, face: Face, relief: list[Point], period: float) -> Section:
        """A film from its relief: (height over the deepest groove, y) from y = 0 to the period [m]."""
        base = self.base_um * 1e-6
        if self.grooves == "interior":
            points = [(base + h, y) for h, y in relief]
            flat = Way((0.0, 0.0), face).line((0.0, period)).pieces
            way = Way(points[-1], face)
            for point in points[-2::-1]:
                way.line(point)
        else:
            points = [(-base - h, y) for h, y in relief]
            flat = Way((0.0, period), face).line((0.0, 0.0)).pieces
            way = Way(points[0], face)
            for point in points[1:]:
                way.line(point)
        return Section((*flat, *way.pieces), period)


class PrismaticFilm(_Film):
    """A film of prisms along x. Its flat face lies in the plane of the sample."""

    kind: Literal["prismatic-film"]
    pitch_um: Positive
    """Distance from prism to prism [µm]."""
    lower_facet_deg: FacetAngle | None = None
    """Angle of the facet below each ridge to the plane of the film [°]; with upper_facet_deg it makes a triangle."""
    upper_facet_deg: FacetAngle | None = None
    """Angle of the facet above each ridge to the plane of the film [°]."""
    points_um: list[Annotated[list[Number], Field(min_length=2, max_length=2)]] | None = Field(
        default=None, min_length=2
    )
    """Instead of angles: corners (y, height over the deepest groove) [µm], from y = 0 to the pitch."""

    @model_validator(mode="after")
    def _sound(self) -> PrismaticFilm:
        angles = (self.lower_facet_deg, self.upper_facet_deg)
        if (self.points_um is None) == (None in angles):
            raise wrong("points_um", "either both facet angles or points are asked for (give one of them)")
        if self.points_um is not None:
            ys = [y for y, _ in self.points_um]
            if ys[0] != 0.0 or abs(ys[-1] - self.pitch_um) > 1e-6 * self.pitch_um:
                raise wrong("points_um", f"do not go from y = 0 to the pitch of {self.pitch_um:g} µm")
            if any(b < a for a, b in pairwise(ys)):
                raise wrong("points_um", "y goes back and forth (give the corners from below to above)")
            if abs(self.points_um[0][1] - self.points_um[-1][1]) > 1e-9 * self.pitch_um:
                raise wrong("points_um", "the last height is not the first (a prism has to join the next one)")
            if min(h for _, h in self.points_um) < 0.0:
                raise wrong("points_um", "a height is below 0 (count from the deepest groove)")
        elif self.lower_facet_deg == 0.0 or self.upper_facet_deg == 0.0:
            raise wrong("lower_facet_deg", "a facet of 0° never reaches the ridge (give angles above 0)")
        return self

    def shapes(self, shop: Workshop, key: str) -> list[Section]:
        """Its section."""
        self._warn_of_size(shop, f"{key}.pitch_um", self.pitch_um, "µm", 10_000.0)
        face = shop.body(key, self.medium)
        pitch = self.pitch_um * 1e-6
        if self.points_um is not None:
            relief = [(h * 1e-6, y * 1e-6) for y, h in self.points_um]
            relief[-1] = (relief[0][0], pitch)
        else:
            lower, upper = (math.tan(math.radians(a or 0.0)) for a in (self.lower_facet_deg, self.upper_facet_deg))
            height = pitch * lower * upper / (lower + upper)
            relief = [(0.0, 0.0), (height, height / lower), (0.0, pitch)]
        return [self._section(face, relief, pitch)]


class ScannedProfile(_Film):
    """A film with a section that a profilometer scanned."""

    kind: Literal["scanned-profile"]
    file: str
    """CSV file with columns x_um (along the scan, upwards in the sample) and z_um (height) [µm]."""
    tolerance_um: Positive
    """The section that is traced stays this close to the scan [µm]: set it to the scan's noise."""
    period_um: Positive | None = None
    """Length of the scan that is repeated [µm], from its beginning; all of it by default."""
    mirrored: bool = False
    """Whether every second period is a mirror image, for scans whose ends do not fit together."""

    def shapes(self, shop: Workshop, key: str) -> list[Section]:
        """Its section."""
        face = shop.body(key, self.medium)
        shop.files.append(shop.folder / self.file)
        x, z = read_scan(shop.folder / self.file, f"{key}.file")
        length = float(x[-1] - x[0])
        period = length if self.period_um is None else self.period_um
        if period > length * (1.0 + 1e-9):
            raise RecipeError(f"{key}.period_um: {period:g} µm is more than the scan's {length:g} µm (scan farther)")
        corners = simplified(x, z, period, self.tolerance_um, key, closes=not self.mirrored)
        low = float(corners[:, 1].min())
        relief = [((h - low) * 1e-6, y * 1e-6) for y, h in corners.tolist()]
        period *= 1e-6
        relief[-1] = (relief[-1][0], period)
        if self.mirrored:
            relief += [(h, 2.0 * period - y) for h, y in relief[-2::-1]]
            period *= 2.0
        return [self._section(face, relief, period)]


class Outline(Keys):
    """A way along which a section of one's own is laid. Its front is on the left, seen with z to the right and y up."""

    points_mm: list[Annotated[list[Number], Field(min_length=2, max_length=3)]] = Field(min_length=2)
    """Points (z, y) [mm]; a third number bends the way from the point before into an arc that turns by so many degrees,
    counter-clockwise positive."""
    closed: bool = False
    """Whether the last point is joined to the first one."""
    front: str | None = None
    """Material that light from the front meets; for a body with a medium, its smooth border by default."""
    back: str | None = None
    """Material that light from the back meets; that of the front by default."""
    medium: str | None = None
    """What is behind it, for a transparent body: its outlines run clockwise, so that their front is outside."""

    @model_validator(mode="after")
    def _sound(self) -> Outline:
        if self.front is None and self.medium is None:
            raise wrong("front", "is missing (name a material, or a medium for a transparent body)")
        if self.medium is not None and self.back is not None:
            raise wrong("back", "a body has one material for both faces of its border (give front only)")
        if len(self.points_mm[0]) == 3:
            raise wrong("points_mm", "the first point has no arc that leads to it (give two numbers there)")
        return self

    def pieces(self, shop: Workshop, key: str) -> list[Piece]:
        """Its pieces [m]."""
        if self.medium is not None:
            face = shop.body(key, self.medium, self.front, surface_key="front")
        else:
            front = self.front or ""
            face = shop.sheet(key, front, self.back or front, names=("front", "back"))
        way = Way((self.points_mm[0][0] / 1000.0, self.points_mm[0][1] / 1000.0), face)
        for z, y, *turn in self.points_mm[1:]:
            way.arc((z / 1000.0, y / 1000.0), math.radians(turn[0]) if turn else 0.0)
        if self.closed:
            way.line((self.points_mm[0][0] / 1000.0, self.points_mm[0][1] / 1000.0))
        return way.pieces


class Profile(Kind):
    """A section of one's own: segments and exact arcs, infinite along x and repeated along y."""

    kind: Literal["profile"]
    pitch_mm: Positive
    """The section is repeated at this distance [mm]."""
    outlines: list[Outline] = Field(min_length=1)
    """The ways that make up the section; they may reach beyond one period."""

    def shapes(self, shop: Workshop, key: str) -> list[Section]:
        """Its section."""
        pieces = [p for k, o in enumerate(self.outlines) for p in o.pieces(shop, f"{key}.outlines[{k + 1}]")]
        return [Section(tuple(pieces), self.pitch_mm / 1000.0)]
