"""What a comparison holds: labels, bands, spread, outliers, notes, and that bad input ends in one line."""

import json

import numpy as np
import pytest

from clerestory import Basis, Bsdf, ClerestoryError, MissingDataError, Model
from clerestory.compare import compare
from clerestory.compare.statistics import outliers, spread
from clerestory.files import default_labels

ET = ("exterior", "transmission")


def diffuser(value: float, band: str = "visible") -> Bsdf:
    return Bsdf.from_models({band: {ET: Model.lambertian(value)}})


def lobes(width: float, shift: float = 0.0, basis: str = "klems-quarter") -> Model:
    patches = Basis.named(basis)
    out = patches.outgoing_centres("interior")
    aim = out + np.array([0.0, -shift, 0.0])
    aim /= np.linalg.norm(aim, axis=1)[:, None]
    angle = np.arccos(np.clip(out @ aim.T, -1.0, 1.0))
    return Model.matrix(0.02 + np.exp(-((angle / width) ** 2)), patches)


@pytest.fixture(scope="module")
def four():
    sets = {name: diffuser(value) for name, value in (("A", 0.50), ("B", 0.51), ("C", 0.49), ("D", 0.80))}
    return compare(sets, patches=(1, 41))


def test_spread_and_outlier_of_diffusers(four):
    q = four.quantity("T_h-h, uniform")
    assert q.values == pytest.approx((0.50, 0.51, 0.49, 0.80), abs=1e-9)
    assert q.spread.minimum == pytest.approx(0.49)
    assert q.spread.range_percent == pytest.approx(100 * 0.31 / 0.575)
    assert q.spread.standard_deviation == pytest.approx(np.std([0.5, 0.51, 0.49, 0.8], ddof=1))
    assert [o.label for o in q.outliers] == ["D"]
    assert any("D stands apart" in s for s in four.summary)
    assert not any("A stands apart" in s for s in four.summary)


def test_diffusers_differ_in_l1_but_not_in_direction(four):
    mean = four.distances[-1]
    assert mean.patch is None
    assert mean.relative_l1[0][3] == pytest.approx(0.3 / 0.65, abs=1e-6)
    assert mean.relative_l1[3][0] == mean.relative_l1[0][3]
    assert mean.transport_deg[0][3] == pytest.approx(0.0, abs=1e-6)
    assert mean.relative_l1[2][2] == 0.0


def test_direct_direct_of_a_diffuser_is_its_share_of_the_patch(four):
    share = Basis.named("klems-full").projected_solid_angles[40] / np.pi
    assert four.quantity("T_d-d, Klems 41").values[0] == pytest.approx(0.5 * share, rel=1e-6)
    assert four.quantity("T_d-h, Klems 41").values[0] == pytest.approx(0.5, abs=1e-9)


def test_everything_is_json(four):
    made = json.loads(json.dumps(four.to_dict(), allow_nan=False))
    assert made["settings"]["band"] == "visible"
    assert len(made["quantities"]) == len(four.quantities)
    assert made["sets"][0]["label"] == "A"
    assert "data" not in made


def test_beams_are_direct_whatever_the_patch():
    clear = Bsdf.from_models({ET: Model.specular(0.7)})
    c = compare({"clear": clear, "milky": diffuser(0.7)}, patches=(1, 130))
    assert c.quantity("T_d-d, Klems 130").values[0] == pytest.approx(0.7)
    assert c.quantity("T_d-d within 0.5°, Klems 130").values[0] == pytest.approx(0.7)
    assert all(c.quantity("T_d-d within 0.5°, Klems 1").resolved)
    # Two data sets: nobody is an outlier.
    assert not any(q.outliers for q in c.quantities)
    assert c.distances[0].relative_l1[0][1] == pytest.approx(2.0)
    assert c.distances[0].transport_deg[0][1] == pytest.approx(45.0, abs=0.3)


