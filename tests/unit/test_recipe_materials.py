"""Materials and media of recipes as the core gets them."""

import tomllib

import numpy as np
import pytest

from clerestory import Bsdf, Model
from clerestory.trace import RecipeError, load
from clerestory.trace.bands import Bands
from clerestory.trace.materials import Glass
from clerestory.trace.media import Medium

SPECTRUM = Bands(names=["486 nm", "588 nm", "656 nm"])


def test_sellmeier_gives_the_indices_of_bk7():
    # SCHOTT N-BK7: n at 587.6 nm is 1.5168, at 486.1 nm 1.52238, at 656.3 nm 1.51432.
    glass = Medium(
        sellmeier=[[1.03961212, 0.00600069867], [0.231792344, 0.0200179144], [1.01046945, 103.560653]],
    )
    bands = Bands(names=["F", "d", "C"], wavelengths_nm=[486.1327, 587.5618, 656.2725])
    assert glass.indices(bands, "media.glass") == pytest.approx([1.52238, 1.51680, 1.51432], abs=2e-5)


def test_cauchy_and_wavelengths_by_name():
    glass = Medium(cauchy=[1.5046, 0.0042])
    assert glass.indices(SPECTRUM, "media.glass") == pytest.approx(
        [1.5046 + 0.0042 / x**2 for x in (0.486, 0.588, 0.656)]
    )
    with pytest.raises(RecipeError, match=r"media\.glass\.cauchy: the wavelength of the band solar is not known"):
        glass.indices(Bands(names=["solar"]), "media.glass")


def test_glass_is_given_by_its_transmittance():
    # Radiance's rule for 88 % at normal incidence: a transmissivity of 0.96.
    spec = Glass(kind="glass", transmittance=0.88).spec(Bands(), "materials.glass", None)
    assert spec.numbers["transmissivity"][0] == pytest.approx(0.9585, abs=5e-4)
    assert not spec.opaque
    with pytest.raises(RecipeError, match=r"materials\.glass\.transmittance: 0\.95 in visible is more than a pane"):
        Glass(kind="glass", transmittance=0.95).spec(Bands(), "materials.glass", None)


def pane(medium="", material="", face='exterior = "m"', thickness=0, more=""):
    return tomllib.loads(f'[sample]\nkind = "pane"\nthickness_mm = {thickness}\n{face}\n{more}\n{material}\n{medium}')


@pytest.mark.parametrize(
    ("material", "message"),
    [
        ('kind = "gaussian"\nwidth = 0.1\nreflectance = 0.6\ndiffuse_transmittance = 0.5', "are more than 1 together"),
        ('kind = "gaussian"\nwidth = 0.0\nreflectance = 0.6', "materials.m.width: 0.0 does not fit"),
        ('kind = "trans"\ncolour = 0.8', "materials.m.transmission: is missing"),
        ('kind = "ggx"\nreflectance = 0.8\nroughness = 2', "materials.m.roughness: 2 does not fit"),
        ('kind = "glass"', "either transmittance or transmissivity"),
        ('kind = "bsdf"\nfile = "nowhere.xml"', "materials.m.file: nowhere.xml does not exist"),
        ('kind = "mixture"\nparts = { other = 0.5 }', "materials.m.parts.other: there is no such material"),
        ('kind = "mixture"\nparts = { m = 1.5 }', "materials.m.parts.m: 1.5 does not fit"),
    ],
)
def test_faulty_materials_are_named(material, message):
    with pytest.raises(RecipeError) as caught:
        load(pane(material=f"[materials.m]\n{material}"))
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("medium", "message"),
    [
        ("", "media.g.index: no refractive index is given"),
        ("index = 1.5\ncauchy = [1.5]", "media.g.index: index and cauchy are both given"),
        ("index = 0.2", "media.g.index: 0.2 in visible is no refractive index"),
        ("index = 1.5\nabsorption_per_m = -1.0", "media.g.absorption_per_m: -1 is below 0"),
        ("index = 1.5\ng = 1.0", "media.g.g: not between −1 and 1"),
    ],
)
def test_faulty_media_are_named(medium, message):
    with pytest.raises(RecipeError) as caught:
        load(pane(medium=f"[media.g]\n{medium}", face='medium = "g"', thickness=4))
    assert message in str(caught.value)


