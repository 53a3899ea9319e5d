"""What comes with Clerestory: instruments and programs compared, and records of known samples.

The tables are those of the report IEA SHC Task 61 C.2.2 (2021), sections 2.10.1, 2.10.2 and 3.1, in words of our own.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

from pydantic import Field

from clerestory.trace.keys import Keys, NotNegative, Positive  # pydantic looks at them at run time

_FOLDER = Path(__file__).parent


class CatalogueInstrument(Keys):
    """A kind of instrument that laboratories use."""

    name: str
    kind: str
    manufacturer: str
    features: str
    gives: list[str]
    """Formats of its files."""
    laboratories: list[str]
    incident_deg: str
    """Angles of incidence."""
    outgoing: str
    """Directions that are seen."""
    source: str
    spot: str
    detector: str
    wavelength_nm: list[Positive]
    """First and last."""
    smallest_bsdf: Positive | None = None
    """Below which nothing is seen [1/sr]."""
    dynamic_range: Positive | None = None
    """Largest signal over the smallest."""
    accuracy: str | None = None
    samples: str | None = None
    """Sizes that fit."""
    hours: NotNegative | None = None
    """For 145 incident directions [h]."""
    limits: list[str] = Field(default_factory=list)
    url: str | None = None


class CatalogueSoftware(Keys):
    """A program that makes or changes BSDFs."""

    name: str
    job: str
    technology: str
    takes: list[str]
    gives: list[str]
    exports_bsdf: bool


class _Shelves(Keys):
    instruments: list[CatalogueInstrument] = Field(default_factory=list)
    software: list[CatalogueSoftware] = Field(default_factory=list)


def instruments() -> list[CatalogueInstrument]:
    """Instruments as the report compares them."""
    return _shelves("instruments").instruments


def software() -> list[CatalogueSoftware]:
    """Programs as the report compares them."""
    return _shelves("software").software


def record(name: str) -> Path | None:
    """The file of a record that comes with Clerestory, such as `roundrobin`."""
    path = _FOLDER / f"{name}.toml"
    return path if name == "roundrobin" and path.exists() else None


def _shelves(name: str) -> _Shelves:
    return _Shelves.of(tomllib.loads((_FOLDER / f"{name}.toml").read_text(encoding="utf-8")))
