"""Each step of a preparation, on scans whose truth is known."""

import json
from dataclasses import replace

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.directions import angles, direction
from clerestory.integrals import continued
from clerestory.measure import Measurement
from clerestory.measure.delaunay import surface
from clerestory.measure.prepare import CONVENTIONS, Sector, Settings, prepare
from clerestory.measure.prepare.channels import as_bands, side_by_side
from clerestory.measure.prepare.convention import Convention, check_peaks, converted
from clerestory.measure.prepare.limits import within_reach
from clerestory.measure.prepare.noise import noise, with_errors
from clerestory.measure.prepare.positions import averaged, inhomogeneity
from clerestory.measure.prepare.reciprocity import filled, missing_angles
from clerestory.measure.prepare.reference import as_bsdf, without_dark
from clerestory.measure.prepare.signature import drifts, signatures
from clerestory.measure.prepare.spectra import weights
from clerestory.measure.prepare.symmetry import chosen, completed, scores
from clerestory.measure.prepare.together import combined
from synthetic_lab import about, diffuse_and_peak, hemisphere, prism, scan, series, twill, venetian

SIGMA = 0.6


def beam(power=1.0, when=None, shift_deg=0.0, attenuation=None, radius=4.0):
    """A Gaussian beam along the normal: ∫ dΩ = 2π σ² times its peak."""
    theta, phi = about(np.array([0.0, 0.0, 1.0]), "interior", radius, 0.2)
    x = theta[:, None] * np.column_stack([np.cos(np.radians(phi)), np.sin(np.radians(phi))])
    values = power * np.exp(-0.5 * ((x - [shift_deg, 0.0]) ** 2).sum(axis=1) / SIGMA**2)
    conditions = {"date": when} if when else {}
    if attenuation:
        conditions["attenuation"] = attenuation
    base = scan(diffuse_and_peak, 0.0, 0.0, points=(theta, phi))
    return replace(base, values=values[:, None], quantity="signal", purpose="beam", conditions=conditions)


INTEGRAL = 2.0 * np.pi * np.radians(SIGMA) ** 2


def signal(theta_deg=30.0, gain=1.0, dark=0.0, when=None):
    truth = scan(diffuse_and_peak, theta_deg, 90.0)
    values = gain * INTEGRAL * truth.values * np.cos(np.radians(truth.theta_deg))[:, None] + dark
    return replace(truth, values=values, quantity="signal", conditions={"date": when} if when else {})


def dark(level, when=None):
    theta = np.zeros(20)
    base = scan(diffuse_and_peak, 0.0, 0.0, points=(theta, theta))
    return replace(
        base,
        values=np.full((20, 1), level),
        quantity="signal",
        purpose="dark",
        conditions={"date": when} if when else {},
    )


def test_signal_to_bsdf():
    raw = Measurement("s", (signal(dark=0.01), replace(beam(), values=beam().values + 0.01), dark(0.01)))
    kept = [s.values.copy() for s in raw.scans]
    done, step = as_bsdf(without_dark(raw)[0])
    np.testing.assert_allclose(done.of()[0].values, scan(diffuse_and_peak, 30.0, 90.0).values, rtol=2e-3)
    assert done.of()[0].quantity == "bsdf"
    assert step.figures["scans of signal"] == 1
    for s, values in zip(raw.scans, kept, strict=True):  # raw values are never changed
        np.testing.assert_array_equal(s.values, values)


def test_beam_of_one_point_and_attenuation():
    # A detector that takes in the whole beam: P_i at its centre, Ω from its angle.
    cone = 3.0
    omega = 2.0 * np.pi * (1.0 - np.cos(np.radians(0.5 * cone)))
    one = replace(beam(), theta_deg=np.zeros(1), phi_deg=np.zeros(1), values=np.array([[INTEGRAL / omega]]))
    done, _ = as_bsdf(Measurement("s", (signal(), one)), detector_cone_deg=cone)
    truth = scan(diffuse_and_peak, 30.0, 90.0).values
    np.testing.assert_allclose(done.of()[0].values, truth, rtol=1e-9)
    with pytest.raises(ClerestoryError, match="profile"):
        as_bsdf(Measurement("s", (signal(), one)))
    weak, _ = as_bsdf(Measurement("s", (signal(), beam(1e-3, attenuation="1000"))))
    np.testing.assert_allclose(weak.of()[0].values, truth, rtol=2e-3)
    with pytest.raises(ClerestoryError, match="none of the beam"):
        as_bsdf(Measurement("s", (signal(),)))


