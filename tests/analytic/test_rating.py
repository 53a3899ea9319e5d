"""Figures of EN 14500 and classes of EN 14501 on systems that are known."""

import re
from pathlib import Path

import numpy as np
import pytest

from clerestory import Bsdf, ClerestoryError, MissingDataError, Model
from clerestory.rating import classify, optics
from clerestory.rating.classes import edition
from clerestory.rating.product import rate_device, rate_window
from clerestory.thermal.en_iso_52022 import REFERENCE_GLAZINGS, g_total
from clerestory.trace.keys import RecipeError

LIMITS = edition("en-14501:2005")


def cloth(openness=0.03, diffuse=0.05, reflectance=0.5):
    through = Model.sum([(1.0, Model.specular(openness)), (1.0, Model.lambertian(diffuse))])
    back = Model.lambertian(reflectance)
    parts = {
        (side, scatter): model
        for side in ("exterior", "interior")
        for scatter, model in (("transmission", through), ("reflection", back))
    }
    return Bsdf.from_models({"visible": parts, "solar": parts}).with_metadata(name="cloth")


def test_figures_of_a_cloth():
    found = optics(cloth(), "transmission")
    assert found.normal_normal == pytest.approx(0.03, abs=1e-9)
    assert found.normal_diffuse == pytest.approx(0.05, abs=1e-6)
    assert found.normal_hemispherical == pytest.approx(0.08, abs=1e-6)
    assert found.diffuse_hemispherical == pytest.approx(0.08, abs=1e-6)
    back = optics(cloth(), "reflection")
    assert (back.normal_normal, back.normal_hemispherical) == pytest.approx((0.0, 0.5), abs=1e-6)


def test_beams_of_a_table_count_as_straight():
    """The same cloth on Klems' patches: the published criterion finds the beam in the table."""
    found = optics(cloth(openness=0.10, diffuse=0.02).to_matrix("klems-full"), "transmission")
    assert found.normal_normal == pytest.approx(0.10, abs=0.005)
    assert found.normal_hemispherical == pytest.approx(0.12, abs=1e-3)


@pytest.mark.parametrize(
    ("quantities", "criterion", "number"),
    [
        ({"g_tot": 0.50}, "solar gain", 0),
        ({"g_tot": 0.4999}, "solar gain", 1),
        ({"g_tot": 0.10}, "solar gain", 3),
        ({"g_tot": 0.0999}, "solar gain", 4),
        ({"tau_v_dif-h": 0.02}, "daylight utilisation", 1),
        ({"tau_v_dif-h": 0.40}, "daylight utilisation", 4),
        ({"tau_v_n-n": 0.0, "tau_v_n-dif": 0.0199}, "glare control", 4),
        ({"tau_v_n-n": 0.05, "tau_v_n-dif": 0.02}, "glare control", 2),
        ({"tau_v_n-n": 0.0501, "tau_v_n-dif": 0.02}, "glare control", 1),
        ({"tau_v_n-n": 0.11, "tau_v_n-dif": 0.0}, "glare control", 0),
        ({"tau_v_n-n": 0.0, "tau_v_n-dif": 0.04}, "night privacy", 3),
        ({"tau_v_n-n": 0.2, "tau_v_n-dif": 0.01}, "outward view", 4),
        ({"tau_v_n-n": 0.2, "tau_v_n-dif": 0.16}, "outward view", 2),
    ],
)
def test_classes_at_their_limits(quantities, criterion, number):
    found = {rating.criterion: rating for rating in classify(quantities, LIMITS)}
    assert found[criterion].number == number


def test_what_is_not_known_is_not_rated():
    found = {rating.criterion: rating for rating in classify({"g_tot": 0.2}, LIMITS)}
    assert found["solar gain"].number == 2
    assert found["glare control"].number is None
    assert "tau_v_n-n, tau_v_n-dif is not known" in found["glare control"].words
    assert found["darkening"].number is None
    assert "with lamps" in found["darkening"].words


