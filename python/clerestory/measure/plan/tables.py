"""A plan as files: incident directions and paths as CSV, all of it as JSON."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from clerestory.measure.plan.make import Plan, PlannedPath

NAMES = ("plan.json", "incident.csv", "paths.csv")


def as_json(plan: Plan) -> dict[str, Any]:
    """A plan for machines; paths by their number of points."""
    extent = plan.extent
    return {
        "job": plan.job.model_dump(mode="json"),
        "instrument": plan.instrument.model_dump(mode="json"),
        "way": plan.route.way,
        "why": plan.route.why,
        "positions": plan.route.positions,
        "holder": extent.holder,
        "spot_mm": extent.spot_mm,
        "periods_in_spot": None if math.isinf(extent.periods) else extent.periods,
        "covers_four_periods": extent.covers,
        "largest_theta_deg": extent.largest_theta_deg,
        "limited_by": extent.limited_by,
        "incident": [
            {"number": n, "side": side, "theta_deg": theta, "phi_deg": phi}
            for n, (side, theta, phi) in enumerate(plan.incident, start=1)
        ],
        "paths": [
            {
                "incidence": p.incidence,
                "scatter": p.scatter,
                "kind": p.path.kind,
                "points": len(p.path),
                "step_deg": p.path.step_deg,
            }
            for p in plan.paths
        ],
        "hours": plan.hours,
        "advice": list(plan.advice),
    }


def incident_csv(plan: Plan) -> str:
    """Number, side, polar angle, azimuth and length of the spot of each incident direction."""
    rows = [
        (n, side, f"{theta:g}", f"{phi:g}", f"{plan.extent.lit_mm(theta):.1f}")
        for n, (side, theta, phi) in enumerate(plan.incident, start=1)
    ]
    return _table(("number", "incident_side", "theta_deg", "phi_deg", "lit_width_mm"), rows)


def paths_csv(paths: tuple[PlannedPath, ...]) -> str:
    """Every point of every path in order; paths that are for all incident directions have no number."""
    rows = []
    for n, planned in enumerate(paths, start=1):
        path = planned.path
        number = "" if planned.incidence is None else planned.incidence
        for theta, phi in zip(path.theta_deg.tolist(), path.phi_deg.tolist(), strict=True):
            rows.append((n, number, path.kind, planned.scatter, path.side, f"{theta:.4f}", f"{phi:.4f}"))
    return _table(("path", "incidence", "kind", "scatter", "outgoing_side", "theta_deg", "phi_deg"), rows)


def write_plan(plan: Plan, folder: str | os.PathLike[str]) -> list[Path]:
    """Write `NAMES` into a folder, which is made if it does not exist; `paths.csv` only for a scanning instrument.

    Raises
    ------
    OSError
        The folder cannot be made, or a file cannot be written.
    """
    folder = Path(folder)
    content = {
        "plan.json": json.dumps(as_json(plan), indent=2, ensure_ascii=False, allow_nan=False) + "\n",
        "incident.csv": incident_csv(plan),
    }
    if plan.paths:
        content["paths.csv"] = paths_csv(plan.paths)
    folder.mkdir(exist_ok=True)
    for name, text in content.items():
        write_whole(folder / name, text.encode("utf-8"))
    return [folder / name for name in content]


def _table(head: tuple[str, ...], rows: Sequence[tuple[object, ...]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(rows)
    return text.getvalue()
