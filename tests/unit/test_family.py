"""Products with a parameter: where it stands, data sets by its values, what lies between, and the manifest on disk."""

import json

import numpy as np
import pytest

from blind_recipe import BLIND
from clerestory import Basis, Bsdf, ClerestoryError, Model, trace
from clerestory.directions import direction
from clerestory.system import family
from clerestory.system.dataset import data_set
from clerestory.system.family import place
from clerestory.system.family.family import Family, State
from clerestory.system.product import Curve, product_of

SIDES = [(side, scatter) for side in ("exterior", "interior") for scatter in ("transmission", "reflection")]
QUARTER = Basis.named("klems-quarter")
NORMAL = np.array([0.0, 0.0, -1.0])
CROWNED = BLIND.replace("width_mm = 80", "width_mm = 80\ncrown_mm = 5")
HEAD = '[family]\nparameter = "tilt_deg"\nvalues = [0, 30, 60]\nbasis = "klems-quarter"\nsamples = 32\n'


def written(folder, text, name="family.toml"):
    path = folder / name
    path.write_text(text)
    return path


def matrix_state(name, value, transmittance):
    components = {
        (side, scatter): Model.matrix(np.full((41, 41), x / np.pi), QUARTER)
        for side in ("exterior", "interior")
        for scatter, x in (("transmission", transmittance), ("reflection", 0.3))
    }
    return State(name, value, Bsdf.from_models(components).with_metadata(name=name), ({"number": 1, "kind": "file"},))


def test_a_blind_gets_a_data_set_for_each_tilt(tmp_path):
    planned = family.load(written(tmp_path, HEAD + CROWNED))
    assert planned.slats_mm == {"width": 80.0, "pitch": 72.0, "crown": 5.0}
    made = planned.make()
    assert [s.name for s in made.states] == ["tilt_0", "tilt_30", "tilt_60"]
    through = [float(s.bsdf.integrate(NORMAL, "transmission", part="direct")) for s in made.states]
    # Rays along the normal see the gap less the arc's height, or the slat's height where it is turned by more.
    expected = [1.0 - 5.0 / 72.0, 1.0 - 40.0 / 72.0, 1.0 - 80.0 * np.sin(np.radians(60.0)) / 72.0]
    np.testing.assert_allclose(through, expected, atol=0.06)
    assert [s.components[0]["sample"] for s in made.states] == ["venetian-blind"] * 3


def test_a_layer_of_a_window_changes_though_its_recipe_is_a_file(tmp_path):
    written(tmp_path, CROWNED, "blind.toml")
    window = """
[family]
parameter = "tilt_deg"
values = [0, 45]
[system]
basis = "klems-quarter"
[[layers]]
kind = "recipe"
recipe = "blind.toml"
samples = 32
[[layers]]
kind = "gap"
gas = "air"
width_mm = 50
[[layers]]
kind = "glass"
glass = "clear"
thickness_mm = 4
"""
    planned = family.load(written(tmp_path, window))
    assert place.words(planned.place) == "layers[1].changed.sample.tilt_deg"
    made = planned.make()
    assert [[c["kind"] for c in s.components] for s in made.states] == [["recipe", "gap", "glass"]] * 2
    light = [float(s.bsdf.integrate(NORMAL, "transmission")) for s in made.states]
    assert light[0] > 2.0 * light[1]
    # A key of a layer itself can change as well.
    for key in ("layers[2].width_mm", "width_mm"):
        text = window.replace('"tilt_deg"', f'"{key}"').replace("[0, 45]", "[10, 50]")
        if key == "width_mm":
            with pytest.raises(ClerestoryError, match=r"width_mm stands in several places \(give one of"):
                family.load(written(tmp_path, text))
        else:
            assert family.load(written(tmp_path, text)).place == ("layers", 1, "width_mm")


def test_a_height_mixes_the_product_with_an_opening(tmp_path):
    text = HEAD.replace("tilt_deg", "height").replace("[0, 30, 60]", "[0, 0.25, 1]") + CROWNED
    made = family.load(written(tmp_path, text)).make()
    whole = float(made.states[2].bsdf.integrate(NORMAL, "transmission"))
    found = [float(s.bsdf.integrate(NORMAL, "transmission")) for s in made.states]
    np.testing.assert_allclose(found, [1.0, 0.75 + 0.25 * whole, whole], rtol=1e-6)


