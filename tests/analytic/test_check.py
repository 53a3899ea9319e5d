"""Checks find what they are for, and stay silent on sound data."""

import numpy as np
import pytest

from clerestory import Basis, Bsdf, Metadata, Model
from clerestory.check import Finding, check
from clerestory.check.tables import neighbours
from samples import sample_files

KLEMS = Basis.named("klems-full")
AREAS = KLEMS.projected_solid_angles
CENTRES = KLEMS.outgoing_centres("interior")
REVERSED = KLEMS.reversed
NORMAL, ABOVE_30 = 0, 40


def diagonal(values):
    return np.diag(np.broadcast_to(values, 145) / AREAS)


def lobe(width=0.3, total=0.5):
    """A reciprocal forward-scattering sample, about `total` of the light."""
    distance = np.linalg.norm(CENTRES[:, None, :2] - CENTRES[None, :, :2], axis=2)
    values = np.exp(-((distance / width) ** 2))
    return values * total / float(np.max(AREAS @ values))


def redirecting():
    """Sends the most of what comes from above up, and lets the rest through."""
    values = np.diag(np.where(CENTRES[:, 1] < -1e-9, 0.3, 0.4))
    for i, travel in enumerate(CENTRES):
        if travel[1] < -1e-9:
            values[KLEMS.index_of_outgoing(travel * [1.0, -1.0, 1.0]), i] = 0.4
    return values / AREAS[:, None]


def opposite(values):
    """What reciprocity makes of transmission for the other side."""
    return values.T[np.ix_(REVERSED, REVERSED)]


def of(band="visible", **values):
    names = {
        "t": ("exterior", "transmission"),
        "tb": ("interior", "transmission"),
        "r": ("exterior", "reflection"),
        "rb": ("interior", "reflection"),
    }
    return Bsdf.from_models({band: {names[k]: Model.matrix(v, KLEMS) for k, v in values.items()}})


def found(bsdf, name, **options):
    return [finding for finding in check(bsdf, **options) if finding.check == name]


SOUND = {
    "pane": of(t=diagonal(0.8), tb=diagonal(0.8), r=diagonal(0.1), rb=diagonal(0.1)),
    "scattering": of(t=lobe(), tb=opposite(lobe()), r=lobe(1.0, 0.3), rb=lobe(1.0, 0.3)),
    "redirecting": of(t=redirecting(), tb=opposite(redirecting()), r=diagonal(0.05), rb=diagonal(0.05)),
    "diffuser and mirror": Bsdf.from_models(
        {
            ("exterior", "transmission"): Model.lambertian(0.4),
            ("interior", "transmission"): Model.lambertian(0.4),
            ("exterior", "reflection"): Model.specular(0.5),
            ("interior", "reflection"): Model.specular(0.5),
        }
    ),
}


@pytest.mark.parametrize("name", SOUND)
def test_sound_data_have_no_errors_and_no_warnings(name):
    assert [f for f in check(SOUND[name]) if f.severity != "note"] == []


def test_every_finding_speaks():
    bad = of(t=100.0 * lobe(), r=lobe(1.0, 0.9))
    for finding in check(bad, purpose="glare"):
        assert isinstance(finding, Finding)
        assert finding.where
        assert finding.what
        assert str(finding).startswith(f"{finding.severity}: {finding.where}: ")
        assert "\n" not in str(finding)
    severities = [f.severity for f in check(bad)]
    assert severities == sorted(severities, key=["error", "warning", "note"].index)


def test_energy():
    assert found(of(t=diagonal(0.9), r=diagonal(0.1)), "energy") == []
    (finding,) = found(of(t=diagonal(0.93), r=diagonal(0.1)), "energy")
    assert finding.severity == "warning"
    values = np.full(145, 0.8)
    values[ABOVE_30] = 1.1
    (finding,) = found(of(t=diagonal(values), r=diagonal(0.1)), "energy")
    assert finding.severity == "error"
    assert "1 of 145" in finding.what
    assert "from above, 30° (Klems 41)" in finding.what
    assert "110 % passes and 10 % is reflected" in finding.what


def test_energy_of_a_colour_weight_is_none():
    assert check(of("cie-z", t=diagonal(1.2))) == []


def test_reciprocity_between_the_sides():
    assert found(SOUND["redirecting"], "reciprocity") == []
    noise = np.random.default_rng(0).normal(1.0, 0.25, (145, 145))
    (finding,) = found(of(t=lobe(), tb=lobe() * noise), "reciprocity")
    assert finding.severity == "warning"
    assert "between the sides" in finding.what


def test_reciprocity_of_a_reflection():
    values = lobe(1.0, 0.3) * np.random.default_rng(0).normal(1.0, 0.25, (145, 145))
    (finding,) = found(of(r=values), "reciprocity")
    assert finding.where == "visible, reflection from the exterior"


