"""A camera-based goniophotometer as a TOML file: its screens, where the camera sees them, and its pictures.

Lengths are in millimetres in the sample's frame with its origin in the middle of the lit patch; pixels are counted
from the upper left corner of a picture, whose first pixel has its middle at 0.5, 0.5.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, model_validator

from clerestory.trace.keys import Keys, NotNegative, Number, Positive, wrong
from clerestory.trace.recipe import read_toml
from clerestory.trace.shipped import Shelf

if TYPE_CHECKING:
    import os
    from typing import Self

RIGS = Shelf(Path(__file__).parent / "rigs", "rig", "measure camera")

Point = Annotated[list[Number], Field(min_length=3, max_length=3)]
Pixel = Annotated[list[Number], Field(min_length=2, max_length=2)]
Reflectance = Annotated[Number, Field(gt=0.0, le=1.0)]


class Mark(Keys):
    """A point of a screen, and where it is seen."""

    mm: Point
    """In the sample's frame [mm]."""
    pixel: Pixel
    """Column and row."""


class Pinhole(Keys):
    """A camera without distortion; its optical axis meets the middle of the picture."""

    position_mm: Point
    """Of its entrance pupil [mm]."""
    target_mm: Point
    """What its axis points to [mm]."""
    up: Point
    """A direction that is up in the picture."""
    focal_pixels: Positive
    """Focal length over the width of a pixel."""
    size_pixels: Annotated[list[Annotated[int, Field(gt=0)]], Field(min_length=2, max_length=2)]
    """Width and height of a picture."""


class ScreenTable(Keys):
    """A flat diffuse screen, in one place or turned about the sample's normal to several."""

    corners_mm: Annotated[list[Point], Field(min_length=3)]
    """Corners of a convex screen in order [mm]."""
    reflectance: Reflectance
    """Of its Lambertian coating [-]."""
    marks: list[Mark] = Field(default_factory=list)
    """Four points or more, no three of them on a line; or a `camera`."""
    camera: Pinhole | None = None
    """What sees the screen; or `marks`. It turns with the screen."""
    turned_deg: Annotated[list[Number], Field(min_length=1)] = Field(default_factory=lambda: [0.0])
    """Angles that screen and camera are turned by, counter-clockwise as seen from the room [°]."""

    @model_validator(mode="after")
    def _seen(self) -> Self:
        if bool(self.marks) == (self.camera is not None):
            raise wrong("marks", "a screen has marks or a camera (give one of them)")
        if self.marks and len(self.marks) < 4:
            raise wrong("marks", f"{len(self.marks)} points do not tell the perspective (give four or more)")
        return self


class Direct(Keys):
    """A camera that sees the sample itself, each direction of its light in a pixel, as through a Fourier lens."""

    view: str
    """Radiance's options of a view whose rays run along the leaving light, such as `-vta -vd 0 0 1 -vu 0 1 0 -vh 180
    -vv 180`."""


class Darkening(Keys):
    """How the lens darkens toward the rim."""

    focal_pixels: Positive
    """Focal length over the width of a pixel, which gives a pixel its angle to the axis."""
    coefficients: Annotated[list[Number], Field(min_length=1, max_length=3)]
    """a, b, c of 1 + a θ² + b θ⁴ + c θ⁶, θ in radians."""


class Incidence(Keys):
    """Pictures of light from one direction."""

    theta_deg: Annotated[Number, Field(ge=0.0, lt=90.0)]
    """Angle to the source from the normal [°]."""
    phi_deg: Number = 0.0
    """Azimuth of the source [°]."""
    illuminance_lx: Positive
    """On a plane across the beam, or on the sample, as `illuminance_on` says [lx]."""
    pictures: Annotated[list[str], Field(min_length=1)]
    """One a position, in their order: paths seen from this file."""


class Rig(Keys):
    """A camera-based goniophotometer and its pictures."""

    sample: str = "sample"
    """Name of the sample."""
    laboratory: str = ""
    """Who measured."""
    incident_side: Literal["exterior", "interior"] = "exterior"
    """Side that light comes from."""
    scatter: Literal["transmission", "reflection"] = "transmission"
    """What the screens see."""
    aperture_mm2: Positive | None = None
    """Lit area of the sample; needed for screens [mm²]."""
    aperture_on: Literal["sample", "beam"] = "sample"
    """Whether the area is an aperture's on the sample, or one's across the beam, whose lit area grows with 1/cos θ."""
    illuminance_on: Literal["beam", "sample"] = "beam"
    """Where the illuminances were measured; on the sample a beam's is cos θ times as large."""
    grid_deg: Annotated[Number, Field(ge=0.5, le=15.0)] = 5.0
    """Step of the exit grid; 5 is IEA Task 21's with 1,297 directions [°]."""
    feather: Annotated[Number, Field(ge=0.0, le=0.5)] = 0.05
    """Part of a screen's size over which its pixels lose weight toward its edges, where another screen goes on."""
    largest_mismatch: Annotated[Number, Field(gt=0.0)] = 0.03
    """Relative difference of two screens along their seam that is warned of."""
    dark_cd_m2: NotNegative = 0.0
    """Luminance of a picture without light, which is taken off [cd/m²]."""
    vignetting: Darkening | None = None
    """Of the lens, if the pictures are not corrected for it."""
    screens: list[ScreenTable] = Field(default_factory=list)
    """Screens; or `direct`."""
    direct: Direct | None = None
    """A camera that sees the sample itself."""
    incidences: Annotated[list[Incidence], Field(min_length=1)]
    """What was measured."""

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if bool(self.screens) == (self.direct is not None):
            raise wrong("screens", "light is seen on screens or directly (give one of screens and direct)")
        if self.screens and self.aperture_mm2 is None:
            raise wrong("aperture_mm2", "is missing (a screen's light comes from the lit area of the sample)")
        if abs(90.0 / self.grid_deg - round(90.0 / self.grid_deg)) > 1e-9:
            raise wrong("grid_deg", f"{self.grid_deg:g}° does not divide 90° (give 5, 2, 1 or so)")
        for n, incidence in enumerate(self.incidences, start=1):
            if len(incidence.pictures) != self.positions:
                raise wrong(
                    f"incidences[{n}].pictures",
                    f"{len(incidence.pictures)} pictures of {self.positions} positions (give one each, in their order)",
                )
        return self

    @property
    def positions(self) -> int:
        """Pictures of one incident direction."""
        return sum(len(screen.turned_deg) for screen in self.screens) if self.screens else 1


def read_rig(path: str | os.PathLike[str]) -> Rig:
    """A rig from a TOML file; the paths of its pictures are made to be seen from here.

    Raises
    ------
    RecipeError
        The file is faulty; the text names the file and the key.
    """
    from clerestory.files import named

    path = Path(path)
    with named(path):
        rig = Rig.of(read_toml(path))
    found = [
        one.model_copy(update={"pictures": [str(path.parent / picture) for picture in one.pictures]})
        for one in rig.incidences
    ]
    return rig.model_copy(update={"incidences": found})
