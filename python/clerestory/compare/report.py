"""The report of a comparison: one HTML file that holds its pictures and opens anywhere.

It fetches nothing and holds no date but one that is given, so that the same data make the same bytes. Whatever comes
from files or labels is escaped by the template engine.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

from markupsafe import Markup, escape

from clerestory.compare.statistics import LEAST, LIMIT, RELATIVE_FLOOR
from clerestory.compare.summary import in_unit
from clerestory.plot import hemisphere_grid, slices, transmittance_bars
from clerestory.report.frame import environment, png, symbol
from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterable, Sequence

    from matplotlib.figure import Figure

    from clerestory.compare.result import Comparison, Quantity, Spread

GROUPS = ("hemispherical", "direct-hemispherical", "direct-direct")
"""Groups of the main table and of the bars."""
_DPI = 150


@dataclass(frozen=True)
class Cell:
    """A cell of a table."""

    text: str
    mark: str = ""
    """Classes: `outlier`, `unresolved`."""
    note: str = ""
    """What the mark means, as a tooltip."""
    shade: float | None = None
    """Depth of colour of a heat map, 0 to 1."""


@dataclass(frozen=True)
class Table:
    """Rows of data sets and columns of values."""

    groups: tuple[tuple[Markup, int], ...]
    """Heads over several columns, and how many."""
    heads: tuple[Markup, ...]
    rows: tuple[tuple[str, tuple[Cell, ...]], ...]
    feet: tuple[tuple[str, tuple[str, ...]], ...] = ()


def write_report(
    comparison: Comparison,
    path: str | os.PathLike[str],
    *,
    title: str = "Comparison of BSDF data sets",
    command: str | None = None,
    date: str | None = None,
    progress: Callable[[float], object] | None = None,
) -> None:
    """Write the report of a comparison, whole or not at all.

    Parameters
    ----------
    comparison
        What `clerestory.compare.compare` gave.
    path
        The HTML file.
    title
        Head of the report.
    command
        Command line that made it, for the reader who wants to repeat it.
    date
        Date to print; none by default, so that the same data make the same file.
    progress
        Called with the share that is done, 0 to 1.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    text = html(comparison, title=title, command=command, date=date, progress=progress)
    write_whole(path, text.encode("utf-8"))


def html(
    comparison: Comparison,
    *,
    title: str = "Comparison of BSDF data sets",
    command: str | None = None,
    date: str | None = None,
    progress: Callable[[float], object] | None = None,
) -> str:
    """The report as text; see `write_report`."""
    made = environment("clerestory.compare")
    made.filters["value"] = in_unit
    return made.get_template("report.html.j2").render(
        c=comparison,
        version=comparison.version,
        title=title,
        command=command,
        date=date,
        letter="T" if comparison.settings.scatter == "transmission" else "R",
        what="transmittance" if comparison.settings.scatter == "transmission" else "reflectance",
        pictures=_pictures(comparison, progress or (lambda _: None)),
        main=_table(comparison, [q for g in GROUPS for q in comparison.of_group(g)]),
        cones=_table(comparison, comparison.of_group("cone")),
        cut_offs=_table(comparison, comparison.of_group("cut-off")),
        reflection=_table(comparison, comparison.of_group("reflection")),
        outliers=[(q, o) for q in comparison.quantities for o in q.outliers if o.score is not None],
        heat=_heat(comparison),
        stand_ins=_stand_ins(comparison),
        treatments=_treatments(comparison.quantities),
        limit=LIMIT,
        least=LEAST,
        floor_percent=100.0 * RELATIVE_FLOOR,
    )


def _pictures(comparison: Comparison, tell: Callable[[float], object]) -> dict[str, str]:
    settings, data = comparison.settings, comparison.data
    common = {"side": settings.side, "scatter": settings.scatter, "band": settings.band}
    made = {"bars": png(bars(comparison), _DPI)}
    tell(0.2)
    grid = hemisphere_grid(data, settings.patches, **common, samples=settings.samples)  # type: ignore[arg-type]
    made["hemispheres"] = png(grid, _DPI)
    tell(0.6)
    made["slices"] = png(slices(data, settings.patches, **common), _DPI)  # type: ignore[arg-type]
    tell(1.0)
    return made


def bars(comparison: Comparison) -> Figure:
    """Hemispherical, direct-hemispherical and direct-direct values of all data sets."""
    wanted = [q for g in GROUPS for q in comparison.of_group(g) if g != "hemispherical" or q.of == "uniform"]
    names = {q.key: q.symbol if q.patch is None else f"{q.symbol}\n{q.of.split(' (')[0]}" for q in wanted}
    if len(set(names.values())) < len(names):
        # Two patches of one polar angle: the numbers tell them apart.
        names = {q.key: q.symbol if q.patch is None else f"{q.symbol}\nKlems {q.patch}" for q in wanted}
    values = {
        label: {names[q.key]: float("nan") if (v := q.values[k]) is None else v for q in wanted}
        for k, label in enumerate(comparison.labels)
    }
    what = "transmittance" if comparison.settings.scatter == "transmission" else "reflectance"
    return transmittance_bars(values, ylabel=f"{comparison.settings.band} {what}")


def _groups(quantities: Sequence[Quantity]) -> tuple[tuple[Markup, int], ...]:
    """Heads that neighbours share: the symbol, or for cones the incident patch."""
    names = [_incidence(q.of.split(", ")[1]) if q.group == "cone" else symbol(q.symbol) for q in quantities]
    return tuple((name, len(list(members))) for name, members in groupby(names))