@pytest.mark.parametrize(
    ("move", "words"),
    [
        ([-1.0, 1.0, 1.0], "mirrored left to right"),
        ([1.0, -1.0, 1.0], "mirrored up to down"),
        ([-1.0, -1.0, 1.0], "turned by 180°"),
    ],
)
def test_a_side_that_counts_directions_differently_is_named(move, words):
    skewed = np.zeros((145, 145))
    for i, travel in enumerate(CENTRES):
        target = np.array([travel[0] * 0.5 - 0.3, travel[1] * 0.5 + 0.2, 1.0])
        skewed[KLEMS.index_of_outgoing(target), i] = 0.6
    skewed /= AREAS[:, None]
    order = KLEMS.index_of_outgoing(CENTRES * move)
    (finding,) = found(of(t=skewed, tb=opposite(skewed)[np.ix_(order, order)]), "convention")
    assert finding.what.endswith(f"from the interior {words}")


def test_unequal_halves():
    (finding,) = found(of(t=lobe(total=0.5), tb=lobe(total=0.4)), "sides")[:1]
    assert "reciprocity makes them equal" in finding.what


def test_negative_values():
    values = lobe()
    values[3, 5] = -1e-4
    (finding,) = found(of(t=values), "negative")
    assert finding.severity == "note"
    assert finding.what.startswith("1 of 21025 values is negative; it would take")
    (finding,) = found(of(t=lobe() - 0.3), "negative")
    assert finding.severity == "warning"


def test_empty_patches():
    values = lobe()
    values[:, ABOVE_30] = 0.0
    (finding,) = found(of(t=values), "empty")
    assert "from above, 30° (Klems 41)" in finding.what
    values[:, 133:] = 0.0
    assert len(found(of(t=values), "empty")) == 2
    # Slats cut the light off: a large dark region is no gap.
    assert found(of(t=diagonal(np.where(CENTRES[:, 1] < -0.5, 0.0, 0.5))), "empty") == []
    # Yarns cut it off step by step.
    assert found(of(t=diagonal(np.maximum(0.0, CENTRES[:, 2] - 0.2))), "empty") == []


def test_outliers():
    values = np.full(145, 0.5)
    values[ABOVE_30] = 0.3
    (finding,) = found(of(t=diagonal(values)), "outlier")
    assert finding.what == "30 % for light from above, 30° (Klems 41), but 50 % around it"
    values = np.full(145, 0.5)
    values[NORMAL] = 0.3
    assert "along the normal (Klems 1)" in found(of(t=diagonal(values)), "outlier")[0].what
    # A honeycomb has a tip at the normal.
    theta = KLEMS.limits_deg[:, :2].mean(axis=1)
    theta[0] = 0.0
    tip = np.maximum(0.0, 1.0 - np.tan(np.radians(theta)) * 1.6)
    assert found(of(t=diagonal(tip * 0.95)), "outlier") == []


def test_missing_halves():
    (finding,) = [f for f in found(of(tb=lobe(), rb=lobe(1, 0.1)), "sides") if f.severity == "warning"]
    assert "make sure that exterior and interior are not swapped" in finding.remedy
    assert any("no transmission" in f.what for f in found(of(r=lobe()), "sides"))
    assert any("none from the interior" in f.what for f in found(of(t=lobe(), r=lobe(1, 0.1)), "sides"))
    assert found(SOUND["pane"], "sides") == []


def test_copies():
    (finding,) = found(of(t=redirecting(), r=redirecting()), "copy")
    assert finding.severity == "error"
    assert finding.where == "visible, reflection from the exterior"
    assert finding.what == "the values are those of the transmission from the exterior"
    (finding,) = found(of(t=redirecting(), tb=redirecting()), "copy")
    assert "the data from the interior are a copy of the exterior's" in finding.what
    assert found(of(t=diagonal(0.5), tb=diagonal(0.5)), "copy") == []  # symmetric: no fault


def test_placeholders():
    (finding,) = found(of(t=np.full((145, 145), 0.1)), "placeholder")
    assert finding.severity == "warning"
    assert "0.1/sr (31 %, an ideal diffuser)" in finding.what
    (finding,) = found(of(t=lobe(), r=np.zeros((145, 145))), "placeholder")
    assert finding.severity == "note"
    assert found(Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.3)}), "placeholder") == []


def test_transposed():
    """A sample that gathers light from above downward: its transpose sends more light out than came in."""
    gathering = np.zeros((145, 145))
    for i, travel in enumerate(CENTRES):
        target = np.array([0.2 * travel[0], 0.2 * travel[1] - 0.3, 1.0])
        gathering[KLEMS.index_of_outgoing(target), i] = 0.8
    gathering /= AREAS[:, None]
    assert found(of(t=gathering), "transposed") == []
    (finding,) = found(of(t=gathering.T), "transposed")
    assert finding.severity == "warning"
    assert "rows and columns look exchanged" in finding.what


