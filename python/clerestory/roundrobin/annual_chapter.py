"""The year in a round robin's report."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.annual.frequencies import DGI_CLASSES, DGP_CLASSES
from clerestory.annual.results import plan_of
from clerestory.plot.carpet import carpets
from clerestory.plot.class_bars import class_bars
from clerestory.plot.floor_plan import floor_plan
from clerestory.plot.occurrence import occurrence
from clerestory.plot.style import render
from clerestory.report import Cell, Figure, Heading, Paragraph, Table
from clerestory.roundrobin import conclusion
from clerestory.roundrobin.recipe import TREATMENTS

if TYPE_CHECKING:
    import matplotlib.figure

    from clerestory.report.document import Block
    from clerestory.roundrobin.run import Found

_DPI = 120
_FLOOR = 4
"""Points from which on a plan of the floor is drawn."""


def of_system(found: Found) -> list[Block]:
    """As section 3.6 of the report."""
    years = found.years_of
    assert years is not None
    said, seed = found.system.said, years.seeds[0]
    cases = [case for case in found.cases if case in found.years]
    weights = years.hours.weights(years.weather)
    blocks: list[Block] = [
        Heading("The year", 3),
        Paragraph(
            f"Room {years.room.name}, view {years.recipe.view}; weather: {years.weather.source}. Daylight autonomy "
            f"counts all hours with the sun above the horizon, values at the eye those from {years.hours.words}. The "
            "direct sun has the resolution of the data set (five phases); no shade is moved."
        ),
    ]
    if len(years.points) >= _FLOOR:
        for threshold in years.recipe.thresholds_lx:
            shares = {str(case): found.annual(case, seed).autonomy[threshold] for case in cases}
            made = floor_plan(
                years.points,
                shares,
                label=f"daylight autonomy, {threshold:g} lx",
                percent=True,
                plan=plan_of(years.room),
            )
            blocks.append(
                _figure(made, said(f"Daylight autonomy at {threshold:g} lx."), "Floor plans of daylight autonomy")
            )
    top = float(max(np.quantile(found.years[case][seed].eye_illuminance[weights > 0.0], 0.99) for case in cases))
    step = float(np.median(years.weather.interval))
    series = {str(case): found.years[case][seed].eye_illuminance for case in cases}
    made = carpets(series, years.weather.times, step, label="$E_v$ [lx]", limits=(0.0, max(top, 1.0)))
    blocks.append(_figure(made, said("Vertical illuminance at the eye."), "Carpets of vertical illuminance"))
    edges = _edges(top)
    for treatment in TREATMENTS:
        own = {c.laboratory: found.years[c][seed].eye_illuminance for c in cases if c.treatment == treatment}
        if own:
            made = occurrence(own, weights, edges=edges)
            blocks.append(
                _figure(
                    made,
                    said(f"{treatment}: how often vertical illuminances occur, {years.hours.words}."),
                    "Histogram and cumulated share of vertical illuminance",
                )
            )
    for classes, name in ((DGP_CLASSES, "dgp_classes"), (DGI_CLASSES, "dgi_classes")):
        shares = {str(case): np.array(getattr(found.annual(case, seed), name)) for case in cases}
        marked = {
            f"{label} *" if case in found.coarse else label: shares[label] for case in cases if (label := str(case))
        }
        made = class_bars(marked, classes.names, ranges=classes.ranges)
        blocks.append(
            _figure(
                made,
                said(f"{classes.index} in classes, {years.hours.words}. *: the data are too coarse for glare."),
                f"Stacked bars of the classes of {classes.index}",
            )
        )
    blocks.append(_table(found))
    return blocks


def _table(found: Found) -> Table:
    rows = []
    names = next(found.annual(case, seed) for case, years in found.years.items() for seed in years).names
    for case, own in found.years.items():
        for seed in own:
            values = found.annual(case, seed).values
            note = found.coarse.get(case, "")
            cells = [
                Cell(conclusion.in_unit(values[key], unit), values[key], note if kind == "glare" else "")
                for key, _, unit, kind in names
            ]
            rows.append((Cell(case.laboratory), Cell(case.treatment), Cell(str(seed)), *cells))
    heads = (
        "laboratory",
        "treatment",
        "seed",
        *(words.removesuffix(", mean of the points") for _, words, _, _ in names),
    )
    caption = found.system.said(
        "What the year comes to; autonomy is the mean of the points. Marked: the data are too "
        "coarse for glare and direct sun."
    )
    return Table(caption, heads, tuple(rows), 3)


def _edges(top: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Round edges of bins from 0 to about `top` [lx], the same for all treatments."""
    rough = max(top, 1.0) / 18.0
    decade = 10.0 ** np.floor(np.log10(rough))
    width = next(m * decade for m in (1.0, 2.0, 2.5, 5.0, 10.0) if m * decade >= rough)
    edges: np.ndarray[tuple[int, ...], np.dtype[np.float64]] = np.arange(int(np.ceil(top / width)) + 2) * width
    return edges


def _figure(made: matplotlib.figure.Figure, caption: str, alt: str) -> Figure:
    return Figure(caption, alt, render(made, ".png", dpi=_DPI))
