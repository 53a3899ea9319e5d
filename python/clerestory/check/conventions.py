"""What a person or a program may have mixed up: halves, sides, order, unit; and how symmetric the data are."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from clerestory.check.physics import ENERGY_ERROR, ENERGY_WARNING, LIT, permutation
from clerestory.check.tables import neighbours
from clerestory.directions import SIDES
from clerestory.finding import Finding, Severity
from clerestory.words import percent

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from clerestory.check.physics import Tables
    from clerestory.check.tables import Table

ROUGH = 0.05
"""Mean relative jump between neighbouring incident patches above which direct-hemispherical values are not smooth."""
SYMMETRIC = 0.05
"""Relative difference below which data count as symmetric."""
FLUX_TOTAL = 0.035
"""T + R below which a sample is blacker than any real one."""


def halves(tables: Tables) -> Iterator[Finding]:
    """Sides and components that are not there."""
    band = next(iter(tables.values())).band
    sides = {scatter: [s for s in SIDES if (s, scatter) in tables] for scatter in ("transmission", "reflection")}
    if sides["transmission"] == ["interior"]:
        yield Finding(
            "warning",
            "sides",
            f"{band}, transmission",
            "only light from the interior is in the data; light from outdoors is answered by reciprocity",
            "usual for genBSDF with its default; make sure that exterior and interior are not swapped",
        )
    if not sides["transmission"]:
        yield Finding("note", "sides", band, "no transmission in the data", "right for an opaque sample only")
    missing = [side for side in SIDES if side not in sides["reflection"]]
    if missing:
        yield Finding(
            "note",
            "sides",
            f"{band}, reflection",
            f"none from the {' and none from the '.join(missing)}",
            "energy cannot be checked on that side, and layers behind or before it see no light back",
        )


def copies(tables: Tables) -> Iterator[Finding]:
    """Transmission and reflection that are the same numbers."""
    for a, b in combinations(tables.values(), 2):
        if a.scatter == b.scatter or a.values.shape != b.values.shape or a.hemispherical <= LIT:
            continue
        if np.ptp(a.values) > 0.0 and np.allclose(a.values, b.values, rtol=1e-6, atol=1e-9):
            yield Finding(
                "error",
                "copy",
                b.where if b.scatter == "reflection" else a.where,
                f"the values are those of the {(a if b.scatter == 'reflection' else b).scatter} from the "
                f"{(a if b.scatter == 'reflection' else b).side}",
                "a fault of the program that wrote the file: ask for the true data, or leave this part out",
            )


def placeholders(tables: Tables) -> Iterator[Finding]:
    """Blocks of one value."""
    for table in tables.values():
        if table.kind not in ("matrix", "tensor tree") or np.ptp(table.values) > 1e-9 * abs(float(table.values.max())):
            continue
        value = float(table.values.flat[0])
        if value > 0.0:
            yield Finding(
                "warning",
                "placeholder",
                table.where,
                f"all values are {value:.4g}/sr ({percent(table.hemispherical)}, an ideal diffuser)",
                "a placeholder unless the sample is an ideal diffuser",
            )
        else:
            yield Finding("note", "placeholder", table.where, "all values are 0", "right if no light goes there")


def transposed(tables: Tables) -> Iterator[Finding]:
    """Direct-hemispherical values that are smooth and below 1 only if rows and columns change places."""
    for table in tables.values():
        if not (table.own and table.square) or table.hemispherical <= LIT:
            continue
        swapped = np.asarray(table.incident.projected_solid_angles @ table.positive.T)
        near = neighbours(table.incident)
        rough, rough_swapped = _roughness(table.totals, near), _roughness(swapped, near)
        above, above_swapped = float(table.totals.max()), float(swapped.max())
        if above > 1.0 + ENERGY_ERROR and above_swapped <= 1.0 + ENERGY_WARNING and rough > rough_swapped:
            reason = f"up to {percent(above)} of the light leaves, transposed at most {percent(above_swapped)}"
        elif rough > ROUGH and rough > 3.0 * rough_swapped:
            reason = f"totals of neighbouring patches jump by {percent(rough)}, transposed by {percent(rough_swapped)}"
        else:
            continue
        yield Finding(
            "warning",
            "transposed",
            table.where,
            f"rows and columns look exchanged: {reason}",
            "check where the light goes; ask the writer of the file whether its columns are incident patches",
        )


def _roughness(totals: NDArray[np.float64], near: list[NDArray[np.int64]]) -> float:
    means = np.array([totals[n].mean() for n in near])
    return float(np.abs(totals - means).mean() / totals.mean()) if totals.mean() > 0.0 else 0.0


def units(tables: Tables) -> Iterator[Finding]:
    """Values that look like per cent, BSDF times cosine, or flux per patch."""
    own = [table for table in tables.values() if table.own and table.hemispherical > 0.0]
    for table in own:
        if 1.5 < table.hemispherical <= 101.0 and float(np.median(table.totals)) > 1.5:
            yield Finding(
                "error",
                "unit",
                table.where,
                f"{percent(table.hemispherical)} of diffuse light leaves: the values look like per cent",
                "divide them by 100",
            )
        elif _by_ring(table) is not None:
            yield from _shape(table)
    if _looks_like_flux(own):
        table = own[0]
        yield Finding(
            "warning",
            "unit",
            table.band,
            f"less than {percent(FLUX_TOTAL)} of any light leaves, but the plain sums of the values are plausible: "
            "they look like flux per outgoing patch",
            "divide them by the projected solid angle of their outgoing patch",
        )


def _shape(table: Table) -> Iterator[Finding]:
    """Compare the mean by outgoing polar angle with the cosine and with the patches' own size."""
    means = _by_ring(table)
    assert means is not None
    rings = table.outgoing.rings
    cosines = np.cos(np.radians([nominal for _, _, nominal, _ in rings]))
    ratio = means / cosines
    if np.ptp(ratio) / ratio.mean() < 0.1 and np.ptp(means) / means.mean() > 0.3:
        yield Finding(
            "warning",
            "unit",
            table.where,
            "the values fall with the cosine of the outgoing angle: they look like BSDF times cosine",
            "divide them by that cosine; a BSDF has none in it",
        )
        return
    areas = np.array([np.pi * (np.sin(np.radians(b)) ** 2 - np.sin(np.radians(a)) ** 2) / n for a, b, _, n in rings])
    as_is, divided = _bends(means), _bends(means / areas)
    sums = table.positive.sum(axis=0)
    if as_is > 0.03 and divided < 0.2 * as_is and float(sums.max()) <= 1.0 + ENERGY_WARNING:
        yield Finding(
            "warning",
            "unit",
            table.where,
            "the values follow the size of their outgoing patches: they look like flux per patch",
            "divide them by the projected solid angle of their outgoing patch",
        )


