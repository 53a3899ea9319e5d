"""Tensor trees against Radiance: its BSDF library on real files, its `rttree_reduce` on arrays."""

import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

import clerestory
from clerestory import Bsdf, Model
from samples import find_samples

PAIRS = 1000
FILES = find_samples("tensortree")
LOADED: dict[Path, object] = {}
"""Files in Radiance's library; it hangs in a later load when one of them is freed."""


def disk_points(rng, n):
    """Uniform points of the disk, a hair inside of it."""
    r, phi = 0.999 * np.sqrt(rng.random(n)), 2 * np.pi * rng.random(n)
    return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=-1)


def directions(points, sign):
    """Unit vectors on the interior (+1) or exterior (-1) side."""
    z = np.sqrt(1 - np.sum(points**2, axis=-1))
    return np.concatenate([points, sign * z[:, None]], axis=-1)


def angles(vectors):
    """Polar angles and azimuths [°], as the library takes them."""
    return np.degrees(np.arccos(vectors[:, 2])), np.degrees(np.arctan2(vectors[:, 1], vectors[:, 0]))


@pytest.fixture(params=FILES or [None], ids=lambda p: p.name if p else "absent")
def both(request, require_pyradiance, sample_data, tmp_path):
    """A file in Radiance's library and in ours."""
    path = request.param
    if path.suffix == ".gz":
        import gzip

        plain = tmp_path / path.stem
        plain.write_bytes(gzip.decompress(path.read_bytes()))
        path = plain
    library = require_pyradiance.bsdf
    if request.param not in LOADED:
        LOADED[request.param] = library.load_file(str(path))
    return library, LOADED[request.param], clerestory.read(path)


def components(bsdf):
    """(sign of the incident side, scatter) of what the file holds itself."""
    (band,) = bsdf.models.values()
    for side, scatter in band:
        yield (1 if side == "interior" else -1), scatter


def test_values_at_random_pairs_of_directions(both):
    library, theirs, ours = both
    rng = np.random.default_rng(5)
    for sign, scatter in components(ours):
        i_points, o_points = disk_points(rng, PAIRS), disk_points(rng, PAIRS)
        incident = directions(i_points, sign)
        outgoing = directions(o_points, sign if scatter == "reflection" else -sign)
        values = ours.evaluate(incident, outgoing)
        # Where a step of 1e-5 changes the value the pair is at the border of a cell.
        inside = np.ones(PAIRS, dtype=bool)
        for step in 1e-5 * np.array([[1, 1], [-1, 1], [1, -1], [-1, -1]]):
            moved = ours.evaluate(
                directions(i_points + step, sign), directions(o_points + step, np.sign(outgoing[0, 2]))
            )
            inside &= moved == values
        assert np.mean(inside) > 0.95
        query = zip(*angles(incident), *angles(outgoing), strict=True)
        expected = np.array([library.query(theirs, *pair)[1] for pair in query])
        np.testing.assert_allclose(values[inside], expected[inside], rtol=5e-4, atol=1e-6)


def test_direct_hemispherical_values(both):
    library, theirs, ours = both
    rng = np.random.default_rng(6)
    for sign, scatter in components(ours):
        incident = directions(disk_points(rng, 200), sign)
        totals = ours.integrate(incident, scatter)
        way = library.SAMPLE_R if scatter == "reflection" else library.SAMPLE_T
        part = way | library.SAMPLE_SP | library.SAMPLE_DF
        expected = [library.direct_hemi(theirs, *pair, part) for pair in zip(*angles(incident), strict=True)]
        np.testing.assert_allclose(totals, expected, rtol=5e-3, atol=1e-6)


def array(rank, levels, rng):
    """A noisy forward lobe over a floor."""
    size = 1 << levels
    shape = (size // 2 if rank == 3 else size,) + (size,) * (rank - 1)
    at = np.meshgrid(*[(np.arange(n) + 0.5) / size for n in shape], indexing="ij")
    shift = 1 - at[0] if rank == 3 else at[0]
    lobe = np.exp(-20 * ((at[-2] - shift) ** 2 + (at[-1] - 0.5) ** 2))
    return ((0.05 + 8 * lobe) * (1 + 0.1 * rng.random(shape))).astype("<f4")


@pytest.mark.parametrize(("rank", "levels"), [(3, 4), (4, 3)])
@pytest.mark.parametrize("percent", [10, 50, 90, 99])
def test_reduction_is_that_of_rttree_reduce(require_pyradiance, tmp_path, rank, levels, percent):
    values = array(rank, levels, np.random.default_rng(7))
    program = Path(require_pyradiance.anci.BINPATH) / "rttree_reduce"
    options = ["-h", "-ff", "-t", str(percent), "-r", str(rank), "-g", str(levels)]
    text = subprocess.run(
        [program, *options], input=values.tobytes(), capture_output=True, check=True, env=os.environ
    ).stdout

    reduced, report = Model.tree_from_grid(values).reduced(percent=percent)
    path = tmp_path / "reduced.xml"
    ours = Bsdf.from_models({("exterior", "transmission"): reduced})
    ours.write(path)
    xml, count = re.subn(
        r"(<ScatteringData>).*?(</ScatteringData>)", rf"\g<1>{text.decode()}\g<2>", path.read_text(), flags=re.DOTALL
    )
    assert count == 1
    path.write_text(xml)
    theirs = clerestory.read(path)

    (model,) = next(iter(theirs.models.values())).values()
    assert model.tree_leaves == report.leaves_after
    rng = np.random.default_rng(8)
    incident, outgoing = directions(disk_points(rng, 20_000), -1), directions(disk_points(rng, 20_000), 1)
    # Their file has 4 digits for large values.
    np.testing.assert_allclose(ours.evaluate(incident, outgoing), theirs.evaluate(incident, outgoing), rtol=6e-4)
