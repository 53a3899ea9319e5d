"""The report of a comparison of photographs with renderings: one HTML file that holds its pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory import _core
from clerestory.counts import counted
from clerestory.files import named
from clerestory.photo.cases import read_picture
from clerestory.photo.comparison_figure import pair, scatter, words_of
from clerestory.plot.style import figures
from clerestory.report.frame import environment, png
from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from matplotlib.figure import Figure

    from clerestory.photo.agreement import Agreement, PhotoComparison
    from clerestory.photo.cases import Found

MOST_PAIRS = 6
"""Pictures of cases in a report."""
_DPI = 110


def summary(c: PhotoComparison) -> list[str]:
    """What the comparison says, in sentences."""
    lines = []
    if c.check is not None:
        lines.append(
            f"E_v of {counted(c.check.count, 'photograph')} beside the meter: bias {c.check.bias:+.0f} lx, RMSE "
            f"{c.check.rmse:.0f} lx"
        )
        if c.check.rejected:
            names = ", ".join(f"{name} ({off:+.0f} %)" for name, off in c.check.rejected)
            lines.append(f"left out, beyond {c.check.limit_percent:g} % of the measured E_v: {names}")
    for a in c.agreements:
        unit = "" if a.quantity in ("dgp", "dgi") else " lx" if a.quantity == "illuminance" else " cd/m²"
        text = f"{words_of(a.quantity).split(' [')[0]} of {counted(a.count, 'case')}: "
        if a.correlation is not None:
            text += f"R² {a.correlation:.3f}, "
        if a.determination is not None:
            text += f"about 1:1 {_number(a.determination)}, "
        text += f"bias {_signed(a.bias)}{unit}, RMSE {figures(a.rmse)}{unit}"
        if a.outliers:
            text += f"; apart stand {', '.join(o.label for o in a.outliers)}"
        lines.append(text)
    return lines


def _signed(value: float) -> str:
    return ("−" if value < 0.0 else "+") + figures(abs(value))


def write_comparison(
    c: PhotoComparison,
    path: str | os.PathLike[str],
    *,
    title: str = "Photographs and renderings",
    command: str | None = None,
    date: str | None = None,
    progress: Callable[[float], object] | None = None,
) -> None:
    """Write the report of a comparison, whole or not at all.

    Parameters
    ----------
    c
        What `compare_cases` gave.
    path
        The HTML file.
    title
        Head of the report.
    command
        Command line that made it.
    date
        Date to print; none by default, so that the same data make the same file.
    progress
        Called with the share that is done, 0 to 1.
    """
    pictured = sorted((f for f in c.found if f.case.photo is not None), key=_apart, reverse=True)
    pairs = []
    for number, found in enumerate(pictured[:MOST_PAIRS]):
        pairs.append((found.case.name, png(pair_of(found), _DPI), _pair_words(found)))
        if progress is not None:
            progress((number + 1) / min(len(pictured), MOST_PAIRS))
    quantities = [a.quantity for a in c.agreements]
    rejected = {name for name, _ in c.check.rejected} if c.check is not None else set()
    text = (
        environment("clerestory.photo")
        .get_template("comparison.html.j2")
        .render(
            c=c,
            title=title,
            command=command,
            date=date,
            version=_core.__version__,
            summary=summary(c),
            agreements=[_row(a) for a in c.agreements],
            scatter=png(scatter(c.agreements), _DPI),
            names=", ".join(words_of(q) for q in quantities),
            pairs=pairs,
            left_out=len(pictured) > MOST_PAIRS,
            columns=[*(["E_v measured [lx]"] if c.check is not None else []), *(words_of(q) for q in quantities)],
            rows=[_case(f, quantities, f.case.name in rejected, with_meter=c.check is not None) for f in c.found],
        )
    )
    write_whole(path, text.encode("utf-8"))


def pair_of(found: Found) -> Figure:
    """The pictures of a case side by side."""
    photo, rendering = found.case.photo, found.case.rendering
    if photo is None or rendering is None:
        raise _core.MissingDataError(f"the case {found.case.name} has values only (give its pictures)")
    first, second = read_picture(photo), read_picture(rendering)
    with named(rendering):
        return pair(first, second)


def _apart(found: Found) -> float:
    photo, rendering = found.values["dgp"]
    return abs(rendering - photo)


def _pair_words(found: Found) -> str:
    return "; ".join(
        f"{words_of(name).split(' [')[0]} {figures(a, 4)} | {figures(b, 4)}"
        for name, (a, b) in found.values.items()
        if not name.startswith("luminance")
    )


def _number(value: float | None, text: str = "{:.3f}") -> str:
    return "–" if value is None else text.format(value).replace("-", "−")


def _row(a: Agreement) -> list[str]:
    return [
        words_of(a.quantity),
        str(a.count),
        _number(a.correlation),
        _number(a.determination),
        _number(a.slope),
        "–" if a.intercept is None else figures(a.intercept).replace("-", "−"),
        figures(a.mean),
        _signed(a.bias),
        figures(a.rmse),
        ", ".join(o.label for o in a.outliers) or "–",
    ]


def _case(found: Found, quantities: list[str], marked: bool, *, with_meter: bool) -> tuple[str, bool, list[str]]:  # noqa: FBT001 (one row)
    cells = []
    if with_meter:
        off = found.difference_percent
        cells.append("–" if found.case.measured is None or off is None else f"{found.case.measured:.0f} ({off:+.0f} %)")
    for name in quantities:
        cells.append(" | ".join(figures(v) for v in found.values[name]) if name in found.values else "–")
    return found.case.name, marked, cells
