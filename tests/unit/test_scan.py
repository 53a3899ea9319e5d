"""What an instrument saw, as values that cannot be wrong unnoticed."""

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.measure import Measurement, Scan, SphereValues


def scan(**changes):
    given = {
        "incident_side": "exterior",
        "scatter": "transmission",
        "incident_theta_deg": 30.0,
        "incident_phi_deg": 90.0,
        "theta_deg": [0.0, 60.0, 90.0],
        "phi_deg": [0.0, 270.0, 10.0],
        "values": [[0.5], [0.4], [-0.001]],
    }
    return Scan(**(given | changes))


def test_directions_are_those_of_the_frame():
    seen = scan()
    # Light from above outside goes down and into the room.
    np.testing.assert_allclose(seen.incident, [0.0, 0.5, -np.cos(np.radians(30.0))], atol=1e-12)
    np.testing.assert_allclose(seen.outgoing[1], [0.0, -np.sin(np.radians(60.0)), 0.5], atol=1e-12)
    assert seen.side == "interior"
    assert scan(scatter="reflection").side == "exterior"


def test_dsf_becomes_bsdf_without_the_horizon():
    bsdf = scan(quantity="dsf", standard_errors=[[0.1], [0.1], [0.1]]).as_bsdf()
    np.testing.assert_allclose(bsdf.values[:, 0], [0.5, 0.8])
    np.testing.assert_allclose(bsdf.standard_errors[:, 0], [0.1, 0.2])
    assert scan().as_bsdf().values[2, 0] == -0.001
    with pytest.raises(ClerestoryError, match="beam"):
        scan(quantity="signal").as_bsdf()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"theta_deg": [0.0, 60.0, 90.1]}, "90.1"),
        ({"theta_deg": [0.0, 60.0, np.nan]}, "nan"),
        ({"phi_deg": [0.0, 1.0]}, "azimuths"),
        ({"phi_deg": [0.0, 1.0, np.inf]}, "azimuth"),
        ({"values": [[1.0], [2.0]]}, "3 points of 1 channels"),
        ({"channels": ("X", "Y", "Z")}, "3 channels"),
        ({"incident_theta_deg": 95.0}, "95"),
        ({"incident_side": "front"}, "front"),
        ({"quantity": "radiance"}, "radiance"),
        ({"standard_errors": [[1.0]]}, "standard errors"),
    ],
)
def test_what_does_not_fit_is_refused(changes, message):
    with pytest.raises(ClerestoryError, match=message):
        scan(**changes)


def test_raw_values_cannot_be_changed():
    seen = scan()
    with pytest.raises(ValueError, match="read-only"):
        seen.values[0] = 0.0
    with pytest.raises(TypeError):
        seen.conditions["lamp"] = "xenon"


def test_a_measurement_tells_its_scans_apart():
    beam = scan(purpose="beam", quantity="signal")
    both = Measurement("twill", (scan(), beam, scan(scatter="reflection")))
    assert both.of("exterior", "transmission") == (both.scans[0],)
    assert both.of(purpose="beam") == (beam,)
    with pytest.raises(ClerestoryError, match="no channel 'Z'"):
        scan().channel("Z")


def test_sphere_values_are_by_wavelength_or_band():
    spectrum = SphereValues("glass", "exterior", "transmission", 8.0, [0.8, 0.7], wavelength_nm=[400.0, 500.0])
    assert spectrum.values[1] == 0.7
    with pytest.raises(ClerestoryError, match="rise"):
        SphereValues("glass", "exterior", "transmission", 8.0, [0.8, 0.7], wavelength_nm=[500.0, 400.0])
    with pytest.raises(ClerestoryError, match="one of them"):
        SphereValues("glass", "exterior", "transmission", 8.0, [0.8])
    with pytest.raises(ClerestoryError, match="2 values do not go with 1"):
        SphereValues("glass", "exterior", "transmission", 8.0, [0.8, 0.7], bands=("visible",))
