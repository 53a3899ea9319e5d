"""Heat through windows beside published values and energy's conservation."""

import csv
import math

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.thermal import (
    CONDITIONS,
    Conditions,
    Gap,
    Gas,
    Openings,
    ThermalLayer,
    balance,
    en410,
    en673,
    en_iso_52022,
    solar_gain,
    u_value,
)
from clerestory.thermal.convection import nusselt
from clerestory.thermal.gains import inward_fractions
from clerestory.thermal.layer import front_of_cloth, front_of_slats, permeability_of_slats
from clerestory.thermal.network import SIGMA
from samples import ABSENT, sample_root

# Generic clear glass of 3 mm (CLEAR_3 of the IGDB); U, SHGC and temperatures of it by pywincalc 3.3.1 with NFRC's
# climates, upright, 1 m by 1 m: found once and kept here.
CLEAR = ThermalLayer("clear", 0.003048, 1.0, 0.84, 0.84)
AIR, ARGON = Gap(0.0127), Gap(0.0127, Gas({"argon": 0.9, "air": 0.1}))


@pytest.mark.parametrize(
    ("panes", "gaps", "u", "shgc", "transmitted", "absorbed"),
    [
        (1, [], 5.9125, 0.8606, 0.8338, [0.0914]),
        (2, [AIR], 2.7296, 0.7633, 0.7033, [0.0965, 0.0723]),
        (2, [ARGON], 2.5837, 0.7638, 0.7033, [0.0965, 0.0723]),
    ],
)
def test_clear_glass(panes, gaps, u, shgc, transmitted, absorbed):
    layers = [CLEAR] * panes
    assert u_value(layers, gaps) == pytest.approx(u, abs=1e-4)
    assert solar_gain(layers, gaps, transmitted, absorbed).shgc[0] == pytest.approx(shgc, abs=1e-4)


def test_temperatures_of_double_glazing():
    winter = balance([CLEAR] * 2, [AIR], CONDITIONS["nfrc-winter"])
    np.testing.assert_allclose(winter.temperatures_c.ravel(), [-14.36, -14.03, 6.17, 6.50], atol=0.005)
    summer = balance([CLEAR] * 2, [AIR], CONDITIONS["nfrc-summer"], [0.09649, 0.07225])
    np.testing.assert_allclose(summer.temperatures_c.ravel(), [35.04, 35.11, 33.17, 33.04], atol=0.005)


def test_radiation_and_conduction_alone_are_a_chain_of_resistances():
    """In a vacuum between grey walls with small differences: 1/U is the sum of what each layer resists."""
    climate = Conditions("chain", 19.9, 20.1, 1e-12, 1e-12)
    layer = ThermalLayer("grey", 0.01, 0.5, 0.6, 0.3)
    radiation = 4.0 * SIGMA * 293.15**3
    expected = 1.0 / (radiation * 0.6) + 0.01 / 0.5 + 1.0 / (radiation * 0.3)
    assert 1.0 / u_value([layer], [], climate) == pytest.approx(expected, rel=1e-5)


def test_a_layer_that_long_waves_pass():
    """One that neither reflects nor conducts: half of what it emits goes each way, the rest passes."""
    climate = Conditions("clear", 0.0, 10.0, 1e-12, 1e-12)
    layer = ThermalLayer("film", 0.001, 1e3, 0.4, 0.4, 0.6)
    whole = SIGMA * (283.15**4 - 273.15**4)
    assert u_value([layer], [], climate) == pytest.approx((0.6 + 0.2) * whole / 10.0, rel=1e-6)


SHADE = ThermalLayer("shade", 0.001, 0.15, 0.8, 0.8, 0.1, Openings(0.01, 0.02, 0.005, 0.005, 0.01))


