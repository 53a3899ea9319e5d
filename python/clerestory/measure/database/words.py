"""What the database holds, in words: a sample, a scan, sphere values, a file, a run, a model and so on."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from clerestory.counts import counted
from clerestory.directions import direction, incident_in_words
from clerestory.finding import tally

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from clerestory.measure.database.database import Database
    from clerestory.measure.database.records import (
        Configuration,
        File,
        Run,
        Sample,
        StoredReport,
        StoredScan,
        StoredSphereValues,
        Subject,
    )
    from clerestory.measure.scan import Scan

_LISTED = 6


def about_sample(database: Database, sample: Sample) -> list[str]:
    """What is known of a sample: directions covered, values, what was odd, and models with what they were made of."""
    lines = [sample.name, *_facts(sample)]
    scans = database.stored_scans(sample=sample.name)
    groups: dict[tuple[str, str, str], list[StoredScan]] = {}
    for scan in scans:
        groups.setdefault((scan.purpose, scan.side, scan.scatter), []).append(scan)
    for (purpose, side, scatter), members in groups.items():
        what = "" if purpose == "sample" else f" of the {purpose}" if purpose == "beam" else " in the dark"
        points = sum(scan.points for scan in members)
        lines.append(
            f"  {scatter} of light from the {side}{what}: {counted(len(members), 'scan')}, {counted(points, 'point')}"
        )
        lines += [f"    {line}" for line in [*_covered(members), *_values(members)]]
    spheres = database.sphere_values(sample.name)
    if spheres:
        lines.append(f"  integrating sphere: {counted(len(spheres), 'set')} of values")
    for (side, scatter, collected), of_kind in groupby(
        sorted(spheres, key=lambda v: (v.incident_side, v.scatter, v.collected)),
        key=lambda v: (v.incident_side, v.scatter, v.collected),
    ):
        angles = _angles("evenly diffuse" if v.theta_deg != v.theta_deg else f"{v.theta_deg:g}°" for v in of_kind)
        lines.append(f"    {collected} {scatter} from the {side} at {angles}")
    for run in _runs(database, scans):
        lines.append(f"  run: {run}")
    files = database.files(sample=sample.name)
    if files:
        formats = ", ".join(sorted({file.format for file in files}))
        lines.append(f"  {counted(len(files), 'file')} ({formats})")
    subjects = {("sample", sample.id), *(("file", file.id) for file in files), *(("scan", s.id) for s in scans)}
    names = {("file", file.id): f"{file.name}: " for file in files}
    for note in database.notes():
        if (note.subject, note.subject_id) in subjects:
            author = f" ({note.author})" if note.author else ""
            lines.append(f"  {note.kind}: {names.get((note.subject, note.subject_id), '')}{note.text}{author}")
    lines += [f"  {check.words}" for check in database.checks(sample=sample.name)]
    on_models = set()
    for model in database.models(sample=sample.name):
        of = counted(model.scans, "scan")
        of += f" and {counted(model.sphere_values, 'set')} of sphere values" if model.sphere_values else ""
        lines.append(f"  {model.words}, made {model.made:%Y-%m-%d %H:%M} of {of}")
        reports = [report for report in database.reports(model=model.id) if report.kind == "report"]
        lines += [f"    {report.words}" for report in reports]
        on_models |= {report.id for report in reports}
    for report in database.reports(sample=sample.name):
        if report.kind == "report" and report.id not in on_models:
            lines.append(f"  {report.words}")
    return lines


def about_model(database: Database, number: int) -> list[str]:
    """What is known of a model: steps, what it was made of, what was made from it, reports, notes."""
    lines = database.provenance(number).lines()
    lines += [f"  made from it: {one.words}" for one in database.models() if number in one.parents]
    lines += [f"  {check.words}" for check in database.checks(model=number)]
    lines += [f"  {report.words}" for report in database.reports(model=number) if report.kind == "report"]
    return lines + _notes(database, "model", number)


def about_scan(database: Database, scan: StoredScan) -> list[str]:
    """What is known of a scan."""
    points = database.scan(scan.id)
    lines = [
        f"scan {scan.id} of sample {scan.sample}{'' if scan.purpose == 'sample' else f' ({scan.purpose})'}",
        f"  {scan.scatter} of light from the {scan.side}, {scan.incident_words} (θ {scan.theta_deg:g}°, "
        f"φ {scan.phi_deg:g}°)",
        f"  {counted(scan.points, 'point')} of {scan.quantity.upper()}, channels: {', '.join(scan.channels)}"
        f"{'' if points.standard_errors is None else ', with standard errors'}",
    ]
    if scan.points:
        theta = points.theta_deg
        lines.append(f"  outgoing θ from {theta.min():.4g}° to {theta.max():.4g}°")
        for name in scan.channels:
            values = points.channel(name)
            below = int((values < 0.0).sum())
            peak = int(values.argmax())
            lines.append(
                f"  {name}: {values.min():.4g} to {values.max():.4g}, the highest at θ {points.theta_deg[peak]:.4g}°, "
                f"φ {points.phi_deg[peak]:.4g}°{f'; {below} below 0' if below else ''}"
            )
        lines.append(f"  the highest of {scan.channels[0]} goes {scan.peak_words}")
    if scan.purpose == "beam":
        lines += _beam(points)
    lines += [f"  {key}: {value}" for key, value in points.conditions.items()]
    if points.source is not None:
        lines.append(f"  file: {points.source.name} ({points.source.format}; {points.source.convention})")
    return lines + _notes(database, "scan", scan.id)


def about_sphere(database: Database, stored: StoredSphereValues) -> list[str]:
    """Values of a sphere: each band, or a spectrum's ends and lowest and highest values."""
    values = database.sphere_value(stored.id)
    lines = [
        f"sphere value {stored.id} of sample {stored.sample}",
        f"  {stored.collected} {stored.scatter} of light from the {stored.side}, {stored.light_words}",
    ]
    errors = values.standard_errors
    if values.wavelength_nm is not None:
        nm = values.wavelength_nm
        low, high = int(values.values.argmin()), int(values.values.argmax())
        lines.append(
            f"  spectrum of {counted(len(nm), 'wavelength')}, {nm.min():g} to {nm.max():g} nm: "
            f"{values.values[low]:.4g} at {nm[low]:g} nm to {values.values[high]:.4g} at {nm[high]:g} nm"
        )
    for k, band in enumerate(values.bands):
        error = f" ± {errors[k]:.2g}" if errors is not None else ""
        lines.append(f"  {band}: {values.values[k]:.4g}{error}")
    lines += [f"  {key}: {value}" for key, value in values.conditions.items()]
    if values.source is not None:
        lines.append(f"  file: {values.source.name} ({values.source.format}; {values.source.convention})")
    return lines