def test_unresolved_cones_do_not_enter_the_spread():
    matrices = {name: Bsdf.from_models({ET: lobes(w)}) for name, w in (("a", 0.2), ("b", 0.3))}
    q = compare(matrices, patches=(1,)).quantity("T_d-d within 1.5°, Klems 1")
    assert q.resolved == (False, False)
    assert q.spread is None
    assert "narrower than the data resolve" in q.words


def test_three_sets_name_only_the_furthest():
    c = compare({"a": diffuser(0.5), "b": diffuser(0.51), "c": diffuser(0.6)}, patches=(1,))
    (outlier,) = c.quantity("T_h-h, uniform").outliers
    assert (outlier.label, outlier.score) == ("c", None)


def test_a_turned_sample_is_found():
    up = lobes(0.3, shift=0.6)
    right = Bsdf.from_models({ET: up})
    close = Bsdf.from_models({ET: lobes(0.32, shift=0.6)})
    wrong = right.rotated(90.0)
    c = compare({"a": right, "b": close, "turned": wrong}, patches=(1, 41))
    assert [(t.label, t.words) for t in c.turns] == [("turned", "turned by 270°")]
    assert c.turns[0].after_deg < 0.2 * c.turns[0].before_deg
    assert any("turned would agree better" in s for s in c.summary)


def test_stand_ins_of_a_diffuser_are_right_and_of_a_clear_pane_wrong():
    c = compare({"a": diffuser(0.5), "b": diffuser(0.5)}, patches=(1,), against_models=True)
    by_name = {s.name: s for s in c.stand_ins}
    assert by_name["Lambertian"].relative_l1[0] == pytest.approx(0.0, abs=1e-6)
    clear = Bsdf.from_models({ET: Model.specular(0.7)})
    c = compare({"a": clear, "b": clear}, patches=(1,), against_models=True)
    by_name = {s.name: s for s in c.stand_ins}
    assert by_name["Lambertian"].relative_l1[0] == pytest.approx(2.0)
    assert by_name["specular + Lambertian"].transport_deg[0] < 0.01
    place = [q.key for q in c.quantities].index("T_h-h, uniform")
    assert by_name["specular + Lambertian"].errors[place][1] == pytest.approx(0.0, abs=1e-6)


def test_standard_errors_travel():
    basis = Basis.named("klems-full")
    values = np.full((145, 145), 0.1)
    noisy = Model.matrix(values, basis, standard_errors=0.05 * values)
    c = compare({"noisy": Bsdf.from_models({ET: noisy}), "sure": diffuser(0.1 * np.pi)}, patches=(1,))
    q = c.quantity("T_d-h, Klems 1")
    assert q.standard_errors[1] is None
    expected = 0.05 * 0.1 * np.sqrt(np.sum(basis.projected_solid_angles**2))
    assert q.standard_errors[0] == pytest.approx(expected, rel=1e-6)


def test_reciprocity_is_told():
    interior = Bsdf.from_models({("interior", "transmission"): Model.lambertian(0.4)})
    c = compare({"front only": diffuser(0.4), "back only": interior}, patches=(1,))
    assert c.sets[1].by_reciprocity
    assert not c.sets[0].by_reciprocity
    assert any("back only" in note and "reciprocity" in note for note in c.notes)


def test_systems_that_are_obviously_different_get_a_note():
    c = compare({"pale": diffuser(0.6), "dark": diffuser(0.05)}, patches=(1,))
    assert any("hardly of one system" in note for note in c.notes)
    c = compare({"pale": diffuser(0.6), "clear": Bsdf.from_models({ET: Model.specular(0.6)})}, patches=(1,))
    assert any("apart on average" in note for note in c.notes)


def test_common_band_is_taken():
    both = Bsdf.from_models({"visible": {ET: Model.lambertian(0.3)}, "solar": {ET: Model.lambertian(0.2)}})
    c = compare({"a": both, "b": diffuser(0.25, "solar")}, patches=(1,))
    assert c.settings.band == "solar"
    assert any("solar" in note for note in c.notes)
    with pytest.raises(MissingDataError, match="no band in common"):
        compare({"a": diffuser(0.3), "b": diffuser(0.3, "nir")})
    with pytest.raises(MissingDataError, match="b has no band 'visible'"):
        compare({"a": diffuser(0.3), "b": diffuser(0.3, "nir")}, band="visible")


