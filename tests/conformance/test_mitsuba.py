"""Pictures that Mitsuba 3 makes of data sets, beside what the data sets say."""

from __future__ import annotations

import numpy as np
import pytest

from clerestory import Basis, Bsdf, ClerestoryError, Model, direction
from clerestory.directions import SCATTERS, SIDES, outgoing_side
from clerestory.system import pane_from_normal
from registry import CASES

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed (pip install mitsuba)")
import drjit as dr  # noqa: E402

from clerestory.mitsuba import Ways, material, register  # noqa: E402 (needs Mitsuba)

COMPONENTS = [(side, scatter) for side in SIDES for scatter in SCATTERS]
#: In 32 bits, and through a pinhole's pixel.
CLOSE = 2e-3


#: LLVM before 16 ends the process on Mitsuba's kernels; DRJIT_LIBLLVM_PATH names a newer one.
LLVM = ["llvm_ad_rgb"] if "llvm_ad_rgb" in mi.variants() and dr.detail.llvm_version()[0] >= 16 else []


@pytest.fixture(params=["scalar_rgb", *LLVM], autouse=True)
def variant(request):
    mi.set_variant(request.param)
    return request.param


def lambertian(transmittance: float, reflectance: float) -> Bsdf:
    values = {"transmission": transmittance, "reflection": reflectance}
    return Bsdf.from_models({key: Model.lambertian(values[key[1]]) for key in COMPONENTS})


def uneven() -> Bsdf:
    """Matrices without any symmetry, which are not reciprocal."""
    basis, rng = Basis.named("klems-quarter"), np.random.default_rng(8)
    n = len(basis)
    return Bsdf.from_models({key: Model.matrix(rng.random((n, n)) * 0.4 / np.pi, basis) for key in COMPONENTS})


PATHS = {"type": "path", "max_depth": 3, "rr_depth": 100}
#: By directions that the material draws alone, so that there is no noise where it draws by its values.
DRAWN = {"type": "direct", "bsdf_samples": 1, "emitter_samples": 0}


def seen(
    bsdf, light: dict, towards: np.ndarray, *, turned: float = 0.0, samples: int = 16, integrator: dict = PATHS
) -> np.ndarray:
    """Radiance of the origin, towards a direction in the sample's frame; the sample is turned in its plane [°]."""
    eye = (5.0 * towards).tolist()
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": integrator,
            "sensor": {
                "type": "perspective",
                "fov": 0.02,
                "to_world": mi.ScalarTransform4f().look_at(origin=eye, target=[0, 0, 0], up=[0.3, 0.9, 0.1]),
                "film": {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
                "sampler": {"type": "independent", "sample_count": samples},
            },
            "window": {
                "type": "rectangle",
                "bsdf": bsdf,
                "to_world": mi.ScalarTransform4f().rotate([0, 0, 1], turned),
            },
            "light": light,
        }
    )
    return np.array(mi.render(scene, seed=1)).reshape(3)


def sun(incident: np.ndarray) -> dict:
    return {"type": "directional", "direction": (-incident).tolist(), "irradiance": {"type": "rgb", "value": 1.0}}


SKY = {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}}


@pytest.mark.parametrize("side", SIDES)
def test_white_furnace(side):
    """As bright as what surrounds it, where nothing is absorbed."""
    eye = direction(35.0, 20.0, side=side)
    np.testing.assert_allclose(seen(material(lambertian(0.7, 0.3)), SKY, eye, integrator=DRAWN), 1.0, rtol=1e-5)


@pytest.mark.parametrize("scatter", SCATTERS)
@pytest.mark.parametrize("side", SIDES)
def test_a_matrix_in_the_sun(side, scatter):
    """Data that are not reciprocal, by the values for light from the sun, not by those of the reversed path."""
    data, incident = uneven(), direction(50.0, 100.0, side=side)
    eye = direction(20.0, 200.0, side=outgoing_side(side, scatter))
    expected = float(data.evaluate(incident, eye)) * np.cos(np.radians(50.0))
    assert expected != pytest.approx(float(data.evaluate(eye, incident)) * np.cos(np.radians(50.0)), rel=0.05)
    np.testing.assert_allclose(seen(material(data), sun(incident), eye), expected, rtol=CLOSE)