def about_run(database: Database, run: Run) -> list[str]:
    """A run: who, when, with what, and its scans."""
    known = [("laboratory", run.laboratory), ("operator", run.operator), ("date", run.date)]
    lines = [f"run {run.id}", *(f"  {name}: {text}" for name, text in known if text)]
    if run.instrument:
        lines.append(f"  instrument: {run.instrument}, {run.configuration}")
    for (sample, purpose), members in groupby(
        sorted(database.stored_scans(run=run.id), key=lambda s: (s.sample, s.purpose)),
        key=lambda s: (s.sample, s.purpose),
    ):
        scans = [*members]
        of = sample if purpose == "sample" else f"{sample} ({purpose})"
        points = sum(scan.points for scan in scans)
        numbers = f"scan:{scans[0].id} to {scans[-1].id}" if len(scans) > 1 else f"scan:{scans[0].id}"
        lines.append(f"  {of}: {counted(len(scans), 'scan')} of {counted(points, 'point')} ({numbers})")
    spheres = database.stored_sphere_values(run=run.id)
    for sample in dict.fromkeys(one.sample for one in spheres):
        lines.append(f"  {sample}: {counted(sum(s.sample == sample for s in spheres), 'set')} of sphere values")
    lines += [f"  {check.words}" for check in database.checks(run=run.id)]
    return lines + _notes(database, "run", run.id)


