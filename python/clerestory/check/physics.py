"""What no real sample can do: give back more light than it gets, less than none, or break reciprocity."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory.check.tables import Table, neighbours, reciprocal
from clerestory.directions import SIDES
from clerestory.finding import Finding, Severity
from clerestory.words import percent

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.metadata import Metadata

    Tables = Mapping[tuple[Side, Scatter], Table]

ENERGY_WARNING = 0.01
ENERGY_ERROR = 0.05
"""Share by which the light that leaves may exceed what arrived."""
RECIPROCITY_NOTE = 0.03
RECIPROCITY_WARNING = 0.10
"""Relative difference Σ|f − f_reversed|ΛΛ / ΣfΛΛ; the noise of a careful simulation stays below the first."""
HEMISPHERICAL = 0.02
"""Relative difference of T_hh from both sides, which reciprocity makes equal."""
NEGATIVE = 0.01
"""Share of the light that negative values take away before they are more than noise."""
OUTLIER = 0.25
"""Relative difference from its neighbours at which a single incident patch stands out."""
EMPTY_AREA = 0.15
"""Share of the incident hemisphere up to which connected patches without light count as a gap in the data."""
LIT = 0.005
"""Value above which the neighbours of a gap count as lit."""


def energy(tables: Tables) -> Iterator[Finding]:
    """T + R of every incident patch is at most 1."""
    for side in SIDES:
        parts = [table for (s, _), table in tables.items() if s == side]
        if not parts or any(t.incident != parts[0].incident for t in parts):
            continue
        sums = np.sum([t.totals for t in parts], axis=0)
        worst = int(np.argmax(sums))
        excess = float(sums[worst]) - 1.0
        if excess <= ENERGY_WARNING:
            continue
        first = parts[0]
        shares = " and ".join(
            f"{percent(float(t.totals[worst]))} {'passes' if t.scatter == 'transmission' else 'is reflected'}"
            for t in parts
        )
        yield Finding(
            "error" if excess > ENERGY_ERROR else "warning",
            "energy",
            f"{first.band}, light from the {side}",
            f"more light leaves than arrives in {int(np.sum(sums > 1.0 + ENERGY_WARNING))} of {len(sums)} incident "
            f"patches; worst for {first.at(worst)}: {shares}",
            "check the calibration and the unit; scale the data to measured hemispherical values if you have them",
        )


def reciprocity(tables: Tables) -> Iterator[Finding]:
    """Reversed paths carry the same: T from one side against T from the other, R against itself."""
    front, back = tables.get(("exterior", "transmission")), tables.get(("interior", "transmission"))
    if front is not None and back is not None:
        yield from _equal_halves(front, back)
        turned = reciprocal(back)
        if turned is not None and turned.incident == front.incident and turned.outgoing == front.outgoing:
            yield from _sides_fit(front, back, front.difference(turned.values))
    for side in SIDES:
        table = tables.get((side, "reflection"))
        turned = None if table is None else reciprocal(table)
        if table is None or turned is None or not table.square:
            continue
        score = table.difference(turned.values)
        if score > RECIPROCITY_NOTE and table.hemispherical > LIT:
            yield Finding(
                "warning" if score > RECIPROCITY_WARNING else "note",
                "reciprocity",
                table.where,
                f"reversed paths differ by {percent(score)}",
                _MADE_UP,
            )


def _equal_halves(front: Table, back: Table) -> Iterator[Finding]:
    a, b = front.hemispherical, back.hemispherical
    difference = abs(a - b) / max(a, b) if max(a, b) > 0.0 else 0.0
    if difference > HEMISPHERICAL and max(a, b) > LIT:
        yield Finding(
            "warning",
            "sides",
            f"{front.band}, transmission",
            f"{percent(a)} of diffuse light passes from the exterior but {percent(b)} from the interior; "
            "reciprocity makes them equal",
            "one of the two is faulty or of another sample: trust the one that was measured, and leave the other out",
        )


def _sides_fit(front: Table, back: Table, score: float) -> Iterator[Finding]:
    if score <= RECIPROCITY_NOTE or max(front.hemispherical, back.hemispherical) <= LIT:
        return
    where = f"{front.band}, transmission"
    severity: Severity = "warning" if score > RECIPROCITY_WARNING else "note"
    if np.allclose(front.values, back.values, rtol=1e-6, atol=1e-9):
        text = (
            f"the data from the interior are a copy of the exterior's, though reversed paths differ by {percent(score)}"
        )
        yield Finding(severity, "copy", where, text, "leave the copy out: reciprocity gives the other side")
        return
    for words, values in _other_conventions(back) if score > RECIPROCITY_WARNING else ():
        turned = reciprocal(replace(back, values=values))
        other = np.inf if turned is None else front.difference(turned.values)
        if other < 0.25 * score and other < RECIPROCITY_WARNING:
            yield Finding(
                "warning",
                "convention",
                where,
                f"the two sides differ by {percent(score)} on reversed paths, but by {percent(other)} with those "
                f"from the interior {words}",
                "one side's directions are counted differently: find out which by a direction that you know, such as "
                "the sun from above",
            )
            return
    text = f"reversed paths differ by {percent(score)} between the sides"
    yield Finding(severity, "reciprocity", where, text, _MADE_UP)


_MADE_UP = "common where a fabric is modelled from few measurements; otherwise ask how the data were made"


def _other_conventions(table: Table) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """The table as another way of counting directions would give it."""
    if not table.square:
        return
    for words, move in MOVES.items():
        order = permutation(table, move)
        if order is not None:
            yield words, table.values[np.ix_(order, order)]
    yield "transposed", table.values.T


MOVES = {
    "mirrored left to right": np.diag([-1.0, 1.0, 1.0]),
    "mirrored up to down": np.diag([1.0, -1.0, 1.0]),
    "turned by 180°": np.diag([-1.0, -1.0, 1.0]),
}


def permutation(table: Table, move: NDArray[np.float64]) -> NDArray[np.int64] | None:
    """The order into which a symmetry of the plane brings the patches; None if it does not map them on each other."""
    centres = table.incident.outgoing_centres("interior")
    order = table.incident.index_of_outgoing(centres @ move.T)
    return order if len(np.unique(order)) == len(order) else None


def negative(tables: Tables) -> Iterator[Finding]:
    """Values below 0."""
    for table in tables.values():
        count = int(np.sum(table.values < 0.0))
        if count == 0:
            continue
        verb = "is negative; it" if count == 1 else "are negative; together they"
        light = float(np.sum(table.positive * table.weights))
        share = float(np.sum((table.positive - table.values) * table.weights)) / light if light > 0.0 else 1.0
        yield Finding(
            "warning" if share > NEGATIVE else "note",
            "negative",
            table.where,
            f"{count} of {table.values.size} values {verb} would take {percent(share)} of the light away",
            "negative values count as 0 in all results; subtract the dark signal before the next export",
        )


def empty(tables: Tables) -> Iterator[Finding]:
    """Incident patches without any light among lit ones."""
    for table in tables.values():
        yield from (
            Finding(
                "warning",
                "empty",
                table.where,
                _gap_words(table, gap),
                "these directions were probably not measured: interpolate them, or ask for the complete data",
            )
            for gap in _gaps(table)
        )


def thermal(metadata: Metadata) -> Iterator[Finding]:
    """Emissivity and thermal-infrared transmittance of a side make up at most 1."""
    tir = metadata.tir or 0.0
    for side, value in (("exterior", metadata.emissivity_exterior), ("interior", metadata.emissivity_interior)):
        if value is not None and not 0.0 <= value <= 1.0:
            yield Finding(
                "error", "thermal", f"{side} face", f"an emissivity of {value:g} does not exist", "give one from 0 to 1"
            )
        elif value is not None and value + tir > 1.0 + ENERGY_WARNING:
            yield Finding(
                "error",
                "thermal",
                f"{side} face",
                f"emissivity {value:g} and thermal-infrared transmittance {tir:g} are more than 1 together",
                "correct one of them; with the reflectance they make up 1",
            )


def outliers(tables: Tables) -> Iterator[Finding]:
    """Single incident patches that stand out of neighbours which agree with each other."""
    for table in tables.values():
        near = neighbours(table.incident)
        means = np.array([table.totals[n].mean() for n in near])
        spreads = np.array([np.ptp(table.totals[n]) for n in near])
        apart = np.abs(table.totals - means)
        chosen = (apart > OUTLIER * means) & (spreads < 0.5 * apart) & (means > 0.2 * table.totals.max())
        for patch in np.flatnonzero(chosen & (table.totals > 0.0)):
            if patch == 0 and _is_continued(table):
                continue
            yield Finding(
                "warning",
                "outlier",
                table.where,
                f"{percent(float(table.totals[patch]))} for {table.at(int(patch))}, but {percent(float(means[patch]))} "
                "around it",
                "that measurement or sum is probably faulty: interpolate it, or ask",
            )


def _is_continued(table: Table) -> bool:
    """Whether the patch at the normal goes on as the next rings do: tubes and honeycombs have a tip there."""
    counts = [count for *_, count in table.incident.rings[:3]]
    if len(counts) < 3 or counts[0] != 1:
        return False
    first = float(table.totals[1 : 1 + counts[1]].mean())
    second = float(table.totals[1 + counts[1] : sum(counts)].mean())
    low, high = sorted((first, 2.0 * first - second))
    return (1.0 - OUTLIER) * low <= float(table.totals[0]) <= (1.0 + OUTLIER) * high


def _gap_words(table: Table, gap: list[int]) -> str:
    if len(gap) == 1:
        return f"no light at all for {table.at(gap[0])}, though its neighbours are lit"
    return f"no light at all in {len(gap)} incident patches among lit ones, from {table.at(gap[0])} on"


def _gaps(table: Table) -> list[list[int]]:
    """Connected patches without light that are small and have lit neighbours."""
    dark = table.totals <= 0.0
    if not dark.any() or dark.all():
        return []
    touching = neighbours(table.incident)
    areas = table.incident.projected_solid_angles
    gaps, seen = [], np.zeros(len(dark), dtype=bool)
    for start in np.flatnonzero(dark):
        if seen[start]:
            continue
        gap, edge, queue = [], set(), [int(start)]
        seen[start] = True
        while queue:
            patch = queue.pop()
            gap.append(patch)
            for other in touching[patch]:
                if not dark[other]:
                    edge.add(int(other))
                elif not seen[other]:
                    seen[other] = True
                    queue.append(int(other))
        lit = float(np.median(table.totals[sorted(edge)])) > LIT
        if lit and float(areas[gap].sum()) < EMPTY_AREA * np.pi and _is_abrupt(table, sorted(edge)):
            gaps.append(sorted(gap))
    return gaps


def _is_abrupt(table: Table, edge: list[int]) -> bool:
    """Whether the light does not fade toward the gap, as it does where slats or yarns cut it off."""
    return float(np.median(table.totals[edge])) > 0.5 * float(np.median(table.totals[table.totals > 0.0]))