@pytest.mark.parametrize(
    "material",
    [
        'kind = "black"',
        'kind = "plastic"\ncolour = 0.5\nspecularity = 0.05\nroughness = 0.1',
        'kind = "metal"\ncolour = 0.8\nroughness = 0.1',
        'kind = "trans"\ncolour = 0.8\ntransmission = 0.4\ntransmitted_specularity = 0.2\nspecularity = 0.05',
        'kind = "glass"\ntransmittance = 0.88',
        'kind = "ggx"\nreflectance = 0.8\nroughness = 0.3',
        'kind = "gaussian"\nwidth = 0.1\nreflectance = 0.3\ntransmittance = 0.3\ndiffuse_reflectance = 0.2',
        'kind = "abg"\nb = 0.001\ng = 2.0\nreflectance = 0.5',
        'kind = "bsdf"\nfile = "half.bsdf.npz"',
        'kind = "mixture"\nparts = { dark = 0.5, clear = 0.5 }',
    ],
)
def test_every_kind_of_material_can_be_a_sheet(material, tmp_path):
    half = {
        (side, s): Model.lambertian(0.4) for side in ("exterior", "interior") for s in ("transmission", "reflection")
    }
    Bsdf.from_models(half).save(tmp_path / "half.bsdf.npz")
    recipe = tmp_path / "sheet.toml"
    recipe.write_text(
        f'[sample]\nkind = "pane"\nthickness_mm = 0\nexterior = "m"\n[materials.m]\n{material}\n'
        '[materials.dark]\nkind = "black"\n[materials.clear]\nkind = "glass"\ntransmissivity = 1.0\n'
    )
    assert load(recipe).bands == ["visible"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            'kind = "venetian-blind"\npitch_mm = 20\ntilt_deg = 90\n'
            'slat = { width_mm = 30, thickness_mm = 1, upper = "m" }',
            "sample: profile:",
        ),
        (
            'kind = "profile"\npitch_mm = 10\n'
            'outlines = [{ points_mm = [[0, 0], [4, 4], [4, 0], [0, 4]], front = "m" }]',
            "sample: profile:",
        ),
        (
            'kind = "profile"\npitch_mm = 10\noutlines = [{ points_mm = [[0, 0], [4, 4]], medium = "g" }]',
            "sample: profile:",
        ),
        (
            'kind = "layers"\nlayers = [{ kind = "pane", thickness_mm = 4, medium = "g" },'
            ' { kind = "pane", thickness_mm = 4, medium = "g", z_mm = 2 }]',
            "sample.layers[2].z_mm: the layer begins at 2 mm, within layer 1, which ends at 4 mm",
        ),
        (
            'kind = "perforated-screen"\npitch_mm = 2\nhole_mm = 2\nexterior = "m"',
            "sample.hole_mm: holes of 2 mm touch each other",
        ),
        (
            'kind = "woven-fabric"\nweave = "plain"\nopenness = 0.5\n'
            'warp = { per_cm = 20, width_mm = 0.4, thickness_mm = 0.2, material = "m" }\n'
            'weft = { per_cm = 20, thickness_mm = 0.2, material = "m" }',
            "sample.openness: 0.5 is met by no yarn width: the warp alone leaves 0.2 open",
        ),
        (
            'kind = "woven-fabric"\nweave = "plain"\n'
            'warp = { per_cm = 20, width_mm = 0.6, thickness_mm = 0.2, material = "m" }\n'
            'weft = { per_cm = 20, width_mm = 0.2, thickness_mm = 0.2, material = "m" }',
            "sample.warp.width_mm: yarns of 0.6 mm touch at a distance of 0.5 mm",
        ),
        (
            'kind = "venetian-blind"\npitch_mm = 72\nslat = { width_mm = 80, thickness_mm = 1, upper = "t" }',
            "sample.slat.upper: light passes t, so that it cannot be the skin of something thick",
        ),
        ('kind = "scene"\nfile = "x.rad"\nunit = "m"', "sample.period_mm: either period_mm or region_mm is asked for"),
        (
            'kind = "scene"\nfile = "x.rad"\nunit = "m"\nperiod_mm = [1, 1]',
            "sample.file: x.rad",
        ),
        (
            'kind = "height-map"\nfile = "x.csv"\nstep_um = 1\nmedium = "g"\nbase_um = 1',
            "sample.file: x.csv does not exist",
        ),
    ],
)
def test_samples_that_cannot_be_are_named_before_any_tracing(text, message):
    more = (
        '\n[materials.m]\nkind = "black"\n[materials.t]\nkind = "lambertian"\nreflectance = 0.3\ntransmittance = 0.3\n'
        "[media.g]\nindex = 1.5\n"
    )
    with pytest.raises(RecipeError) as caught:
        load(tomllib.loads(f"[sample]\n{text}{more}"))
    assert str(caught.value).startswith(message)