def about_configuration(database: Database, setup: Configuration) -> list[str]:
    """How an instrument was set up, its lamp's spectrum and its runs."""
    sizes = [
        ("spot", _millimetres(setup.spot_mm)),
        ("cone of the source", _degrees(setup.source_cone_deg)),
        ("cone of the detector", _degrees(setup.detector_cone_deg)),
    ]
    known = [("lamp", setup.lamp), ("detector", setup.detector), ("filters", setup.filters), *sizes]
    lines = [f"{setup.instrument}: {setup.name}", *(f"  {name}: {text}" for name, text in known if text)]
    spectrum = database.lamp_spectrum(setup.id)
    if spectrum is not None:
        nm, power = spectrum
        peak = nm[int(power.argmax())]
        lines.append(
            f"  lamp's spectrum: {counted(len(nm), 'wavelength')}, {nm.min():g} to {nm.max():g} nm, "
            f"highest at {peak:g} nm"
        )
    for run in database.runs():
        if (run.instrument, run.configuration) == (setup.instrument, setup.name):
            who = ", ".join(word for word in (run.laboratory, run.date) if word)
            lines.append(f"  run:{run.id}{f' ({who})' if who else ''}: {counted(run.scans, 'scan')}")
    return lines + _notes(database, "configuration", setup.id)


def about_report(database: Database, report: StoredReport) -> list[str]:
    """A report, and what it is on; of a check, what it found."""
    lines = [
        report.words,
        f"  SHA-256 {report.sha256}, {report.bytes:,} bytes, made {report.made:%Y-%m-%d %H:%M}",
    ]
    for model in database.models():
        if report in database.reports(model=model.id):
            lines.append(f"  on {model.words} of sample {model.sample!r}")
    lines += [f"  on sample {sample!r}" for sample in report.samples]
    if report.kind == "check":
        check = database.check(report.id)
        of = [counted(len(check.scans), "scan")] if check.scans else []
        of += [f"{counted(len(check.sphere_values), 'set')} of sphere values"] if check.sphere_values else []
        of += [f"model:{model}" for model in check.models]
        lines.append(f"  of {' and '.join(of)}, by clerestory {check.clerestory}")
        lines.append(f"  {tally(check.findings)}")
        lines += [f"    {finding}" for finding in check.findings]
    return lines + _notes(database, "report", report.id)


def _beam(scan: Scan) -> list[str]:
    """The beam's profile: centre and widths."""
    from clerestory._core import ClerestoryError
    from clerestory.measure.prepare.signature import LEVELS, signatures

    try:
        found = signatures(scan)
    except ClerestoryError as error:
        return [f"  profile: {error}"]
    lines = []
    for one in found:
        widths = ", ".join(
            f"{width:.3g}° wide at {100.0 * level:g} %"
            for level, width in zip(LEVELS, one.widths_deg, strict=True)
            if width is not None
        )
        lines.append(
            f"  profile of {one.channel}: centre at θ {one.theta_deg:.4g}°, φ {one.phi_deg:.4g}°, "
            f"{widths or 'no width (the scan does not get below half of the peak)'}"
        )
    return lines


def _notes(database: Database, subject: Subject, number: int) -> list[str]:
    return [
        f"  {note.kind}: {note.text}{f' ({note.author})' if note.author else ''}"
        for note in database.notes(subject, number)
    ]


