"""The laboratory's database: samples, runs, files, scans with their points, models and where each came from.

`Database` is one class in layers, a file each: `connection` opens it, `spheres` and `reading` ask, `writing` imports,
`origins` finds measured values again, `models` and `reports` keep what was made of them, `checks` what was found,
`database` takes out. `tables` is the schema, `migrations` its history.
"""

from clerestory.measure.database.connection import DEFAULT, VARIABLE, Location, location
from clerestory.measure.database.database import Database
from clerestory.measure.database.incoming import Added
from clerestory.measure.database.records import (
    Configuration,
    File,
    Note,
    Origin,
    Provenance,
    Run,
    Sample,
    StoredCheck,
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
    "Origin",
    "Provenance",
    "Run",
    "Sample",
    "StoredCheck",
    "StoredModel",
    "StoredReport",
    "StoredScan",
    "StoredSphereValues",
    "location",
]
