"""The table `product` of a specification: who makes it, and how it is to be placed."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from clerestory.system.product.data import Orientation
from clerestory.trace.keys import Keys, NotNegative, Number, wrong

Compass = Annotated[Number, Field(ge=0.0, lt=360.0)]


class OrientationKeys(Keys):
    """Where a directed element belongs, such as a grating under a roof light that is open to the north."""

    mounting: Literal["facade", "roof"]
    """What it is made for."""
    up_azimuth_deg: Compass | None = None
    """Compass azimuth [°] that the up of its data looks to where it lies level: 0 is north, 90 east. For a roof."""
    faces_azimuth_deg: Compass | None = None
    """Compass azimuth [°] that its exterior looks to. For a façade; any by default."""
    within_deg: Annotated[NotNegative, Field(le=180.0)] = 0.0
    """How far the azimuth may be off [°]."""
    tilt_deg: Annotated[list[Number], Field(min_length=2, max_length=2)] | None = None
    """Least and greatest tilt that it may be placed at [°]: 0 is level, 90 upright."""

    @model_validator(mode="after")
    def _sound(self) -> OrientationKeys:
        if self.mounting == "roof":
            if self.up_azimuth_deg is None:
                raise wrong("up_azimuth_deg", "is missing: a roof's element has an up (add it, 0 is north)")
            if self.faces_azimuth_deg is not None:
                raise wrong("faces_azimuth_deg", "goes with a facade (leave it out)")
        elif self.up_azimuth_deg is not None:
            raise wrong("up_azimuth_deg", "goes with a roof; upright, up is up (leave it out)")
        if self.tilt_deg is not None and not 0.0 <= self.tilt_deg[0] <= self.tilt_deg[1] <= 180.0:
            raise wrong("tilt_deg", "least and greatest tilt are asked for, from 0 to 180°")
        return self

    def made(self) -> Orientation:
        """As a value."""
        azimuth = self.up_azimuth_deg if self.mounting == "roof" else self.faces_azimuth_deg
        tilt = None if self.tilt_deg is None else (self.tilt_deg[0], self.tilt_deg[1])
        return Orientation(self.mounting, azimuth, self.within_deg, tilt)

    @classmethod
    def from_value(cls, value: Orientation) -> OrientationKeys:
        """As keys that `made` turns into the value again."""
        azimuth = "up_azimuth_deg" if value.mounting == "roof" else "faces_azimuth_deg"
        tables = {
            "mounting": value.mounting,
            azimuth: value.azimuth_deg,
            "within_deg": value.within_deg,
            "tilt_deg": None if value.tilt_deg is None else list(value.tilt_deg),
        }
        return cls.of({key: member for key, member in tables.items() if member is not None})


class ProductKeys(Keys):
    """A product."""

    manufacturer: str | None = None
    """Who makes it."""
    product_name: str | None = None
    """Name under which it is sold."""
    device_type: str | None = None
    """Kind of device, such as `Venetian blind horizontal`."""
    orientation: OrientationKeys | None = None
    """How it is to be placed."""

    @property
    def fields(self) -> dict[str, str | float]:
        """By the names of `Metadata`."""
        given = {key: getattr(self, key) for key in ("manufacturer", "product_name", "device_type")}
        return {key: value for key, value in given.items() if value is not None}
