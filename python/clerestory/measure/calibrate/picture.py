"""Measured and modelled direct-hemispherical values as a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from clerestory.plot import style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.measure.calibrate.agreement import Agreement, Row


@style.styled
def picture(before: Agreement, after: Agreement | None = None) -> Figure:
    """Curves over the incident angle with their difference below, a column a component.

    A component that was measured at several azimuths is drawn in falsecolour over the incident hemisphere as in figure
    22 of the report of IEA SHC Task 61 (2021, C.2.2): measured, modelled, difference; the source stands where it is
    seen.

    Parameters
    ----------
    before
        The sphere's values beside the model's.
    after
        The same after calibration, which is drawn too.
    """
    keys = list(dict.fromkeys((row.band, row.side, row.scatter) for row in before.rows))
    flat = [key for key in keys if _one_azimuth(before.of(key[1], key[2], key[0]))]
    round_ = [key for key in keys if key not in flat]
    rows = (2 if flat else 0) + len(round_)
    columns = max(len(flat), 3 if round_ else 1)
    figure = Figure(figsize=(3.3 * columns, 2.6 * rows), layout="constrained")
    grid = figure.add_gridspec(rows, columns, height_ratios=[2.0, 1.0][: 2 if flat else 0] + [2.0] * len(round_))
    for column, (band, side, scatter) in enumerate(flat):
        top, low = figure.add_subplot(grid[0, column]), figure.add_subplot(grid[1, column])
        _curves(top, low, before.of(side, scatter, band), () if after is None else after.of(side, scatter, band))
        top.set_title(f"{band}, {scatter} from the {side}")
        if column == 0:
            top.set_ylabel("direct-hemispherical")
            low.set_ylabel("model − sphere")
            top.legend()
    for line, (band, side, scatter) in enumerate(round_, start=2 if flat else 0):
        found = before.of(side, scatter, band)
        values = [[row.measured for row in found], [row.modelled for row in found], [row.difference for row in found]]
        top_value = max(max(values[0]), max(values[1]), 1e-12)
        largest = max(max(abs(v) for v in values[2]), 1e-12)
        for column, (title, shown) in enumerate(zip(("sphere", "model", "model − sphere"), values, strict=True)):
            axes = figure.add_subplot(grid[line, column], projection="polar")
            limits = Normalize(-largest, largest) if column == 2 else Normalize(0.0, top_value)
            marks = axes.scatter(
                np.radians([row.phi_deg for row in found]),
                [row.theta_deg for row in found],
                c=shown,
                cmap="RdBu_r" if column == 2 else "viridis",
                norm=limits,
                s=60,
                edgecolors=style.INK,
                linewidths=0.4,
            )
            axes.set_ylim(0.0, 90.0)
            axes.set_yticks([30.0, 60.0])
            axes.set_title(f"{title}\n{band}, {scatter} from the {side}")
            figure.colorbar(marks, ax=axes, shrink=0.8)
    return figure


def _one_azimuth(rows: Sequence[Row]) -> bool:
    return len({round(row.phi_deg % 360.0, 1) for row in rows if row.theta_deg > 0.5}) <= 1


def _curves(top: object, low: object, before: Sequence[Row], after: Sequence[Row]) -> None:
    from matplotlib.axes import Axes

    assert isinstance(top, Axes)
    assert isinstance(low, Axes)
    ordered = sorted(before, key=lambda row: row.theta_deg)
    theta = [row.theta_deg for row in ordered]
    errors = [row.standard_error or 0.0 for row in ordered]
    top.errorbar(theta, [r.measured for r in ordered], yerr=errors, fmt="o", color=style.INK, label="sphere")
    for label, rows, colour in (("model", ordered, style.COLOURS[0]), ("calibrated", after, style.COLOURS[1])):
        line = sorted(rows, key=lambda row: row.theta_deg)
        if not line:
            continue
        top.plot([r.theta_deg for r in line], [r.modelled for r in line], color=colour, label=label)
        low.plot([r.theta_deg for r in line], [r.difference for r in line], color=colour)
    low.axhline(0.0, color=style.INK, linewidth=0.7)
    low.set_xlabel("incident angle [°]")
    top.set_ylim(0.0, 1.08 * max(top.get_ylim()[1], 1e-12))
    for axes in (top, low):
        axes.set_xlim(0.0, 90.0)
        axes.set_xticks([0.0, 30.0, 60.0, 90.0])
