"""The laboratory's database: samples, runs, files, scans with their points, models and where each came from.

`Database` is one class in layers, a file each: `connection` opens it, `reading` asks, `writing` imports, `models` keeps
what was made of scans, `database` takes out. `tables` is the schema, `migrations` its history.
"""

from clerestory.measure.database.connection import DEFAULT, VARIABLE, Location, location
from clerestory.measure.database.database import Database
from clerestory.measure.database.incoming import Added
from clerestory.measure.database.records import (
    Configuration,
    File,
    Note,
    Provenance,
    Run,
    Sample,
    StoredModel,
    StoredReport,
    StoredScan,
    StoredSphereValues,
)

__all__ = [
    "DEFAULT",
    "VARIABLE",
    "Added",
    "Configuration",
    "Database",
    "File",
    "Location",
    "Note",
    "Provenance",
    "Run",
    "Sample",
    "StoredModel",
    "StoredReport",
    "StoredScan",
    "StoredSphereValues",
    "location",
]
