"""Conversion of data sets, through the Python face."""

import _thread
import threading

import numpy as np
import pytest

import clerestory
from clerestory import Basis, Bsdf, Model, _core

FULL = Basis.named("klems-full")


def noisy(basis=FULL):
    rng = np.random.default_rng(3)
    values = rng.uniform(0, 0.3, (len(basis), len(basis)))
    return Model.matrix(values, basis, standard_errors=0.1 * values)


def data_set():
    return Bsdf.from_models(
        {
            "visible": {("exterior", "transmission"): noisy(), ("interior", "reflection"): Model.lambertian(0.4)},
            "solar": {("exterior", "transmission"): Model.specular(np.linspace(0.9, 0.2, 9))},
        }
    )


def test_every_component_becomes_a_matrix_with_a_report():
    result = data_set().to_matrix("klems-half", samples=64)
    assert result.bands == ("visible", "solar")
    assert all(m.kind == "matrix" for members in result.models.values() for m in members.values())
    reports = {(r.band, r.side, r.scatter): r for r in result.conversion}
    exact = reports["visible", "exterior", "transmission"]
    assert (exact.source, exact.samples, exact.rms_error) == ("matrix", 0, 0.0)
    sampled = reports["solar", "exterior", "transmission"]
    assert sampled.samples == 64
    assert sampled.worst_direct_hemispherical < 1e-12
    assert data_set().conversion == []


def test_direct_hemispherical_values_are_conserved():
    source = data_set()
    result = source.to_matrix("klems-full", outgoing="klems-quarter")
    model = result.models["visible"]["exterior", "transmission"]
    assert (len(model.incident_basis), len(model.outgoing_basis)) == (145, 41)
    assert model.standard_errors.shape == (41, 145)
    incident = FULL.incident_centres("exterior")
    before = source.integrate(incident, "transmission")
    np.testing.assert_allclose(result.integrate(incident, "transmission"), before, rtol=1e-9)


def test_bands_are_chosen():
    assert data_set().to_matrix("klems-quarter", bands=["solar"]).bands == ("solar",)
    assert data_set().to_matrix("klems-quarter", bands="solar").bands == ("solar",)
    with pytest.raises(clerestory.MissingDataError, match='no band "nir"'):
        data_set().to_matrix("klems-quarter", bands=["nir"])


def test_what_cannot_be_done_is_said():
    with pytest.raises(clerestory.ClerestoryError, match="known: klems-full"):
        data_set().to_matrix("klems-third")
    with pytest.raises(clerestory.ClerestoryError, match="give 2 to"):
        data_set().to_matrix("klems-half", samples=1)


def long_job(progress=None):
    """Ten seconds or more."""
    backwards = _core.Model.from_parts("reversed", [], [], [], [noisy(Basis.named("klems-half"))._core])
    return Bsdf.from_models({("exterior", "transmission"): Model(backwards)}).to_matrix(
        "klems-full", samples=16_384, progress=progress
    )


def test_progress_is_told_and_can_stop_the_work():
    shares = []

    class EnoughError(Exception):
        pass

    def report(share):
        shares.append(share)
        raise EnoughError

    with pytest.raises(EnoughError):
        long_job(report)
    assert len(shares) == 1
    assert 0.0 <= shares[0] <= 1.0


def test_ctrl_c_stops_the_work():
    timer = threading.Timer(0.3, _thread.interrupt_main)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        long_job()
    timer.join()


def test_trees_are_made_of_anything():
    source = data_set()
    result = source.to_tree("tensor4", resolution=4, samples=8, reduce=None)
    assert {m.kind for members in result.models.values() for m in members.values()} == {"tensor tree"}
    reports = {(r.band, r.side, r.scatter): r for r in result.conversion}
    assert reports["visible", "interior", "reflection"].rms_error < 1e-6
    assert reports["solar", "exterior", "transmission"].rms_error is None
    assert reports["solar", "exterior", "transmission"].worst_direct_hemispherical < 0.12
    assert 0.1 < reports["visible", "exterior", "transmission"].rms_error < 1.0


def test_isotropic_trees_are_for_isotropic_samples():
    diffuse = Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.4)})
    assert diffuse.to_tree("tensor3", resolution=3).models["visible"]["exterior", "transmission"].kind == "tensor tree"
    blind = np.where(np.arange(145)[:, None] % 4 == 0, 1.0, 0.0) * np.ones((145, 145))
    values = blind * np.where(FULL.incident_centres("exterior")[:, 1] > 0, 1.0, 0.1)
    model = Model.matrix(values, FULL)
    assert model.anisotropy() > 0.1
    with pytest.raises(clerestory.UnsupportedError, match="use tensor4"):
        Bsdf.from_models({("exterior", "transmission"): model}).to_tree("tensor3", resolution=3)
    with pytest.raises(clerestory.ClerestoryError, match="give tensor3 or tensor4"):
        diffuse.to_tree("tensor5")
    with pytest.raises(clerestory.ClerestoryError, match="give 0 to 10"):
        diffuse.to_tree(resolution=11)
