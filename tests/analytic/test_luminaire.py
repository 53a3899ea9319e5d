"""A window as a luminaire: closed forms for diffusers and beams, and files read back."""

import json
import math

import numpy as np
import pytest

from clerestory import Bsdf, ClerestoryError, FileFormatError, Model
from clerestory.cli import main
from clerestory.luminaire import Facade, candle_power, daylight_supply, eulumdat, lm63
from clerestory.luminaire.candle_power import flux_of
from clerestory.sky import Place, Sky


def window(model):
    return Bsdf.from_models({("exterior", "transmission"): model})


def test_a_facade_has_the_frame_of_a_person_in_the_room():
    x, y, z = Facade(180.0).frame
    np.testing.assert_allclose(x, [-1.0, 0.0, 0.0], atol=1e-12)  # who looks south has the west at the right
    np.testing.assert_allclose(y, [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(z, [0.0, 1.0, 0.0], atol=1e-12)
    roof = Facade(180.0, 0.0).frame
    np.testing.assert_allclose(roof[2], [0.0, 0.0, -1.0], atol=1e-12)
    for frame in (Facade(33.0, 41.0).frame, roof):
        np.testing.assert_allclose(np.cross(frame[0], frame[1]), frame[2], atol=1e-12)


def test_a_diffuser_is_a_lambertian_source():
    """I = τ E A cosγ / π, whatever the sky."""
    found = candle_power(window(Model.lambertian(0.5)), Sky.overcast(), area_m2=2.0)
    assert found.flux == pytest.approx(0.5 * 2.0 * found.illuminance, rel=1e-9)
    expected = found.flux * np.cos(np.radians(found.gamma_deg)) / math.pi
    np.testing.assert_allclose(found.intensity, np.broadcast_to(expected, found.intensity.shape), rtol=0.01, atol=1e-6)
    assert found.scaled_by == pytest.approx(1.0, abs=0.005)
    assert found.beams == ()


def test_illuminance_of_an_upright_window_under_the_overcast_sky():
    """0.3962 of the horizontal illuminance from the sky (CIE), and half of what the ground sends back."""
    sky = Sky.overcast()
    found = candle_power(window(Model.lambertian(0.5)), sky)
    assert found.illuminance == pytest.approx(sky.illuminance(90.0, 180.0), rel=2e-3)


def test_a_clear_pane_shows_the_sky_upside_down():
    """Light from above goes down: the floor gets the light of the sky, the ceiling that of the ground."""
    sky = Sky.overcast()
    found = candle_power(window(Model.specular(0.8)), sky)
    up, down = (found.intensity[list(found.c_deg).index(c)] for c in (90.0, 270.0))
    k = list(found.gamma_deg).index(45.0)
    assert down[k] > 2.0 * up[k]
    toward = np.array([[0.0, math.sin(math.radians(45.0)), -math.cos(math.radians(45.0))]])
    luminance = float(sky.luminance(Facade().to_world(toward))[0])
    assert down[k] == pytest.approx(0.8 * luminance * math.cos(math.radians(45.0)), rel=0.02)


def test_the_suns_beam_is_apart_and_its_flux_is_kept():
    found = candle_power(window(Model.specular(0.8)), Sky.clear((30.0, 180.0)))
    (beam,) = found.beams
    assert (beam.c_deg, beam.gamma_deg) == pytest.approx((270.0, 30.0), abs=1e-6)
    assert flux_of(found.c_deg, found.gamma_deg, found.intensity) == pytest.approx(found.flux, rel=1e-9)
    assert candle_power(window(Model.specular(0.8)), Sky.clear((30.0, 0.0))).beams == ()


@pytest.mark.parametrize("made", [eulumdat, lm63])
def test_files_are_read_back(made):
    found = candle_power(window(Model.lambertian(0.5)), Sky.clear((30.0, 150.0)), area_m2=1.5, c_step_deg=30.0)
    data = made.write(found, "Fenster mit Umlaut ä", width_m=1.0, height_m=1.5, maker="Maker")
    back = made.read(data)
    inside = back.gamma_deg <= 90.0
    np.testing.assert_allclose(back.intensity[:, inside], found.intensity, rtol=1e-4, atol=1e-3)
    assert flux_of(back.c_deg, back.gamma_deg, back.intensity) == pytest.approx(found.flux, rel=1e-3)
    assert back.area_m2 == pytest.approx(1.5)
    assert all(len(line) <= 132 for line in data.decode("latin-1").split("\r\n"))


@pytest.mark.parametrize("made", [eulumdat, lm63])
def test_damaged_files_are_refused(made):
    found = candle_power(window(Model.lambertian(0.5)), Sky.uniform(), c_step_deg=90.0, gamma_step_deg=30.0)
    data = made.write(found, "x")
    for damaged in (b"", b"garbage", data[: len(data) // 2], data.replace(b"0", b"x")):
        with pytest.raises(FileFormatError):
            made.read(damaged)


def test_daylight_supply_goes_with_the_transmittance():
    place = Place(47.3, 11.4, 1.0)
    half, full = (
        daylight_supply(window(Model.lambertian(t)), place, step_min=60, orientations=["south", "north"])
        for t in (0.25, 0.5)
    )
    for less, more in zip(half, full, strict=True):
        assert more.luminous_energy == pytest.approx(2.0 * less.luminous_energy)
        assert more.luminous_energy == pytest.approx(0.5 * more.exposure)
    by = {(s.day[5:], s.orientation): s.exposure for s in full}
    assert by["12-15", "south"] > 4.0 * by["12-15", "north"]
    assert by["06-15", "north"] > by["12-15", "north"]


def test_wrong_grids_are_refused():
    with pytest.raises(ClerestoryError, match="do not divide"):
        candle_power(window(Model.lambertian(0.5)), Sky.uniform(), c_step_deg=7.0)
    with pytest.raises(ClerestoryError, match="area"):
        candle_power(window(Model.lambertian(0.5)), Sky.uniform(), area_m2=0.0)
    with pytest.raises(ClerestoryError, match="tilt"):
        Facade(0.0, 200.0)


def test_the_command(tmp_path, capsys):
    path = tmp_path / "film.bsdf.npz"
    window(Model.lambertian(0.5)).save(path)
    for words in (["-o", "a.ldt"], ["-o", "a.ies", "--sky", "clear", "--sun", "40,180"]):
        words = [words[0], str(tmp_path / words[1]), *words[2:]]
        assert main(["system", "export", str(path), *words, "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["flux_lm"] > 0.0
    table = tmp_path / "supply.csv"
    assert main(["system", "export", str(path), "-o", str(table), "--place", "47.3,11.4,1"]) == 0
    assert len(table.read_text(encoding="utf-8").splitlines()) == 9
    capsys.readouterr()
    for words in (["-o", "a.txt"], ["-o", "a.csv"], ["-o", "a.ldt", "--sky", "clear"], ["-o", "a.ldt", "--steps", "7"]):
        assert main(["system", "export", str(path), words[0], str(tmp_path / words[1]), *words[2:]]) != 0
        assert capsys.readouterr().err.startswith("error: ")