def _head(quantity: Quantity) -> Markup:
    if quantity.group == "cone":
        return Markup(escape(quantity.of.split(", ")[0].removeprefix("within ")))
    return _incidence(quantity.of)


def _incidence(words: str) -> Markup:
    """`30° (Klems 41)` in two lines."""
    angle, _, patch = words.partition(" (")
    return Markup("{}<br><small>{}</small>").format(angle, patch.rstrip(")")) if patch else Markup(escape(words))


def _table(comparison: Comparison, quantities: Sequence[Quantity]) -> Table | None:
    if not quantities:
        return None
    rows = tuple((label, tuple(_cell(q, k, label) for q in quantities)) for k, label in enumerate(comparison.labels))
    spreads = [(_several(q), q.unit) for q in quantities]
    fields = ("mean", "minimum", "maximum", "standard_deviation")
    feet = [
        (field.replace("_", " "), tuple(_number(getattr(s, field, None), unit) for s, unit in spreads))
        for field in fields
    ]
    ranges = [None if s is None else s.range_percent for s, _ in spreads]
    feet.append(("range over mean [%]", tuple("–" if r is None else f"{r:.3g}" for r in ranges)))
    return Table(_groups(quantities), tuple(_head(q) for q in quantities), rows, tuple(feet))


def _several(quantity: Quantity) -> Spread | None:
    """The spread, if it is one of more than one value."""
    return quantity.spread if quantity.spread is not None and quantity.spread.count > 1 else None


def _number(value: float | None, unit: str) -> str:
    """A value without its unit, which stands in the caption."""
    return in_unit(value, unit).removesuffix(" %").removesuffix("°")


def _cell(quantity: Quantity, k: int, label: str) -> Cell:
    value = quantity.values[k]
    if value is None:
        note = "not cut off below 90°" if quantity.group == "cut-off" else "no data"
        return Cell("–", "missing", note)
    text = _number(value, quantity.unit)
    error = quantity.standard_errors[k]
    if error is not None:
        text += f" ± {_number(error, quantity.unit)}"
    if not quantity.resolved[k]:
        return Cell(text, "unresolved", "narrower than the data resolve; not part of the spread")
    for outlier in quantity.outliers:
        if outlier.label == label:
            score = "furthest from the median" if outlier.score is None else f"modified z-score {outlier.score:.1f}"
            return Cell(text, "outlier" if outlier.score is not None else "furthest", score)
    return Cell(text)


def _heat(comparison: Comparison) -> list[tuple[str, Table, Table]]:
    """Tables of both distances, the mean first."""
    ordered = [comparison.distances[-1], *comparison.distances[:-1]]
    top_angle = max((v for d in ordered for row in d.transport_deg for v in row if v is not None), default=0.0)
    heads = tuple(Markup(k + 1) for k in range(len(comparison.labels)))

    def table(matrix: Iterable[Iterable[float | None]], top: float, digits: int) -> Table:
        rows = []
        for i, (label, row) in enumerate(zip(comparison.labels, matrix, strict=True)):
            cells = []
            for j, v in enumerate(row):
                if i == j:
                    cells.append(Cell("", "self"))
                elif v is None:
                    cells.append(Cell("–", "missing", "a data set is dark"))
                else:
                    cells.append(Cell(f"{v:.{digits}f}", shade=v / top if top > 0.0 else 0.0))
            rows.append((f"{i + 1}\u2002{label}", tuple(cells)))
        return Table((), heads, tuple(rows))

    return [(d.of, table(d.transport_deg, top_angle, 1), table(d.relative_l1, 2.0, 2)) for d in ordered]


def _stand_ins(comparison: Comparison) -> list[tuple[str, str, Table]]:
    """Errors of each stand-in against each data set."""
    chosen = [
        k
        for k, q in enumerate(comparison.quantities)
        if q.group in GROUPS and not (q.group == "hemispherical" and q.of != "uniform")
    ]
    chosen.sort(key=lambda k: GROUPS.index(comparison.quantities[k].group))
    members = [comparison.quantities[k] for k in chosen]
    heads = (*(_head(q) for q in members), Markup("L1"), Markup("transport"))
    groups = (*_groups(members), (Markup("distance"), 2))
    made = []
    for stand_in in comparison.stand_ins:
        own = tuple(Cell(_number(stand_in.values[k], comparison.quantities[k].unit)) for k in chosen)
        rows = [("its own value", (*own, Cell(""), Cell("")))]
        for n, label in enumerate(comparison.labels):
            cells = [Cell(_signed(stand_in.errors[k][n])) for k in chosen]
            angle = stand_in.transport_deg[n]
            cells += [Cell(f"{stand_in.relative_l1[n]:.2f}"), Cell("–" if angle is None else f"{angle:.1f}°")]
            rows.append((f"error against {label}", tuple(cells)))
        made.append((stand_in.name, stand_in.words, Table(groups, heads, tuple(rows))))
    return made


def _signed(error: float | None) -> str:
    """A difference of fractions in points of per cent."""
    if error is None:
        return "–"
    return f"{100.0 * error:+.2f}".replace("-", "−")


def _treatments(quantities: Iterable[Quantity]) -> list[tuple[Markup, str]]:
    """How the values of each symbol were made; once for all patches that share it."""
    made: dict[tuple[str, str], None] = {}
    for quantity in quantities:
        made.setdefault((quantity.symbol, quantity.words))
    return [(symbol(name), words) for name, words in made]