@pytest.mark.parametrize("layers", [[CLEAR] * 3, [CLEAR, SHADE, CLEAR], [SHADE, CLEAR], [CLEAR, SHADE], [SHADE]])
@pytest.mark.parametrize("climate", ["nfrc-summer", "nfrc-winter"])
def test_heat_is_conserved(layers, climate):
    """What the sun leaves in the layers goes out or in; air that two gaps exchange brings nothing from elsewhere."""
    conditions = Conditions("sun", CONDITIONS[climate].outdoor_c, 22.0, 15.0, irradiance=600.0)
    absorbed = [0.1, 0.3, 0.05][: len(layers)]
    gaps = [Gap(0.03)] * (len(layers) - 1)
    found = balance(layers, gaps, conditions, absorbed)
    at = found.temperatures_c
    indoors = found.indoor_coefficient * (at[-1, 1] - 22.0)
    outdoors = found.outdoor_coefficient * (at[0, 0] - conditions.outdoor_c)
    brought = found.heat_in - indoors
    if layers == [CLEAR, SHADE]:  # beside the room: its air passes through the gap
        assert abs(brought) > 1.0
    else:
        assert brought == pytest.approx(0.0, abs=1e-9)
    if layers != [SHADE, CLEAR]:  # beside the outdoors the air takes heat away
        assert found.heat_in + outdoors == pytest.approx(600.0 * sum(absorbed), abs=1e-4)
    else:
        assert found.heat_in + outdoors < 600.0 * sum(absorbed) - 1.0


def test_warm_air_rises_between_panes():
    found = balance([CLEAR, SHADE, CLEAR], [Gap(0.03)] * 2, CONDITIONS["nfrc-winter"])
    outer, inner = found.speeds_m_s
    assert outer < 0.0 < inner
    assert outer == pytest.approx(-inner, rel=0.1)  # one mass of air, warmer and so faster where it rises
    assert inner > -outer
    tight = ThermalLayer("tight", 0.001, 0.15, 0.8, 0.8, 0.1)
    assert not balance([CLEAR, tight, CLEAR], [Gap(0.03)] * 2, CONDITIONS["nfrc-winter"]).speeds_m_s.any()


def test_the_fraction_that_flows_inward_is_a_ratio_of_resistances():
    """With coefficients that hold at any temperature nearly nothing is left of the network's curvature."""
    climate = Conditions("linear", 20.0, 20.0, 25.0, 8.0, irradiance=10.0)
    bare = ThermalLayer("bare", 0.004, 1.0, 1e-6, 1e-6)
    fraction = inward_fractions([bare], [], climate, [0.1])
    outside, inside = 1.0 / 25.0 + 0.002, 1.0 / 8.0 + 0.002
    assert fraction[0] == pytest.approx(outside / (outside + inside), rel=1e-5)


def test_each_direction_by_itself_is_near_to_one_set_of_fractions():
    layers, gaps = [CLEAR, SHADE], [Gap(0.05)]
    theta = np.radians([0.0, 30.0, 60.0, 80.0])
    transmitted, absorbed = 0.1 * np.cos(theta), np.stack([0.1 + 0.05 * np.sin(theta), 0.4 * np.cos(theta)])
    quick = solar_gain(layers, gaps, transmitted, absorbed)
    exact = solar_gain(layers, gaps, transmitted, absorbed, each=True)
    assert quick.shgc[0] == pytest.approx(exact.shgc[0], abs=1e-6)
    np.testing.assert_allclose(quick.shgc, exact.shgc, atol=0.01)
    np.testing.assert_allclose(quick.secondary, quick.inward @ absorbed)


@pytest.mark.parametrize("tilt", [0.0, 30.0, 59.999, 60.0, 75.0, 90.0, 120.0, 180.0])
def test_a_gap_conducts_at_least(tilt):
    assert nusselt(tilt, 1.0, 40.0) >= 1.0
    assert nusselt(tilt, 5e4, 40.0) >= nusselt(tilt, 5e3, 40.0)


def test_warm_from_above_does_not_convect():
    assert nusselt(180.0, 1e5, 40.0) == pytest.approx(1.0)


def test_gases():
    """Air at 0 °C and mixtures between their parts (ISO 15099, annex B)."""
    air = Gas().at(273.15)
    assert air.conductivity == pytest.approx(0.02407, rel=1e-3)
    assert air.viscosity == pytest.approx(1.722e-5, rel=1e-3)
    assert air.density == pytest.approx(1.2925, rel=1e-3)
    alike = Gas({"argon": 0.5, "krypton": 0.5}).at(283.0)
    parts = [Gas(name).at(283.0).conductivity for name in ("argon", "krypton")]
    assert parts[1] < alike.conductivity < parts[0]
    nearly = Gas({"argon": 1.0 - 1e-9, "krypton": 1e-9}).at(283.0)
    assert nearly.conductivity == pytest.approx(parts[0], rel=1e-6)
    assert nearly.viscosity == pytest.approx(Gas("argon").at(283.0).viscosity, rel=1e-6)