def test_a_device_with_reference_glazing():
    rated = rate_device(cloth(), LIMITS)
    pane = REFERENCE_GLAZINGS["C"]
    assert rated.g["interior"]["C"].g == pytest.approx(g_total("interior", pane.u, pane.g, 0.08, 0.5).g, abs=1e-5)
    assert rated.quantities["g_tot"] == rated.g["interior"]["C"].g
    assert {r.criterion: r.number for r in rated.ratings}["glare control"] == 1
    assert rated.name == "cloth"
    assert rated.cut_off.angle_deg is None


def test_a_device_of_visible_values_alone():
    parts = {("exterior", "transmission"): Model.lambertian(0.2)}
    rated = rate_device(Bsdf.from_models(parts), LIMITS)
    assert rated.g == {}
    assert any("solar" in doubt for doubt in rated.doubts)
    assert {r.criterion: r.number for r in rated.ratings}["solar gain"] is None
    with pytest.raises(MissingDataError, match="visible"):
        rate_device(Bsdf.from_models({"solar": parts}), LIMITS)


def test_a_window_with_its_own_g():
    rated = rate_window(cloth(), LIMITS, g=0.12, secondary=0.04)
    numbers = {r.criterion: r.number for r in rated.ratings}
    assert (numbers["solar gain"], numbers["secondary heat"]) == (3, 3)


def test_limits_that_are_not_public_are_asked_for(tmp_path):
    with pytest.raises(RecipeError, match="not public"):
        edition("en-14501:2021")
    path = tmp_path / "mine.toml"
    path.write_text(
        '["mine"]\nsource = "own"\n[["mine".by_value]]\ncriterion = "solar gain"\nquantity = "g_tot"\n'
        "limits = [0.2]\nclasses = [4, 0]\n",
        encoding="utf-8",
    )
    assert classify({"g_tot": 0.1}, edition(path))[0].number == 4
    path.write_text(
        '["mine"]\nsource = "own"\n[["mine".by_value]]\ncriterion = "solar gain"\nquantity = "g_tot"\n'
        "limits = [0.2]\nclasses = [4]\n",
        encoding="utf-8",
    )
    with pytest.raises(RecipeError, match=r"mine\.toml.*classes"):
        edition(path)
    with pytest.raises(RecipeError, match=r"5 is no class \(give 0 to 4\)"):
        edition(_written(path, path.read_text(encoding="utf-8").replace("[4]", "[5, 0]")))
    with pytest.raises(ClerestoryError, match="g_total"):
        classify({"g_total": 0.2}, LIMITS)
    with pytest.raises(ClerestoryError, match="no share"):
        classify({"g_tot": np.inf}, LIMITS)


def _written(path, text):
    path.write_text(text, encoding="utf-8")
    return path


def test_the_file_of_limits_that_the_guide_shows(tmp_path):
    """Rows of another edition may begin elsewhere, and be more or fewer."""
    guide = (Path(__file__).parents[2] / "docs" / "systems.md").read_text(encoding="utf-8")
    (text,) = (block for block in re.findall(r"```toml\n(.*?)```", guide, re.DOTALL) if "by_openness" in block)
    limits = edition(_written(tmp_path / "mine.toml", text))
    (grid,) = limits.by_openness
    for straight, row in ((0.0, 0), (0.01, 1), (0.02, 2), (0.03, 2), (0.031, 3)):
        ratings = classify({"tau_v_n-n": straight, "tau_v_n-dif": 0.5, "g_tot": 0.2}, limits)
        assert {r.criterion: r.number for r in ratings} == {
            "glare control": grid.rows[row][-1],
            "solar gain": 2,
            "darkening": None,
        }
    short = text.replace("openness = [0.005, 0.01, 0.03]", "openness = [0.005, 0.01]")
    with pytest.raises(RecipeError, match="one more than limits of openness, 3"):
        edition(_written(tmp_path / "mine.toml", short))
