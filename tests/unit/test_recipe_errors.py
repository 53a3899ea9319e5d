"""Recipes that cannot be followed: one line that names the key, what is wrong and the remedy."""

import tomllib

import pytest

from blind_recipe import BLIND
from clerestory import ClerestoryError
from clerestory.trace import RecipeError, load

WIDTH = "width_mm = 80"
REFLECTANCE = "reflectance = 0.5"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (WIDTH, "widht_mm = 80", "sample.slat.widht_mm: there is no such key (did you mean width_mm?)"),
        (WIDTH, "width_mm = -3", "sample.slat.width_mm: -3 does not fit (give a number greater than 0)"),
        (WIDTH, "width_mm = nan", "sample.slat.width_mm: nan does not fit (give a finite number)"),
        (WIDTH, 'width_mm = "wide"', "sample.slat.width_mm: 'wide' does not fit (give a valid number)"),
        (WIDTH, "width_mm = true", "sample.slat.width_mm: True does not fit (give a valid number)"),
        (WIDTH, "width_mm = 80\ncrown_mm = 50", "sample.slat.crown_mm: 50 mm is more than a half circle over 80 mm"),
        (WIDTH, "width_mm = 80\nbead_mm = 40", "sample.slat.bead_mm: two beads of 40 mm fill the whole slat"),
        ("pitch_mm = 72", "", "sample.pitch_mm: is missing (add it)"),
        ("pitch_mm = 72", "pitch_mm = 0", "sample.pitch_mm: 0 does not fit (give a number greater than 0)"),
        ("pitch_mm = 72", "pitch_mm = 72\ntilt_deg = 95", "sample.tilt_deg: 95 does not fit (give a number less than"),
        ('"venetian-blind"', '"venetian"', "sample.kind: 'venetian' is not known (did you mean venetian-blind?)"),
        ('kind = "lambertian"', "", "materials.paint.kind: is missing"),
        ('"lambertian"', '"lambert"', "materials.paint.kind: 'lambert' is not known (did you mean lambertian?)"),
        ('upper = "paint"', 'upper = "piant"', "sample.slat.upper: there is no material 'piant' (did you mean paint?)"),
        (REFLECTANCE, "reflectance = 1.5", "materials.paint.reflectance: 1.5 in visible is not a share (give 0 to 1)"),
        (
            REFLECTANCE,
            "reflectance = 0.8\ntransmittance = 0.3",
            "materials.paint: reflectance 0.8 and transmittance 0.3 in visible are more than 1 together (lower one",
        ),
        (
            REFLECTANCE,
            "reflectance = { visble = 0.5 }",
            "materials.paint.reflectance.visble: there is no such band (did you mean visible?)",
        ),
        (REFLECTANCE, 'reflectance = "half"', "materials.paint.reflectance: 'half' does not fit (a number, or a table"),
        (
            "[sample]\n",
            '[bands]\nnames = ["visible", "solar"]\n[sample]\n',
            None,
        ),
        (
            "[sample]\n",
            '[bands]\nnames = ["visible", "Visible"]\n[sample]\n',
            "bands.names: 'visible' is there twice (give each band once)",
        ),
    ],
)
def test_a_wrong_key_is_named(old, new, message):
    assert old in BLIND
    text = BLIND.replace(old, new, 1)
    if message is None:
        assert load(tomllib.loads(text)).bands == ["visible", "solar"]
        return
    with pytest.raises(RecipeError) as caught:
        load(tomllib.loads(text))
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, ClerestoryError)


def test_the_file_is_named_first(tmp_path):
    path = tmp_path / "blind.toml"
    path.write_text(BLIND.replace(WIDTH, "width_mm = 0"))
    with pytest.raises(RecipeError, match=r"blind\.toml: sample\.slat\.width_mm: 0 does not fit"):
        load(path)
    path.write_text(BLIND.replace("[sample]", "[sample"))
    with pytest.raises(RecipeError, match=r"blind\.toml: not TOML: .*line 2"):
        load(path)
    path.write_bytes(b"name = '\xff'")
    with pytest.raises(RecipeError, match=r"blind\.toml: byte 8: not text in UTF-8"):
        load(path)


def test_a_recipe_that_does_not_exist_is_named():
    with pytest.raises(RecipeError, match=r"flat-bind: no recipe has this name \(did you mean flat-blind\?"):
        load("flat-bind")
    with pytest.raises(FileNotFoundError):
        load("nowhere.toml")


def test_unusual_sizes_are_warned_of():
    sample = load(tomllib.loads(BLIND.replace(WIDTH, "width_mm = 80000").replace("72", "72000")))
    assert sample.warnings == ["sample.slat.width_mm: 80000 mm is unusual (check the unit)"]
    assert load(tomllib.loads(BLIND)).warnings == []


def test_values_by_band():
    text = BLIND.replace(REFLECTANCE, "reflectance = { visible = 0.5, solar = 0.6 }")
    text += '\n[bands]\nnames = ["solar", "visible"]\n'
    assert load(tomllib.loads(text)).recipe.materials["paint"].reflectance == {"visible": 0.5, "solar": 0.6}
    with pytest.raises(RecipeError, match=r"materials\.paint\.reflectance: no value for the band solar"):
        load(tomllib.loads(text.replace(", solar = 0.6", "")))