PANE = '[[layers]]\nkind = "glass"\nglass = "clear"\nthickness_mm = 4\n'
SHARP = '[system]\nresolution = "layers"\n' + PANE
OVER_GLASS = """
[system]
resolution = "layers"
basis = "klems-quarter"
[[layers]]
kind = "glass"
glass = "clear"
thickness_mm = 4
[[layers]]
kind = "gap"
gas = "air"
width_mm = 20
[[layers]]
kind = "recipe"
samples = 16
recipe = "blind.toml"
"""
HALF = '[family]\nparameter = "height"\nvalues = [0, 0.5, 1]\nbasis = "klems-quarter"\nsamples = 16\n'
AT_33 = direction(33.0, 90.0)


@pytest.mark.parametrize("without", ["sharp.toml", "pane.toml", "blind.toml", "pane.npz", "flat-blind"])
def test_the_window_without_the_product_is_named_as_everywhere(tmp_path, without):
    written(tmp_path, CROWNED, "blind.toml")
    written(tmp_path, PANE, "pane.toml")
    written(tmp_path, SHARP, "sharp.toml")
    Bsdf.from_models({"visible": dict.fromkeys(SIDES, Model.specular(0.4))}).save(tmp_path / "pane.npz")

    def few(sample, **settings):
        return trace.measure(sample, **{**settings, "samples": 16})

    planned = family.load(written(tmp_path, f'{HALF}without = "{without}"\n' + CROWNED))
    made = planned.make(few)
    alone = data_set(without, tmp_path, traced=few)
    assert set(alone.sources) <= set(planned.sources)
    assert [s.bsdf.bands for s in made.states] == [("visible",)] * 3
    # Half of the window is as it is without the product, half as it is with it, for beams as for all light.
    for part in ("all", "direct"):
        open_, half, lowered = (float(s.bsdf.integrate(AT_33, "transmission", part=part)) for s in made.states)
        assert half == pytest.approx(0.5 * (open_ + lowered), abs=1e-6)
        assert open_ == pytest.approx(float(alone.bsdf.integrate(AT_33, "transmission", band="visible", part=part)))


def test_over_sharp_glass_both_windows_are_sharp(tmp_path):
    written(tmp_path, CROWNED, "blind.toml")
    written(tmp_path, SHARP, "sharp.toml")
    head = HALF.replace('basis = "klems-quarter"\nsamples = 16', 'without = "sharp.toml"')
    planned = family.load(written(tmp_path, head + OVER_GLASS))
    made = planned.make()
    # A pane sends light straight on, and what it lets through at 33° is its own, not that of a patch.
    through = float(made.states[0].bsdf.integrate(AT_33, "transmission"))
    assert through == float(made.states[0].bsdf.integrate(AT_33, "transmission", part="direct"))
    assert through == pytest.approx(0.8878, abs=5e-4)
    assert "clear 4 mm: solar, nir left out, which the product has not" in planned.notes
    sharp = data_set("sharp.toml", tmp_path).bsdf
    assert made.states[0].bsdf.metadata.emissivity_exterior == pytest.approx(0.84, abs=0.01)
    sharp.only_band("solar").save(tmp_path / "solar.npz")
    planned = family.load(written(tmp_path, HALF + 'without = "solar.npz"\n' + CROWNED))
    with pytest.raises(ClerestoryError, match=r"^family.without: .* has solar, the product visible \(build both"):
        planned.make()


def test_between_states_is_a_mixture_by_distance():
    made = Family("f", "tilt_deg", (matrix_state("tilt_0", 0.0, 0.6), matrix_state("tilt_40", 40.0, 0.2)))
    assert float(made.at(10.0).bsdf.integrate(NORMAL, "transmission")) == pytest.approx(0.5)
    assert made.at(40.0) is made.states[1]
    assert made.nearest(20.0).value == 0.0
    assert made.nearest(20.1).value == 40.0
    finer = made.refined(15.0)
    assert finer.values == [0.0, 15.0, 30.0, 40.0]
    assert finer.states[1].bsdf.models["visible"]["exterior", "transmission"].kind == "matrix"
    with pytest.raises(ClerestoryError, match=r"tilt_deg 50 lies beyond the states of f \(0 to 40\)"):
        made.at(50.0)
    with pytest.raises(ClerestoryError, match="step of 0 "):
        made.refined(0.0)


def test_states_of_other_bands_do_not_mix():
    one, other = matrix_state("tilt_0", 0.0, 0.6), matrix_state("tilt_40", 40.0, 0.2)
    renamed = State(other.name, other.value, other.bsdf.renamed_band("visible", "solar"))
    with pytest.raises(ClerestoryError, match="tilt_40 has a band 'solar', tilt_0 has none"):
        Family("f", "tilt_deg", (one, renamed)).at(10.0)


