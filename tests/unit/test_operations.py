"""Data sets made of others: scaled, normalised, mixed, reciprocal, with separated peaks."""

import numpy as np
import pytest

import clerestory
from clerestory import Basis, Bsdf, Model

QUARTER = Basis.named("klems-quarter")
FULL = Basis.named("klems-full")


def table(seed, basis=QUARTER, scale=0.3):
    values = np.random.default_rng(seed).uniform(0, scale, (len(basis), len(basis)))
    return Model.matrix(values, basis)


def sheet():
    """A diffuser of 0.2 and a beam of 0.4 in the patch straight through."""
    values = np.full((145, 145), 0.2 / np.pi)
    values[np.diag_indices(145)] += 0.4 / FULL.projected_solid_angles
    return Bsdf.from_models(
        {("exterior", "transmission"): Model.matrix(values, FULL), ("exterior", "reflection"): Model.lambertian(0.3)}
    )


def test_normalised_by_patch_and_by_one_number():
    source = Bsdf.from_models({("exterior", "transmission"): table(1)})
    incident = QUARTER.incident_centres("exterior")
    wanted = np.linspace(0.1, 0.9, 41)
    result = source.normalised(wanted, "exterior", "transmission", basis=QUARTER)
    np.testing.assert_allclose(result.integrate(incident, "transmission"), wanted)
    result = source.normalised(0.25, "exterior", "transmission", basis="klems-quarter")
    np.testing.assert_allclose(result.integrate(incident, "transmission"), 0.25)
    with pytest.raises(clerestory.MissingDataError, match="no reflection"):
        source.normalised(0.25, "exterior", "reflection")
    with pytest.raises(clerestory.ClerestoryError, match="3 direct-hemispherical values"):
        source.normalised([0.1, 0.2, 0.3], "exterior", "transmission")


def test_normalising_scattered_light_keeps_the_peak():
    model = Model.sum([(1.0, Model.specular(0.3)), (1.0, table(2, FULL))])
    source = Bsdf.from_models({("exterior", "transmission"): model})
    result = source.normalised(0.5, "exterior", "transmission", part="scattered")
    incident = FULL.incident_centres("exterior")
    np.testing.assert_allclose(result.integrate(incident, "transmission"), 0.5)
    np.testing.assert_allclose(result.integrate(incident, "transmission", part="direct"), 0.3)


def test_scaled():
    result = sheet().scaled(0.5)
    incident = FULL.incident_centres("exterior")
    np.testing.assert_allclose(result.integrate(incident, "transmission"), 0.3)
    np.testing.assert_allclose(result.integrate(incident, "reflection"), 0.15)
    with pytest.raises(clerestory.ClerestoryError, match="factor -1"):
        sheet().scaled(-1.0)


def test_reciprocal_average_makes_the_error_zero():
    front, back = table(3), table(4)
    assert front.reciprocity_error(back) > 0.3
    source = Bsdf.from_models({("exterior", "transmission"): front, ("interior", "transmission"): back})
    models = source.reciprocal_average().models["visible"]
    forced = models["exterior", "transmission"]
    assert forced.reciprocity_error(models["interior", "transmission"]) < 1e-12
    reversed_ = QUARTER.reversed
    expected = (front.values + back.values.T[np.ix_(reversed_, reversed_)]) / 2
    np.testing.assert_allclose(forced.values, expected)
    assert np.isnan(Model.lambertian(0.0).reciprocity_error(Model.lambertian(0.0)))


def test_bands_are_mixed_renamed_and_taken_apart():
    source = Bsdf.from_models(
        {
            "visible": {("exterior", "transmission"): table(5)},
            "nir": {("exterior", "transmission"): table(6)},
        }
    )
    mixed = source.with_band("solar", {"visible": 0.499, "nir": 0.501})
    assert mixed.bands == ("visible", "nir", "solar")
    again = mixed.with_near_infrared(0.499)
    key = ("exterior", "transmission")
    np.testing.assert_allclose(again.models["nir"][key].values, source.models["nir"][key].values, atol=1e-12)
    assert again.warnings == []
    worse = mixed.with_near_infrared(0.9)
    assert "values are negative" in worse.warnings[0]
    assert mixed.renamed_band("nir", "Infra").bands == ("visible", "infra", "solar")
    with pytest.raises(clerestory.ClerestoryError, match="there twice"):
        mixed.renamed_band("nir", "solar")


def test_mixed_kinds_become_a_sum():
    mixed = Model.mixture([(0.5, table(7)), (0.5, Model.lambertian(0.4))])
    assert mixed.kind == "sum"
    assert Model.mixture([(0.5, Model.lambertian(0.2)), (0.5, Model.lambertian(0.4))]).kind == "Lambertian"


def test_peaks_are_separated_in_transmission_only():
    separated = sheet().separate_peaks()
    kinds = {key: m.kind for key, m in separated.models["visible"].items()}
    assert kinds == {("exterior", "transmission"): "separated", ("exterior", "reflection"): "Lambertian"}
    incident = FULL.incident_centres("exterior")[[0, 40, 87]]
    np.testing.assert_allclose(separated.integrate(incident, "transmission", part="direct"), 0.4, rtol=1e-3)
    np.testing.assert_allclose(separated.integrate(incident, "transmission"), 0.6)
