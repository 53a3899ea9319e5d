"""`make demo`: one fabric as five laboratories might give it, and the report that compares them.

The fabric has open holes, through which light goes straight until the yarn's thickness hides them (the cut-off), and
yarn that scatters mostly forward. Its formula is sampled at several resolutions. Three of the data sets then suffer
what happens in laboratories: a scale that is 5 % too high, a beam that is 3° off, a sample mounted turned by 90°.

    python -m clerestory.demo FOLDER
"""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.directions import SIDES
from clerestory.model import Model

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side

OPENNESS = 0.06
"""Share of the area that is open along the normal."""
CUT_OFF_DEG = (80.0, 62.0)
"""Angle of incidence [°] at which the holes close, in the horizontal and in the vertical plane."""
SCATTERED = 0.03
"""Scattered transmittance along the normal."""
REFLECTANCE = 0.45
OFF_DEG = 3.0
"""Angle [°] by which the beam of laboratory D misses its direction, downward."""
_STEPS = 8


def beam(travel: NDArray[np.float64]) -> NDArray[np.float64]:
    """Direct transmittance for directions of travel (..., 3): the holes, hidden by the thickness of the yarn."""
    slope = np.abs(travel[..., :2]) / np.maximum(np.abs(travel[..., 2:]), 1e-9)
    open_share = np.maximum(0.0, 1.0 - slope / np.tan(np.radians(CUT_OFF_DEG)))
    return np.asarray(OPENNESS * open_share[..., 0] * open_share[..., 1])


def scattering() -> Model:
    """The yarn: half of the light about its direction of travel, half evenly; less for grazing light."""
    basis = Basis.named("klems-full")
    travel = basis.outgoing_centres("interior")
    lobes = np.maximum(travel @ travel.T, 0.0) ** 6
    lobes /= basis.projected_solid_angles @ lobes
    totals = SCATTERED * np.sqrt(travel[:, 2])
    return Model.matrix((0.5 / np.pi + 0.5 * lobes) * totals, basis)


def fabric() -> Bsdf:
    """The fabric itself."""
    return _data_set(_through())


def _through() -> Model:
    """An ideal beam on fine patches, and the scattered light."""
    fine = Basis.named("reinhart:6")
    through = Model.specular(beam(fine.outgoing_centres("interior")), basis=fine)
    return Model.sum([(1.0, through), (1.0, scattering())])


def misaligned() -> Bsdf:
    """The fabric on Klems full, its beam `OFF_DEG` too low."""
    basis = Basis.named("klems-full")
    middles = (np.arange(_STEPS) + 0.5) / _STEPS
    u, v = np.meshgrid(middles, middles)
    numbers = np.column_stack([u.ravel(), v.ravel()])
    values = np.array(scattering().values)
    for patch in range(len(basis)):
        travel = basis.sample_outgoing(patch, numbers, "interior")
        leaving = travel - np.array([0.0, np.radians(OFF_DEG), 0.0])
        leaving[:, :2] /= np.maximum(np.linalg.norm(leaving, axis=1), 1.0)[:, None]
        shares = beam(travel) / len(travel)
        flux = np.bincount(basis.index_of_outgoing(leaving), weights=shares, minlength=len(basis))
        values[:, patch] += flux / basis.projected_solid_angles
    return _data_set(Model.matrix(values, basis))


def laboratories() -> dict[str, Bsdf]:
    """The fabric as laboratories might give it, by their names."""
    sample = fabric()
    klems = sample.to_matrix("klems-full", samples=64)
    return {
        "A, Klems": klems,
        "B, high resolution": _data_set(_through(), sides=("exterior",)).to_tree(resolution=5, samples=4),
        "C, Klems half, 5 % high": sample.to_matrix("klems-half", samples=64).scaled(1.05),
        "D, beam 3° off": misaligned().to_matrix("klems-full"),
        "E, mounted turned": klems.rotated(90.0),
    }


def _data_set(transmission: Model, sides: Sequence[Side] = SIDES) -> Bsdf:
    backwards = {"exterior": transmission, "interior": transmission.reciprocal()}
    parts: dict[tuple[Side, Scatter], Model] = {}
    for side in sides:
        parts[side, "transmission"] = backwards[side]
        parts[side, "reflection"] = Model.lambertian(REFLECTANCE)
    made = Bsdf.from_models(parts)
    return made.with_metadata(name="Demonstration fabric", manufacturer="Clerestory", thickness_m=0.0005)


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the data sets and their report into a folder.

    Returns
    -------
    Exit code of `clerestory compare`.
    """
    from clerestory.cli import main as command_line

    words = list(sys.argv[1:] if arguments is None else arguments)
    if len(words) != 1 or words[0].startswith("-"):
        sys.stderr.write("usage: python -m clerestory.demo FOLDER\n")
        return 2
    folder = Path(words[0])
    folder.mkdir(parents=True, exist_ok=True)
    command = ["compare"]
    for name, bsdf in laboratories().items():
        path = folder / f"laboratory_{name[0].lower()}.xml"
        bsdf.write(path)
        command.append(f"{name}={path}")
    report = folder / "report.html"
    command += ["-o", str(report)]
    sys.stdout.write(f"$ {shlex.join(['clerestory', *command])}\n")
    sys.stdout.flush()
    code = command_line(command)
    if code == 0:
        sys.stdout.write(f"The report is {report}\n")
    return code


if __name__ == "__main__":
    sys.exit(main())
