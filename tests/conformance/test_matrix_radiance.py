"""Matrices as Radiance's programs read and write them, and the year's product as `dctimestep` finds it."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pyradiance
import pytest

from clerestory import read
from clerestory.annual.exchange import read as read_matrix
from clerestory.annual.exchange import write as write_matrix
from clerestory.annual.phases import Transfer
from clerestory.basis import Basis
from samples import ABSENT, sample_root

BIN = Path(pyradiance.__file__).parent / "bin"


def radiance(program, *words, cwd):
    environment = os.environ | {"RAYPATH": str(Path(pyradiance.__file__).parent / "lib")}
    done = subprocess.run([BIN / program, *map(str, words)], cwd=cwd, env=environment, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


@pytest.mark.parametrize("form", ["ascii", "float", "double"])
@pytest.mark.parametrize("theirs", ["a", "f", "d"])
def test_matrices_go_to_and_fro(tmp_path, form, theirs):
    values = np.random.default_rng(2).random((4, 6, 3))
    write_matrix(tmp_path / "ours.mtx", values, form=form)
    (tmp_path / "theirs.mtx").write_bytes(radiance("rmtxop", f"-f{theirs}", "-s", "2", "ours.mtx", cwd=tmp_path))
    assert np.allclose(read_matrix(tmp_path / "theirs.mtx"), 2.0 * values, rtol=2e-6)


@pytest.mark.parametrize("name", ["blinds30.xml", "ec60.xml"])
def test_three_phases_multiply_as_theirs(tmp_path, name):
    """V T D s of one data set: our patches are numbered as Radiance numbers a window's directions."""
    root = sample_root()
    if root is None:
        pytest.skip(ABSENT)
    path = root / "klems" / name
    rng = np.random.default_rng(3)
    view, daylight, sky = rng.random((5, 145)), rng.random((145, 146)), rng.random((146, 8))
    basis = Basis.named("klems-full")
    transfer = Transfer.of(read(path), basis)
    for matrix, file in ((view, "v"), (daylight, "d"), (sky, "s")):
        write_matrix(tmp_path / f"{file}.mtx", matrix, form="double")
    (tmp_path / "found.mtx").write_bytes(radiance("dctimestep", "-of", "v.mtx", path, "d.mtx", "s.mtx", cwd=tmp_path))
    found = read_matrix(tmp_path / "found.mtx")[:, :, 1]
    expected = view @ transfer.transmission @ daylight @ sky
    assert np.allclose(found, expected, rtol=5e-4)
