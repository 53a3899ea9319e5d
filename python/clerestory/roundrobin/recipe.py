"""Study files of round robins: every table and key."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import Field, model_validator

from clerestory.annual.recipe import WorkingHours
from clerestory.room.recipe import Treatment
from clerestory.trace.keys import Fraction, Keys, Number, Positive, wrong

Analysis = Literal["transmittance", "moments", "year"]
"""Analyses beside the inventory, which is always made; the conclusion is of those that were."""
ANALYSES: tuple[Analysis, ...] = get_args(Analysis)
Resolution = Literal["klems", "high", "raw"]
"""What a laboratory gave: a matrix on an angle basis, finer data, or raw measurements, which are only listed."""
TREATMENTS: tuple[Treatment, ...] = ("klems", "klems-peaks", "high", "high-peaks")
TIMES = (
    "2021-02-21 14:00",
    *(f"{year}-21 14:00" for year in ("2020-12", "2021-01", "2021-03", "2021-04", "2021-05", "2021-06")),
)
"""Those of the report of IEA SHC Task 61 (2021, C.2.2, section 3.5); the first is the one that is rendered."""


class Given(Keys):
    """A data set that a laboratory gave."""

    laboratory: Annotated[str, Field(min_length=1)]
    """Who gave it."""
    file: str | None = None
    """BSDF file, specification of a window or recipe of a sample, relative to the study; raw data need none."""
    resolution: Resolution | None = None
    """klems, high or raw; by the file by default."""
    flipped: bool = False
    """The file's interior is put to the exterior."""
    note: str = ""
    """For the inventory, such as what else was given."""

    @model_validator(mode="after")
    def _sound(self) -> Given:
        if self.file is None and self.resolution != "raw":
            raise wrong("file", 'there is none (give a BSDF file, or resolution = "raw" for data that are only listed)')
        return self


class Pane(Keys):
    """A pane in front of a shade, on its exterior."""

    file: str | None = None
    """BSDF file or specification, relative to the study."""
    glass: Annotated[Number, Field(gt=0.0, le=1.0)] | None = None
    """Visible transmittance of a clear pane at normal incidence."""
    glass_reflectance: Fraction | None = None
    """Visible reflectance of that pane; that of glass of index 1.52 by default."""

    @model_validator(mode="after")
    def _one(self) -> Pane:
        if (self.file is None) == (self.glass is None):
            raise wrong("file", "either a file or glass is asked for (give one of them)")
        return self


class System(Keys):
    """A system that laboratories characterised."""

    title: str = ""
    """What it is called; its name in the study by default."""
    pane: Pane | None = None
    """In front of it; it stands alone by default."""
    data_sets: Annotated[list[Given], Field(min_length=1)]
    """What the laboratories gave."""


class Moments(Keys):
    """Points in time."""

    room: str = "office"
    """A room recipe, or the name of one that comes with Clerestory; its sky is that of all times."""
    view: str = "desk"
    """One of the room's views."""
    times: Annotated[list[str], Field(min_length=1)] = Field(default=list(TIMES))
    """Day and standard time of the room's place; the first is rendered."""
    size_px: Annotated[int, Field(ge=32, le=2048)] = 400
    """Width and height of the renderings."""
    samples: Annotated[int, Field(ge=1)] = 8
    """Paths a pixel."""


class Year(Keys):
    """The year of a room."""

    room: str = "cell-71t"
    """A room recipe, or the name of one that comes with Clerestory."""
    view: str = "window"
    """One of the room's views: vertical illuminance and glare are found there."""
    sensors: str = "workplane"
    """One name of the room's sensors: daylight autonomy is found there."""
    weather: str | None = None
    """A weather file; without one a year is made up for the room's place, and the report says so."""
    months: Annotated[list[Annotated[int, Field(ge=1, le=12)]], Field(min_length=1)] = Field(default=list(range(1, 13)))
    """That are computed, 1 to 12."""
    thresholds_lx: Annotated[list[Positive], Field(min_length=1)] = Field(default=[500.0, 50.0])
    """Illuminances of daylight autonomy [lx], of all hours with the sun above the horizon."""
    hours: WorkingHours = Field(default_factory=WorkingHours)
    """Hours that count at the eye."""
    paths: Annotated[int, Field(ge=16, multiple_of=16)] = 8192
    """Paths of a sensor or view."""


class Recipe(Keys):
    """A round robin as a table."""

    name: str = "Round robin"
    """Head of the report."""
    systems: Annotated[dict[str, System], Field(min_length=1)]
    """By name."""
    pane: Pane | None = None
    """In front of all systems that have none of their own."""
    analyses: list[Analysis] = Field(default=list(ANALYSES))
    """What is done."""
    treatments: Annotated[list[Treatment], Field(min_length=1)] = Field(default=list(TREATMENTS))
    """How data sets are used; those of high resolution only where the data are."""
    patches: Annotated[list[Annotated[int, Field(ge=1, le=145)]], Field(min_length=1)] = Field(default=[1, 41, 88, 130])
    """Incident patches of Klems' full basis at which transmittances are compared."""
    seeds: Annotated[list[Annotated[int, Field(ge=0)]], Field(min_length=1)] = Field(default=[1, 2])
    """Of the random numbers: points in time are found with each; the year with the first, and with the others for the
    first treatment alone."""
    moments: Moments = Field(default_factory=Moments)
    """Points in time."""
    year: Year = Field(default_factory=Year)
    """The year."""

    @model_validator(mode="after")
    def _sound(self) -> Recipe:
        for key in ("analyses", "treatments", "patches", "seeds"):
            values = getattr(self, key)
            twice = next((v for k, v in enumerate(values) if v in values[:k]), None)
            if twice is not None:
                raise wrong(key, f"{twice!r} is there twice (give each once)")
        return self