def test_a_height_map_is_a_closed_body(tmp_path):
    x = np.arange(16) / 16.0
    np.save(tmp_path / "heights.npy", 2.0 * np.sin(2 * np.pi * x)[:, None] + np.cos(2 * np.pi * x)[None, :])
    recipe = tmp_path / "film.toml"
    text = (
        '[sample]\nkind = "height-map"\nfile = "heights.npy"\nstep_um = 1\nmedium = "g"\nbase_um = 20\n'
        "{}[media.g]\nindex = 1.5\n"
    )
    for more in ("", "mirrored = true\n", 'relief = "exterior"\n'):
        recipe.write_text(text.format(more))
        sample = load(recipe)
        low, high = sample.depth_m
        assert high - low == pytest.approx(26e-6, rel=1e-2)
    np.savetxt(tmp_path / "heights.csv", np.ones((4, 5)), delimiter=";")
    recipe.write_text(text.replace(".npy", ".csv").format(""))
    assert load(recipe).shapes[0].periods == pytest.approx((5e-6, 4e-6))
    (tmp_path / "heights.csv").write_text("1;2;nan\n1;2;3")
    with pytest.raises(RecipeError, match="has holes: 1 value not finite"):
        load(recipe)


DIELECTRIC = """
void dielectric glass 0 0 5 0.9 0.9 0.9 1.5 0
glass sphere ball 0 0 4 0.5 0.5 0 0.3
void plastic red 0 0 5 0.6 0.2 0.1 0.04 0.1
red polygon sheet 0 0 9 0 0 1  1 0 1  1 1 1
"""


def test_materials_of_a_radiance_scene(tmp_path):
    (tmp_path / "scene.rad").write_text(DIELECTRIC)
    recipe = tmp_path / "scene.toml"
    text = '[sample]\nkind = "scene"\nfile = "scene.rad"\nunit = "cm"\nperiod_mm = [10, 10]\n'
    recipe.write_text(text)
    sample = load(recipe)
    assert sample.depth_m == pytest.approx((-0.003, 0.01), rel=1e-3)
    assert any("the colour of red counts as grey" in w for w in sample.warnings)
    assert sample._media["glass"]["absorption"][0] == pytest.approx(-np.log(0.9) / 0.01)
    recipe.write_text(text + '[sample.surfaces.red]\nmaterial = "m"\n[materials.m]\nkind = "black"\n')
    assert load(recipe).warnings == []
    recipe.write_text(text + '[sample.surfaces.rde]\nmaterial = "m"\n[materials.m]\nkind = "black"\n')
    with pytest.raises(
        RecipeError, match=r"sample\.surfaces\.rde: the file has no such surface \(did you mean red\?\)"
    ):
        load(recipe)
