"""What peak extraction and resolution of a 1 % open fabric's data do to E_v and glare, on the report's seven dates."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from clerestory import room, trace
from clerestory.glare import evaluate
from clerestory.trace.recipe import read_toml
from timing import table

DATES = ("2020-12-21", "2021-01-21", "2021-02-21", "2021-03-21", "2021-04-21", "2021-05-21", "2021-06-21")
TREATMENTS = ("klems", "klems-peaks", "high", "high-peaks")
FABRIC = "twill-1-percent"
#: Cells along an axis of the tensor tree, 2 to this power, and paths a cell.
LEVELS, PATHS = 6, 2048
SIZE, SAMPLES = 400, 8


def fabric(folder: Path) -> Path:
    """The fabric at high resolution, traced; its file."""
    # XML holds no beams: they go into the cells that they fall into, as in a measured file.
    path = folder / "fabric.xml"
    trace.measure(FABRIC, basis="tensor4", resolution=LEVELS, samples=PATHS).write(path)
    return path


def office(path: Path, treatment: str, sky: dict[str, Any]) -> room.Room:
    """The office that comes with Clerestory, with the fabric in its window."""
    tables = read_toml(room.shipped.ROOMS.path_of("office") or "")
    tables["systems"] = {"window": {"file": str(path), "treatment": treatment}}
    tables["sky"] = {**tables["sky"], **sky}
    # The report's hours are of Central European Time, in summer too.
    tables["place"]["timezone"] = 1.0
    return room.load(tables)


def rated(path: Path, treatment: str, sky: dict[str, Any]) -> tuple[float, float, float, float]:
    """E_v [lx], DGP, DGI at the office's desk, and the sun's altitude [°]."""
    made = office(path, treatment, sky)
    view = made.view("desk").model_copy(update={"size_px": [SIZE, SIZE]})
    found = evaluate(made.picture(view, samples=SAMPLES).picture())
    return found.vertical_illuminance, found.dgp, found.dgi, made.sky.settings.sun.altitude_deg


def report(data: Path) -> str:
    """Text of the section."""
    del data
    rows = []
    with tempfile.TemporaryDirectory() as name:
        path = fabric(Path(name))
        for date in DATES:
            cells, altitude = [], 0.0
            for treatment in TREATMENTS:
                eye, dgp, dgi, altitude = rated(path, treatment, {"time": f"{date} 14:00"})
                cells += [f"{eye:.0f}", f"{dgp:.3f}", f"{dgi:.1f}"]
            rows.append([date, f"{altitude:.1f}°", *cells])
    heads = [f"{t}: {what}" for t in TREATMENTS for what in ("E_v [lx]", "DGP", "DGI")]
    return f"""### Treatments of a fabric

The shipped office ({SIZE} × {SIZE} pixels, {SAMPLES} paths a pixel, view `desk`) with the shipped 1 % open twill
alone in its south window, Preetham's clear sky of turbidity 3, Aldrans, 14:00 CET. The twill was traced to a tensor
tree of {1 << LEVELS} × {1 << LEVELS} directions on either side; `klems` is the Klems matrix of it. The report's
figures 55 to 62 are of measured fabrics in another room, whose plan, reflectances and view are not in its text.

{table(["date", "sun", *heads], rows)}
"""