def test_openness_of_layers():
    assert front_of_cloth(0.049855) == pytest.approx(0.078 * 0.049855**1.2)
    assert front_of_slats(0.8, 0.0) == pytest.approx(0.016 * 0.8**0.53)
    assert front_of_slats(0.8, 45.0) > 0.0
    assert permeability_of_slats(0.016, 0.012, 0.0, 0.0006) == pytest.approx(1.0 - 0.0006 / 0.0126)
    limit = math.acos(0.0006 / 0.0126)
    across = 0.016 * math.cos(limit) + 0.0006 * math.sin(limit)
    closed = permeability_of_slats(0.016, 0.012, 90.0, 0.0006)
    assert closed == pytest.approx(1.0 - 0.0006 * 0.016 / (across * 0.0126))


# EN 673 and EN 410 by hand, and the sheet of a fabric on the market (transmittance 0.225, reflectance 0.577).
@pytest.mark.parametrize(
    ("width", "gas", "emissivity", "u"),
    [
        (0.012, {"air": 1.0}, 0.837, 2.85),
        (0.016, {"air": 1.0}, 0.837, 2.73),
        (0.016, {"air": 1.0}, 0.04, 1.37),
        (0.016, {"argon": 0.9, "air": 0.1}, 0.04, 1.14),
        (0.016, {"argon": 0.9, "air": 0.1}, 0.03, 1.10),
    ],
)
def test_en_673(width, gas, emissivity, u):
    gaps = en673.gap_conductances([width], [gas], [(0.837, emissivity)])
    assert en673.u_value([0.004, 0.004], gaps) == pytest.approx(u, abs=0.005)


def test_en_673_of_one_pane_and_of_three():
    assert en673.u_value([0.004], np.zeros(0)) == pytest.approx(5.75, abs=0.005)
    gaps = en673.gap_conductances([0.012] * 2, [{"argon": 0.9, "air": 0.1}] * 2, [(0.837, 0.03), (0.03, 0.837)])
    assert gaps[0] == pytest.approx(gaps[1])
    assert en673.u_value([0.004] * 3, gaps) < 0.75
    level = en673.gap_conductances([0.016], [{"air": 1.0}], [(0.837, 0.837)], position="horizontal")
    upright = en673.gap_conductances([0.016], [{"air": 1.0}], [(0.837, 0.837)])
    assert level[0] > upright[0]


def test_en_410_by_its_formulas():
    gap = 6.0
    g, secondary = en410.g_value(0.7, [0.1, 0.08], [gap])
    by_hand = ((0.18) / 23.0 + 0.08 / gap) / (1.0 / 8.0 + 1.0 / 23.0 + 1.0 / gap)
    assert secondary == pytest.approx(by_hand)
    assert g == pytest.approx(0.7 + by_hand)
    single, _ = en410.g_value(0.8, [0.1], [])
    assert single == pytest.approx(0.8 + 0.1 * 8.0 / 31.0)


@pytest.mark.parametrize(
    ("letter", "interior", "exterior"),
    [("A", 0.406, 0.2475), ("B", 0.414, 0.2185), ("C", 0.385, 0.1665), ("D", 0.259, 0.1137)],
)
def test_en_iso_52022_1(letter, interior, exterior):
    glazing = en_iso_52022.REFERENCE_GLAZINGS[letter]
    inside = en_iso_52022.g_total("interior", glazing.u, glazing.g, 0.225, 0.577)
    assert inside.g == pytest.approx(interior, abs=0.0006)
    assert inside.doubts == ()
    outside = en_iso_52022.g_total("exterior", glazing.u, glazing.g, 0.225, 0.577)
    assert outside.g == pytest.approx(exterior, abs=0.0001)


