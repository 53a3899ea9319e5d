"""Panes against closed forms: Fresnel's equations, stacks of two and three, energy."""

import numpy as np
import pytest

from clerestory import Basis, Bsdf, ClerestoryError, FileFormatError, MissingDataError, Model
from clerestory.directions import direction
from clerestory.system import Glass, Glazing, Plate, Sheet, pane, read_glass
from clerestory.system.coating import clear_or_bronze, roos
from clerestory.system.plate import uncoated
from clerestory.system.shelf import glass
from clerestory.system.spectrum import standard
from clerestory.system.stack import stack

THETA = np.array([0.0, 17.0, 30.0, 50.0, 60.0, 70.0, 80.0, 89.0])


def plate(index: float = 1.52, alpha_d: float = 0.06) -> Plate:
    """A grey pane: exp(−alpha_d) passes along the normal at all wavelengths."""
    thickness, wavelength = 0.004, np.array([250.0, 2600.0])
    return Plate("pane", (Sheet(wavelength, index, alpha_d * wavelength * 1e-9 / (4 * np.pi * thickness), thickness),))


def by_hand(index: float, alpha_d: float) -> tuple[np.ndarray, np.ndarray]:
    """Transmittance and reflectance (2, m) in both polarisations."""
    cos = np.cos(np.radians(THETA))
    inner = np.sqrt(1 - np.sin(np.radians(THETA)) ** 2 / index**2)
    faces = [((cos - index * inner) / (cos + index * inner)) ** 2, ((index * cos - inner) / (index * cos + inner)) ** 2]
    a = np.exp(-alpha_d / inner)
    t = np.stack([a * (1 - r) ** 2 / (1 - (a * r) ** 2) for r in faces])
    return t, np.stack([r * (1 + a * tt) for r, tt in zip(faces, t, strict=True)])


def test_a_plate_is_fresnels():
    t, r = by_hand(1.52, 0.06)
    optics = plate().at(550.0, THETA)
    np.testing.assert_allclose(optics.transmittance[:, 0], t, atol=1e-12)
    np.testing.assert_allclose(optics.exterior[:, 0], r, atol=1e-12)
    np.testing.assert_allclose(optics.interior[:, 0], r, atol=1e-12)


def test_two_panes_are_the_closed_form_in_each_polarisation():
    t, r = by_hand(1.52, 0.06)
    u, s = by_hand(1.6, 0.2)
    optics = Glazing([plate(), plate(1.6, 0.2)]).at(550.0, THETA)
    kept = 1 - r * s
    np.testing.assert_allclose(optics.transmittance[:, 0], t * u / kept, atol=1e-12)
    np.testing.assert_allclose(optics.exterior[:, 0], r + t**2 * s / kept, atol=1e-12)
    first = (1 - t - r) * (1 + t * s / kept)
    np.testing.assert_allclose(optics.absorbed[0, 0, :, 0], first, atol=1e-12)


def test_three_equal_panes_are_the_closed_form():
    t, r = by_hand(1.52, 0.06)
    # T₃ = t³ / ((1 − r²)² − t² r²), from the geometric series of the outer panes about the middle one.
    expected = (t**3 / ((1 - r**2) ** 2 - (t * r) ** 2)).mean(axis=0)
    bsdf = Glazing([plate()] * 3).bsdf()
    found = bsdf.integrate(direction(THETA, 30.0), "transmission", part="direct")
    np.testing.assert_allclose(found, expected, atol=1e-6)
    assert bsdf.bands == ("visible", "solar", "nir")


def test_beams_of_panes_are_exact_peaks_and_a_diagonal():
    bsdf = Glazing([plate()]).bsdf()
    incident = direction(53.0, 200.0)
    (peak,) = bsdf.peaks(incident, "transmission")
    np.testing.assert_allclose(peak.outgoing, -incident, atol=1e-12)
    basis = Basis.named("klems-full")
    matrix = bsdf.to_matrix(basis, bands=["visible"]).models["visible"]["exterior", "transmission"].values
    assert np.count_nonzero(matrix) == len(basis)
    assert np.count_nonzero(np.diag(matrix)) == len(basis)


def test_energy_is_shared_out_to_the_last_bit():
    panes = [plate(), plate(1.7, 1.0), glass("clear", 0.006), plate(1.52, 0.0)]
    optics = Glazing(panes).at(np.linspace(300, 2500, 40), THETA)
    for side, reflected in enumerate((optics.exterior, optics.interior)):
        total = optics.transmittance + reflected + optics.absorbed[:, side].sum(axis=0)
        np.testing.assert_allclose(total, 1.0, atol=1e-12)


