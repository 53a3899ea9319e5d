"""Layered systems against the textbook recursion (Klems 1994) in a few lines of NumPy, and panes in closed form."""

import numpy as np
import pytest

from clerestory import Basis, Bsdf, ClerestoryError, MissingDataError, Model
from clerestory.directions import direction
from clerestory.integrals import hemispherical
from clerestory.system import Layer, Window, pane, pane_from_normal, stack

BASIS = Basis.named("klems-half")
AREA = BASIS.projected_solid_angles
TURN = BASIS.reversed
COMPONENTS = [(side, scatter) for side in ("exterior", "interior") for scatter in ("transmission", "reflection")]


def shade(seed: int) -> dict[tuple[str, str], np.ndarray]:
    """A reciprocal layer of random values [1/sr] (outgoing, incident)."""
    rng = np.random.default_rng(seed)
    n = len(BASIS)

    def turned(values: np.ndarray) -> np.ndarray:
        return values.T[np.ix_(TURN, TURN)]

    t = 0.4 * 2 / np.pi * rng.random((n, n))
    r = [0.4 / np.pi * rng.random((n, n)) for _ in range(2)]
    return {
        ("exterior", "transmission"): t,
        ("exterior", "reflection"): r[0] + turned(r[0]),
        ("interior", "transmission"): turned(t),
        ("interior", "reflection"): r[1] + turned(r[1]),
    }


def bsdf(layer: dict[tuple[str, str], np.ndarray]) -> Bsdf:
    return Bsdf.from_models({key: Model.matrix(values, BASIS) for key, values in layer.items()})


def glass_table(theta_deg: np.ndarray) -> dict[tuple[str, str], np.ndarray]:
    """Fresnel's formulae for n = 1.52, 6 mm, absorption 15 1/m, as diagonal matrices [1/sr]."""
    n, depth = 1.52, 15.0 * 0.006
    cos = np.cos(np.radians(theta_deg))
    inner = np.sqrt(1 - np.sin(np.radians(theta_deg)) ** 2 / n**2)
    a = np.exp(-depth / inner)
    t, r = 0.0, 0.0
    for face in ((cos - n * inner) / (cos + n * inner), (n * cos - inner) / (n * cos + inner)):
        f = face**2
        part = a * (1 - f) ** 2 / (1 - (a * f) ** 2)
        t, r = t + part / 2, r + f * (1 + a * part) / 2
    values = {"transmission": np.diag(t / AREA), "reflection": np.diag(r / AREA)}
    return {(side, scatter): values[scatter] for side, scatter in COMPONENTS}


def recursion(layers: list[dict[tuple[str, str], np.ndarray]]) -> dict[tuple[str, str], np.ndarray]:
    """The classic result, layer by layer, with explicit inverses."""
    lam, one = np.diag(AREA), np.eye(len(AREA))
    total = layers[0]
    for layer in layers[1:]:
        tf1, rf1, tb1, rb1 = (total[key] for key in COMPONENTS)
        tf2, rf2, tb2, rb2 = (layer[key] for key in COMPONENTS)
        x12 = np.linalg.inv(one - lam @ rb1 @ lam @ rf2)
        x21 = np.linalg.inv(one - lam @ rf2 @ lam @ rb1)
        total = {
            ("exterior", "transmission"): tf2 @ x12 @ lam @ tf1,
            ("interior", "transmission"): tb1 @ x21 @ lam @ tb2,
            ("exterior", "reflection"): rf1 + tb1 @ x21 @ lam @ rf2 @ lam @ tf1,
            ("interior", "reflection"): rb2 + tf2 @ x12 @ lam @ rb1 @ lam @ tb2,
        }
    return total


def classic(model: Bsdf, side: str, scatter: str) -> np.ndarray:
    """Scattered light and beams as one matrix [1/sr] (outgoing, incident)."""
    incident, out_side = BASIS.incident_centres(side), side
    if scatter == "transmission":
        out_side = "interior" if side == "exterior" else "exterior"
    values = model.evaluate(incident[None, :, :], BASIS.outgoing_centres(out_side)[:, None, :])
    beams = model.integrate(incident, scatter, part="direct")
    return values + np.diag(beams / AREA)


