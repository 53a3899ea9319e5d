"""Scans written for optics programs and read back."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import KDTree

import instrument_files as files
from clerestory import ClerestoryError, measure
from clerestory.directions import direction
from clerestory.measure import Measurement, Scan
from clerestory.measure.formats import lighttools, reflectances, zemax


def same(first, second):
    """Whether scans hold the same points, in any order."""
    assert (first.incident_side, first.scatter, first.quantity) == (
        second.incident_side,
        second.scatter,
        second.quantity,
    )
    np.testing.assert_allclose(second.incident, first.incident, atol=1e-9)
    assert set(first.channels) == set(second.channels)
    assert len(first) == len(second)
    away, nearest = KDTree(second.outgoing).query(first.outgoing)
    assert away.max() < 1e-6
    for name in first.channels:
        np.testing.assert_allclose(second.channel(name)[nearest], first.channel(name), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("name", files.GOLDEN["zemax"])
def test_zemax_comes_back(name):
    measurement = zemax.read(files.GOLDEN["zemax"][name], name).measurements[0]
    (again,) = zemax.write(measurement).items()
    assert again[0] == f"paint_exterior_{'btdf' if name == 'b.bsdf' else 'brdf'}.bsdf"
    back = zemax.read(again[1], again[0]).measurements[0]
    assert back.sample == "paint"
    assert len(back.scans) == len(measurement.scans)
    for first, second in zip(measurement.scans, back.scans, strict=True):
        same(first, second)
        assert dict(second.conditions) == dict(first.conditions)
    # Writing what was read from a file of ours gives the same bytes.
    assert zemax.write(back)[again[0]] == again[1]


@pytest.mark.parametrize("name", files.GOLDEN["lighttools"])
def test_lighttools_comes_back(name):
    measurement = lighttools.read(files.GOLDEN["lighttools"][name], name).measurements[0]
    written = lighttools.write(measurement)
    back = lighttools.read(written["film.bsdf"], "film.bsdf").measurements[0]
    assert len(back.scans) == len(measurement.scans)
    for first, second in zip(measurement.scans, back.scans, strict=True):
        same(first, second)
        assert second.conditions["hemispherical"] == first.conditions["hemispherical"]
    # Reflection and transmission of one direction are rows of the table of shares, too.
    rows = reflectances.read(written["film_exterior_RTfile.txt"], "film_exterior_RTfile.txt").sphere_values
    total = "hemispherical"
    assert [(v.scatter, v.collected, v.incident_side) for v in rows] == [
        ("transmission", total, "exterior"),
        ("reflection", total, "exterior"),
    ]
    assert rows[1].values[0] == pytest.approx(0.25 + 0.01 * (name == "m.bsdf"))


def lambertian(theta_deg, phi_deg=90.0, **changes):
    """Points at no table's directions, of a BTDF of 0.6/π and a small lobe about the straight beam."""
    rng = np.random.default_rng(7)
    z, phi = rng.random(4000), rng.random(4000) * 360.0
    theta = np.degrees(np.arccos(z))
    outgoing = direction(theta, phi, side="interior")
    straight = -direction(theta_deg, phi_deg, side="exterior")
    lobe = 0.2 * np.exp(4.0 * (outgoing @ straight - 1.0))
    given = {
        "incident_side": "exterior",
        "scatter": "transmission",
        "incident_theta_deg": theta_deg,
        "incident_phi_deg": phi_deg,
        "theta_deg": theta,
        "phi_deg": phi,
        "values": (0.6 / np.pi + lobe)[:, None],
    }
    return Scan(**(given | changes))


@pytest.mark.parametrize("module", [zemax, lighttools])
def test_scattered_points_are_interpolated_onto_a_table(module):
    scans = (lambertian(0.0), lambertian(40.0))
    (name, data), *_ = module.write(Measurement("film", scans)).items()
    # About a slanted direction a table reaches where no point was found; one about the normal does not.
    assert (b"repeat the nearest measured one" in data) == (module is zemax)
    back = module.read(data, name).measurements[0]
    for scan in back.scans:
        straight = -scan.incident
        truth = 0.6 / np.pi + 0.2 * np.exp(4.0 * (scan.outgoing @ straight - 1.0))
        inner = scan.theta_deg < 85.0
        np.testing.assert_allclose(scan.values[inner, 0], truth[inner], rtol=0.03)
        # The diffuse part alone transmits 0.6; the lobe adds its integral, found here by fine quadrature.
        mu, phi = np.meshgrid((np.arange(400) + 0.5) / 400, (np.arange(400) + 0.5) / 400 * 2 * np.pi)
        side = np.sqrt(1 - mu**2)
        w = np.stack([side * np.cos(phi), side * np.sin(phi), mu], axis=-1)
        total = 0.6 + (0.2 * np.exp(4.0 * (w @ straight - 1.0)) * mu).mean() * 2 * np.pi
        assert float(scan.conditions["hemispherical"]) == pytest.approx(total, rel=0.01)