def test_drift_is_told_and_corrected_in_time():
    day = "2026-03-01T10:{:02d}:00"
    scans = (
        beam(1.0, day.format(0)),
        signal(30.0, 1.02, 0.011, day.format(20)),
        signal(50.0, 1.05, 0.0125, day.format(50)),
        beam(1.06, day.format(59)),
        dark(0.01, day.format(0)),
        dark(0.01295, day.format(59)),
    )
    scans = (
        replace(scans[0], values=scans[0].values + 0.01),
        *scans[1:3],
        replace(scans[3], values=scans[3].values + 0.01295),
        *scans[4:],
    )
    raw, _ = without_dark(Measurement("s", scans))
    found = drifts(raw)[0]
    assert found.power == pytest.approx(0.06, abs=1e-6)
    assert found.seconds == 59 * 60
    done, step = as_bsdf(raw)
    for s, theta in zip(done.of(), (30.0, 50.0), strict=True):
        np.testing.assert_allclose(s.values, scan(diffuse_and_peak, theta, 90.0).values, rtol=3e-3)
    assert step.figures["corrected in time"]
    assert any("+6.0 %" in text for text in step.warnings)
    assert drifts(Measurement("s", (beam(), beam(shift_deg=0.25))))[0].shift_deg == pytest.approx(0.25, abs=0.02)


def test_signature_of_a_gaussian_beam():
    found = signatures(beam())[0]
    assert found.integral == pytest.approx(INTEGRAL, rel=2e-3)
    full, one, faint = found.widths_deg
    assert full == pytest.approx(SIGMA * 2.0 * np.sqrt(2.0 * np.log(2.0)), rel=0.03)
    assert one == pytest.approx(SIGMA * 2.0 * np.sqrt(2.0 * np.log(100.0)), rel=0.03)
    assert faint == pytest.approx(SIGMA * 2.0 * np.sqrt(2.0 * np.log(1e4)), rel=0.03)
    assert found.whole
    cut = signatures(beam(radius=0.8))[0]
    assert not cut.whole
    assert cut.widths_deg[2] is None
    # A line through the beam gives the same light as the square.
    line = beam()
    kept = np.abs(np.sin(np.radians(line.phi_deg)) * line.theta_deg) < 0.01
    line = replace(line, theta_deg=line.theta_deg[kept], phi_deg=line.phi_deg[kept], values=line.values[kept])
    assert signatures(line)[0].integral == pytest.approx(INTEGRAL, rel=0.02)


@pytest.mark.parametrize("name", CONVENTIONS)
def test_blind_sample_in_a_laboratory_of_another_convention(name):
    """What a laboratory writes of a sample that is like no mirror image of itself comes back as it was."""
    convention = CONVENTIONS[name]
    truth = series(prism, thetas_deg=(30.0, 60.0), phis_deg=(70.0, 200.0))

    def written(phi):
        tries = np.arange(0.0, 360.0, 0.5)
        return np.array(
            [tries[np.argmin(np.abs((convention.azimuth(tries) - p + 180.0) % 360.0 - 180.0))] for p in phi]
        )

    lab = []
    for s in truth.scans:
        incident = s.incident_phi_deg + (180.0 if convention.incident == "travel" else 0.0)
        lab.append(
            replace(s, incident_phi_deg=float(written([incident % 360.0])[0]), phi_deg=written(s.phi_deg % 360.0))
        )
    back, _ = converted(Measurement("s", tuple(lab)), convention)
    for found, expected in zip(back.scans, truth.scans, strict=True):
        np.testing.assert_allclose(found.incident, expected.incident, atol=1e-9)
        np.testing.assert_allclose(found.outgoing, expected.outgoing, atol=5e-3)


def test_presets_in_words():
    # Counter-clockwise from up as seen from outside is to the left there, which is the right in the room.
    assert CONVENTIONS["hslu"].azimuth(0.0) == 90.0
    assert CONVENTIONS["hslu"].azimuth(90.0) == 0.0
    sun = replace(scan(diffuse_and_peak, 30.0, 270.0))
    above, _ = converted(Measurement("s", (sun,)), CONVENTIONS["window"])
    assert above.scans[0].incident_phi_deg == 90.0
    turned, _ = converted(Measurement("s", (sun,)), Convention("the other side", flipped=True))
    assert turned.scans[0].incident_side == "interior"


def test_self_check_by_the_peak():
    good = series(diffuse_and_peak, thetas_deg=(30.0, 60.0), phis_deg=(20.0, 110.0))
    assert check_peaks(good.scans).better is None
    wrong = [replace(s, incident_phi_deg=s.incident_phi_deg + 180.0) for s in good.scans]
    assert "180°" in check_peaks(wrong).better
    assert check_peaks(series(prism, thetas_deg=(30.0, 60.0)).scans).better is None


