"""Memory and time of studies by sensors, hours and data sets."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import room_radiance
from clerestory import Bsdf, read
from clerestory.weather import read_weather
from clerestory.weather.wea import to_wea
from timing import table
from years import BLIND, WEATHER, grid

CHILD = """
import json, resource, sys, time
from clerestory.annual.study import load
started = time.perf_counter()
study = load(sys.argv[1], cache=sys.argv[2])
for _ in study.parts():
    pass
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
print(json.dumps({"seconds": time.perf_counter() - started, "peak": peak}))
"""


def report(data: Path) -> str:
    """Text of the section."""
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = to_wea(read_weather(data / WEATHER)).splitlines()
        (folder / "year.wea").write_text("\n".join(text) + "\n")
        june = [line for line in text[6:] if line.split()[0] == "6"]
        (folder / "month.wea").write_text("\n".join([*text[:6], *june]) + "\n")
        bsdf = read(data / BLIND)
        for sensors, weather, states in (
            (100, "month", 1),
            (100, "year", 1),
            (500, "year", 1),
            (2000, "year", 1),
            (2000, "year", 3),
            (2000, "year", 10),
        ):
            found = _child(folder, bsdf, sensors, weather, states)
            rows.append([str(sensors), weather, str(states), f"{found['seconds']:.1f}", f"{found['peak']:.0f}"])
    head = ["sensors", "weather", "data sets", "time [s]", "peak memory [MiB]"]
    return f"""### Memory and growth of a study

Studies of five phases in the same room as processes of their own, each with an empty cache, 1,024 paths a sensor, the
blind {BLIND.name} turned by as many angles as there are data sets, and the memory that a study may use by default
(2 GiB).

{table(head, rows)}
"""


def _child(folder: Path, bsdf: Bsdf, sensors: int, weather: str, states: int) -> dict[str, float]:
    """Seconds and peak memory [MiB] of a study in a process of its own."""
    points, _ = grid(sensors)
    tables = room_radiance.tables({"glass": 0.8}, sun=False, sky=True)
    lines = [
        "[sky]",
        'kind = "overcast"',
        "[room]",
        *(f"{key} = {value}" for key, value in (room_radiance.SIZE | room_radiance.REFLECTANCES).items()),
        "[[room.openings]]",
        *(f"{key} = {json.dumps(value)}" for key, value in tables["room"]["openings"][0].items()),
        "[systems.window]",
        "glass = 0.8",
        "[sensors.plane]",
        f"points_m = {json.dumps(points.tolist())}",
    ]
    (folder / "room.toml").write_text("\n".join(lines) + "\n")
    study = ['room = "room.toml"', f'weather = "{weather}.wea"', "paths = 1024"]
    for k in range(states):
        bsdf.rotated(3.0 * k).to_matrix("klems-full").save(folder / f"state{k}.bsdf.npz")
        study += [f"[data_sets.s{k}]", f'file = "state{k}.bsdf.npz"', 'treatment = "klems"']
    (folder / "study.toml").write_text("\n".join(study) + "\n")
    with tempfile.TemporaryDirectory() as cache:
        command = [sys.executable, "-c", CHILD, str(folder / "study.toml"), cache]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr[-800:])
    return dict(json.loads(done.stdout))