def test_en_iso_52022_1_says_where_it_does_not_hold():
    found = en_iso_52022.g_total("exterior", 1.1, 0.10, 0.6, 0.05)
    assert len(found.doubts) == 3
    with pytest.raises(ClerestoryError, match=r"absorptance of -0\.2"):
        en_iso_52022.g_total("exterior", 1.1, 0.5, 0.6, 0.6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: balance([], [], CONDITIONS["nfrc-winter"]), "0 layers"),
        (lambda: balance([CLEAR] * 2, [], CONDITIONS["nfrc-winter"]), "0 gaps for 2 layers"),
        (lambda: balance([CLEAR], [], CONDITIONS["nfrc-winter"], [0.1, 0.2]), "2 absorptances for 1 layer"),
        (lambda: Gas("helium"), "helium"),
        (lambda: Gas({"air": 0.5}), "sum to 0.5"),
        (lambda: Gap(0.0), "gap of 0 m"),
        (lambda: ThermalLayer("pane", 0.0), "pane: thickness 0"),
        (lambda: ThermalLayer("pane", 0.003, 1.0, 0.9, 0.84, 0.2), "pane: emissivity 0.9 of the exterior"),
        (lambda: u_value([CLEAR], [], Conditions("equal", 20.0, 20.0, 25.0)), "equal"),
        (lambda: solar_gain([CLEAR], [], 0.9, [0.2]), "sum to 1.1"),
        (lambda: solar_gain([CLEAR], [], 0.9, [0.05], CONDITIONS["nfrc-winter"]), "no sun"),
        (lambda: Openings(top_m=-1.0), "top_m"),
        (lambda: en673.gap_conductances([0.01], [{"helium": 1.0}], [(0.8, 0.8)]), "helium"),
    ],
)
def test_what_does_not_fit_is_refused(call, message):
    with pytest.raises(ClerestoryError, match=message):
        call()


def _recorded():
    root = sample_root()
    if root is None:
        return []
    path = root / "glazing" / "expected_wincalc" / "wincalc_expected.csv"
    with path.open(encoding="utf-8") as file:
        return [r for r in csv.DictReader(file) if r["spectrum"] == "full_spectrum"]


@pytest.mark.skipif(sample_root() is None, reason=ABSENT)
@pytest.mark.parametrize(
    ("case", "layers", "gap"),
    [
        ("1_layer/nfrc_102/no_basis", [(0.003048, 1.0)], None),
        ("1_layer/coated_nfrc_6400/no_basis", [(0.00572, 1.0)], None),
        ("2_layers/low_e_nfrc_2191_air_nfrc_102/no_basis", [(0.003, 1.0), (0.003048, 1.0)], AIR),
        ("2_layers/low_e_nfrc_2191_air_nfrc_102/flipped_low_e/no_basis", [(0.003, 1.0), (0.003048, 1.0)], AIR),
        (
            "2_layers/nfrc_102_air_nfrc_102/forced_ventilation/no_basis",
            [(0.003048, 1.0)] * 2,
            Gap(0.0127, forced_speed_m_s=1.0, forced_temperature_c=21.0),
        ),
        # Conductivity and permeability as its XML file has them.
        (
            "2_layers/nfrc_102_air_bsdf_xml/thermal_openness_0.01_top_and_bottom/full_basis",
            [(0.003048, 1.0), (0.001, 0.15, Openings(0.01, 0.01, front=front_of_cloth(0.049855)))],
            AIR,
        ),
    ],
)
def test_recorded_results_of_wincalc(case, layers, gap):
    """U within 0.02 W/(m² K) and SHGC within 0.005, from the recorded optics and emissivities."""
    rows = [row for row in _recorded() if row["case"] == case]
    assert rows
    for row in rows:
        made = [
            ThermalLayer(
                f"layer {k + 1}",
                *given[:2],
                float(row[f"ir_layer{k}_emissivity_front_hemispheric"]),
                float(row[f"ir_layer{k}_emissivity_back_hemispheric"]),
                float(row[f"ir_layer{k}_transmittance_front_diffuse_diffuse"]),
                *given[2:],
            )
            for k, given in enumerate(layers)
        ]
        if "flipped" in case:
            # The recorded emissivities are those of the pane as it stands in the file.
            first = made[0]
            made[0] = ThermalLayer(
                first.name, first.thickness_m, 1.0, first.emissivity_interior, first.emissivity_exterior
            )
        gaps = [] if gap is None else [gap]
        assert u_value(made, gaps) == pytest.approx(float(row["Uenv_U"]), abs=0.02)
        if "flipped" in case:
            continue  # so are the recorded absorptances
        transmitted = float(row["solar_front_transmittance_direct_hemispherical"])
        absorbed = [float(row[f"solar_layer{k}_front_absorptance_direct"]) for k in range(len(made))]
        gain = solar_gain(made, gaps, transmitted, absorbed)
        assert gain.shgc[0] == pytest.approx(float(row["SHGCenv_SHGC"]), abs=0.005)
        assert math.isclose(gain.secondary[0], gain.shgc[0] - transmitted)