def test_coarse_and_fine():
    def sharp(i, o, s):
        return diffuse_and_peak(i, o, s, peak=40.0, width_deg=1.0)

    coarse = scan(sharp, 40.0, 90.0)
    toward = continued(coarse.incident, "transmission")
    fine = scan(sharp, 40.0, 90.0, points=about(toward, "interior", 7.0, 0.25))
    exact = 0.3 + 40.0 * 2.0 * np.pi * np.radians(1.0) ** 2 * np.cos(np.radians(40.0))
    whole, step = combined(Measurement("s", (fine, coarse)))
    assert len(whole.of()) == 1
    assert float(surface(whole.of()[0]).integrate().total[0]) == pytest.approx(exact, rel=0.01)
    assert abs(float(surface(coarse).integrate().total[0]) - exact) > 0.05 * exact
    assert step.figures["coarse points left out"] > 0
    high = replace(fine, values=1.3 * fine.values)
    _, step = combined(Measurement("s", (coarse, high)))
    assert next(iter(step.figures["fine over coarse"].values())) == pytest.approx(1.3, rel=0.02)
    assert "1.30 times" in step.warnings[0]
    scaled, _ = combined(Measurement("s", (coarse, high)), level="coarse")
    assert float(surface(scaled.of()[0]).integrate().total[0]) == pytest.approx(exact, rel=0.02)


def test_limits():
    reflecting = scan(diffuse_and_peak, 40.0, 90.0, scatter="reflection", points=hemisphere(2.5, 90.0))
    done, step = within_reach(
        Measurement("s", (reflecting,)),
        grazing_deg=80.0,
        shadow_deg=5.0,
        unreachable=(Sector("exterior", 50.0, 90.0, 350.0, 10.0),),
    )
    left = done.scans[0]
    assert left.theta_deg.max() <= 80.0
    assert (left.outgoing @ left.incident).max() < np.cos(np.radians(5.0))
    phi = (left.phi_deg + 180.0) % 360.0 - 180.0
    assert not ((left.theta_deg >= 50.0) & (np.abs(phi) < 10.0)).any()
    assert sum(step.figures.values()) == len(reflecting) - len(left)
    for theta, limit in ((40.0, 75.0), (82.0, 82.0), (88.0, 85.0)):
        one = Measurement("s", (scan(diffuse_and_peak, theta, 90.0, points=hemisphere(5.0, 90.0)),))
        assert within_reach(one)[1].settings["grazing_deg"] == limit
    with pytest.raises(ClerestoryError, match="nothing is left"):
        within_reach(Measurement("s", (reflecting,)), grazing_deg=1e-6, unreachable=(Sector("exterior", 0, 90, 0, 0),))


def test_noise_is_estimated_and_integrals_stay_unbiased():
    def black(i, o, s):
        return np.zeros(len(o))

    raw = [scan(black, 30.0, 90.0, noise_dsf=0.01, seed=k, points=hemisphere(4.0)) for k in range(20)]
    sigma = np.mean([noise(s, "visible") for s in raw])
    assert sigma == pytest.approx(0.01, rel=0.05)
    lit = scan(diffuse_and_peak, 30.0, 90.0, noise_dsf=0.01, points=hemisphere(3.0))
    assert noise(lit, "visible") == pytest.approx(0.01, rel=0.35)  # no negative values: from the neighbours
    done, step = with_errors(Measurement("s", tuple(raw)))
    assert step.figures["negative"] == sum(int((s.values < 0.0).sum()) for s in raw)
    totals = [float(surface(s).integrate().total[0]) for s in done.of()]
    clipped = [float(surface(replace(s, values=np.maximum(s.values, 0.0))).integrate().total[0]) for s in raw]
    assert abs(np.mean(totals)) < 3.0 * np.std(totals) / np.sqrt(len(totals))
    assert np.mean(clipped) > 10.0 * abs(np.mean(totals))
    errors = done.of()[0].standard_errors[:, 0] * np.cos(np.radians(done.of()[0].theta_deg))
    np.testing.assert_allclose(errors, noise(raw[0], "visible"), rtol=1e-9)
    mostly = replace(lit, values=lit.values - 0.5)
    assert "negative" in with_errors(Measurement("s", (mostly,)))[1].warnings[0]


