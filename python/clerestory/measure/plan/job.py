"""What a person wants to measure: the sample, and what the data are for."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, model_validator

from clerestory.measure.plan.instrument import find_instrument
from clerestory.trace.keys import Keys, NotNegative, Number, Positive, wrong
from clerestory.trace.reading import reading
from clerestory.trace.recipe import read_toml

if TYPE_CHECKING:
    import os
    from typing import Self

Symmetry = Literal["isotropic", "quadrilateral", "left-right", "up-down", "rotational", "none", "unknown"]
"""Of a sample: no dependence on the azimuth; mirrored in x and y; mirrored in y alone (left and right alike); the same
after half a turn but not mirrored, as a twill; none; or not known, which is measured as none."""
SYMMETRIES: tuple[Symmetry, ...] = (
    "isotropic",
    "quadrilateral",
    "left-right",
    "up-down",
    "rotational",
    "none",
    "unknown",
)
Purpose = Literal["klems", "high-resolution", "glare", "cut-off"]
"""Matrices of 145 patches; tensor trees; glare, where the sun's surroundings decide; or the angle of cut-off."""
PURPOSES: tuple[Purpose, ...] = ("klems", "high-resolution", "glare", "cut-off")
Directions = Literal["steps", "klems-full", "klems-half", "klems-quarter", "tregenza"]
"""Steps of the polar angle at some azimuths; or the patches of a basis that symmetry leaves."""
DIRECTIONS: tuple[Directions, ...] = ("steps", "klems-full", "klems-half", "klems-quarter", "tregenza")


class Piece(Keys):
    """The sample."""

    name: str = "sample"
    """What it is called in files."""
    width_mm: Positive
    """Width [mm]."""
    height_mm: Positive
    """Height [mm]."""
    period_mm: NotNegative = 0.0
    """Period of its structure in the direction in which it is longest [mm]; 0 for none."""
    symmetry: Symmetry = "unknown"
    """As far as it is known."""
    weave: Literal["none", "square", "rectangular"] = "none"
    """Of a fabric with orthogonal yarns: the same count both ways, or not."""
    cut_off_deg: Annotated[Number, Field(ge=0.0, lt=90.0)] | None = None
    """Angle of incidence from which no light passes straight through, estimated from the geometry [°]."""
    geometry_known: bool = False
    """Whether its geometry is known well enough to trace it."""
    states: Annotated[int, Field(ge=1)] = 1
    """Configurations that data are needed for, such as tilts of slats."""
    prismatic: bool = False
    """Whether it turns light in one plane, as prisms and louvres do."""
    translucent: bool = False
    """Whether light spreads inside it, as in opal glass."""
    specular: bool = True
    """Whether a beam goes straight through or is mirrored."""


class Job(Keys):
    """A plan's beginning: sample, purpose and instrument."""

    sample: Piece
    """The sample."""
    purpose: Purpose = "high-resolution"
    """What the data are for."""
    instrument: str = "pg2"
    """Name of an instrument that comes with Clerestory, or the path of a TOML file seen from this one."""
    sides: Annotated[list[Literal["exterior", "interior"]], Field(min_length=1)] = Field(
        default_factory=lambda: ["exterior"]  # type: ignore[arg-type]
    )
    """Sides that light comes from."""
    scatter: Annotated[list[Literal["transmission", "reflection"]], Field(min_length=1)] = Field(
        default_factory=lambda: ["transmission", "reflection"]  # type: ignore[arg-type]
    )
    """What is wanted; what the instrument does not see is left out, and said."""
    directions: Directions = "steps"
    """Incident directions."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.sample.weave != "none" and self.sample.symmetry == "isotropic":
            raise wrong("sample.symmetry", "a weave is not isotropic (give quadrilateral, rotational or none)")
        if self.purpose == "cut-off" and self.sample.cut_off_deg is None:
            raise wrong("sample.cut_off_deg", "is missing for the purpose cut-off (estimate it from the geometry)")
        return self


def read_job(path: str | os.PathLike[str]) -> Job:
    """A job from a TOML file; the path of an instrument in it is seen from the file's folder.

    Raises
    ------
    RecipeError
        The file is faulty; the text names the file and the key.
    """
    from clerestory.files import named

    path = Path(path)
    with named(path):
        job = Job.of(read_toml(path))
        if Path(job.instrument).suffix:
            instrument = path.parent / job.instrument
            with reading("instrument"):
                find_instrument(instrument)
            return job.model_copy(update={"instrument": str(instrument)})
        return job
