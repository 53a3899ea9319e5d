"""Room recipes: TOML files that describe a room, its windows, the sky, and what is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from clerestory.trace.keys import Fraction, Keys, NotNegative, Number, Positive, wrong
from clerestory.trace.materials import Material

if TYPE_CHECKING:
    from typing import Self

Point = Annotated[list[Number], Field(min_length=3, max_length=3)]
"""x, y, z [m]: east, north, up, unless the sky's north is turned."""

Treatment = Literal["high", "high-peaks", "klems", "klems-peaks"]
"""How a data set is used: at its own resolution or as a Klems matrix, with or without its through-beam as an explicit
peak."""

LEVELS = (
    "direct",
    "diffuse",
    "direct_illuminance",
    "diffuse_illuminance",
    "global_horizontal",
    "zenith_luminance",
    "turbidity",
)
"""Keys of the sky that say how much light there is."""

SURFACES = {"floor": 0.2, "walls": 0.5, "ceiling": 0.8}
"""Reflectances of a room's surfaces that are not given others."""


class Place(Keys):
    """Where the building is."""

    latitude: Annotated[Number, Field(ge=-90.0, le=90.0)]
    """Degrees, north positive."""
    longitude: Annotated[Number, Field(ge=-180.0, le=180.0)]
    """Degrees, east positive."""
    timezone: str | Number = 0.0
    """IANA name, such as Europe/Vienna, or hours ahead of UTC."""


class Sky(Keys):
    """The sky, the sun and the ground."""

    kind: Literal["perez", "cie", "overcast", "clear", "intermediate", "uniform", "preetham"]
    """Which model."""
    type: Annotated[int, Field(ge=1, le=15)] | None = None
    """Type of a CIE general sky."""
    time: str | None = None
    """When, on the place's clock: 2021-02-21 14:00."""
    sun_deg: Annotated[list[Number], Field(min_length=2, max_length=2)] | None = None
    """Altitude and compass azimuth of the sun [°], instead of place and time."""
    direct: NotNegative | None = None
    """Direct normal irradiance [W/m²]."""
    diffuse: NotNegative | None = None
    """Diffuse horizontal irradiance [W/m²]."""
    direct_illuminance: NotNegative | None = None
    """Direct normal illuminance [lx]."""
    diffuse_illuminance: NotNegative | None = None
    """Diffuse horizontal illuminance [lx]."""
    global_horizontal: NotNegative | None = None
    """Global horizontal irradiance [W/m²], divided by Erbs' correlation."""
    zenith_luminance: NotNegative | None = None
    """Luminance of the zenith [cd/m²], of CIE's skies."""
    turbidity: Positive | None = None
    """Turbidity, of clear, intermediate and Preetham's skies."""
    ground_reflectance: Fraction = 0.2
    """Reflectance of the ground."""
    preset: Literal["clerestory", "radiance"] = "clerestory"
    """Whose choices are followed where a model leaves some."""
    north_deg: Number = 0.0
    """Compass azimuth of the room's y axis [°]."""

    @model_validator(mode="after")
    def _sound(self) -> Sky:
        if (self.kind == "cie") != (self.type is not None):
            if self.kind == "cie":
                raise wrong("type", "a CIE general sky has a type (give 1 to 15)")
            raise wrong("type", "only a CIE general sky has a type (leave it out, or set kind to cie)")
        if self.time is not None and self.sun_deg is not None:
            raise wrong("sun_deg", "time and sun_deg both say where the sun is (give one of them)")
        if self.kind not in ("overcast", "uniform") and self.time is None and self.sun_deg is None:
            raise wrong("time", f"where the sun is in a {self.kind} sky is not given (give time, or sun_deg)")
        return self


def _pane(value: object) -> object:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and 0.0 < value <= 1.0:
        return float(value)
    if isinstance(value, str):
        return value
    raise PydanticCustomError(
        "pane", "Input should be a transmittance above 0 and up to 1, a glass by its name, or a file of its spectra"
    )


Pane = Annotated[float | str, BeforeValidator(_pane)]
"""A pane of glass: a transmittance, a glass by its name, or a file of its spectra."""


class System(Keys):
    """A window system."""

    file: str | None = None
    """Its data set: a BSDF file, a specification of a window or a recipe of a sample (.toml), relative to this recipe;
    or the name of one that comes with Clerestory; or give glass."""
    glass: Pane | None = None
    """Visible transmittance of a clear pane at normal incidence; or the name of a glass that comes with Clerestory, or
    a file of a pane's spectra."""
    glass_reflectance: Fraction | None = None
    """Visible reflectance of a pane by its transmittance; that of glass of index 1.52 by default."""
    thickness_mm: Positive | None = None
    """Thickness of a glass by its name [mm]."""
    treatment: Treatment = "high-peaks"
    """How the data set of `file` is used."""
    band: str | None = None
    """Band of the file; visible by default."""
    flipped: bool = False
    """The file's interior is put to the exterior."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        self._check()
        return self

    def _check(self) -> None:
        if (self.file is None) == (self.glass is None):
            raise wrong("file", "either a file or glass is asked for (give one of them)")
        if isinstance(self.glass, str) and self.glass_reflectance is not None:
            raise wrong("glass_reflectance", "goes with a transmittance (leave it out)")
        if not isinstance(self.glass, str) and self.thickness_mm is not None:
            raise wrong("thickness_mm", "goes with a glass by its name (leave it out)")


class Opening(Keys):
    """A window in a wall of the built room."""

    wall: Literal["south", "north", "east", "west"] = "south"
    """The wall that it is in."""
    width_m: Positive
    """Width [m]."""
    height_m: Positive
    """Height [m]."""
    sill_m: NotNegative
    """Height of its lower edge above the floor [m]."""
    left_m: NotNegative | None = None
    """From the wall's left end, as seen from the room, to the window [m]; in the middle by default."""
    system: str
    """Its system."""