def test_weights_of_bands():
    found = weights(["VIS", "NIR"], "solar", ranges_nm={"VIS": (380.0, 780.0), "NIR": (780.0, 2500.0)})
    assert sum(found.shares.values()) == pytest.approx(1.0, abs=1e-12)
    assert 0.45 < found.shares["VIS"] < 0.6
    narrow = weights([f"{w} nm" for w in range(400, 760, 50)], "visible")
    assert sum(narrow.shares.values()) == pytest.approx(1.0, abs=1e-12)
    assert max(narrow.shares, key=narrow.shares.get) == "550 nm"
    filters = weights([f"{w}-{w + 50} nm" for w in range(350, 1000, 50)], "solar", standard="iso9050")
    assert sum(filters.shares.values()) == pytest.approx(1.0, abs=1e-12)
    assert filters.outside > 0.1
    with pytest.raises(ClerestoryError, match="VIS=380-780"):
        weights(["VIS"], "solar")


def test_detectors_to_bands():
    vis = replace(scan(diffuse_and_peak, 30.0, 90.0), channels=("VIS",))
    nir = replace(scan(diffuse_and_peak, 30.0, 90.0, points=hemisphere(4.0)), channels=("NIR",))
    nir = replace(nir, values=2.0 * nir.values)
    both, step = side_by_side(Measurement("s", (vis, nir)))
    assert len(both.of()) == 1
    assert step.figures["interpolated"] == 1
    done, _ = as_bands(both, {"visible": {"VIS": 1.0}, "solar": {"VIS": 0.5, "NIR": 0.5}})
    assert done.of()[0].channels == ("visible", "solar")
    ratio = surface(done.of()[0]).integrate().total
    assert ratio[1] / ratio[0] == pytest.approx(1.5, rel=0.01)
    with pytest.raises(ClerestoryError, match=r"sum to 0\.9"):
        as_bands(both, {"solar": {"VIS": 0.5, "NIR": 0.4}})
    with pytest.raises(ClerestoryError, match="none of the bands"):
        as_bands(Measurement("s", (vis,)), {"solar": {"UV": 1.0}})


def test_positions():
    scans = [
        replace(s, values=s.values * f, conditions={"position": str(k)})
        for k, f in enumerate((1.0, 1.02, 0.98, 1.0))
        for s in [scan(diffuse_and_peak, 30.0, 90.0)]
    ]
    done, step = averaged(Measurement("s", tuple(scans)))
    assert len(done.of()) == 1
    np.testing.assert_allclose(done.of()[0].values, scans[0].values, rtol=1e-12)
    expected = np.std([1.0, 1.02, 0.98, 1.0], ddof=1) / 2.0
    np.testing.assert_allclose(done.of()[0].standard_errors / done.of()[0].values, expected, rtol=1e-9)
    assert not step.warnings
    uneven = [replace(s, values=s.values * f) for s, f in zip(scans, (1.0, 1.3, 1.0, 0.8), strict=True)]
    assert any("inhomogeneous" in text for text in averaged(Measurement("s", tuple(uneven)))[1].warnings)


def test_an_outlier_among_samples_is_found_and_a_representative_one_named():
    rng = np.random.default_rng(3)
    spectra = 0.3 + 0.05 * np.sin(np.linspace(0.0, 6.0, 50)) + 0.002 * rng.standard_normal((7, 1))
    spectra[4] += 0.05
    found = inhomogeneity(spectra)
    assert found.outliers == (4,)
    assert found.representative != 4
    assert not inhomogeneity(np.delete(spectra, 4, axis=0)).outliers
    with pytest.raises(ClerestoryError, match="several samples"):
        inhomogeneity(spectra[:1])


AROUND = (0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0)


@pytest.mark.parametrize(
    ("sample", "name"),
    [(diffuse_and_peak, "isotropic"), (twill, "rotational"), (venetian, "left-right"), (prism, "none")],
)
def test_symmetry_is_told(sample, name):
    measurement = series(sample, thetas_deg=(0.0, 40.0), phis_deg=AROUND, noise_dsf=0.002, points=hemisphere(4.0))
    found = scores(measurement.scans)
    assert chosen(found)[0] == name


def test_a_slight_asymmetry_is_told_from_noise():
    def lopsided(i, o, s, amount=0.0):
        return diffuse_and_peak(i, o, s) * np.exp(amount * np.sign(o[..., 0]) * 0.5)

    def holds(amount):
        made = series(
            lambda i, o, s: lopsided(i, o, s, amount), thetas_deg=(40.0,), phis_deg=(0.0, 180.0), noise_dsf=0.002
        )
        return scores(made.scans)["left-right"].holds

    assert holds(0.02)
    assert not holds(0.25)