def _by_ring(table: Table) -> NDArray[np.float64] | None:
    """Mean of the scattered light by outgoing ring, without the beam and what surrounds it; None if there is little."""
    rings = table.outgoing.rings
    if len(rings) < 4 or not table.square:
        return None
    first, means = 0, []
    floor = np.median(table.positive, axis=1)
    for *_, count in rings:
        means.append(float(floor[first : first + count].mean()))
        first += count
    scattered = np.array(means)
    return scattered if scattered.min() > 0.0 else None


def _bends(means: NDArray[np.float64]) -> float:
    """Mean bend of a curve in logarithmic scale: small for what a sample does, large for a zigzag of patch sizes."""
    return float(np.abs(np.diff(np.log(means), 2)).mean())


def _looks_like_flux(own: list[Table]) -> bool:
    for side in SIDES:
        parts = [t for t in own if t.side == side]
        if {t.scatter for t in parts} != {"transmission", "reflection"} or parts[0].incident != parts[1].incident:
            continue
        totals = parts[0].totals + parts[1].totals
        sums = parts[0].positive.sum(axis=0) + parts[1].positive.sum(axis=0)
        if totals.max() < FLUX_TOTAL and sums.min() > 0.1 and sums.max() <= 1.0 + ENERGY_WARNING:
            return True
    return False


def symmetry(tables: Tables, sample: str = "") -> Iterator[Finding]:
    """How symmetric the transmission is, which a person can compare with the sample, or with its name."""
    table = tables.get(("exterior", "transmission")) or tables.get(("interior", "transmission"))
    if table is None or not table.square or table.hemispherical <= LIT:
        return
    scores = {}
    for words, move in _SYMMETRIES.items():
        order = permutation(table, move)
        if order is not None:
            scores[words] = table.difference(table.values[np.ix_(order, order)])
    if not scores:
        return
    found = [words for words, score in scores.items() if score < SYMMETRIC]
    severity: Severity = "note"
    if len(found) == len(scores):
        text, remedy = (
            "symmetric in every way",
            "right for panes, fabrics and diffusers, not for slats, prisms and films",
        )
        named = next((word for word in _DIRECTED if word in sample.lower()), None)
        if named is not None and table.noise < 0.3:
            severity = "warning"
            text += f", though the sample is called a {named}"
    elif scores["up–down"] < SYMMETRIC and scores["left–right"] > 4.0 * SYMMETRIC:
        text = "symmetric up–down but not left–right, as of vertical slats"
        remedy = "if the sample's slats are horizontal, its data are turned by 90°"
    else:
        text = f"symmetric {' and '.join(found)}" if found else "without symmetry"
        remedy = "compare with the sample"
    figures = ", ".join(f"{words} {percent(score)}" for words, score in scores.items())
    yield Finding(severity, "symmetry", table.where, f"{text}; differences: {figures}", remedy)


_DIRECTED = ("blind", "louvre", "louver", "lamella", "slat", "prism", "venetian")
"""Words in the name of a sample that cannot be symmetric in every way."""

_SYMMETRIES = {
    "left–right": np.diag([-1.0, 1.0, 1.0]),
    "up–down": np.diag([1.0, -1.0, 1.0]),
    "half turn": np.diag([-1.0, -1.0, 1.0]),
    "quarter turn": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
}