class Furniture(Keys):
    """A box in the room."""

    corner_m: Point
    """Its lowest corner [m]."""
    size_m: Annotated[list[Positive], Field(min_length=3, max_length=3)]
    """Its size along x, y and z [m]."""
    material: str | Fraction = 0.5
    """A material, or a reflectance."""


class Box(Keys):
    """A rectangular room: x from 0 to its width, y from 0 (south) to its depth, z from the floor at 0."""

    width_m: Positive
    """Along x [m]."""
    depth_m: Positive
    """Along y [m]."""
    height_m: Positive
    """Along z [m]."""
    wall_thickness_m: NotNegative = 0.0
    """Depth of the reveals; windows lie in the outer plane [m]."""
    floor: str | Fraction = SURFACES["floor"]
    """A material, or a reflectance."""
    walls: str | Fraction = SURFACES["walls"]
    """A material, or a reflectance."""
    ceiling: str | Fraction = SURFACES["ceiling"]
    """A material, or a reflectance."""
    openings: list[Opening] = Field(default_factory=list)
    """Windows."""
    furniture: list[Furniture] = Field(default_factory=list)
    """Boxes."""


class Geometry(Keys):
    """A file of shapes."""

    file: str
    """Radiance scene (.rad), OBJ, STL or PLY, relative to the recipe."""
    unit: Literal["m", "cm", "mm", "inch", "foot"] = "m"
    """Of its lengths."""
    material: str | Fraction | None = None
    """For surfaces whose name is not among the materials."""
    facade: bool = False
    """Whether they stand between the windows and the ports, for the six-phase method."""


class Port(Keys):
    """An opening before a façade, through which daylight comes to what stands there and to the windows."""

    corners_m: Annotated[list[Point], Field(min_length=3)]
    """Corners [m], counter-clockwise as seen from the façade."""


class Window(Keys):
    """A window polygon."""

    corners_m: Annotated[list[Point], Field(min_length=3)]
    """Corners [m], counter-clockwise as seen from the room."""
    system: str
    """Its system."""


class Light(Keys):
    """A polygon that shines evenly from its front."""

    corners_m: Annotated[list[Point], Field(min_length=3)]
    """Corners [m], counter-clockwise as seen from its front."""
    luminance: NotNegative
    """Luminance [cd/m²]."""


class View(Keys):
    """A view."""

    point_m: Point
    """The eye [m]."""
    direction: Point
    """Where it looks."""
    up: Point = Field(default=[0.0, 0.0, 1.0])
    """What is up."""
    projection: Literal["angular", "hemispherical", "perspective", "cylindrical", "parallel", "planispheric"] = (
        "angular"
    )
    """Angular (equidistant) fisheye, on which glare is evaluated; or another."""
    angle_deg: Annotated[list[Positive], Field(min_length=2, max_length=2)] = Field(default=[180.0, 180.0])
    """Width and height [°]; for a parallel view [m]."""
    size_px: Annotated[list[Annotated[int, Field(ge=1, le=16384)]], Field(min_length=2, max_length=2)] = Field(
        default=[800, 800]
    )
    """Width and height in pixels."""


class Sensors(Keys):
    """Points at which illuminance is asked for: listed, or a grid over the built room."""

    points_m: list[Point] | None = None
    """The points [m]."""
    height_m: NotNegative | None = None
    """Height of a grid above the floor [m]."""
    spacing_m: Positive = 0.5
    """Largest distance of a grid's points [m]."""
    margin_m: NotNegative = 0.3
    """Of a grid to the walls [m]."""
    normal: Point = Field(default=[0.0, 0.0, 1.0])
    """Where they face."""

    @model_validator(mode="after")
    def _one(self) -> Sensors:
        if (self.points_m is None) == (self.height_m is None):
            raise wrong("points_m", "either points_m or height_m, for a grid, is asked for (give one of them)")
        return self


class Recipe(Keys):
    """A room recipe."""

    name: str = ""
    """What it is called."""
    place: Place | None = None
    """Where it is."""
    sky: Sky
    """What is outside."""
    room: Box | None = None
    """A rectangular room."""
    geometry: list[Geometry] = Field(default_factory=list)
    """Files of shapes."""
    windows: dict[str, Window] = Field(default_factory=dict)
    """Window polygons by name."""
    systems: dict[str, System] = Field(default_factory=dict)
    """Window systems by name."""
    ports: dict[str, Port] = Field(default_factory=dict)
    """Openings before the façade, for the six-phase method, by name."""
    lights: dict[str, Light] = Field(default_factory=dict)
    """Polygons that shine, by name."""
    materials: dict[str, Material] = Field(default_factory=dict)
    """What surfaces do with light, by name; spectra by red, green and blue."""
    views: dict[str, View] = Field(default_factory=dict)
    """Views by name."""
    sensors: dict[str, Sensors] = Field(default_factory=dict)
    """Sensors by name."""

    @model_validator(mode="after")
    def _sound(self) -> Recipe:
        if self.room is None and not self.geometry:
            raise wrong("room", "there is no room (add [room], or [[geometry]] with a file)")
        if self.sky.time is not None and self.place is None:
            raise wrong("place", "a time needs a place (add [place] with latitude, longitude and timezone)")
        for name, sensors in self.sensors.items():
            if sensors.height_m is not None and self.room is None:
                raise wrong(f"sensors.{name}.height_m", "a grid needs [room] (give points_m)")
        return self