@pytest.mark.parametrize("xml", [None, "plain"])
def test_a_manifest_brings_it_back(tmp_path, xml):
    states = (matrix_state("tilt_0", 0.0, 0.6), matrix_state("tilt_40", 40.0, 0.2))
    made = Family("f", "tilt_deg", states, {"width": 80.0, "pitch": 72.0, "crown": 5.0})
    curve = Curve((0.0, 45.0), (None, 12.5), (80.0, 72.0, 5.0), 3.0)
    files, notes = family.write(made, tmp_path / "out", xml=xml, curve=curve)
    assert notes == []
    assert files[-1].name == "family.json"
    back = family.read(tmp_path / "out")
    assert (back.name, back.parameter, back.values, back.slats_mm) == ("f", "tilt_deg", [0.0, 40.0], made.slats_mm)
    assert [s.components for s in back.states] == [s.components for s in states]
    for a, b in zip(back.states, states, strict=True):
        assert a.bsdf.integrate(NORMAL, "transmission") == pytest.approx(b.bsdf.integrate(NORMAL, "transmission"))
        if xml:
            data = product_of(a.bsdf)
            assert (data.parameter, data.value, data.curve) == ("tilt_deg", a.value, curve)
    # A file that was changed, or is gone, is told.
    files[0].write_bytes(files[0].read_bytes() + b" ")
    with pytest.raises(ClerestoryError, match=r"state 1 \(tilt_0\): .* has changed since"):
        family.read(files[-1])
    files[0].unlink()
    with pytest.raises(ClerestoryError, match=r"state 1 \(tilt_0\): .* does not exist"):
        family.read(files[-1])


def test_damaged_manifests(tmp_path):
    states = (matrix_state("tilt_0", 0.0, 0.6), matrix_state("tilt_40", 40.0, 0.2))
    *_, manifest = family.write(Family("f", "tilt_deg", states), tmp_path)[0]
    good = json.loads(manifest.read_text())

    def fails(change, match):
        held = json.loads(json.dumps(good))
        change(held)
        manifest.write_text(json.dumps(held))
        with pytest.raises(ClerestoryError, match=match) as error:
            family.read(manifest)
        assert "family.json" in str(error.value)

    fails(lambda m: m.pop("format"), "no manifest of a family")
    fails(lambda m: m.update(version=2), "version")
    fails(lambda m: m["states"][0].pop("value"), r"states\[1\].value: is missing")
    fails(lambda m: m["states"].reverse() or m["states"][0].update(value=0.0), "neither rise nor fall")
    fails(lambda m: m["states"][0].update(file="../x.xml"), r"state 1 \(tilt_0\): its file lies elsewhere")
    manifest.write_text("[1, 2")
    with pytest.raises(ClerestoryError, match="no manifest of a family"):
        family.read(manifest)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        (CROWNED, r"family: is missing \(add a table"),
        (HEAD, "family.product: is missing"),
        (HEAD + 'product = "round-robin-blind"\n' + CROWNED, r"tables beside \[family\]: sample, materials"),
        (HEAD + 'product = "round-robin-blinds"\n', "did you mean round-robin-blind"),
        (HEAD + 'product = "none.toml"\n', "none.toml does not exist"),
        (HEAD.replace("tilt_deg", "tilt") + CROWNED, r"the product has no tilt with a number \(it has"),
        (HEAD.replace("[0, 30, 60]", "[0, 60, 30]") + CROWNED, "family.values: they neither rise nor fall"),
        (HEAD.replace("[0, 30, 60]", "[0]") + CROWNED, "family.values"),
        (HEAD.replace("tilt_deg", "height") + CROWNED, "a height is a share"),
        (HEAD + 'without = "x.xml"\n' + CROWNED, "family.without: goes with the parameter height"),
        (HEAD + "tilts = [1]\n" + CROWNED, r"family.tilts: there is no such key"),
        (HEAD + '[product]\norientation = { mounting = "roof" }\n' + CROWNED, "product.orientation.up_azimuth_deg"),
    ],
)
def test_faults_of_a_specification_are_named(tmp_path, text, match):
    path = written(tmp_path, text)
    with pytest.raises(ClerestoryError, match=match) as error:
        family.load(path)
    assert str(error.value).startswith(f"{path}: ")


def test_a_state_that_cannot_be_made_is_named(tmp_path):
    planned = family.load(written(tmp_path, HEAD.replace("[0, 30, 60]", "[0, 95]") + CROWNED))
    with pytest.raises(ClerestoryError, match=r"state tilt_95: sample\.tilt_deg"):
        planned.make()
