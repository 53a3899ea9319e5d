"""Data that were calibrated have a sphere's integrals, and keep what they should keep."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory import Basis, Bsdf, ClerestoryError, Model, UnsupportedError
from clerestory.directions import angles, direction
from clerestory.measure import SphereValues
from clerestory.measure.calibrate import calibrated, calibrated_scans, of_model, of_scans
from clerestory.measure.calibrate.picture import picture
from clerestory.measure.delaunay import surface
from synthetic_lab import diffuse_and_peak, series, twill

KLEMS = Basis.named("klems-full")
THETAS = (0.0, 8.0, 20.0, 40.0, 60.0, 75.0)


def matrix(level=0.3, beam=0.2, seed=1):
    """A reciprocal table: f(i, o) symmetric in the two patches' directions, with a beam."""
    rng = np.random.default_rng(seed)
    a = rng.uniform(0.5, 1.5, (145, 145))
    q = KLEMS.reversed
    a = 0.5 * (a + a[np.ix_(q, q)].T)
    values = level / np.pi * a
    values[np.arange(145), np.arange(145)] += beam / KLEMS.projected_solid_angles
    return values


def film():
    front = Model.matrix(matrix(), KLEMS)
    reflection = Model.matrix(matrix(0.1, 0.05, 2), KLEMS)
    return Bsdf.from_models(
        {
            ("exterior", "transmission"): front,
            ("interior", "transmission"): front.reciprocal(),
            ("exterior", "reflection"): reflection,
        }
    )


def sphere(theta, value, side="exterior", scatter="transmission", collected="hemispherical", phi=90.0, **conditions):
    return SphereValues(
        "film",
        side,
        scatter,
        theta,
        np.array([value]),
        collected,
        bands=("visible",),
        phi_deg=phi,
        conditions=conditions,
    )


def curve(factor=lambda theta: 0.9 - 0.002 * theta, bsdf=None, side="exterior", scatter="transmission"):
    data = bsdf or film()
    return [
        sphere(t, factor(t) * float(data.integrate(direction(t, 90.0, side=side), scatter)), side, scatter)
        for t in THETAS
    ]


def totals(bsdf, side="exterior", scatter="transmission"):
    return bsdf.integrate(KLEMS.incident_centres(side), scatter)


@pytest.mark.parametrize("scaling", ["all", "scattered", "peak"])
def test_a_matrix_has_the_measured_values(scaling):
    given = curve()
    done = calibrated(film(), given, scaling=scaling)
    for v in given:
        got = float(done.bsdf.integrate(direction(v.theta_deg, 90.0, side="exterior"), "transmission"))
        assert got == pytest.approx(v.values[0], abs=1e-6)
    assert done.after.rms < 1e-6 < done.before.rms
    # Other components stay as they are.
    np.testing.assert_array_equal(done.bsdf.models["visible"]["exterior", "reflection"].values, matrix(0.1, 0.05, 2))


def test_the_spheres_uncertainty_is_that_of_the_totals():
    shape = 0.03 * matrix()
    uncertain = film().models["visible"]["exterior", "transmission"].with_standard_errors(shape)
    data = film().with_models({"visible": {("exterior", "transmission"): uncertain}})
    given = [replace(v, standard_errors=0.02 * v.values) for v in curve(lambda theta: 0.5)]
    made = calibrated(data, given).bsdf.models["visible"]["exterior", "transmission"]
    np.testing.assert_allclose(made.total_standard_errors, 0.02 * totals(calibrated(data, given).bsdf), rtol=1e-6)
    np.testing.assert_allclose(made.standard_errors, np.hypot(0.03, 0.02) * 0.5 * matrix(), rtol=1e-6)
    # Without errors of the sphere, those of the data are scaled with them.
    plain = calibrated(data, curve(lambda theta: 0.5)).bsdf.models["visible"]["exterior", "transmission"]
    assert plain.total_standard_errors is None
    np.testing.assert_allclose(plain.standard_errors, 0.5 * shape, rtol=1e-6)


def test_between_measured_angles_factors_are_interpolated():
    done = calibrated(film(), curve())
    ratio = totals(done.bsdf) / totals(film())
    theta, _ = angles(KLEMS.incident_centres("exterior"))
    np.testing.assert_allclose(ratio[theta == 50.0], 0.8, atol=1e-12)
    np.testing.assert_allclose(ratio[theta == 30.0], 0.84, atol=1e-12)
    np.testing.assert_allclose(ratio[theta > 80.0], 0.75, atol=1e-12)  # constant beyond the last


