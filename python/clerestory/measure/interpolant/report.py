"""A report on a fit: what was made, how good it is, and measured points beside the model."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import __version__
from clerestory.counts import counted
from clerestory.report.document import Box, Cell, Document, Figure, Heading, Items, Table
from clerestory.whole import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from clerestory.measure.interpolant.fitted import Component, Fit
    from clerestory.measure.scan import Measurement
    from clerestory.report.document import Block

_SHOWN = 3
"""Incident directions of a component that are drawn: the smallest, a middle and the largest angle."""


def write_report(path: Path, made: Fit, measurement: Measurement) -> None:
    """Write a report, as HTML or PDF by the suffix.

    Parameters
    ----------
    path
        Ends with `.html` or `.pdf`.
    made
        The model, as it was fitted; pictures are of it rather than of a table that was made of it.
    measurement
        What it was made of.
    """
    document = report_on(made, measurement)
    if path.suffix.lower() == ".pdf":
        from clerestory.report.pdf import pdf

        write_whole(path, pdf(document))
    else:
        from clerestory.report.html import html

        write_whole(path, html(document).encode())


def report_on(made: Fit, measurement: Measurement) -> Document:
    """The report, to be shown as HTML or PDF."""
    blocks: list[Block] = []
    if made.warnings:
        blocks.append(Box("Known first", made.warnings, "note"))
    for component in made.components:
        title = f"{component.band}: {component.scatter} of light from the {component.side}"
        blocks += [Heading(title), Items(tuple(component.lines()))]
        if len(component.held_out):
            blocks.append(_held_out(component))
        blocks += _pictures(component, made, measurement)
    scans = counted(len(measurement.of()), "scan")
    points = counted(sum(len(scan) for scan in measurement.of()), "point")
    return Document(
        f"Model of {made.sample or 'a sample'}",
        f"{points} of {scans}; between incident directions: {made.method}",
        __version__,
        tuple(blocks),
    )


def _held_out(component: Component) -> Table:
    held = component.held_out
    rows = tuple(
        (
            Cell(f"{theta:g}°, {phi:g}°", float(theta)),
            Cell(f"{measured:.4f}", float(measured)),
            Cell(f"{found:.4f}", float(found)),
            Cell(f"{found - measured:+.4f}", float(found - measured)),
            Cell(f"{100.0 * misplaced:.1f} %", float(misplaced)),
            Cell(f"{peak:.2f}°", float(peak)),
        )
        for theta, phi, measured, found, misplaced, peak in zip(
            held.theta_deg, held.phi_deg, held.measured, held.found, held.misplaced, held.peak_deg, strict=True
        )
    )
    heads = ("Light from θ, φ", "Measured", "Foretold", "Difference", "Light misplaced", "Peak off by")
    return Table("Direct-hemispherical values of incident directions, each foretold by the others", heads, rows)


def _pictures(component: Component, made: Fit, measurement: Measurement) -> Iterator[Figure]:
    from clerestory.plot.measured import beside_figure
    from clerestory.plot.style import render

    scans = [s for s in measurement.of(component.side, component.scatter) if component.band in s.channels and len(s)]
    directions = sorted({(s.incident_theta_deg, s.incident_phi_deg) for s in scans})
    places = np.unique(np.linspace(0, len(directions) - 1, _SHOWN).round().astype(int))
    for theta, phi in (directions[k] for k in places):
        figure = beside_figure(
            scans,
            made.bsdf,
            incident=(theta, phi),
            side=component.side,
            scatter=component.scatter,
            channel=component.band,
        )
        where = f"light from θ {theta:g}°, φ {phi:g}°"
        yield Figure(
            f"Measured points and the model, {where}", f"Falsecolour and cut, {where}", render(figure, ".png", dpi=110)
        )