def test_reflection_is_compared_where_all_have_it():
    parts = {ET: Model.lambertian(0.3), ("exterior", "reflection"): Model.lambertian(0.2)}
    c = compare({"a": Bsdf.from_models(parts), "b": Bsdf.from_models(parts)}, patches=(1,))
    assert c.quantity("R_d-h, Klems 1").values == pytest.approx((0.2, 0.2))
    c = compare({"a": Bsdf.from_models(parts), "b": diffuser(0.3)}, patches=(1,))
    assert not c.of_group("reflection")
    c = compare({"a": Bsdf.from_models(parts), "b": Bsdf.from_models(parts)}, patches=(1,), scatter="reflection")
    assert c.quantity("R_h-h, uniform").values == pytest.approx((0.2, 0.2))


def test_dark_data_have_no_transport_distance():
    c = compare({"a": diffuser(0.0), "b": diffuser(0.3)}, patches=(1,))
    assert c.distances[0].transport_deg[0][1] is None
    assert c.distances[0].relative_l1[0][1] == pytest.approx(2.0)
    c = compare({"a": diffuser(0.0), "b": diffuser(0.0)}, patches=(1,))
    assert "dark" in c.summary[0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"sets": [diffuser(0.1)]}, "1 data set cannot be compared"),
        ({"sets": []}, "no data sets cannot be compared"),
        ({"sets": [diffuser(0.1)] * 21}, "21 data sets cannot be compared"),
        ({"sets": [diffuser(0.1)] * 2, "labels": ["a"]}, "1 label for 2 data sets"),
        ({"sets": [diffuser(0.1)] * 2, "labels": ["a", "a"]}, "'a' is there twice"),
        ({"sets": [diffuser(0.1)] * 2, "labels": ["a", " "]}, "label 2 is empty"),
        ({"sets": [diffuser(0.1)] * 2, "patches": (0,)}, "patch 0 does not exist"),
        ({"sets": [diffuser(0.1)] * 2, "patches": (146,)}, "patch 146 does not exist"),
        ({"sets": [diffuser(0.1)] * 2, "patches": (1, 1)}, "different numbers"),
        ({"sets": [diffuser(0.1)] * 2, "scatter": "reflection"}, "data set 1: .* reflection"),
    ],
)
def test_what_cannot_be_compared_is_told_in_one_line(arguments, message):
    with pytest.raises(ClerestoryError, match=message) as caught:
        compare(**arguments)
    assert "\n" not in str(caught.value)


def test_labels_are_made_unique():
    assert default_labels(["x/a.xml", "x/b.xml.gz", "x/c.bsdf.npz", "d.npz"]) == ["a", "b", "c", "d"]
    assert default_labels(["x/a.xml", "y/a.xml"]) == ["x/a", "y/a"]
    assert len(set(default_labels(["x/a.xml", "x/a.xml", None, None]))) == 4


def test_statistics_with_gaps():
    assert spread((None, None)) is None
    s = spread((1.0, None, 3.0))
    assert (s.count, s.mean, s.median) == (2, 2.0, 2.0)
    labels = ("a", "b", "c", "d", "e")
    assert outliers(labels, (1.0, 1.0, 1.0, 1.0, 1.01), 0.001) == ()
    (one,) = outliers(labels, (1.0, 1.0, 1.0, 1.0, 1.2), 0.001)
    assert one.label == "e"
    assert one.score == pytest.approx(0.6745 * 0.2 / 0.02)


def test_progress_ends_at_one_and_can_stop():
    shares = []
    compare({"a": diffuser(0.1), "b": diffuser(0.2)}, patches=(1,), progress=shares.append)
    assert shares[-1] == 1.0
    assert shares == sorted(shares)

    def stop(share):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        compare({"a": diffuser(0.1), "b": diffuser(0.2)}, patches=(1,), progress=stop)