def test_azimuths_have_factors_of_their_own():
    data = film()
    given = [sphere(0.0, float(data.integrate(direction(0.0, 0.0), "transmission")))]
    for phi, factor in ((90.0, 0.8), (270.0, 1.2)):
        value = float(data.integrate(direction(40.0, phi), "transmission"))
        given.append(sphere(40.0, factor * value, phi=phi))
    done = calibrated(data, given)
    for phi, factor in ((90.0, 0.8), (180.0, 1.0), (270.0, 1.2), (0.0, 1.0)):
        toward = direction(40.0, phi)
        ratio = float(done.bsdf.integrate(toward, "transmission") / data.integrate(toward, "transmission"))
        assert ratio == pytest.approx(factor, abs=1e-9)


def test_the_part_that_is_kept_is_kept():
    values = film().models["visible"]["exterior", "transmission"].values
    scattered = (
        calibrated(film(), curve(), scaling="scattered").bsdf.models["visible"]["exterior", "transmission"].values
    )
    off = ~np.eye(145, dtype=bool)
    ratio = scattered / values
    assert all(np.ptp(ratio[off[:, k], k]) < 1e-9 for k in range(145))
    peak = calibrated(film(), curve(), scaling="peak").bsdf.models["visible"]["exterior", "transmission"].values
    np.testing.assert_allclose(peak[off], values[off], rtol=1e-12)


def test_peak_and_scattered_light_each_to_its_own():
    data = film()
    given = []
    for t in THETAS:
        toward = direction(t, 90.0)
        total = float(data.integrate(toward, "transmission"))
        given += [sphere(t, total * 0.9), sphere(t, total * 0.5, collected="diffuse")]
    done = calibrated(data, given, scaling="both")
    assert done.after.rms < 1e-6
    assert {f.part for f in done.factors} == {"peak", "scattered"}
    with pytest.raises(ClerestoryError, match="two of hemispherical"):
        calibrated(data, curve(), scaling="both")


def test_reversed_paths_stay_equal_with_both_sides():
    data = film()
    front, back = curve(lambda t: 0.9 - 0.001 * t), curve(lambda t: 0.9 - 0.001 * t, side="interior")
    plain = calibrated(data, [*front, *back])
    kept = calibrated(data, [*front, *back], reciprocal=True)
    held = kept.bsdf.models["visible"]
    breach = held["exterior", "transmission"].reciprocity_error(held["interior", "transmission"])
    assert breach < 1e-9
    loose = plain.bsdf.models["visible"]
    assert loose["exterior", "transmission"].reciprocity_error(loose["interior", "transmission"]) > 1e-3
    assert kept.after.rms < 1e-4
    for v in front:
        got = float(kept.bsdf.integrate(direction(v.theta_deg, 90.0), "transmission"))
        assert got == pytest.approx(v.values[0], abs=1e-6)


def test_reversed_paths_of_reflection_stay_equal():
    data = film()
    done = calibrated(data, curve(scatter="reflection"), reciprocal=True)
    model = done.bsdf.models["visible"]["exterior", "reflection"]
    assert model.reciprocity_error(model) < 1e-9
    assert done.after.rms < 1e-6


def test_one_side_alone_gives_the_other_by_its_reverse():
    done = calibrated(film(), curve(), reciprocal=True)
    held = done.bsdf.models["visible"]
    assert held["exterior", "transmission"].reciprocity_error(held["interior", "transmission"]) < 1e-12
    assert done.after.rms < 1e-9


def test_trees_and_beams():
    smooth = Bsdf.from_models(
        {("exterior", "transmission"): Model.sum([(1.0, Model.lambertian(0.3)), (1.0, Model.specular(0.4))])}
    )
    given = curve(lambda t: 0.9, bsdf=smooth)
    for scaling in ("all", "scattered", "peak"):
        assert calibrated(smooth, given, scaling=scaling).after.rms < 1e-6
    apart = KLEMS.outgoing_centres("interior")[:, None, :2] - KLEMS.outgoing_centres("interior")[None, :, :2]
    lobe = 0.05 + 0.4 * np.exp(-np.sum(apart**2, axis=-1) / 0.2)
    shape = Bsdf.from_models({("exterior", "transmission"): Model.matrix(lobe, KLEMS)})
    tree = shape.to_tree(resolution=4, samples=4)
    given = curve(lambda t: 0.9 - 0.001 * t, bsdf=tree)
    done = calibrated(tree, given)
    assert done.bsdf.models["visible"]["exterior", "transmission"].kind == "tensor tree"
    for row in done.after.rows:
        assert row.modelled == pytest.approx(row.measured, rel=0.002)
    with pytest.raises(UnsupportedError, match="klems-full"):
        calibrated(tree, given, reciprocal=True)


