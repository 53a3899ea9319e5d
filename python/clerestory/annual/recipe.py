"""Studies of a year as tables: the keys, their types, units and defaults."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from clerestory.annual.control.states import DataSet
from clerestory.trace.keys import Keys, Positive, wrong


class WorkingHours(Keys):
    """Hours that count."""

    start: Annotated[float, Field(ge=0.0, lt=24.0)] = 8.0
    """Hour of the day at which they begin."""
    end: Annotated[float, Field(gt=0.0, le=24.0)] = 18.0
    """Hour of the day at which they end."""
    weekdays: bool = False
    """Without Saturdays and Sundays."""
    daylight: bool = False
    """Only with the sun above the horizon."""
    clock: str | None = None
    """IANA name of the clock that people live by; standard time by default."""


class Recipe(Keys):
    """A study as a table."""

    name: str = ""
    """What it is called."""
    room: str
    """A room recipe, or the name of one that comes with Clerestory."""
    weather: str | None = None
    """A weather file; without one a year is made up for the room's place, and says so."""
    method: Literal["2-phase", "3-phase", "5-phase", "6-phase"] = "5-phase"
    """Whether the direct sun has the resolution of the data set."""
    glare: Literal["imageless", "pictures"] = "imageless"
    """Whether glare is found in what eyes see of windows and surfaces, or in pictures of every step."""
    picture_px: Annotated[int, Field(ge=100, le=2000)] = 380
    """Width and height of pictures; of 380 a pixel is as large as the sun."""
    patches: str = "reinhart:4"
    """Of the sky."""
    basis: str = "klems-full"
    """Patches of the windows' directions: an angle basis, such as reinhart:2 for finer ones."""
    sensors: list[str] = Field(default_factory=list)
    """Names of the room's sensors; all of them by default."""
    views: list[str] | None = None
    """Names of the room's views at which glare is found; all by default, for the five-phase method."""
    hours: WorkingHours = Field(default_factory=WorkingHours)
    """Hours that count."""
    threshold_lx: Positive = 500.0
    """Illuminance of daylight autonomy [lx]."""
    paths: Annotated[int, Field(ge=16, multiple_of=16)] = 8192
    """Paths of a sensor or view."""
    seed: Annotated[int, Field(ge=0)] = 1
    """Of the random numbers."""
    memory_gb: Annotated[float, Field(ge=0.25)] = 2.0
    """Memory that may be used [GiB]."""
    data_sets: dict[str, DataSet] = Field(default_factory=dict)
    """What stands in all windows, by name, in one state or several; what the room has by default."""

    @model_validator(mode="after")
    def _sound(self) -> Recipe:
        if self.views and self.method in ("2-phase", "3-phase"):
            raise wrong("views", "glare needs the sun at a data set's resolution (give the method 5-phase)")
        return self
