"""Panes of glass against results of LBNL's WinCalc: light that passes, is mirrored and absorbed, pane by pane."""

import csv

import numpy as np
import pytest

from clerestory.system import Glazing, read_glass

CLEAR, LOW_E = "CLEAR_3.DAT", "nfrc_2191.json"
#: Cases by their panes, outermost first. The case "flipped_low_e" is left out: its recorded optics are those of the
#: glazing that was not flipped.
CASES = {
    "1_layer/nfrc_102/no_basis": [CLEAR],
    "1_layer/coated_nfrc_18100/no_basis": ["nfrc_18100.json"],
    "1_layer/coated_nfrc_6400/no_basis": ["nfrc_6400.json"],
    "1_layer/pv_generic/no_basis": ["generic_pv.json"],
    "2_layers/nfrc_102_air_nfrc_102/no_basis": [CLEAR, CLEAR],
    "2_layers/low_e_nfrc_2191_air_nfrc_102/no_basis": [LOW_E, CLEAR],
    # On Klems quarter, 15° lies in the patch about 18°.
    "2_layers/laminate_nfrc_18000_air_NFRC_102/quarter_basis": ["nfrc_18000.json", CLEAR],
}
ANGLES = {"theta=0_phi=0": 0, "theta=15_phi=270": 1}
BANDS = {"visible": "photopic", "solar": "solar"}


@pytest.fixture(scope="module")
def recorded(sample_data):
    with (sample_data / "glazing/expected_wincalc/wincalc_expected.csv").open() as lines:
        rows = [row for row in csv.DictReader(lines) if row["spectrum"] == "full_spectrum"]
    return {(row["case"], row["incidence"]): row for row in rows}


@pytest.mark.parametrize("case", CASES)
def test_all_shares_of_the_light(sample_data, recorded, case):
    panes = [read_glass(sample_data / "glazing/products" / name) for name in CASES[case]]
    theta = [0.0, 18.0 if "quarter" in case else 15.0]
    for band, curves in Glazing(panes).curves(theta, "nfrc300").items():
        if band == "nir":
            continue
        for incidence, k in ANGLES.items():
            row, word = recorded[case, incidence], BANDS[band]
            expected = [
                float(row[f"{word}_{name}_direct_direct"])
                for name in ("front_transmittance", "front_reflectance", "back_reflectance")
            ]
            expected += [float(row[f"{word}_layer{j}_front_absorptance_direct"]) for j in range(len(panes))]
            ours = [
                curves.transmittance[k],
                curves.reflectance["exterior"][k],
                curves.reflectance["interior"][k],
                *curves.absorptance["exterior"][:, k],
            ]
            # Along the normal nothing but the integration is asked; the angular curves have more freedom.
            np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-4 if k == 0 else 1e-3)
