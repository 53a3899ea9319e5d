"""Record files: what a person knows of samples and instruments, as TOML."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import Field

from clerestory._core import FileFormatError
from clerestory.trace.keys import Keys, Positive, RecipeError  # pydantic looks at them at run time

if TYPE_CHECKING:
    import os

    from clerestory.measure.database.records import Subject
    from clerestory.measure.database.writing import Writing


class SampleRecord(Keys):
    """A sample."""

    name: str
    manufacturer: str | None = None
    description: str | None = None
    structure_period_mm: Positive | None = None
    width_mm: Positive | None = None
    height_mm: Positive | None = None
    thickness_mm: Positive | None = None
    symmetry: str | None = None
    pictures: list[str] | None = None
    """Paths or addresses of photographs and CAD drawings."""
    notes: list[str] = Field(default_factory=list)


class ConfigurationRecord(Keys):
    """An instrument as it is set up."""

    name: str
    lamp: str | None = None
    lamp_wavelength_nm: list[Positive] | None = None
    lamp_power: list[float] | None = None
    """Relative, one a wavelength."""
    detector: str | None = None
    filters: str | None = None
    spot_mm: Positive | None = None
    source_cone_deg: Positive | None = None
    detector_cone_deg: Positive | None = None
    notes: list[str] = Field(default_factory=list)


class InstrumentRecord(Keys):
    """An instrument."""

    name: str
    kind: str | None = None
    manufacturer: str | None = None
    configurations: list[ConfigurationRecord]


class Record(Keys):
    """A file of records."""

    samples: list[SampleRecord] = Field(default_factory=list)
    instruments: list[InstrumentRecord] = Field(default_factory=list)


def read_record(path: str | os.PathLike[str]) -> Record:
    """Read a file of records.

    Raises
    ------
    FileFormatError
        It is not TOML, or a key is wrong; the text names it.
    """
    path = Path(path)
    try:
        return Record.of(tomllib.loads(path.read_text(encoding="utf-8")))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError, RecipeError) as error:
        raise FileFormatError(f"{path}: {error}") from error


def keep_record(database: Writing, record: Record) -> list[str]:
    """Write records to a database; what was written, in words."""
    done = []
    with database.transaction():
        for sample in record.samples:
            about = sample.model_dump(exclude={"name", "notes"}, exclude_none=True)
            number = database.describe_sample(sample.name, **about)
            _note(database, "sample", number, sample.notes)
            done.append(f"sample {sample.name}")
        for instrument in record.instruments:
            for one in instrument.configurations:
                settings = one.model_dump(
                    exclude={"name", "notes", "lamp_wavelength_nm", "lamp_power"}, exclude_none=True
                )
                if one.lamp_wavelength_nm is not None or one.lamp_power is not None:
                    settings["lamp_spectrum"] = (one.lamp_wavelength_nm or [], one.lamp_power or [])
                settings |= {"kind": instrument.kind, "manufacturer": instrument.manufacturer}
                number = database.describe_configuration(instrument.name, one.name, **settings)
                _note(database, "configuration", number, one.notes)
                done.append(f"configuration {one.name} of {instrument.name}")
    return done


def _note(database: Writing, subject: Subject, number: int, texts: list[str]) -> None:
    there = {note.text for note in database.notes(subject, number)}
    for text in texts:
        if text not in there:
            database.note(subject, number, text)