def test_what_a_file_cannot_say_is_refused():
    one = lambertian(30.0)
    with pytest.raises(ClerestoryError, match="two scans"):
        zemax.write(Measurement("film", (one, one)))
    with pytest.raises(ClerestoryError, match="two scans"):
        lighttools.write(Measurement("film", (one, one)))
    with pytest.raises(ClerestoryError, match="form a table"):
        zemax.write(Measurement("film", (one, lambertian(40.0, 0.0))))
    with pytest.raises(ClerestoryError, match="signal"):
        zemax.write(Measurement("film", (replace(one, quantity="signal"),)))
    few = one.theta_deg < 8.0
    sparse = replace(one, theta_deg=one.theta_deg[few], phi_deg=one.phi_deg[few], values=one.values[few])
    with pytest.raises(ClerestoryError, match="points of light from 30° cover less than half"):
        zemax.write(Measurement("film", (sparse,)))
    with pytest.raises(ClerestoryError, match="no scan"):
        lighttools.write(Measurement("film", (replace(one, purpose="dark"),)))
    with pytest.raises(ClerestoryError, match="one set"):
        lighttools.write(Measurement("film", (one, replace(lambertian(40.0), channels=("solar",)))))


def test_the_normal_serves_every_azimuth_and_channels_get_files_of_their_own():
    scans = (lambertian(0.0), lambertian(40.0), lambertian(40.0, 180.0))
    (data,) = zemax.write(Measurement("film", scans)).values()
    back = zemax.read(data, "film.bsdf").measurements[0]
    assert [(s.incident_theta_deg, s.incident_phi_deg) for s in back.scans] == [(0, 90), (40, 90), (0, 180), (40, 180)]
    both = replace(scans[0], channels=("visible", "solar"), values=np.tile(scans[0].values, 2))
    assert sorted(zemax.write(Measurement("a film/1", (both,)))) == [
        "a_film_1_exterior_btdf_solar.bsdf",
        "a_film_1_exterior_btdf_visible.bsdf",
    ]


def test_the_other_half_of_a_symmetric_table_is_mirrored_for_zemax():
    half = zemax.read(files.zemax(), "a.bsdf").measurements[0]
    other = [replace(scan, phi_deg=2.0 * scan.incident_phi_deg - scan.phi_deg) for scan in half.scans]
    (data,) = zemax.write(Measurement("paint", tuple(other))).values()
    assert b"Symmetry\tASymmetrical\n" in data
    back = zemax.read(data, "paint.bsdf").measurements[0]
    for one, both in zip(half.scans, back.scans, strict=True):
        away, nearest = KDTree(both.outgoing).query(one.outgoing)
        assert away.max() < 1e-6
        np.testing.assert_allclose(both.values[nearest], one.values, atol=1e-6)


def test_files_are_written_whole_with_what_they_leave_out(tmp_path):
    scans = (lambertian(40.0), lambertian(40.0, scatter="reflection"), lambertian(40.0, purpose="dark"))
    scans = (replace(scans[0], standard_errors=0.1 * scans[0].values), *scans[1:])
    done = measure.write(Measurement("film", scans), tmp_path / "set", "lighttools")
    assert sorted(path.name for path in done.paths) == ["film.bsdf", "film_exterior_RTfile.txt"]
    assert [note.split(" left out")[0] for note in done.notes] == [
        "standard errors of 1 scan",
        "the beam or the dark of 1 scan",
    ]
    back = measure.read(tmp_path / "set")
    assert [(m.sample, len(m.scans)) for m in back.measurements] == [("film", 2)]
    assert len(back.sphere_values) == 2
    with pytest.raises(ClerestoryError, match="not a finite number"):
        measure.write(Measurement("film", (replace(scans[1], values=np.nan * scans[1].values),)), tmp_path, "zemax")


def test_half_of_a_symmetric_table_is_mirrored_for_lighttools():
    half = zemax.read(files.zemax(), "a.bsdf").measurements[0]
    data = lighttools.write(half)["paint.bsdf"]
    whole = lighttools.read(data, "paint.bsdf").measurements[0].scans[1]
    assert whole.conditions["symmetry"] == "Asymmetric"
    tree = KDTree(whole.outgoing)
    away, nearest = tree.query(whole.outgoing * np.array([-1.0, 1.0, 1.0]))
    assert away.max() < 1e-6
    np.testing.assert_allclose(whole.values[nearest], whole.values, rtol=1e-5)
    away, nearest = tree.query(half.scans[1].outgoing)
    np.testing.assert_allclose(whole.values[nearest[away < 1e-6]], half.scans[1].values[away < 1e-6], rtol=1e-6)
    assert (away < 1e-6).any()