@pytest.mark.parametrize(
    ("sample", "symmetry", "measured"),
    [
        (twill, "rotational", (0.0, 45.0, 90.0, 135.0)),
        (venetian, "left-right", (270.0, 315.0, 0.0, 45.0, 90.0)),
        (diffuse_and_peak, "quadrilateral", (0.0, 45.0, 90.0)),
        (diffuse_and_peak, "isotropic", (0.0,)),
    ],
)
def test_completion_gives_what_would_have_been_measured(sample, symmetry, measured):
    measurement = series(sample, thetas_deg=(40.0,), phis_deg=measured)
    done, step = completed(measurement, symmetry, isotropic_step_deg=45.0)
    assert {round(s.incident_phi_deg % 360.0, 3) % 360.0 for s in done.of()} == set(AROUND)
    for s in done.of():
        truth = sample(s.incident, s.outgoing, "transmission")
        np.testing.assert_allclose(s.values[:, 0], truth, rtol=1e-9, atol=1e-12)
        assert ("made" in s.conditions) == (round(s.incident_phi_deg, 3) % 360.0 not in measured)
    assert step.figures["made"] == len(done.of()) - len(measured)


def test_a_stated_symmetry_that_does_not_hold_is_warned_of():
    measurement = series(venetian, thetas_deg=(40.0,), phis_deg=AROUND)
    _, step = completed(measurement, "quadrilateral")
    assert "does not hold" in step.warnings[0]
    assert "could be tested" in completed(series(twill, thetas_deg=(40.0,), phis_deg=(20.0,)))[1].words


def test_reversed_paths():
    def reciprocal(i, o, s):
        """Depends on the half of both directions' places alone, which swap and keep it."""
        off = (i + o)[..., :2]
        return 0.1 + 0.5 * np.exp(-2.0 * (off**2).sum(axis=-1)) + 0.1 * i[..., 1] * o[..., 1]

    measurement = series(
        reciprocal, thetas_deg=(8.0, 30.0, 50.0), phis_deg=AROUND, scatter="reflection", points=hemisphere(3.0)
    )
    done, step = filled(measurement, [("exterior", "reflection", 70.0, 90.0)])
    made = done.of()[-1]
    assert made.conditions["made"] == "reversed paths"
    assert len(made) == 24
    truth = reciprocal(direction(70.0, 90.0, side="exterior"), made.outgoing, "reflection")
    np.testing.assert_allclose(made.values[:, 0], truth, rtol=0.01)
    assert step.figures["points"]
    assert ("exterior", "reflection", 70.0, 90.0) in missing_angles(measurement)
    with pytest.raises(ClerestoryError, match="was measured"):
        filled(measurement, [("exterior", "reflection", 50.0, 90.0)])
    with pytest.raises(ClerestoryError, match="are needed"):
        filled(replace(measurement, scans=measurement.scans[:3]), [("exterior", "reflection", 70.0, 90.0)])
    passing = replace(measurement, scans=tuple(replace(s, scatter="transmission") for s in measurement.scans))
    assert all(side == "interior" for side, *_ in missing_angles(passing))


def test_all_steps_in_order_and_their_record():
    raw = Measurement("film", (signal(8.0, dark=0.01), signal(30.0, dark=0.01), beam(1.0), dark(0.01)))
    raw = replace(raw, scans=(*raw.scans[:2], replace(raw.scans[2], values=raw.scans[2].values + 0.01), raw.scans[3]))
    done = prepare(raw, Settings(symmetry="isotropic", relative_error=0.02))
    names = [step.name for step in done.steps]
    assert names == [
        "self-check",
        "dark signal",
        "BSDF",
        "together",
        "within reach",
        "positions",
        "noise",
        "symmetry",
    ]
    assert json.loads(json.dumps(done.record()))[2]["step"] == "BSDF"
    assert all(s.standard_errors is not None for s in done.measurement.of())
    for s in done.measurement.of():
        truth = diffuse_and_peak(s.incident, s.outgoing, "transmission")
        np.testing.assert_allclose(s.values[:, 0], truth, rtol=1e-3)
    with pytest.raises(ClerestoryError, match="no scan of the sample"):
        prepare(Measurement("film", (beam(),)))
    with pytest.raises(ClerestoryError, match="hslu"):
        prepare(raw, Settings(convention="lab"))


def test_angles_survive_the_moves():
    theta, _ = angles(scan(twill, 40.0, 10.0).outgoing)
    image = completed(series(twill, thetas_deg=(40.0,), phis_deg=(10.0,)), "rotational")[0].of()[1]
    np.testing.assert_allclose(image.theta_deg, theta, atol=1e-9)
