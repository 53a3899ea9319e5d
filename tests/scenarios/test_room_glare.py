"""Glare without a picture beside that of a picture of the same room."""

from __future__ import annotations

import json

import numpy as np
import pytest

from clerestory import Bsdf, ClerestoryError, Model, room
from clerestory.cli import main
from clerestory.glare import Settings, evaluate
from clerestory.system import pane_from_normal
from clerestory.trace.recipe import read_toml

#: Dark enough that the sun behind it is no matter of course.
DARK = {"glass": 0.05, "glass_reflectance": 0.05}


def office(system, sun, **eye):
    tables = read_toml(room.shipped.ROOMS.path_of("office"))
    tables["systems"]["window"] = system
    tables["sky"] = {"kind": "preetham", "turbidity": 3.0, "sun_deg": list(sun)}
    # Near enough to the window to see the sun through it.
    tables["views"]["desk"] |= {"point_m": [1.8, 1.2, 1.2], "size_px": [300, 300], **eye}
    return room.load(tables)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Data sets of a diffuse film, and of glass as a Klems matrix."""
    folder = tmp_path_factory.mktemp("films")
    sides, scatters = ("exterior", "interior"), ("transmission", "reflection")
    film = Bsdf.from_models({(side, scatter): Model.lambertian(0.3) for side in sides for scatter in scatters})
    film.write(folder / "film.bsdf.npz")
    glass = pane_from_normal(0.5, 0.1).to_matrix("klems-full")
    glass.write(folder / "klems.xml")
    return folder


CASES = {
    "glass, sun aside": ({"glass": 0.8}, (35.0, 260.0)),
    "dark glass, sun aside": (DARK, (35.0, 260.0)),
    "film": ({"file": "film.bsdf.npz", "treatment": "high"}, (30.0, 200.0)),
    "glass as a Klems matrix, sun in the patch": ({"file": "klems.xml", "treatment": "klems"}, (20.0, 180.0)),
}


@pytest.mark.parametrize(("system", "sun"), CASES.values(), ids=list(CASES))
def test_it_is_that_of_a_picture(system, sun, files):
    """DGP within 0.01, E_v within 1 %."""
    given = {**system, "file": str(files / system["file"])} if "file" in system else system
    made = office(given, sun)
    picture, alone = evaluate(made.picture("desk", samples=8).picture()), made.glare("desk")
    assert alone.vertical_illuminance == pytest.approx(picture.vertical_illuminance, rel=0.01)
    assert alone.dgp == pytest.approx(picture.dgp, abs=0.01)
    assert alone.background_luminance > 0.0


def test_the_sun_is_what_pictures_of_ever_smaller_pixels_tend_to():
    """Pixels at the rim of the disc dim it: the error halves with their size."""
    made = office(DARK, (20.0, 180.0))
    alone = made.glare("desk")
    found = []
    for size in (400, 800, 1600):
        view = made.view("desk").model_copy(update={"size_px": [size, size]})
        found.append(evaluate(made.picture(view, samples=1).picture()).dgp)
    assert found[0] < found[1] < found[2] < alone.dgp
    assert 2.0 * found[2] - found[1] == pytest.approx(alone.dgp, abs=0.01)


def test_the_sun_is_a_source_of_its_own():
    made = office(DARK, (20.0, 180.0))
    sun = made.sky.settings.sun
    (source, *_) = made.glare("desk").sources
    assert source.solid_angle == pytest.approx(2.0 * np.pi * (1.0 - np.cos(np.radians(0.2665))), rel=1e-3)
    assert np.degrees(np.arcsin(source.direction[2])) == pytest.approx(sun.altitude_deg, abs=0.01)


def test_settings_that_need_a_picture_are_refused():
    made = office(DARK, (20.0, 180.0))
    with pytest.raises(ClerestoryError, match="needs a picture"):
        made.glare("desk", settings=Settings(threshold=5.0, threshold_of="mean"))


def test_the_command(capsys):
    assert main(["render", "office", "--glare", "--no-picture", "--samples", "2"]) == 0
    told = capsys.readouterr().out
    assert told.startswith("E_v ")
    assert "DGP" in told
    assert main(["render", "office", "--glare", "--no-picture", "--samples", "2", "--json"]) == 0
    assert 0.0 < json.loads(capsys.readouterr().out)["dgp"] <= 1.0
    assert main(["render", "office", "--glare", "--no-picture", "-o", "x.hdr"]) == 2
    assert "it is for --glare alone" in capsys.readouterr().err
