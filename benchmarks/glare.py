"""Glare of a picture, file to indices: ours beside evalglare, and how well they agree."""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path

import pyradiance

from clerestory.glare import evaluate
from clerestory.glare.evaluate import _lens
from clerestory.picture import Picture, View
from glare_pictures import FISHEYES, disks, evalglare, scattered, window
from timing import alternate, row, table

PROGRAM = Path(pyradiance.__file__).parent / "bin" / "evalglare"
REPETITIONS = 5


def _pictures(data: Path, folder: Path) -> dict[str, Path]:
    """Pictures by what they show: real ones, and made ones of 1000 pixels, the program's recommended size."""
    named = {name: data / "images" / f"{name}.hdr" for name in ("evalglare_testimage", "pyradiance_test")}
    for projection, options in FISHEYES.items():
        view = View(options)
        made = {
            "two disks": disks(1000, view, 500.0, (20000.0, 0, 20, 5), (10000.0, 30, -15, 4)),
            "window and sun": window(1000, view, 1),
            "40 sources": scattered(1000, view, 6, 40),
        }
        for name, picture in made.items():
            path = folder / f"{projection}-{name.replace(' ', '-')}.hdr"
            picture.write(path)
            named[f"{name}, {projection}"] = path
    return named


def report(data: Path) -> str:
    """Text of the section."""
    times, figures = [], []
    with tempfile.TemporaryDirectory() as name:
        for words, path in _pictures(data, Path(name)).items():

            def ours(_: int, path: Path = path) -> None:
                # Nothing is kept from one run to the next: a single picture is the job.
                _lens.cache_clear()
                evaluate(Picture.read(path))

            def theirs(_: int, path: Path = path) -> None:
                subprocess.run([str(PROGRAM), str(path)], capture_output=True, check=True)

            times.append(row(words, alternate(ours, theirs, REPETITIONS), digits=1))
            found, printed = evaluate(Picture.read(path)), evalglare(PROGRAM, path)
            figures.append(
                [
                    words,
                    f"{len(found.sources)} / {len(printed.sources)}",
                    f"{abs(found.dgp - printed.values['dgp']):.1e}",
                    f"{abs(found.dgi - printed.values['dgi']):.1e}",
                    f"{abs(found.ugr - printed.values['ugr']):.1e}",
                    f"{abs(found.vertical_illuminance / printed.values['E_v'] - 1):.1e}",
                ]
            )
    load = os.getloadavg()[0]
    return f"""### Glare of a picture

Aim: at least 20 times, same numbers. From the file to all indices, {REPETITIONS} runs in turn, warm files. evalglare
3.06 runs as a process, with its start of some milliseconds; Clerestory as a call in a running Python, on all
processors, with nothing kept from the run before. Load of the machine at the end: {load:.1f}.

{table(["picture", "Clerestory [ms]", "evalglare [ms]", "ratio", "spread"], times)}

Differences of the results; sources as ours / theirs.

{table(["picture", "sources", "DGP", "DGI", "UGR", "E_v, relative"], figures)}
"""
