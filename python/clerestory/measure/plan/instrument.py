"""Instruments and their limits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import AfterValidator, Field

from clerestory.trace.keys import Keys, NotNegative, Number, Positive, wrong
from clerestory.trace.recipe import read_toml
from clerestory.trace.shipped import Shelf

if TYPE_CHECKING:
    from typing import Any

INSTRUMENTS = Shelf(Path(__file__).parent / "instruments", "instrument", "measure plan")


def _rising(values: list[float]) -> list[float]:
    if not values or sorted(set(values)) != values:
        raise wrong("", "these do not rise (sort them, each once)")
    return values


Angle = Annotated[Number, Field(gt=0.0, le=90.0)]


class Holder(Keys):
    """What holds a sample."""

    name: str
    """What it is called."""
    smallest_mm: Annotated[list[Positive], Field(min_length=2, max_length=2)]
    """Width and height of the smallest sample [mm]."""
    largest_mm: Annotated[list[Positive], Field(min_length=2, max_length=2)]
    """Width and height of the largest sample [mm]."""
    round: bool = False
    """Whether the largest sample is a disk of the first diameter, which the sample's diagonal must fit into."""
    turns_in_its_plane: bool
    """Whether it turns the sample about its normal by itself, for azimuths of incidence."""


class Instrument(Keys):
    """What a goniophotometer can do."""

    name: str
    """In words."""
    kind: Literal["scanning", "image"]
    """A detector that travels, or a camera that sees a screen."""
    scatter: Annotated[list[Literal["transmission", "reflection"]], Field(min_length=1)]
    """What it sees."""
    largest_theta_deg: Angle
    """Largest angle of incidence [°]."""
    largest_outgoing_theta_deg: Angle
    """Largest angle of outgoing light [°]."""
    minutes_an_incidence: Positive
    """Time of one incident direction, fine scans of peaks included [min]."""
    resolution_deg: Positive
    """Angle that source and detector resolve together [°]."""
    grid_step_deg: Annotated[Number, Field(gt=0.0, le=30.0)]
    """Step of the exit grid, or of the coarse scan of the hemisphere [°]."""
    spots_mm: Annotated[list[Positive], AfterValidator(_rising)]
    """Diameters of the lit spot at normal incidence in use [mm], rising."""
    smallest_spot_mm: Positive
    """Smallest spot that the beam can be brought to for small samples [mm]."""
    aperture_on_sample: bool = False
    """Whether the spot is an aperture on the sample, which does not grow with the angle of incidence."""
    shield_deg: NotNegative
    """Angle about the direction to the source within which the detector shades the beam [°]."""
    holders: Annotated[list[Holder], Field(min_length=1)]
    """What holds samples."""


def find_instrument(name: str | Path) -> Instrument:
    """An instrument by its name among those that come with Clerestory, or by the path of a TOML file.

    Raises
    ------
    RecipeError
        There is none, or its file is faulty; the text names the file and the key.
    """
    path = INSTRUMENTS.find(name)
    return instrument_of(read_toml(path), path)


def instrument_of(tables: dict[str, Any], path: Path) -> Instrument:
    """An instrument from the tables of a file."""
    from clerestory.files import named

    with named(path):
        return Instrument.of(tables)
