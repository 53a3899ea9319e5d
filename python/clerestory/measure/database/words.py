"""A sample, a scan or a file of the database in words."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from clerestory.counts import counted
from clerestory.directions import direction, incident_in_words

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from clerestory.measure.database.database import Database
    from clerestory.measure.database.records import File, Sample, StoredScan

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
            lines.append(f"  {note.kind}: {names.get((note.subject, note.subject_id), '')}{note.text}")
    for model in database.models(sample=sample.name):
        lines += [f"  {line}" for line in database.provenance(model.id).lines()]
    return lines


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
    lines += [f"  {key}: {value}" for key, value in points.conditions.items()]
    if points.source is not None:
        lines.append(f"  file: {points.source.name} ({points.source.format}; {points.source.convention})")
    lines += [f"  {note.kind}: {note.text}" for note in database.notes("scan", scan.id)]
    return lines


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
    lines += [f"  {note.kind}: {note.text}" for note in database.notes("file", file.id)]
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
    return [words, f"outgoing θ up to {min(reached):.4g}° to {max(reached):.4g}°"] if reached else [words]


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
