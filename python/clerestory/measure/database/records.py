"""What the database tells: a row a record, in the words of `clerestory.measure`."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Literal, cast

from clerestory.counts import counted
from clerestory.directions import direction, incident_in_words, outgoing_in_words, outgoing_side
from clerestory.finding import tally

if TYPE_CHECKING:
    from datetime import datetime

    from clerestory.directions import Scatter, Side
    from clerestory.finding import Finding
    from clerestory.measure.scan import Purpose, Quantity
    from clerestory.measure.sphere import Collected

Kind = Literal["model", "scans"]
ReportKind = Literal["report", "check"]
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

    @property
    def chosen(self) -> str:
        """What a person said of its convention: a preset's name, or keys and values; empty if nothing."""
        said = {key: self.choices[key] for key in ("convention", "front", "seen_from", "up_deg") if key in self.choices}
        return ", ".join(value if key == "convention" else f"{key}={value}" for key, value in said.items())


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
    bands: tuple[str, ...]
    """Empty for a spectrum."""

    @property
    def what(self) -> str:
        """Bands, or a spectrum."""
        return ", ".join(self.bands) or "spectrum"

    @property
    def light_words(self) -> str:
        """What light was measured."""
        return "evenly diffuse" if self.theta_deg is None else f"θ {self.theta_deg:g}°, φ {self.phi_deg:g}°"


@dataclass(frozen=True)
class StoredModel:
    """A model that was made of scans, or scans that were prepared."""

    id: int
    sample: str
    name: str
    kind: Kind
    file_name: str
    """A ZIP archive of them, where several files were written."""
    bytes: int
    sha256: str
    command: str
    settings: dict[str, object]
    steps: tuple[dict[str, object], ...]
    """What was done, each with step, what, settings, figures and warnings."""
    files: dict[str, str]
    """SHA-256 of what was written, by the name of the file."""
    version: str
    """Of Clerestory, which made it."""
    made: datetime
    parents: tuple[int, ...]
    """Models and prepared scans that it was made from."""
    scans: int
    sphere_values: int

    @property
    def words(self) -> str:
        """Model 'x' (model:3; x.xml)."""
        what = "model" if self.kind == "model" else "prepared scans"
        return f"{what} {self.name!r} (model:{self.id}; {self.file_name})"


@dataclass(frozen=True)
class Origin:
    """What of the database something was made of."""

    samples: tuple[str, ...]
    scans: tuple[int, ...]
    sphere_values: tuple[int, ...]
    parents: tuple[int, ...]
    """Models and prepared scans whose files were read."""
    unknown: tuple[str, ...]
    """What is not in the database, in words."""


@dataclass(frozen=True)
class StoredReport:
    """A report on samples or models, or what a check found."""

    id: int
    name: str
    kind: ReportKind
    file_name: str
    bytes: int
    sha256: str
    made: datetime
    models: tuple[str, ...]
    """Names of those that it is on."""
    samples: tuple[str, ...]

    @property
    def words(self) -> str:
        """Report 'x' (report:3; x.pdf)."""
        return f"{self.kind} {self.name!r} (report:{self.id}; {self.file_name})"


@dataclass(frozen=True)
class StoredCheck:
    """What a check found."""

    report: int
    """Its number among the reports."""
    sample: str
    made: datetime
    clerestory: str
    """The version that looked."""
    findings: tuple[Finding, ...]
    scans: tuple[int, ...]
    """Numbers of what was checked."""
    sphere_values: tuple[int, ...]
    models: tuple[int, ...]
    """Prepared scans among it."""

    @property
    def words(self) -> str:
        """Of which day, and how much was found."""
        return f"check of {self.made:%Y-%m-%d %H:%M}: {self.tally} (report:{self.report})"

    @property
    def tally(self) -> str:
        """How much was found."""
        return tally(self.findings)


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
            f"{model.words} of sample {model.sample!r}",
            f"  SHA-256 {model.sha256}, {model.bytes:,} bytes",
            f"  made {model.made:%Y-%m-%d %H:%M} by clerestory {model.version}: {model.command}",
            f"  settings: {settings}",
        ]
        for step in model.steps:
            lines.append(f"  step {step.get('step')}: {step.get('what')}")
            lines += [f"    warning: {text}" for text in cast("list[str]", step.get("warnings") or [])]
        lines += [f"  made from model:{parent}" for parent in model.parents]
        for (form, convention), members in groupby(self.files, key=lambda file: (file.format, file.convention)):
            lines.append(f"  {form}; {convention}:")
            lines += [f"    {self._of_file(file)}" for file in members]
        loose = [scan for scan in self.scans if scan.file_id is None]
        if loose:
            points = sum(scan.points for scan in loose)
            lines.append(f"  {counted(len(loose), 'scan')} of {counted(points, 'point')} that came from no file")
        for run in self.runs:
            known = [run.laboratory, run.operator, run.date, run.instrument, run.configuration]
            if any(known):
                lines.append(f"  run: {', '.join(word for word in known if word)}")
        return lines

    def _of_file(self, file: File) -> str:
        scans = [scan for scan in self.scans if scan.file_id == file.id]
        spheres = sum(values.file_id == file.id for values in self.sphere_values)
        what = [f"{counted(len(scans), 'scan')} of {counted(sum(s.points for s in scans), 'point')}"] if scans else []
        what += [f"{counted(spheres, 'set')} of sphere values"] if spheres else []
        return f"file {file.name} (SHA-256 {file.sha256[:12]}…): {', '.join(what)}"
