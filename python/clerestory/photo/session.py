"""What a person says of a series: a TOML file, or the options of the command line, with every key checked."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from clerestory.trace.keys import Keys, NotNegative, Number, Positive, wrong

LIMIT_PERCENT = 25.0
"""A picture whose illuminance is further from the measured one is not to be used (Pierson et al. 2021)."""
MOST_PIXELS = 16384


class CameraKeys(Keys):
    """What the levels of the pictures mean."""

    encoding: Literal["auto", "linear", "camera"] = "auto"
    """linear as a raw decoder writes, camera with a response; auto takes 16 bits as linear and 8 as camera."""
    response: str | None = None
    """File with the response, .json or .rsp; recovered from the series by default."""
    method: Literal["debevec", "mitsunaga"] = "debevec"
    """How the response is recovered: as a smooth curve or as a polynomial."""
    primaries: Literal["srgb", "adobe-rgb"] | Annotated[list[Number], Field(min_length=8, max_length=8)] = "srgb"
    """Colours of the pictures' channels; x and y of red, green, blue and white."""

    @model_validator(mode="after")
    def _one(self) -> CameraKeys:
        if self.encoding == "linear" and self.response is not None:
            raise wrong("response", "linear pictures have no response (leave it out, or set encoding to camera)")
        return self


class LensKeys(Keys):
    """Where the lens puts what it sees."""

    projection: Literal["equisolid", "equidistant", "orthographic", "stereographic", "perspective", "table", "none"] = (
        "equisolid"
    )
    """Law of the radius; table for measured ones; none keeps the picture as it was taken, without a view."""
    table: str | None = None
    """File with the columns theta_deg, radius."""
    centre_px: Annotated[list[Number], Field(min_length=2, max_length=2)] | None = None
    """Column and row of the axis; that of the circle, which is sought, by default."""
    radius_px: Positive | None = None
    """Radius at half the field of view; that of the circle by default."""
    field_deg: Annotated[Number, Field(gt=0.0, le=360.0)] = 180.0
    """Field of view over the diameter of the circle."""

    @model_validator(mode="after")
    def _sound(self) -> LensKeys:
        if (self.projection == "table") != (self.table is not None):
            raise wrong("table", "a table and the projection table go together (give both or none)")
        if self.projection == "perspective" and self.radius_px is None:
            raise wrong(
                "radius_px",
                "a perspective lens draws no circle (give a radius, such as half the picture's width, and as "
                "field_deg the angle over twice of it)",
            )
        if self.centre_px is not None and self.radius_px is None:
            raise wrong("radius_px", "the centre is given but not the radius (give both or none)")
        return self


class VignettingKeys(Keys):
    """How the lens darkens toward its rim."""

    coefficients: Annotated[list[Number], Field(min_length=1, max_length=3)] | None = None
    """a, b, c of V(θ) = 1 + a θ² + b θ⁴ + c θ⁶, θ in radians."""
    points: str | None = None
    """File with measured points, with the columns theta_deg, value."""
    fit: Literal["polynomial", "none"] = "polynomial"
    """A polynomial through the points, or the points themselves with straight lines between them."""
    degree: Literal[2, 4, 6] = 6
    """Of the polynomial that is fitted."""

    @model_validator(mode="after")
    def _one(self) -> VignettingKeys:
        if (self.coefficients is None) == (self.points is None):
            raise wrong("points", "either coefficients or points are asked for (give one of them)")
        return self


class SpotKeys(Keys):
    """A spot that a luminance meter has measured."""

    luminance: Positive
    """[cd/m²]"""
    pixels: Annotated[list[NotNegative], Field(min_length=2, max_length=4)] | None = None
    """x, y; x, y, radius; or x1, y1, x2, y2 in the upright picture, from 0 at the upper left."""
    direction_deg: Annotated[list[Number], Field(min_length=2, max_length=3)] | None = None
    """To the right and upward from the line of sight, and the radius."""

    @model_validator(mode="after")
    def _one(self) -> SpotKeys:
        if (self.pixels is None) == (self.direction_deg is None):
            raise wrong("pixels", "either pixels or direction_deg is asked for (give one of them)")
        return self


class CalibrationKeys(Keys):
    """What makes luminances of light: spots, the illuminance, or a factor."""

    spots: list[SpotKeys] = Field(default_factory=list)
    """Spots with a measured luminance; of several the mean factor is taken."""
    factor: Positive | None = None
    """By which the luminances of a camera of nominal speed are multiplied, known from other series."""
    by_illuminance: bool = False
    """Make the illuminance of the picture the measured one of [check]."""

    @model_validator(mode="after")
    def _one(self) -> CalibrationKeys:
        if bool(self.spots) + (self.factor is not None) + self.by_illuminance > 1:
            raise wrong("spots", "spots, factor and by_illuminance exclude each other (give one of them)")
        return self


class CheckKeys(Keys):
    """What the result is compared with."""

    illuminance: Positive | None = None
    """Measured at the lens, on the plane of the lens [lx]."""
    limit_percent: Positive = LIMIT_PERCENT
    """Difference above which the picture is called unfit."""
    fill_overflow: bool = False
    """Raise pixels that are too bright in all exposures, such as the sun, until the illuminance is the measured one."""


class OutputKeys(Keys):
    """What is made."""

    view: str = "-vta"
    """-vta (angular) or -vth (hemispherical), and, if known, -vp, -vd and -vu of the camera."""
    size_px: Annotated[int, Field(ge=16, le=MOST_PIXELS)] = 1000
    """Width and height."""


class Session(Keys):
    """One series and what is to be made of it."""

    pictures: Annotated[list[str], Field(min_length=1)]
    """Files or a folder of them, relative to the session; * and ? stand for any characters."""
    exposures: str | None = None
    """Table with the columns file, time_s, f_number, iso."""
    f_number: Positive | None = None
    """Of all pictures, where EXIF does not say it."""
    iso: Positive | None = None
    """Of all pictures, where EXIF does not say it."""
    times: Literal["written", "thirds"] = "written"
    """thirds: exposure times are thirds of a stop, 2^(n/3) s, which EXIF rounds (1/60 s is 1/64 s)."""
    camera: CameraKeys = Field(default_factory=CameraKeys)
    """What the levels mean."""
    lens: LensKeys = Field(default_factory=LensKeys)
    """Where the lens puts what it sees."""
    vignetting: VignettingKeys | None = None
    """How the lens darkens toward its rim."""
    calibration: CalibrationKeys = Field(default_factory=CalibrationKeys)
    """What makes luminances of light."""
    check: CheckKeys = Field(default_factory=CheckKeys)
    """What the result is compared with."""
    output: OutputKeys = Field(default_factory=OutputKeys)
    """What is made."""

    @model_validator(mode="after")
    def _sound(self) -> Session:
        measured = self.check.illuminance is not None
        if self.calibration.by_illuminance and not measured:
            raise wrong("check.illuminance", "the calibration needs it (give the measured illuminance)")
        if self.check.fill_overflow and (not measured or self.calibration.by_illuminance):
            raise wrong(
                "check.fill_overflow",
                "needs a measured illuminance that is not the calibration (give illuminance, and a spot or a factor)",
            )
        if self.lens.projection == "none":
            for key, used in (
                ("vignetting", self.vignetting is not None),
                ("check.illuminance", measured),
                ("calibration.spots", any(s.direction_deg is not None for s in self.calibration.spots)),
            ):
                if used:
                    raise wrong(key, "needs to know where the lens puts directions (give lens.projection)")
        return self
