"""Fixtures for all tests."""

import os
from pathlib import Path

import pytest

from samples import ABSENT, sample_root


@pytest.fixture(scope="session")
def sample_data() -> Path:
    """The folder of the sample data; skips where it is absent."""
    root = sample_root()
    if root is None:
        pytest.skip(ABSENT)
    return root


@pytest.fixture(scope="session")
def require_pyradiance():
    """Radiance as the package pyradiance, with RAYPATH set; its programs lie in `pyradiance.anci.BINPATH`.

    It is among the locked test dependencies, so it is absent only where it has no wheel.
    """
    pyradiance = pytest.importorskip("pyradiance", reason="pyradiance absent")
    os.environ.setdefault("RAYPATH", f".:{Path(pyradiance.__file__).parent / 'lib'}")
    return pyradiance