@pytest.mark.parametrize("factor", [1.0, 0.3])
def test_units(factor):
    assert found(of(t=factor * lobe(1.0)), "unit") == []
    (finding,) = found(of(t=100.0 * factor * lobe(1.0)), "unit")
    assert finding.severity == "error"
    assert finding.remedy == "divide them by 100"
    diffuser = np.full((145, 145), factor * 0.6 / np.pi) + factor * diagonal(0.1)
    (finding,) = found(of(t=diffuser * CENTRES[:, 2:]), "unit")
    assert "BSDF times cosine" in finding.what
    (finding,) = found(of(t=diffuser * AREAS[:, None]), "unit")
    assert "flux per patch" in finding.what
    assert found(of(t=diffuser), "unit") == []


def test_flux_per_patch_of_a_pane():
    pane = np.diag(np.full(145, 0.8))
    (finding,) = found(of(t=pane, r=pane / 8.0), "unit")
    assert "flux per outgoing patch" in finding.what
    # A thin black fabric is dark, but not as dark as that.
    assert found(of(t=diagonal(0.02), r=diagonal(0.04)), "unit") == []


def test_symmetry_is_told():
    (finding,) = found(SOUND["redirecting"], "symmetry")
    assert finding.severity == "note"
    assert finding.what.startswith("symmetric left–right; differences: left–right 0 %, up–down ")
    assert "every way" in found(SOUND["pane"], "symmetry")[0].what
    quarter = KLEMS.index_of_outgoing(CENTRES[:, [1, 0, 2]])
    vertical = redirecting()[np.ix_(quarter, quarter)] + opposite(redirecting()[np.ix_(quarter, quarter)])
    assert "as of vertical slats" in found(of(t=vertical * 0.5), "symmetry")[0].what


def test_a_blind_is_not_symmetric_in_every_way(monkeypatch):
    monkeypatch.setattr(Bsdf, "metadata", Metadata(name="Venetian blind 80 mm"))
    (finding,) = found(SOUND["pane"], "symmetry")
    assert finding.severity == "warning"
    assert "though the sample is called a blind" in finding.what
    assert found(SOUND["redirecting"], "symmetry")[0].severity == "note"


def test_thermal_values(monkeypatch):
    monkeypatch.setattr(Bsdf, "metadata", Metadata(emissivity_exterior=0.9, emissivity_interior=0.7, tir=0.3))
    (finding,) = found(SOUND["pane"], "thermal")
    assert finding.severity == "error"
    assert finding.where == "exterior face"
    assert finding.what == "emissivity 0.9 and thermal-infrared transmittance 0.3 are more than 1 together"
    monkeypatch.setattr(Bsdf, "metadata", Metadata(emissivity_interior=1.2))
    assert "does not exist" in found(SOUND["pane"], "thermal")[0].what


def test_warnings_of_the_file_come_along(monkeypatch):
    monkeypatch.setattr(Bsdf, "warnings", ["a log line before the XML"])
    assert found(of(t=lobe()), "file")[0].what == "a log line before the XML"


def test_purposes():
    klems = SOUND["pane"]
    (finding,) = found(klems, "purpose", purpose="glare")
    assert finding.severity == "warning"
    assert "the data resolve 10°, the sun is 0.53° wide" in finding.what
    assert "--separate-peaks" in finding.remedy
    assert found(klems, "purpose", purpose="ase")[0].severity == "warning"
    assert found(klems, "purpose", purpose="illuminance")[0].severity == "note"
    quarter = Basis.named("klems-quarter")
    coarse = Bsdf.from_models({("exterior", "transmission"): Model.matrix(np.full((41, 41), 0.1), quarter)})
    assert found(coarse, "purpose", purpose="illuminance")[0].severity == "warning"
    for purpose in ("illuminance", "glare", "ase"):
        assert found(SOUND["diffuser and mirror"], "purpose", purpose=purpose)[0].severity == "note"
        assert found(of(r=lobe()), "purpose", purpose=purpose)[0].severity == "error"
    beam = Bsdf.from_models(
        {("exterior", "transmission"): Model.sum([(1.0, Model.specular(0.1)), (1.0, Model.matrix(lobe(), KLEMS))])}
    )
    assert "the through-beam is separate" in found(beam, "purpose", purpose="glare")[0].what
    diffuse = of(t=np.full((145, 145), 0.1))
    assert "no through-beam" in found(diffuse, "purpose", purpose="glare")[0].what


def test_neighbours_touch_each_other():
    for basis in (KLEMS, Basis.named("klems-quarter"), Basis.named("tregenza")):
        near = neighbours(basis)
        for k, touching in enumerate(near):
            assert 3 <= len(touching) <= 30
            assert k not in touching
            assert all(k in near[other] for other in touching)
    assert set(neighbours(KLEMS)[0]) == set(range(1, 9))


@pytest.mark.parametrize("path", sample_files("klems", "tensortree"))
def test_real_files_can_be_checked(path):
    import clerestory

    for finding in check(clerestory.read(path), purpose="glare"):
        assert "nan" not in str(finding)
        assert len(str(finding)) < 420