def test_turning_glazing_round_turns_its_panes_round():
    panes = [plate(), plate(1.7, 1.0), glass("clear", 0.006)]
    there = Glazing(panes).at(600.0, THETA)
    back = Glazing([p.flipped() for p in reversed(panes)]).at(600.0, THETA)
    np.testing.assert_allclose(back.transmittance, there.transmittance, atol=1e-12)
    np.testing.assert_allclose(back.exterior, there.interior, atol=1e-12)
    np.testing.assert_allclose(back.absorbed, there.absorbed[::-1, ::-1], atol=1e-12)


def test_a_laminate_of_one_material_is_a_thicker_plate():
    sheet = Sheet(550.0, 1.5, 3e-7, 0.003)
    laminate = Plate("laminate", (sheet, sheet)).at(550.0, THETA)
    thick = Plate("plate", (Sheet(550.0, 1.5, 3e-7, 0.006),)).at(550.0, THETA)
    np.testing.assert_allclose(laminate.transmittance, thick.transmittance, atol=1e-12)
    np.testing.assert_allclose(laminate.exterior, thick.exterior, atol=1e-12)


def test_index_and_absorption_follow_from_values_along_the_normal():
    t, r = (values.mean(axis=0)[:1] for values in by_hand(1.52, 0.06))
    index, internal = uncoated(t, r)
    assert index[0] == pytest.approx(1.52, abs=1e-9)
    assert internal[0] == pytest.approx(np.exp(-0.06), abs=1e-9)
    with pytest.raises(ClerestoryError, match="more than 1"):
        uncoated(np.array([0.9]), np.array([0.2]))


def test_roos_for_plain_glass():
    # Values of the model for one pane of category 4, computed from its equation.
    shape = roos(np.ones(1), np.zeros(1), np.zeros(1), np.array([30.0, 50, 60, 70, 80, 90]), 4.0).transmittance[0, 0]
    np.testing.assert_allclose(shape, [0.9925, 0.9588, 0.8944, 0.7462, 0.4586, 0.0], atol=1e-4)
    optics = roos(np.array([0.6]), np.array([0.1]), np.array([0.2]), THETA, 2.0)
    assert (optics.absorbed > -1e-12).all()
    with pytest.raises(ClerestoryError, match="1 to 10"):
        roos(np.ones(1), np.zeros(1), np.zeros(1), THETA, 11.0)


def test_coated_panes_start_as_measured_and_end_as_mirrors():
    optics = clear_or_bronze(np.array([0.8, 0.4]), np.array([0.1, 0.3]), np.array([0.05, 0.4]), np.array([0.0, 90.0]))
    np.testing.assert_allclose(optics.transmittance[0], [[0.8, 0.0], [0.4, 0.0]])
    np.testing.assert_allclose(optics.exterior[0], [[0.1, 1.0], [0.3, 1.0]])
    np.testing.assert_allclose(optics.interior[0], [[0.05, 1.0], [0.4, 1.0]])


def test_a_pane_by_spectra_is_the_core_s_pane():
    wavelengths = np.linspace(300, 2500, 12)
    t, r = (values.mean(axis=0)[0] for values in by_hand(1.52, 0.06))
    grey = Glass("grey", wavelengths, np.full(12, t), np.full(12, r), np.full(12, r))
    ours = Glazing([grey]).bsdf()
    core = pane(1.52, internal_transmittance=float(np.exp(-0.06)))
    towards = direction(THETA, 0.0)
    for scatter in ("transmission", "reflection"):
        np.testing.assert_allclose(ours.integrate(towards, scatter), core.integrate(towards, scatter), atol=1e-6)


def test_a_diffuser_behind_a_pane_is_the_closed_form():
    basis = Basis.named("klems-full")
    area = basis.projected_solid_angles / np.pi
    held = {
        (s, k): Model.lambertian(v)
        for s in ("exterior", "interior")
        for k, v in (("transmission", 0.3), ("reflection", 0.5))
    }
    glass_ = pane(1.52, internal_transmittance=0.95)
    found = stack([glass_, Bsdf.from_models(held)], basis).bsdf
    centres = basis.incident_centres("exterior")
    t, r = (glass_.integrate(centres, k) for k in ("transmission", "reflection"))
    # Light goes to and fro between the diffuser and the pane's diffuse reflectance on these patches.
    series = 1 - 0.5 * (area @ r)
    np.testing.assert_allclose(found.integrate(centres, "transmission"), 0.3 * t / series, atol=1e-12)


def test_spectra_of_the_standards():
    for name in ("en410", "iso9050", "nfrc300"):
        norm = standard(name)
        for band in norm.bands.values():
            assert band.weights.sum() == pytest.approx(1.0, abs=1e-12)
        assert 0.45 < norm.visible_share < 0.6
        assert norm.bands["nir"].wavelength_nm[0] > 780.0
    with pytest.raises(ClerestoryError, match="nfrc300"):
        standard("din")