@pytest.fixture(scope="module")
def system():
    tables = [glass_table(nominal()), shade(1), shade(2), glass_table(nominal())]
    glass = pane(1.52, absorption_per_m=15.0, thickness_m=0.006)
    return stack([glass, bsdf(tables[1]), bsdf(tables[2]), glass], BASIS), recursion(tables)


def nominal() -> np.ndarray:
    return np.concatenate([np.full(count, centre if count > 1 else 0.0) for _, _, centre, count in BASIS.rings])


@pytest.mark.parametrize(("side", "scatter"), COMPONENTS)
def test_stack_is_the_textbook_recursion(system, side, scatter):
    built, expected = system
    np.testing.assert_allclose(classic(built.bsdf, side, scatter), expected[side, scatter], rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("side", ["exterior", "interior"])
def test_energy_closes(system, side):
    built, _ = system
    incident = BASIS.incident_centres(side)
    absorbed = built.absorptance(side=side)
    assert absorbed.shape == (4, len(BASIS))
    leaving = sum(built.bsdf.integrate(incident, scatter) for scatter in ("transmission", "reflection"))
    np.testing.assert_allclose(leaving + absorbed.sum(axis=0), 1.0, rtol=0, atol=1e-9)


def test_reciprocity_is_kept(system):
    built, _ = system
    front = classic(built.bsdf, "exterior", "transmission")
    back = classic(built.bsdf, "interior", "transmission")
    np.testing.assert_allclose(back, front.T[np.ix_(TURN, TURN)], rtol=1e-10, atol=1e-13)


def test_turning_the_system_round_turns_its_layers_round():
    layers = [bsdf(shade(3)), pane(1.5, internal_transmittance=0.9), bsdf(shade(4))]
    built = stack(layers, BASIS)
    round_ = stack([layer.flipped() for layer in reversed(layers)], BASIS)
    turned = built.bsdf.flipped()
    for side, scatter in COMPONENTS:
        np.testing.assert_allclose(
            classic(round_.bsdf, side, scatter), classic(turned, side, scatter), rtol=1e-10, atol=1e-13
        )


def test_only_light_without_scattering_is_a_beam():
    glass = pane_from_normal(0.8993, 0.0826)
    normal = direction(0.0, 0.0)
    window = stack([glass, bsdf(shade(5)), glass], BASIS).bsdf
    assert window.integrate(normal, "transmission", part="direct") == 0.0
    assert window.integrate(normal, "reflection", part="direct") == pytest.approx(0.0826, abs=1e-12)
    double = stack([glass, glass], BASIS).bsdf
    t, r = 0.8993, 0.0826
    assert double.integrate(normal, "transmission", part="direct") == pytest.approx(t * t / (1 - r * r), abs=1e-12)
    assert double.integrate(normal, "transmission", part="scattered") == 0.0


def test_bands_that_all_layers_have_are_built():
    def diffuser(**by_band: float) -> Bsdf:
        return Bsdf.from_models({band: dict.fromkeys(COMPONENTS, Model.lambertian(v)) for band, v in by_band.items()})

    built = stack([diffuser(visible=0.3, solar=0.2), diffuser(solar=0.4, visible=0.1, nir=0.3)], BASIS)
    assert set(built.bsdf.bands) == {"visible", "solar"}
    assert built.warnings == ["left out, for not all layers have it: band nir"]
    for band, t1, t2 in (("visible", 0.3, 0.1), ("solar", 0.2, 0.4)):
        t = built.bsdf.integrate(direction(30, 90), "transmission", band=band)
        assert t == pytest.approx(t1 * t2 / (1 - t1 * t2), abs=1e-12)
        assert built.absorptance(band).shape == (2, len(BASIS))
    assert "2 layers" in repr(built)
    with pytest.raises(MissingDataError, match="no band in common"):
        stack([diffuser(visible=0.3), diffuser(solar=0.3)], BASIS)


def test_what_is_wrong_names_the_layer():
    whole = shade(6)
    dark = {key: values for key, values in whole.items() if key != ("interior", "reflection")}
    with pytest.raises(MissingDataError, match=r"layer 2.*reflection.*interior"):
        stack([bsdf(whole), bsdf(dark)], BASIS)
    with pytest.raises(ClerestoryError, match="at least one layer"):
        stack([])
    with pytest.raises(ClerestoryError, match="centre or mean"):
        stack([bsdf(whole)], BASIS, specular="middle")  # type: ignore[arg-type]


def test_layers_on_other_patches_are_converted_and_say_so():
    finer = stack([bsdf(shade(6)), bsdf(shade(7))], "klems-full")
    assert len(finer.warnings) == 8
    assert "layer 2, band 'visible': reflection for light from the interior converted from" in finer.warnings[-1]
    plain = stack([bsdf(shade(6)), bsdf(shade(7))], BASIS)
    found, expected = (hemispherical(s.bsdf, "transmission").value for s in (finer, plain))
    # Steps in a random table fall into the middle of finer patches.
    assert found == pytest.approx(expected, rel=0.02)
    diffuse = {key: np.full((len(BASIS), len(BASIS)), 0.3 / np.pi) for key in COMPONENTS}
    even = stack([bsdf(diffuse), bsdf(diffuse)], "klems-full").bsdf.integrate(direction(40, 10), "transmission")
    assert even == pytest.approx(0.09 / (1 - 0.09), abs=1e-9)


def test_a_missing_transmission_side_is_answered_by_reciprocity():
    whole = shade(7)
    half = {key: values for key, values in whole.items() if key != ("interior", "transmission")}
    built, expected = stack([bsdf(half), bsdf(whole)], BASIS), stack([bsdf(whole), bsdf(whole)], BASIS)
    assert len(built.warnings) == 1
    assert "reciprocity" in built.warnings[0]
    for side, scatter in COMPONENTS:
        np.testing.assert_allclose(
            classic(built.bsdf, side, scatter), classic(expected.bsdf, side, scatter), rtol=1e-12
        )


def test_panes_say_what_is_missing():
    with pytest.raises(ClerestoryError, match="thickness_m"):
        pane(1.5)
    with pytest.raises(ClerestoryError, match="not given in one way"):
        pane(1.5, internal_transmittance=0.9, extinction=1e-6)
    with pytest.raises(ClerestoryError, match="refractive index"):
        pane(0.5, internal_transmittance=0.9)
    with pytest.raises(ClerestoryError, match="no uncoated pane"):
        pane_from_normal(0.9, 0.2)


def test_panes_by_extinction_and_by_absorption_agree():
    by_extinction = pane(1.52, extinction=4.5e-7, thickness_m=0.004, wavelength_nm=550.0)
    by_absorption = pane(1.52, absorption_per_m=4 * np.pi * 4.5e-7 / 550e-9, thickness_m=0.004)
    towards = direction(np.linspace(0, 89, 30), 45.0)
    for scatter in ("transmission", "reflection"):
        np.testing.assert_allclose(
            by_extinction.integrate(towards, scatter), by_absorption.integrate(towards, scatter), rtol=1e-12
        )


@pytest.mark.parametrize("side", ["exterior", "interior"])
def test_windows_solve_what_stacks_solve(side):
    """The two solvers: of data sets in the core, and of a window's wavelengths."""
    glass, cloth = pane(1.52, internal_transmittance=0.95), bsdf(shade(8))
    stacked = stack([glass, cloth, glass], BASIS)
    layers = [Layer(f"layer {k}", bsdf=layer) for k, layer in enumerate((glass, cloth, glass))]
    window = Window(layers).solve(BASIS)
    for scatter in ("transmission", "reflection"):
        np.testing.assert_allclose(
            classic(window.bsdf, side, scatter), classic(stacked.bsdf, side, scatter), rtol=1e-9, atol=1e-12
        )
    np.testing.assert_allclose(
        window.absorptance("visible", side), stacked.absorptance("visible", side), rtol=0, atol=1e-12
    )
