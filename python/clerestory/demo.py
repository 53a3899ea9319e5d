"""`make demo`: a blind and a fabric as two laboratories find them, and the round robin that compares them.

As laboratories do with such systems, each measures geometry and base material for itself and lets a virtual
goniophotometer find the BSDF: once as a Klems matrix, once as a tensor tree. What they found differs a little, and so
do the apertures of their instruments.

    python -m clerestory.demo FOLDER
"""

from __future__ import annotations

import shlex
import sys
from copy import deepcopy
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clerestory import trace
from clerestory.trace.recipe import read_toml
from clerestory.trace.shipped import RECIPES

if TYPE_CHECKING:
    from collections.abc import Sequence

PATHS = {"klems": 1024, "high": 512}
"""Of an incident patch."""
LEVEL = 5
"""Cells along an axis of a tensor tree, 2 to this power."""
SYSTEMS: dict[str, tuple[str, str, dict[str, dict[str, Any]]]] = {
    "blind": (
        "Venetian blind",
        "round-robin-blind",
        {
            "North": {},
            "South": {"sample.slat.crown_mm": 9.0, "materials.paint.reflectance": 0.66},
        },
    ),
    "fabric": (
        "Roller blind fabric",
        "twill-1-percent",
        {
            "North": {},
            "South": {"sample.openness": 0.013, "materials.yarn.transmittance": 0.36},
        },
    ),
}
"""Title, recipe, and what each laboratory found instead of the recipe's values."""
INSTRUMENTS: dict[str, dict[str, Any]] = {
    "North": {"seed": 1},
    "South": {"seed": 2, "source_cone_deg": 1.5, "detector_cone_deg": 1.5},
}
STUDY = """\
name = "Round robin of a blind and a fabric"
treatments = ["klems", "high", "high-peaks"]
seeds = [1]

[moments]
times = ["2021-02-21 14:00", "2021-05-21 14:00"]
size_px = 256

[year]                 # one month of a synthetic year
months = [3]
"""


def recipe(name: str, changes: dict[str, Any]) -> dict[str, Any]:
    """Tables of a shipped recipe with some values changed, by keys such as `sample.slat.crown_mm`."""
    tables = deepcopy(read_toml(RECIPES.find(name)))
    for key, value in changes.items():
        *path, last = key.split(".")
        table = tables
        for part in path:
            table = table[part]
        table[last] = value
    return tables


def measured(folder: Path) -> str:
    """Let the laboratories measure, write what they give into a folder; the text of the study."""
    text = STUDY
    for system, (title, name, laboratories) in SYSTEMS.items():
        text += f'\n[systems.{system}]\ntitle = "{title}"\n'
        for laboratory, changes in laboratories.items():
            for resolution, paths in PATHS.items():
                basis = {"klems": "klems-full", "high": "tensor4"}[resolution]
                found = trace.measure(
                    recipe(name, changes), basis=basis, resolution=LEVEL, samples=paths, **INSTRUMENTS[laboratory]
                )
                file = f"{system}_{laboratory.lower()}_{resolution}.xml"
                found.write(folder / file)
                text += f'[[systems.{system}.data_sets]]\nlaboratory = "{laboratory}"\nfile = "{file}"\n'
    return text


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the data sets, the study and its report into a folder.

    Returns
    -------
    Exit code of `clerestory roundrobin`.
    """
    from clerestory.cli import main as command_line

    words = list(sys.argv[1:] if arguments is None else arguments)
    if len(words) != 1 or words[0].startswith("-"):
        sys.stderr.write("usage: python -m clerestory.demo FOLDER\n")
        return 2
    folder = Path(words[0])
    folder.mkdir(parents=True, exist_ok=True)
    study = folder / "study.toml"
    study.write_text(measured(folder), encoding="utf-8")
    command = ["roundrobin", str(study), "-o", str(folder), "--cache", str(folder / "cache")]
    sys.stdout.write(f"$ {shlex.join(['clerestory', *command])}\n")
    sys.stdout.flush()
    code = command_line(command)
    if code == 0:
        sys.stdout.write(f"The report is {folder / 'report.html'}\n")
    return code


if __name__ == "__main__":
    sys.exit(main())
