"""What the database tells: a row a record, in the words of `clerestory.measure`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from clerestory.counts import counted
from clerestory.directions import direction, incident_in_words, outgoing_in_words, outgoing_side

if TYPE_CHECKING:
    from datetime import datetime

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Purpose, Quantity
    from clerestory.measure.sphere import Collected

Subject = Literal["sample", "instrument", "configuration", "run", "file", "scan", "model", "report"]
SUBJECTS: tuple[Subject, ...] = (
    "sample",
    "instrument",
    "configuration",
    "run",
    "file",
    "scan",
    "model",
    "report",
)


@dataclass(frozen=True)
class Sample:
    """A piece of material or a system that is measured."""

    id: int
    name: str
    manufacturer: str | None
    description: str | None
    structure_period_mm: float | None
    width_mm: float | None
    height_mm: float | None
    thickness_mm: float | None
    symmetry: str | None
    pictures: tuple[str, ...]
    """Paths or addresses of photographs and CAD drawings."""
    scans: int
    """How many there are, beams and dark ones included."""
    points: int
    sphere_values: int
    models: int


@dataclass(frozen=True)
class Configuration:
    """An instrument as it was set up."""

    id: int
    instrument: str
    name: str
    lamp: str | None
    detector: str | None
    filters: str | None
    spot_mm: float | None
    source_cone_deg: float | None
    """Full angle of the beam [°]."""
    detector_cone_deg: float | None
    """Full angle that the detector takes in [°]."""


@dataclass(frozen=True)
class Run:
    """Scans that a laboratory took in one go."""

    id: int
    laboratory: str | None
    operator: str | None
    date: str | None
    """ISO 8601: a day, or day and time."""
    instrument: str | None
    configuration: str | None
    scans: int
    sphere_values: int


@dataclass(frozen=True)
class File:
    """A file that was imported."""

    id: int
    name: str
    sha256: str
    format: str
    convention: str
    header: tuple[str, ...]
    choices: dict[str, str]
    """What a person said where the file is silent."""
    imported: datetime
    version: str
    """Of Clerestory, which read it."""
    kept: bool
    """Whether its bytes are in the database."""
    scans: int
    sphere_values: int


@dataclass(frozen=True)
class StoredScan:
    """A scan without its points."""

    id: int
    sample: str
    file_id: int | None
    file: str | None
    """Its name."""
    laboratory: str | None
    date: str | None
    purpose: Purpose
    side: Side
    scatter: Scatter
    quantity: Quantity
    channels: tuple[str, ...]
    theta_deg: float
    """Of the direction to the source [°]."""
    phi_deg: float
    points: int
    outgoing_theta_max_deg: float | None
    """The most oblique outgoing direction [°]."""
    value_min: float | None
    """Of the first channel."""
    value_max: float | None
    peak_theta_deg: float | None
    """Where the largest value of the first channel is [°]."""
    peak_phi_deg: float | None

    @property
    def incident_words(self) -> str:
        """Where the light comes from."""
        return incident_in_words(direction(self.theta_deg, self.phi_deg, side=self.side))

    @property
    def peak_words(self) -> str:
        """Where the largest value is."""
        if self.peak_theta_deg is None or self.peak_phi_deg is None:
            return "nowhere"
        side = outgoing_side(self.side, self.scatter)
        return outgoing_in_words(direction(self.peak_theta_deg, self.peak_phi_deg, side=side))


@dataclass(frozen=True)
class StoredSphereValues:
    """Values of a sphere without their numbers."""

    id: int
    sample: str
    file_id: int | None
    file: str | None
    """Its name."""
    side: Side
    scatter: Scatter
    collected: Collected
    theta_deg: float | None
    """None for diffuse light."""
    phi_deg: float


@dataclass(frozen=True)
class StoredModel:
    """A model that was made of scans."""

    id: int
    sample: str
    name: str
    file_name: str
    bytes: int
    sha256: str
    command: str
    settings: dict[str, object]
    version: str
    """Of Clerestory, which made it."""
    made: datetime
    scans: int
    sphere_values: int


@dataclass(frozen=True)
class StoredReport:
    """A report on models."""

    id: int
    name: str
    file_name: str
    bytes: int
    made: datetime
    models: tuple[str, ...]


@dataclass(frozen=True)
class Note:
    """What a person wrote about something, or what was odd in a file."""

    id: int
    subject: Subject
    subject_id: int
    kind: Literal["note", "warning"]
    text: str
    author: str | None
    written: datetime


@dataclass(frozen=True)
class Provenance:
    """What a model was made of, back to the raw points."""

    model: StoredModel
    scans: tuple[StoredScan, ...]
    sphere_values: tuple[StoredSphereValues, ...]
    files: tuple[File, ...]
    runs: tuple[Run, ...]

    def lines(self) -> list[str]:
        """As a tree of text."""
        model = self.model
        settings = ", ".join(f"{key} = {value}" for key, value in model.settings.items()) or "none"
        lines = [
            f"model {model.name!r} of sample {model.sample!r} ({model.file_name}, SHA-256 {model.sha256[:12]}…)",
            f"  made {model.made:%Y-%m-%d %H:%M} by clerestory {model.version}: {model.command}",
            f"  settings: {settings}",
        ]
        for file in self.files:
            lines.append(f"  file {file.name} (SHA-256 {file.sha256[:12]}…, {file.format}; {file.convention})")
            scans = [scan for scan in self.scans if scan.file_id == file.id]
            if scans:
                points = sum(scan.points for scan in scans)
                lines.append(f"    {counted(len(scans), 'scan')} of {counted(points, 'point')}")
            spheres = sum(values.file_id == file.id for values in self.sphere_values)
            if spheres:
                lines.append(f"    {counted(spheres, 'set')} of sphere values")
        loose = [scan for scan in self.scans if scan.file_id is None]
        if loose:
            points = sum(scan.points for scan in loose)
            lines.append(f"  {counted(len(loose), 'scan')} of {counted(points, 'point')} that came from no file")
        for run in self.runs:
            known = [run.laboratory, run.operator, run.date, run.instrument, run.configuration]
            if any(known):
                lines.append(f"  run: {', '.join(word for word in known if word)}")
        return lines