def about_file(database: Database, file: File) -> list[str]:
    """What is known of a file."""
    of_file = [scan for scan in database.stored_scans() if scan.file_id == file.id]
    samples = ", ".join(sorted({scan.sample for scan in of_file}))
    choices = ", ".join(f"{key} = {value}" for key, value in file.choices.items())
    lines = [
        f"{file.name} ({file.format})",
        f"  SHA-256 {file.sha256}",
        f"  imported {file.imported:%Y-%m-%d %H:%M} by clerestory {file.version}"
        f"{', kept as it was' if file.kept else ', too large to be kept as it was'}",
        f"  convention: {file.convention}{f' (said by a person: {choices})' if choices else ''}",
        f"  {counted(file.scans, 'scan')} of {counted(sum(scan.points for scan in of_file), 'point')}"
        f"{f', sample {samples}' if samples else ''}; {counted(file.sphere_values, 'set')} of sphere values",
    ]
    lines += _notes(database, "file", file.id)
    if file.header:
        lines += ["  header:", *(f"    {line}" for line in file.header)]
    return lines


def _facts(sample: Sample) -> list[str]:
    size = [_millimetres(length) for length in (sample.width_mm, sample.height_mm)]
    facts = [
        ("manufacturer", sample.manufacturer),
        ("what", sample.description),
        ("structure period", _millimetres(sample.structure_period_mm)),
        ("size", " × ".join(length or "?" for length in size) if any(size) else None),
        ("thickness", _millimetres(sample.thickness_mm)),
        ("symmetry", sample.symmetry),
        ("pictures", "; ".join(sample.pictures)),
    ]
    return [f"  {name}: {text}" for name, text in facts if text]


def _degrees(angle: float | None) -> str | None:
    return None if angle is None else f"{angle:g}°"


def _millimetres(size: float | None) -> str | None:
    return None if size is None else f"{size:g} mm"


def _covered(scans: Sequence[StoredScan]) -> list[str]:
    """Incident directions, and how far outgoing ones go."""
    thetas = sorted({scan.theta_deg for scan in scans})
    phis = sorted({scan.phi_deg for scan in scans if scan.theta_deg > 0.0})
    first = scans[0]
    words = f"incident θ {_angles(f'{theta:g}°' for theta in thetas)}"
    if phis:
        words += f"; φ {_angles(f'{phi:g}°' for phi in phis)}"
    if len(thetas) == 1 and len(phis) <= 1:
        words += f" ({incident_in_words(direction(first.theta_deg, first.phi_deg, side=first.side))})"
    reached = [scan.outgoing_theta_max_deg for scan in scans if scan.outgoing_theta_max_deg is not None]
    ends = dict.fromkeys(f"{end(reached):.4g}°" for end in (min, max) if reached)
    return [words, f"outgoing θ up to {' to '.join(ends)}"] if ends else [words]


def _values(scans: Sequence[StoredScan]) -> list[str]:
    lines = []
    for (quantity, channels), members in groupby(
        sorted(scans, key=lambda s: (s.quantity, s.channels)), key=lambda s: (s.quantity, s.channels)
    ):
        known = [scan for scan in members if scan.value_max is not None and scan.value_min is not None]
        if not known:
            continue
        top = max(known, key=lambda s: s.value_max or 0.0)
        least = min(scan.value_min for scan in known if scan.value_min is not None)
        lines.append(
            f"{quantity.upper()} of {channels[0]}{f' (and {chr(44).join(channels[1:])})' if channels[1:] else ''}: "
            f"{least:.4g} to {top.value_max:.4g}, the highest {top.peak_words} for light {top.incident_words}"
        )
    return lines


def _angles(texts: Iterable[str]) -> str:
    """A few angles, or the first, the last and how many."""
    known = list(dict.fromkeys(texts))
    if len(known) <= _LISTED:
        return ", ".join(known)
    return f"{known[0]} to {known[-1]} ({len(known)} of them)"


def _runs(database: Database, scans: Sequence[StoredScan]) -> list[str]:
    seen = {(scan.laboratory, scan.date) for scan in scans}
    texts = []
    for run in database.runs():
        words = [run.laboratory, run.operator, run.date, run.instrument, run.configuration]
        if (run.laboratory, run.date) in seen and any(words):
            texts.append(", ".join(word for word in words if word))
    return texts
