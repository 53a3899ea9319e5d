"""Reading BSDF XML: ours beside the loader of Radiance's BSDF library, in one process."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from pyradiance import bsdf as library

import clerestory
from timing import REPETITIONS, alternate, row, table

FILES = (
    "klems/SingleClear.xml",
    "klems/ExtVenetianBlind_17tilt.xml",
    "klems/mcs6216_t3_g6_t80_-a_phi00_kl.xml",
    "klems/blinds30.xml",
    "tensortree/b30.xml",
    "tensortree/pyradiance_t3.xml",
)

# Radiance's library hangs or crashes after data that it loaded are freed: they are kept until the end.
KEPT: list[object] = []


def report(data: Path) -> str:
    """Text of the section."""
    rows = []
    for name in FILES:
        with tempfile.TemporaryDirectory() as folder:
            # The library keeps what it has loaded by file name: every run reads a copy of its own.
            copies = [Path(shutil.copy(data / name, Path(folder) / f"{k}.xml")) for k in range(REPETITIONS + 1)]
            for copy in copies:
                copy.read_bytes()
            pair = alternate(
                lambda k, copies=copies: clerestory.read(copies[k]),
                lambda k, copies=copies: KEPT.append(library.load_file(str(copies[k]))),
            )
        blocks = sum(len(members) for members in clerestory.read(data / name).models.values())
        rows.append([*row(name, pair), str(blocks)])
    head = ["file", "Clerestory [ms]", "Radiance [ms]", "ratio", "spread", "blocks"]
    return f"""### Reading BSDF XML

Aim: at least 5 times. Both in one process, {REPETITIONS} runs in turn, each on a copy of the file that lies in the page
cache. Clerestory reads every block of the file and checks it; Radiance's loader skips all bands but the visible one.

{table(head, rows)}
"""