def test_spectra_are_weighed():
    data = Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.5)})
    waves = np.arange(300.0, 2501.0, 5.0)
    flat = SphereValues("s", "exterior", "transmission", 0.0, np.full(len(waves), 0.4), wavelength_nm=waves)
    assert of_model(data, [flat]).rows[0].measured == pytest.approx(0.4, abs=1e-12)
    narrow = SphereValues(
        "s", "exterior", "transmission", 0.0, np.full(20, 0.4), wavelength_nm=np.linspace(500, 600, 20)
    )
    with pytest.raises(ClerestoryError, match=r"holds .* % of visible light"):
        of_model(data, [narrow])


def test_identical_data_have_no_difference():
    found = of_model(film(), curve(lambda t: 1.0))
    assert found.rms == pytest.approx(0.0, abs=1e-12)
    assert all(row.difference == pytest.approx(0.0, abs=1e-12) for row in found.rows)


@pytest.mark.parametrize(
    ("conditions", "lost"),
    [
        ({"thickness_mm": "6", "port_mm": "25", "spot_mm": "15"}, True),
        ({"thickness_mm": "6", "port_mm": "100", "spot_mm": "25"}, False),
        ({"sphere_mm": "150"}, True),
        ({"sphere_mm": "620"}, False),
    ],
)
def test_light_lost_sideways(conditions, lost):
    value = 0.9 * float(film().integrate(direction(0.0, 0.0), "transmission"))
    found = of_model(film(), [sphere(0.0, value, **conditions)])
    assert any("sideways" in text for text in found.warnings) == lost
    clear = Bsdf.from_models({("exterior", "transmission"): Model.specular(0.9)})
    assert not of_model(clear, [sphere(0.0, 0.5, **conditions)]).warnings


def test_what_cannot_be_is_said():
    assert any("outside of 0.5 to 2" in text for text in calibrated(film(), curve(lambda t: 0.3)).warnings)
    with pytest.raises(ClerestoryError, match="0 to 1"):
        calibrated(film(), [sphere(0.0, 45.0)])
    dark = Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.0)})
    with pytest.raises(ClerestoryError, match="no light"):
        calibrated(dark, [sphere(0.0, 0.3)])
    with pytest.raises(ClerestoryError, match="more light than was measured"):
        calibrated(film(), curve(lambda t: 0.2), scaling="peak")
    with pytest.raises(ClerestoryError, match="no value"):
        calibrated(film(), [sphere(0.0, 0.3, side="interior", scatter="reflection")])
    full = Bsdf.from_models(
        {
            ("exterior", "transmission"): Model.matrix(matrix(0.3, 0.0), KLEMS),
            ("exterior", "reflection"): Model.matrix(matrix(0.5, 0.0, 2), KLEMS),
        }
    )
    assert any("leaves" in text for text in calibrated(full, curve(lambda t: 1.9, bsdf=full)).warnings)


def test_scans_have_the_measured_values():
    measurement = series(diffuse_and_peak, thetas_deg=(0.0, 8.0, 30.0, 60.0), phis_deg=(90.0,))
    factor = {0.0: 0.98, 8.0: 0.98, 60.0: 0.96}
    given = []
    for s in measurement.scans:
        if s.incident_theta_deg in factor:
            total = float(surface(s).integrate().total[0])
            given.append(sphere(s.incident_theta_deg, factor[s.incident_theta_deg] * total))
    for scaling in ("all", "scattered", "peak"):
        done = calibrated_scans(measurement, given, scaling=scaling, peak_deg=12.0)
        assert done.after.rms < 1e-9 < done.before.rms
    between = calibrated_scans(measurement, given).measurement.scans[2]
    expected = np.interp(30.0, [8.0, 60.0], [0.98, 0.96])
    np.testing.assert_allclose(between.values / measurement.scans[2].values, expected)
    assert of_scans(measurement, given).rms > 0.02
    far = [replace(v, theta_deg=45.0) for v in given[:1]]
    with pytest.raises(ClerestoryError, match="no value"):
        calibrated_scans(measurement, far)


def test_pictures():
    one = calibrated(film(), curve())
    figure = picture(one.before, one.after)
    assert len(figure.axes) == 2
    data = film()
    around = [
        sphere(40.0, float(data.integrate(direction(40.0, phi), "transmission")), phi=phi) for phi in (0.0, 90.0, 180.0)
    ]
    assert len(picture(of_model(data, around)).axes) == 6


def test_twill_is_calibrated_by_its_azimuths():
    measurement = series(twill, thetas_deg=(8.0, 40.0), phis_deg=(0.0, 90.0))
    given = [
        sphere(s.incident_theta_deg, f * float(surface(s).integrate().total[0]), phi=s.incident_phi_deg)
        for s, f in zip(measurement.scans, (0.9, 1.1, 0.8, 1.2), strict=True)
    ]
    done = calibrated_scans(measurement, given)
    assert done.after.rms < 1e-9
