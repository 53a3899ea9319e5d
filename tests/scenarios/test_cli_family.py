"""Families of blinds and windows for other programs, as a person meets them on the command line."""

import csv
import json

import pytest

import clerestory
from clerestory.annual import study
from clerestory.cli import main
from clerestory.system import family
from clerestory.system.product import product_of
from short_study import ROOM, days

BLIND = """
[family]
name = "blind"
parameter = "tilt_deg"
values = [0, 60]
basis = "klems-quarter"
samples = 64
[product]
manufacturer = "Maker"
orientation = { mounting = "facade", faces_azimuth_deg = 180, within_deg = 90 }
[bands]
names = ["visible", "solar"]
[sample]
kind = "venetian-blind"
pitch_mm = 72
[sample.slat]
width_mm = 80
crown_mm = 5
upper = "paint"
[materials.paint]
kind = "lambertian"
reflectance = 0.5
"""
STUDY = """
room = "room.toml"
weather = "days.wea"
method = "3-phase"
patches = "reinhart:1"
basis = "klems-quarter"
paths = 64
[data_sets.blind]
family = "FAMILY"
treatment = "klems"
step = 20
[data_sets.blind.states.up]
glass = 0.9
[data_sets.blind.control]
"""
WINDOW = """
[system]
name = "Blind and pane"
basis = "klems-quarter"
[product]
manufacturer = "Maker"
orientation = { mounting = "roof", up_azimuth_deg = 0, within_deg = 10, tilt_deg = [0, 30] }
[[layers]]
kind = "recipe"
name = "slats"
recipe = "blind.toml"
samples = 64
conductivity = 100
emissivity_exterior = 0.6
emissivity_interior = 0.6
tir = 0.3
[[layers]]
kind = "gap"
gas = "air"
width_mm = 50
[[layers]]
kind = "glass"
glass = "clear"
thickness_mm = 6
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("family")
    (made / "family.toml").write_text(BLIND)
    (made / "blind.toml").write_text(BLIND[BLIND.index("[bands]") :])
    (made / "window.toml").write_text(WINDOW)
    (made / "room.toml").write_text(ROOM)
    (made / "days.wea").write_text(days([20]))
    assert main(["system", "family", str(made / "family.toml"), "-o", str(made / "built"), "--for", "plain"]) == 0
    return made


@pytest.fixture
def cache(folder, monkeypatch):
    monkeypatch.setenv("CLERESTORY_CACHE", str(folder / "cache"))
    return folder / "cache"


def failed(capsys, *words):
    capsys.readouterr()
    assert main([str(word) for word in words]) != 0
    error = capsys.readouterr().err.strip().splitlines()[-1]
    assert error.startswith("error: ")
    return error


def test_a_family_on_disk(folder, capsys):
    names = sorted(path.name for path in (folder / "built").iterdir())
    assert names == ["family.json", "tilt_0.xml", "tilt_60.xml"]
    capsys.readouterr()
    assert main(["system", "family", str(folder / "built"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    level, tilted = told["states"]
    assert level["transmittance_diffuse"] > 1.5 * tilted["transmittance_diffuse"]
    bsdf = clerestory.read(folder / "built" / "tilt_60.xml")
    data = product_of(bsdf)
    assert (data.parameter, data.value, bsdf.metadata.manufacturer) == ("tilt_deg", 60.0, "Maker")
    assert data.orientation == family.read(folder / "built").orientation
    # The curve is within the family's tilts: none of them keeps a level sun out.
    assert data.curve.tilt_deg[0] is None
    assert data.curve.tilt_deg[30] == pytest.approx(21.2, abs=0.05)
    assert data.curve.tilt_deg[60] == 0.0


@pytest.mark.parametrize("given", ["built", "built/family.json", "family.toml"])
def test_a_study_takes_a_family(folder, cache, capsys, given):
    law = 'kind = "cut-off"\nsafety_deg = 0\n'
    (folder / "study.toml").write_text(STUDY.replace("FAMILY", given) + law)
    assert main(["annual", str(folder / "study.toml"), "-o", str(folder / "out"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["data_sets"][0]
    assert list(told["states"]["pane"]) == ["up", "tilt_0", "tilt_20", "tilt_40", "tilt_60"]
    with (folder / "out" / "states-blind.csv").open() as stream:
        rows = {row["time"][11:13]: row["pane"] for row in csv.DictReader(stream)}
    # At the equinox the profile angle is that of noon all day, 42.7°: slats of 80 mm at 72 mm keep it out when level.
    assert {rows[hour] for hour in ("10", "12", "14")} == {"tilt_0"}
    assert rows["02"] == "up"
    assert any(cache.glob("family-*/family.json"))


def test_a_family_that_is_damaged_in_the_cache_is_made_again(folder, tmp_path):
    clock = 'kind = "schedule"\ntimes = [{state = "up"}]\n'
    (folder / "study.toml").write_text(STUDY.replace("FAMILY", "built") + clock)
    study.load(folder / "study.toml", cache=tmp_path)
    (manifest,) = tmp_path.glob("family-*/family.json")
    state = manifest.parent / "tilt_40.bsdf.npz"
    for damage in (lambda: state.write_bytes(b"half"), state.unlink, lambda: manifest.write_text("{")):
        damage()
        made = study.load(folder / "study.toml", cache=tmp_path)
        assert "it is made again" in made.cache.warnings[0]
        assert state.stat().st_size > 1000
    assert study.load(folder / "study.toml", cache=tmp_path).cache.warnings == []


def test_a_schedule_of_tilts_takes_the_nearest_state(folder, cache, capsys):
    head = STUDY.replace("FAMILY", "built")
    clock = 'kind = "schedule"\ntimes = [{tilt_deg = 33, start = 9, end = 12}, {state = "up"}]\n'
    (folder / "study.toml").write_text(head + clock)
    assert main(["annual", str(folder / "study.toml"), "-o", str(folder / "out"), "--json"]) == 0
    with (folder / "out" / "states-blind.csv").open() as stream:
        rows = [row["pane"] for row in csv.DictReader(stream)]
    assert rows[9:12] == ["tilt_40"] * 3
    assert rows.count("up") == 21
    capsys.readouterr()
    # The same from a file with angles.
    angles = ["47.5" if name == "tilt_40" else name for name in rows]
    (folder / "tilts.csv").write_text("all\n" + "\n".join(angles) + "\n")
    (folder / "study.toml").write_text(head + 'kind = "schedule"\nfile = "tilts.csv"\n')
    assert main(["annual", str(folder / "study.toml"), "-o", str(folder / "out"), "--json"]) == 0
    with (folder / "out" / "states-blind.csv").open() as stream:
        assert [row["pane"] for row in csv.DictReader(stream)] == rows
    (folder / "tilts.csv").write_text("all\n" + "\n".join(["nan", *angles[1:]]) + "\n")
    assert "line 2, column all: no state 'nan'" in failed(capsys, "annual", folder / "study.toml")
    (folder / "tilts.csv").write_text("all\n" + "\n".join(["120", *angles[1:]]) + "\n")
    assert "line 2, column all: 120: 120° is no tilt of slats" in failed(capsys, "annual", folder / "study.toml")
    for clock, match in (
        ("{tilt_deg = 120}", r"times[1].tilt_deg: 120° is no tilt of slats"),
        ('{tilt_deg = 20, state = "up"}', "either a state or tilt_deg is asked for"),
        ("{start = 3}", "either a state or tilt_deg is asked for"),
    ):
        (folder / "study.toml").write_text(head + f'kind = "schedule"\ntimes = [{clock}, {{state = "up"}}]\n')
        assert match in failed(capsys, "annual", folder / "study.toml")


def test_faults_of_families_in_a_study(folder, cache, capsys):
    law = 'kind = "cut-off"\n'
    text = STUDY.replace("FAMILY", "built") + law
    for old, new, match in (
        ('"built"', '"none.json"', "data_sets.blind.family: "),
        ("step = 20", "step = -1", "data_sets.blind.step: "),
        ("states.up", "states.tilt_0", "data_sets.blind.states.tilt_0: the family has a state of this name"),
        ('"built"', '"room.toml"', "data_sets.blind.family: "),
    ):
        (folder / "study.toml").write_text(text.replace(old, new))
        error = failed(capsys, "annual", folder / "study.toml")
        assert match in error
        assert f"{folder / 'study.toml'}: " in error


def test_a_window_for_other_programs(folder, capsys):
    out = folder / "window.xml"
    assert main(["system", "export", str(folder / "window.toml"), "-o", str(out)]) == 0
    bsdf = clerestory.read(out)
    assert set(bsdf.bands) == {"visible", "solar", "nir"}
    assert all(len(members) == 4 for members in bsdf.models.values())
    known = bsdf.metadata
    assert (known.manufacturer, known.name, known.tir) == ("Maker", "Blind and pane", 0.0)
    assert (known.emissivity_exterior, known.emissivity_interior) == (0.6, 0.84)
    assert 0.0 < known.thermal_conductivity < 2.0
    assert known.thickness_m == pytest.approx(0.056 + 0.0805, abs=0.003)
    data = product_of(bsdf)
    assert [(c["number"], c["kind"], c["name"]) for c in data.components] == [
        (1, "recipe", "slats"),
        (2, "gap", "100 % air"),
        (3, "glass", "clear 6 mm"),
    ]
    assert (data.orientation.mounting, data.orientation.tilt_deg) == ("roof", (0.0, 30.0))
    assert data.curve.slats_mm == (80.0, 72.0, 5.0)
    assert 2.0 < data.heat.u < 6.0
    capsys.readouterr()
    assert main(["system", "rate", str(folder / "window.toml"), "--json"]) == 0
    heat = json.loads(capsys.readouterr().out)["heat"]
    assert (data.heat.u, data.heat.shgc) == pytest.approx((heat["u_w_m2k"], heat["g"]))
    assert main(["info", str(out)]) == 0
    told = capsys.readouterr().out
    assert "layer or gap 2: gap, 100 % air" in told
    assert "to be placed: roof, azimuth 0° within 10°" in told
    # For WINDOW, which asks for thermal data, and from the file again, which keeps what it said.
    assert main(["system", "build", str(folder / "window.toml"), "-o", str(folder / "w.xml"), "--for", "window"]) == 0
    assert main(["system", "export", str(out), "-o", str(folder / "again.xml"), "--for", "window"]) == 0
    again = clerestory.read(folder / "again.xml")
    assert (product_of(again).curve, product_of(again).orientation) == (data.curve, data.orientation)
    assert (again.bands, again.metadata.manufacturer) == (("solar", "visible"), "Maker")


def test_energyplus_and_a_manifest(folder, capsys):
    for name in ("w.idf", "w.epJSON", "w.json"):
        assert main(["system", "export", str(folder / "window.toml"), "-o", str(folder / name), "--json"]) == 0
    text = (folder / "w.idf").read_text()
    assert text.count("\nMatrix:TwoDimension,") == 9
    assert "Construction:ComplexFenestrationState,\n  Blind and pane," in text
    held = json.loads((folder / "w.epJSON").read_text())
    assert set(held["Construction:ComplexFenestrationState"]) == {"Blind and pane"}
    manifest = json.loads((folder / "w.json").read_text())
    assert manifest["manufacturer"] == "Maker"
    assert [c["kind"] for c in manifest["components"]] == ["recipe", "gap", "glass"]
    assert manifest["orientation"]["azimuth_deg"] == 0.0


def test_what_export_refuses(folder, capsys):
    window = folder / "window.toml"
    out = folder / "refused"
    for words, match in (
        ([window, "-o", f"{out}.txt"], "the name does not tell the format"),
        ([window, "-o", f"{out}.idf", "--for", "window"], ".idf files are for energyplus"),
        ([window, "-o", f"{out}.idf", "--sun", "40,180"], "go with candle power"),
        ([window, "-o", f"{out}.ldt", "--for", "window"], "--for goes with data sets"),
        ([folder / "built" / "tilt_0.xml", "-o", f"{out}.idf"], "layer 1 (blind, tilt_0): EnergyPlus takes no shading"),
        ([folder / "none.xml", "-o", f"{out}.xml"], "none.xml"),
        ([folder / "built" / "tilt_0.xml", "-o", f"{out}.xml", "--for", "window"], "WINDOW needs"),
    ):
        assert match in failed(capsys, "system", "export", *words)
    assert not list(folder.glob("refused*"))


def test_a_family_that_cannot_be_written_leaves_nothing(folder, capsys):
    out = folder / "none"
    words = ["system", "family", folder / "family.toml", "-o", out, "--for", "window"]
    assert "family.toml: state tilt_0: WINDOW needs emissivity_exterior" in failed(capsys, *words)
    assert not out.exists()
    before = {path.name: path.read_bytes() for path in (folder / "built").iterdir()}
    words[4] = folder / "built"
    failed(capsys, *words)
    assert {path.name: path.read_bytes() for path in (folder / "built").iterdir()} == before
    assert "is a file" in failed(capsys, "system", "family", folder / "family.toml", "-o", folder / "days.wea")
    assert "--for goes with --output" in failed(capsys, "system", "family", folder / "family.toml", "--for", "plain")
    assert "not TOML" in failed(capsys, "system", "family", folder / "built" / "tilt_0.xml")
