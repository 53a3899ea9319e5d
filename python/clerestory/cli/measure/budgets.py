"""Tables of uncertainties, as `clerestory measure fit` shows them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.cli.common import say, table

if TYPE_CHECKING:
    from collections.abc import Mapping

    from clerestory.directions import Scatter, Side
    from clerestory.measure.uncertainty import Budget, Uncertainty


def budgets_of(found: Mapping[tuple[str, Side, Scatter], Uncertainty]) -> dict[str, list[Budget]]:
    """Budgets of each component, by its words."""
    from clerestory.measure.uncertainty.tables import budgets

    return {f"{band}, {scatter} from {side}": budgets(one) for (band, side, scatter), one in found.items()}


def say_budgets(told: Mapping[str, list[Budget]]) -> None:
    """Print one table a component."""
    for where, budgets in told.items():
        causes = list(dict.fromkeys(cause for budget in budgets for cause in budget.of_total))
        rows = [
            [
                f"{b.theta_deg:g}° at azimuth {b.phi_deg:g}°{'' if b.measured else ' (between)'}",
                f"{b.total:.4f}",
                f"{b.interval[0]:.4f} to {b.interval[1]:.4f}",
                *(_percent(b.of_total.get(cause), b.total) for cause in causes),
            ]
            for b in budgets
        ]
        say(table([f"{where}: direct-hemispherical", "value", "95 %", *(f"{cause} [%]" for cause in causes)], rows))


def as_rows(told: Mapping[str, list[Budget]]) -> list[dict[str, object]]:
    """Budgets as JSON shows them; fluxes into patches by their largest uncertainty."""
    return [
        {
            "component": where,
            "theta_deg": b.theta_deg,
            "phi_deg": b.phi_deg,
            "measured": b.measured,
            "value": b.total,
            "standard_uncertainty": b.total_error,
            "interval_95": b.interval,
            "causes": dict(b.of_total),
            "largest_patch": {
                "patch": int(np.argmax(b.flux_errors)) + 1,
                "flux": float(b.fluxes[np.argmax(b.flux_errors)]),
                "standard_uncertainty": float(b.flux_errors.max()),
            },
        }
        for where, budgets in told.items()
        for b in budgets
    ]


def _percent(error: float | None, value: float) -> str:
    return "–" if error is None or value <= 0.0 else f"{100.0 * error / value:.2f}"