@pytest.mark.parametrize("side", SIDES)
def test_a_matrix_under_the_sky(side, variant):
    """Directions are drawn by the density that is told, and light is weighed by it."""
    data, eye = uneven(), direction(40.0, 300.0, side=side)
    back = Bsdf.from_models({(outgoing_side(s, c), c): data.model(s, c)[0].reciprocal() for s, c in COMPONENTS})
    expected = sum(float(back.integrate(eye, scatter)) for scatter in SCATTERS)
    np.testing.assert_allclose(seen(material(data), SKY, eye, integrator=DRAWN), expected, rtol=CLOSE)
    if "llvm" in variant:  # the other one takes its time
        np.testing.assert_allclose(seen(material(data), SKY, eye, samples=4000), expected, rtol=0.03)


@pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
@pytest.mark.parametrize("name", CASES)
def test_every_kind_of_model(name):
    """What is seen of an even sky is what the data set sends there from all directions."""
    data = CASES[name].bsdf
    back = Ways(data, None).backward
    for side in SIDES:
        eye = direction(41.0, 93.0, side=side)
        expected = sum(float(back.integrate(eye, scatter)) for scatter in SCATTERS)
        found = seen(material(data), SKY, eye, samples=400, integrator=DRAWN)
        # Weights are all alike but for what models draw by bounds of their values.
        np.testing.assert_allclose(found, expected, rtol=0.05, atol=1e-6)


def test_up_is_the_worlds():
    """A shape that is turned in its plane shows the same picture where the sample follows the world."""
    data, incident, eye = uneven(), direction(50.0, 100.0), direction(20.0, 200.0, side="interior")
    expected = float(data.evaluate(incident, eye)) * np.cos(np.radians(50.0))
    upright = seen(material(data, up=(0.0, 1.0, 0.2)), sun(incident), eye, turned=40.0)
    np.testing.assert_allclose(upright, expected, rtol=CLOSE)
    # Without it the sample turns with the shape.
    theirs = data.rotated(40.0).evaluate(incident, eye) * np.cos(np.radians(50.0))
    np.testing.assert_allclose(seen(material(data), sun(incident), eye, turned=40.0), theirs, rtol=CLOSE)


def test_glass():
    """Beams go on and are mirrored; what is seen of the sky is what both make of it."""
    glass, eye = pane_from_normal(0.8, 0.1), direction(60.0, 130.0, side="interior")
    t, r = (float(glass.integrate(eye, scatter)) for scatter in SCATTERS)
    np.testing.assert_allclose(seen(material(glass), SKY, eye, integrator=DRAWN), t + r, rtol=CLOSE)
    # A lamp behind the pane, in the line of sight.
    lamp = {
        "type": "disk",
        "to_world": mi.ScalarTransform4f().look_at(origin=(-8.0 * eye).tolist(), target=[0, 0, 0], up=[0, 1, 0]),
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": 1.0}},
    }
    found = seen(material(glass), lamp, eye, samples=1000, integrator=DRAWN)
    # Rays that are mirrored miss it.
    np.testing.assert_allclose(found, t, atol=4.0 * np.sqrt(t * r / 1000))


def test_files_and_what_is_wrong(tmp_path, variant):
    lambertian(0.5, 0.2).save(tmp_path / "film.bsdf.npz")
    register()
    made = {"type": "clerestory", "filename": str(tmp_path / "film.bsdf.npz"), "up": [0.0, 1.0, 0.0]}
    found = seen(made, SKY, direction(10.0, 0.0, side="interior"), integrator=DRAWN)
    np.testing.assert_allclose(found, 0.7, rtol=1e-5)
    with pytest.raises(Exception, match="needs filename"):
        mi.load_dict({"type": "clerestory"})
    with pytest.raises(ClerestoryError, match="no band 'solar'"):
        material(lambertian(0.5, 0.2), band="solar")
    lying = mi.SurfaceInteraction3f()
    lying.wi, lying.sh_frame = mi.Vector3f(0.6, 0.0, 0.8), mi.Frame3f(mi.Vector3f(0.0, 0.0, 1.0))
    upright = material(lambertian(0.5, 0.2), up=(0.0, 0.0, 1.0))
    with pytest.raises(ClerestoryError, match="along the shape's normal"):
        upright.eval(mi.BSDFContext(), lying, mi.Vector3f(0.0, 0.0, 1.0))
    if "llvm" in variant:
        mi.set_variant("llvm_ad_spectral_polarized")
        with pytest.raises(ClerestoryError, match="no polarisation"):
            material(lambertian(0.5, 0.2))
