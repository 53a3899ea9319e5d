"""The result of a comparison in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from clerestory.compare.result import Distances, Quantity, Settings, Turn

_NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")
AGREE_PERCENT = 10.0
"""A range [%] above this is called a difference."""
DIFFERENT_RATIO = 2.0
"""Hemispherical values that differ by more than this are hardly of one system."""
DIFFERENT_LEAST = 0.02
"""Nor are they compared below this value."""
DIFFERENT_DEG = 20.0
"""Distributions that lie further apart than this [°] are hardly of one system."""


def percent(value: float, digits: int = 3) -> str:
    """A fraction in per cent: `47.8 %`, `0.94 %`."""
    shown = 100.0 * value
    if shown == 0.0:
        return "0 %"
    places = max(0, digits - 1 - int(np.floor(np.log10(abs(shown)))))
    return f"{shown:.{min(places, 4)}f} %"


def plain_percent(value: float) -> str:
    """A percentage with two digits or so."""
    return f"{value:.0f}" if value >= 10.0 else f"{value:.2g}"


def in_unit(value: float | None, unit: str) -> str:
    """A value as it is shown."""
    if value is None:
        return "–"
    return percent(value) if unit == "%" else f"{value:.3g}°"


def listed(names: Sequence[str]) -> str:
    """A, B and C."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def sentences(
    labels: tuple[str, ...],
    settings: Settings,
    quantities: Sequence[Quantity],
    distances: Sequence[Distances],
    turns: Sequence[Turn],
) -> tuple[str, ...]:
    """The result in a few sentences."""
    count = _NUMBERS[len(labels)] if len(labels) < len(_NUMBERS) else str(len(labels))
    made = [_agreement(count, settings, quantities[0])]
    made += _widest(quantities)
    made += _outliers(labels, quantities)
    made += _farthest(labels, distances[-1])
    made += [
        f"{t.label} would agree better with {t.reference} if it were {t.words}: their light lies {t.before_deg:.1f}° "
        f"apart as it is and {t.after_deg:.1f}° after that. Check the sample's mounting and the file's sides."
        for t in turns
    ]
    return tuple(made)


def _agreement(count: str, settings: Settings, first: Quantity) -> str:
    s = first.spread
    assert s is not None
    what = "transmittance" if settings.scatter == "transmission" else "reflectance"
    head = f"The {count} data sets ({settings.band}, light from the {settings.side})"
    if s.range_percent is None:
        return f"{head} are all dark: no light is left to compare."
    verb = "agree within" if s.range_percent <= AGREE_PERCENT else "differ by"
    return (
        f"{head} {verb} {plain_percent(s.range_percent)} % of their mean in hemispherical {what} {first.symbol}: "
        f"{percent(s.minimum)} to {percent(s.maximum)}."
    )


def _widest(quantities: Iterable[Quantity]) -> list[str]:
    groups = {"direct-hemispherical": "direct-hemispherical", "direct-direct": "direct-direct"}
    made = []
    for group, name in groups.items():
        own = [q for q in quantities if q.group == group and q.spread and q.spread.range_percent is not None]
        if not own:
            continue
        widest = max(own, key=lambda q: (q.spread.maximum - q.spread.minimum) if q.spread else 0.0)
        s = widest.spread
        assert s is not None
        made.append(
            f"In {name} {widest.symbol} they differ most at {widest.of}: {percent(s.minimum)} to {percent(s.maximum)}."
        )
    return made


def _outliers(labels: tuple[str, ...], quantities: Iterable[Quantity]) -> list[str]:
    shown = [q for q in quantities if q.group != "cone"]
    made = []
    for label in labels:
        own = [(q, o) for q in shown for o in q.outliers if o.label == label]
        real = [(q, o) for q, o in own if o.score is not None]
        if not real:
            continue
        parts = [
            f"{q.symbol}, {q.of} ({in_unit(o.value, q.unit)}, median {in_unit(q.spread.median, q.unit)})"
            for q, o in real[:4]
            if q.spread is not None
        ]
        more = f" and {len(real) - 4} more" if len(real) > 4 else ""
        made.append(f"{label} stands apart in {'; '.join(parts)}{more}.")
    if len(labels) >= 4 and not made:
        made.append("No data set stands apart in any of the values.")
    return made


def _farthest(labels: tuple[str, ...], mean: Distances) -> list[str]:
    pairs = [
        (angle, labels[a], labels[b])
        for a, row in enumerate(mean.transport_deg)
        for b, angle in enumerate(row)
        if b > a and angle is not None
    ]
    if not pairs:
        return []
    near, far = min(pairs), max(pairs)
    if len(pairs) == 1:
        return [
            f"To make the outgoing light of {near[1]} from that of {near[2]}, it would have to be turned by "
            f"{near[0]:.2g}° on average (transport distance, mean over all incident directions)."
        ]
    return [
        f"The outgoing light of {near[1]} and {near[2]} lies closest, {near[0]:.2g}° apart on average; that of "
        f"{far[1]} and {far[2]} furthest, {far[0]:.2g}° (transport distance, mean over all incident directions)."
    ]


def different_systems(
    quantities: Sequence[Quantity], distances: Sequence[Distances], labels: tuple[str, ...]
) -> list[str]:
    """Notes on data sets that are hardly of one system."""
    notes = []
    s = quantities[0].spread
    if s is not None and s.maximum > DIFFERENT_LEAST and s.maximum > DIFFERENT_RATIO * s.minimum:
        values = quantities[0].values
        known = [(v, label) for v, label in zip(values, labels, strict=True) if v is not None]
        (low, dark), (high, bright) = min(known), max(known)
        notes.append(
            f"{dark} and {bright} are hardly of one system, or not of the same state: {quantities[0].symbol} is "
            f"{percent(low)} and {percent(high)}"
        )
    square = np.array([[np.nan if v is None else v for v in row] for row in distances[-1].transport_deg])
    others = len(labels) - 1
    mean = np.nansum(square, axis=1) / others
    apart = [k for k in range(len(labels)) if mean[k] > DIFFERENT_DEG]
    if 2 * len(apart) > len(labels):
        # Most are far from the rest, so none is the odd one out.
        notes.append(
            f"{listed(labels)} are hardly of one system, or some are turned: their light lies "
            f"{np.mean(mean):.0f}° apart on average"
        )
    else:
        notes += [
            f"{labels[k]} and the others are hardly of one system, or it is turned: their light lies "
            f"{mean[k]:.0f}° apart on average"
            for k in apart
        ]
    return notes
