"""Ten million measured points into the laboratory's database and out again: time and peak memory of each command."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from clerestory.measure import Measurement, Scan, write
from timing import table

CASES = ((100, 100_000), (1, 10_000_000))

# A command in a process of its own, which tells its time and peak memory in the end. What `resource` tells would be
# that of the parent if it was larger.
CHILD = """
import json, sys, time
from pathlib import Path
from clerestory.cli import main
started = time.perf_counter()
code = main(sys.argv[1:])
status = Path("/proc/self/status").read_text()
peak = float(status.split("VmHWM:")[1].split()[0]) / 1024.0
print(json.dumps({"code": code, "seconds": time.perf_counter() - started, "peak": peak}))
"""


def report(_data: Path) -> str:
    """Text of the section."""
    rows = []
    for scans, points in CASES:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            size = _files(folder / "files", scans, points)
            for words in (
                ["import", str(folder / "files")],
                ["import", str(folder / "files")],
                ["list", "scans"],
                ["show", "twill"],
                ["export", "twill", "-o", str(folder / "out")],
            ):
                found = _child([*words, "--db", str(folder / "lab.sqlite")])
                again = " (again)" if words[0] == "import" and rows and rows[-1][1].startswith("import") else ""
                rows.append(
                    [
                        f"{scans} × {points:,}",
                        words[0] + again,
                        f"{found['seconds']:.1f}",
                        f"{found['peak']:.0f}",
                    ]
                )
            same = all((folder / "out" / p.name).read_bytes() == p.read_bytes() for p in (folder / "files").iterdir())
            stored = (folder / "lab.sqlite").stat().st_size
            rows.append([f"{scans} × {points:,}", f"files {size >> 20} MiB, database {stored >> 20} MiB", "", ""])
            if not same:
                raise RuntimeError("what was exported is not what was imported")
    head = ["scans × points", "command", "time [s]", "peak memory [MiB]"]
    return f"""### The laboratory's database with ten million points

`clerestory measure` with pab Mountain files, each command as a process of its own. What is exported are the imported
files, byte by byte.

{table(head, rows)}
"""


def _files(folder: Path, scans: int, points: int) -> int:
    """Files of scans as an instrument would write them; their size in bytes."""
    for k in range(scans):
        numbers = np.random.default_rng(k)
        theta = np.round(numbers.uniform(0.0, 90.0, points), 3)
        values = np.round(numbers.lognormal(-2.0, 2.0, points), 6)
        scan = Scan(
            "exterior",
            "transmission",
            round(80.0 * k / scans, 2),
            90.0,
            theta,
            np.round(numbers.uniform(0.0, 360.0, points), 3),
            values[:, None],
        )
        write(Measurement("twill", (scan,)), folder, "mountain")
    return sum(path.stat().st_size for path in folder.iterdir())


def _child(words: list[str]) -> dict[str, float]:
    done = subprocess.run([sys.executable, "-c", CHILD, "measure", *words], capture_output=True, text=True, check=False)
    found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    if found["code"]:
        raise RuntimeError(done.stderr)
    return found
