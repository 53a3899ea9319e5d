"""pab's files read here, and by Radiance's pabopto2bsdf and bsdf2ttree: the same sides, azimuths and lobes."""

import os
import subprocess

import numpy as np
import pytest

import clerestory
from clerestory import MissingDataError, measure
from clerestory.measure.formats.sir import interpolant_of
from measured import mountain_points, mountain_text

DIRECTIONS = [(0, 0), (30, 45), (30, 135), (30, 225), (30, 315)]


@pytest.fixture(scope="module", params=["transmission", "reflection"])
def skew(request, tmp_path_factory, require_pyradiance):
    """Files of a sample without symmetry, with what pabopto2bsdf makes of them."""
    folder = tmp_path_factory.mktemp(request.param)
    paths = []
    for theta, phi in DIRECTIONS:
        points = mountain_points(theta, phi, transmitted=request.param == "transmission")
        paths.append(folder / f"skew_{theta}_{phi}.txt")
        paths[-1].write_text(mountain_text(points, theta, phi))
    programs = require_pyradiance.anci.BINPATH
    made = subprocess.run([programs / "pabopto2bsdf", *paths], capture_output=True, check=True, cwd=folder)
    (folder / "skew.sir").write_bytes(made.stdout)
    return request.param, folder, paths, programs


def test_lobes_are_those_of_the_points(skew):
    """The interpolant's DSF along measured directions, within what its lobes smooth away."""
    scatter, folder, paths, _ = skew
    scans = measure.read(paths).measurements[0].scans
    interpolant = interpolant_of((folder / "skew.sir").read_bytes())
    assert (interpolant.side, interpolant.scatter) == ("exterior", scatter)
    assert len(interpolant.incident) == len(DIRECTIONS)
    for scan in scans:
        lobes = interpolant.dsf(scan.incident, scan.outgoing)
        assert np.corrcoef(lobes, scan.values[:, 0])[0, 1] > 0.95


def test_the_file_of_lobes_is_a_file_of_scans(skew):
    scatter, folder, _, _ = skew
    (measurement,) = measure.read(folder / "skew.sir").measurements
    assert measurement.sample == "skew"
    assert {(s.incident_side, s.scatter, s.quantity) for s in measurement.scans} == {("exterior", scatter, "dsf")}
    interpolant = interpolant_of((folder / "skew.sir").read_bytes())
    for k, scan in enumerate(measurement.scans):
        np.testing.assert_allclose(scan.incident, interpolant.incident[k], atol=1e-9)
        # Lobes are left out where they have faded.
        np.testing.assert_allclose(
            scan.values[:, 0], interpolant.dsf(scan.incident, scan.outgoing), atol=2e-3 * scan.values.max()
        )
        # Cells are of equal solid angle, so that their sum is the integral of DSF: the file's own figure, less what its
        # lobes lose beyond the horizon.
        total = scan.values.sum() * 2.0 * np.pi / interpolant.grid**2
        assert total == pytest.approx(interpolant.lobes[k].volume, rel=0.05)


@pytest.mark.slow
def test_sides_and_azimuths_are_those_of_radiance(skew):
    """Radiance takes pab's front to be the interior; with that choice both send the light to the same place."""
    scatter, folder, paths, programs = skew
    command = [programs / "bsdf2ttree", "-g", "4", "-t", "0", folder / "skew.sir"]
    search = f"{os.environ['PATH']}{os.pathsep}{programs}"
    made = subprocess.run(command, capture_output=True, check=True, cwd=folder, env={**os.environ, "PATH": search})
    (folder / "skew.xml").write_bytes(made.stdout)
    bsdf = clerestory.read(folder / "skew.xml")

    def likeness(front):
        found = []
        for scan in measure.read(paths, front=front).measurements[0].scans:
            incident = np.broadcast_to(scan.incident, (len(scan), 3))
            theirs = bsdf.evaluate(incident, scan.outgoing) * np.cos(np.radians(scan.theta_deg))
            found.append(np.corrcoef(theirs, scan.values[:, 0])[0, 1])
        return found

    # Cells of 16 by 16 smooth the peak.
    assert min(likeness("interior")) > 0.85
    if scatter == "transmission":
        assert np.mean(likeness("exterior")) < 0.6
    else:
        with pytest.raises(MissingDataError):
            likeness("exterior")