def test_spectra_agree_with_the_published_tables(sample_data):
    folder = sample_data / "glazing/standards"

    def column(name: str) -> np.ndarray:
        rows = (line.split() for line in (folder / name).read_text().splitlines())
        return np.array([row[:2] for row in rows if row and row[0][0].isdigit()], dtype=float)

    sun = column("ASTM_E891_Table_1_Direct_AM1_5.ssp")
    sun = sun[sun[:, 0] <= 2.5]
    made = standard("nfrc300").bands["solar"]
    values = np.sin(made.wavelength_nm / 200.0) + 1.0
    weights = np.interp(sun[:, 0] * 1000, made.wavelength_nm, values)
    expected = np.trapezoid(sun[:, 1] * weights, sun[:, 0]) / np.trapezoid(sun[:, 1], sun[:, 0])
    assert made.mean(values) == pytest.approx(expected, abs=1e-9)
    table = column("prEN410_Table_2_AM1_0_divdL.ssp.txt")
    solar = standard("en410").bands["solar"]
    density = np.interp(solar.wavelength_nm, table[:, 0], table[:, 1])
    widths = np.where(solar.wavelength_nm < 800, 20.0, np.where(solar.wavelength_nm <= 2000, 50.0, 100.0))
    inside = ~np.isin(solar.wavelength_nm, (800, 2050, 2100, 2500))  # where the steps of the table change
    np.testing.assert_allclose((density * widths)[inside], solar.weights[inside], rtol=0.02, atol=2e-4)


def test_what_is_wrong_with_a_pane_is_said(tmp_path):
    waves = np.array([400.0, 700.0])
    with pytest.raises(ClerestoryError, match=r"'x' sends out 120.0 % .* 700 nm"):
        Glass("x", waves, np.array([0.5, 0.9]), np.array([0.1, 0.3]), np.array([0.1, 0.1]))
    with pytest.raises(ClerestoryError, match="do not rise"):
        Glass("x", waves[::-1], np.zeros(2), np.zeros(2), np.zeros(2))
    with pytest.raises(ClerestoryError, match="known: clear"):
        glass("opal", 0.004)
    dark = Glass("dark", np.array([900.0, 1000.0]), np.zeros(2), np.zeros(2), np.zeros(2))
    with pytest.raises(MissingDataError, match=r"layer 1 \(dark\): 900 to 1000 nm"):
        Glazing([dark]).curves(0.0)
    for text, message in (
        ("", "empty"),
        ("{ Thickness } 3\n0.3 0.1 0.2 0.2\n", "name no unit of wavelengths"),
        ("{ Units } SI Microns\n0.3 0.1 0.2\n", "line 2: 3 numbers instead of 4"),
        ("{ Units } SI Microns\n0.3 0.1 0.2 x\n", "line 2: .*'x', not a number"),
        ("{ Units } SI Microns\n0.3 0.1 0.2 0.2\n0.3 0.1 0.2 0.2\n", "line 3: wavelengths do not rise"),
        ('{"type": "glazing"', "line 1: no JSON"),
        ('{"measured_data": {}, "spectral_data": {"spectral_data": []}}', "no spectra along the normal"),
        (
            '{"name": "p", "measured_data": {}, "spectral_data": {"spectral_data": '
            '[{"wavelength": 0.3, "T": 0.1, "Rf": 0.1}]}}',
            "Rb of p at 300 nm is missing",
        ),
        ('{"type": "shading", "measured_data": {}}', "not a pane"),
        ("wavelength_nm,T,Rf\n300,0,0\n", "no column Rb"),
        ("lambda,T,Rf,Rb\n300,0,0,0\n", "head it wavelength_nm"),
        ("wavelength_nm,T,Rf,Rb\n300,0.9,0.2,0.1\n", "sends out 110.0 %"),
    ):
        path = tmp_path / "pane.dat"
        path.write_text(text)
        with pytest.raises((FileFormatError, MissingDataError), match=message) as caught:
            read_glass(path)
        assert str(caught.value).startswith(f"{path}: ")


def test_csv_in_and_out(tmp_path):
    path = tmp_path / "pane.csv"
    path.write_text("# a pane\nwavelength_um;T;Rf;Rb\n0.3;0.1;0.05;0.06\n2.6;0.5;0.05;0.06\n")
    made = read_glass(path)
    assert made.wavelength_nm.tolist() == [300.0, 2600.0]
    lines = Glazing([made, made]).csv().splitlines()
    assert lines[0].endswith("absorptance_1,absorptance_2")
    assert len(lines) == 1 + 3 * 19
    assert lines[1].startswith("visible,0,")
