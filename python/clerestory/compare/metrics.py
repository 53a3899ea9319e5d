"""Data sets of one system side by side: values, spread, outliers and distances."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError, MissingDataError, __version__
from clerestory.basis import Basis
from clerestory.check import check
from clerestory.compare import stand_ins, summary
from clerestory.compare.inputs import common_band, described, files_twice, load
from clerestory.compare.orientation import find_turns
from clerestory.compare.quantities import figures, klems, theta_words
from clerestory.compare.result import Comparison, Distances, Quantity, Settings, StandIn
from clerestory.compare.statistics import outliers, spread

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.compare.inputs import Sources
    from clerestory.compare.quantities import Figure
    from clerestory.directions import Scatter, Side

PATCHES = (1, 41, 88, 130)
"""Incident patches of the Task 61 report: light from above at 0, 30, 50 and 70° to the normal."""
CONES_DEG = (0.5, 1.5, 5.0)
"""Half angles of the cones of direct-direct values [°]."""
SAMPLES = 64
"""Incident directions a patch."""
FLOORS = {"%": 0.001, "°": 1.0}
"""Least deviation that makes an outlier: 0.1 % of the light, 1°."""


def compare(
    sets: Sources,
    *,
    labels: Sequence[str] | None = None,
    band: str | None = None,
    side: Side = "exterior",
    scatter: Scatter = "transmission",
    patches: Sequence[int] = PATCHES,
    against_models: bool = False,
    progress: Callable[[float], object] | None = None,
) -> Comparison:
    """Compare two to twenty data sets of one system.

    Parameters
    ----------
    sets
        Data sets or names of files, in any mixture of resolutions; a mapping gives them their labels.
    labels
        Names of the data sets, usually of the laboratories; by default those of the files.
    band
        Name of the band; by default visible, or the first that all data sets have.
    side
        Side that the light comes from.
    scatter
        Light that passes or that returns.
    patches
        Incident patches of Klems' full basis, counted from 1.
    against_models
        Also compare with simple models made of the first data set (see `clerestory.compare.stand_ins`).
    progress
        Called with the share that is done, 0 to 1.

    Returns
    -------
    Every number of the report. Values are fractions of the incident light, angles are in degrees.

    Raises
    ------
    ClerestoryError
        Fewer than two or more than twenty data sets, labels that do not go with them, patches that do not exist, or no
        band that all data sets have.
    MissingDataError
        A data set holds neither the component nor the one that reciprocity would take.
    OSError, FileFormatError
        A file cannot be read.

    Examples
    --------
    >>> from clerestory import Bsdf, Model
    >>> from clerestory.compare import compare
    >>> pale, dark = (
    ...     Bsdf.from_models({("exterior", "transmission"): Model.lambertian(t)}) for t in (0.5, 0.4)
    ... )
    >>> result = compare({"pale": pale, "dark": dark})
    >>> round(result.quantity("T_h-h, uniform").spread.range_percent, 1)
    22.2
    """
    tell = progress or _nobody
    chosen = tuple(patches)
    _check_patches(chosen)
    inputs = load(sets, labels)
    data = {label: source.bsdf for label, source in inputs.items()}
    used, notes = common_band(data, band)
    settings = Settings(
        band=used,
        side=side,
        scatter=scatter,
        patches=chosen,
        cones_deg=CONES_DEG,
        samples=SAMPLES,
        ground_reflectance=0.2,
        incident="centres of the 41 patches of Klems quarter, weighted by projected solid angle",
    )
    members = tuple(described(label, source, settings) for label, source in inputs.items())
    notes += [
        f"{member.label} has no {scatter} for light from the {side}: the other side's is taken by reciprocity"
        for member in members
        if member.by_reciprocity
    ]
    tell(0.05)
    reflection = scatter == "transmission" and all(_has(b, settings, "reflection") for b in data.values())
    found = []
    for bsdf in data.values():
        found.append(figures(bsdf, settings, reflection=reflection))
        tell(0.05 + 0.25 * len(found) / len(data))
    quantities = _quantities(tuple(data), found)
    simple = stand_ins.made_of(next(iter(data.values())), next(iter(data)), settings) if against_models else {}
    everything = {**data, **{name: model for name, (model, _) in simple.items()}}
    every = _distances(everything, len(data), settings, lambda share: tell(0.3 + 0.5 * share))
    distances = tuple(_part(d, len(data)) for d in every)
    turns = find_turns(data, quantities[0].values, settings, distances)
    tell(0.9)
    compared = tuple(
        _stand_in(name, words, figures(model, settings, reflection=False), quantities, every[-1], len(data), k)
        for k, (name, (model, words)) in enumerate(simple.items())
    )
    findings = tuple(tuple(check(bsdf, band=used)) for bsdf in data.values())
    tell(1.0)
    notes += files_twice(members) + summary.different_systems(quantities, distances, tuple(data))
    return Comparison(
        version=__version__,
        settings=settings,
        sets=members,
        quantities=quantities,
        distances=distances,
        turns=turns,
        stand_ins=compared,
        findings=findings,
        notes=tuple(notes),
        summary=summary.sentences(tuple(data), settings, quantities, distances, turns),
        data=data,
    )


def _nobody(_share: float) -> None:
    """Nobody wants to know."""


def _check_patches(patches: tuple[int, ...]) -> None:
    count = len(klems())
    wrong = [p for p in patches if not 1 <= p <= count]
    if wrong:
        raise ClerestoryError(f"Klems patch {wrong[0]} does not exist (give numbers from 1 to {count})")
    if not patches or len(set(patches)) != len(patches):
        raise ClerestoryError("the incident patches must be one or more different numbers (such as 1,41,88,130)")


def _has(bsdf: Bsdf, settings: Settings, scatter: Scatter) -> bool:
    try:
        bsdf.model(settings.side, scatter, settings.band)
    except MissingDataError:
        return False
    return True


def _quantities(labels: tuple[str, ...], found: Sequence[Sequence[Figure]]) -> tuple[Quantity, ...]:
    made = []
    for row in zip(*found, strict=True):
        first = row[0]
        values = tuple(f.value for f in row)
        ways = dict.fromkeys(f.words for f in row)
        if len(ways) == 1:
            words = first.words
        else:
            words = "; ".join(
                f"{', '.join(label for label, f in zip(labels, row, strict=True) if f.words == way)}: {way}"
                for way in ways
            )
        resolved = tuple(f.resolved for f in row)
        # What a data set cannot resolve says nothing about the others.
        judged = tuple(v if r else None for v, r in zip(values, resolved, strict=True))
        made.append(
            Quantity(
                key=first.key,
                group=first.group,
                symbol=first.symbol,
                of=first.of,
                patch=first.patch,
                unit=first.unit,
                words=words,
                values=values,
                standard_errors=tuple(f.standard_error for f in row),
                resolved=resolved,
                spread=spread(judged),
                outliers=outliers(labels, judged, FLOORS[first.unit]),
            )
        )
    return tuple(made)


def _distances(
    sets: Mapping[str, Bsdf], own: int, settings: Settings, progress: Callable[[float], object]
) -> tuple[Distances, ...]:
    """At each patch, then the mean over the hemisphere of incident directions; NaN between stand-ins, after `own`."""
    models = [bsdf.model(settings.side, settings.scatter, settings.band)[0]._core for bsdf in sets.values()]
    probes = klems().incident_centres(settings.side)[[p - 1 for p in settings.patches]]
    quarter = Basis.named("klems-quarter")
    everywhere = quarter.incident_centres(settings.side)
    weights = quarter.projected_solid_angles / np.pi
    l1, transport = _core.distances(models, own, np.concatenate([probes, everywhere]), progress)
    angle = np.degrees(transport)
    count = len(probes)
    made = [
        Distances(
            theta_words(patch), patch, _square(len(models), own, l1[:, k]), _square(len(models), own, angle[:, k])
        )
        for k, patch in enumerate(settings.patches)
    ]
    rest = angle[:, count:]
    lit = np.isfinite(rest)
    with_light = np.where(lit.any(axis=1), (lit * weights).sum(axis=1), np.nan)
    mean = np.where(lit, rest * weights, 0.0).sum(axis=1) / with_light
    made.append(
        Distances(
            "all incident directions",
            None,
            _square(len(models), own, l1[:, count:] @ weights),
            _square(len(models), own, mean),
        )
    )
    return tuple(made)


def _square(count: int, own: int, pairs: NDArray[np.float64]) -> tuple[tuple[float, ...], ...]:
    square = np.where(np.eye(count, dtype=bool), 0.0, np.nan)
    rows, columns = np.triu_indices(count, 1)
    rows, columns = rows[rows < own], columns[rows < own]
    square[rows, columns] = square[columns, rows] = pairs
    return tuple(tuple(float(v) for v in row) for row in square)


def _part(distances: Distances, count: int) -> Distances:
    """Without the stand-ins, which come last; NaN as None."""
    return Distances(
        distances.of,
        distances.patch,
        tuple(row[:count] for row in distances.relative_l1[:count]),
        tuple(
            tuple(None if v is None or np.isnan(v) else v for v in row[:count])
            for row in distances.transport_deg[:count]
        ),
    )


def _stand_in(
    name: str,
    words: str,
    own: Sequence[Figure],
    quantities: tuple[Quantity, ...],
    distances: Distances,
    count: int,
    number: int,
) -> StandIn:
    by_key = {figure.key: figure.value for figure in own}
    values = tuple(by_key.get(q.key) for q in quantities)
    errors = tuple(
        tuple(None if value is None or v is None else value - v for v in q.values)
        for value, q in zip(values, quantities, strict=True)
    )
    row = count + number
    return StandIn(
        name,
        words,
        values,
        errors,
        distances.relative_l1[row][:count],
        tuple(None if v is None or np.isnan(v) else v for v in distances.transport_deg[row][:count]),
    )
