"""Metrics of a year by hand, and what must be so whatever the year."""

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.annual import en17037, lm83
from clerestory.annual.frequencies import (
    DGI_CLASSES,
    DGP_CLASSES,
    class_shares,
    cumulated,
    histogram,
    simplified_dgp,
)
from clerestory.annual.metrics import PointYear, point_metrics, share_of_area

RANDOM = np.random.default_rng(5)
#: Illuminances that reach over all bands, with nights.
YEAR = RANDOM.lognormal(5.5, 1.6, (600, 12)) * (RANDOM.random((600, 1)) > 0.3)
HOURS = RANDOM.choice([0.0, 0.25, 0.5, 1.0], 600)


def test_points_by_hand():
    illuminance = [[0.0, 50.0], [99.0, 100.0], [250.0, 300.0], [500.0, 3000.0], [4000.0, 3001.0], [1e6, 1e6]]
    found = point_metrics(illuminance, [1, 1, 1, 1, 1, 0])  # the last does not count
    assert found.hours == 5
    assert found.autonomy_at(500) == pytest.approx([2 / 5, 2 / 5])
    assert found.autonomy_at(300) == pytest.approx([2 / 5, 3 / 5])
    assert found.continuous_autonomy_at(500) == pytest.approx(
        [(99 / 500 + 0.5 + 1 + 1) / 5, (0.1 + 0.2 + 0.6 + 1 + 1) / 5]
    )
    # Below 100, 100 to 300, 300 to 3000 with both ends, above.
    assert found.useful == pytest.approx(np.array([[2, 1, 1, 1], [1, 1, 2, 1]]).T / 5)
    assert found.exposure == pytest.approx([4849, 6451])
    assert found.mean == pytest.approx([4849 / 5, 6451 / 5])
    assert list(found.highest) == [4000, 3001]


def test_what_is_so_for_every_year():
    found = point_metrics(YEAR, HOURS)
    assert found.hours == pytest.approx(HOURS.sum())
    assert found.useful.sum(axis=0) == pytest.approx(np.ones(12), abs=1e-12)
    assert (found.useful >= 0).all()
    assert (found.continuous_autonomy >= found.autonomy).all()
    assert (np.diff(found.autonomy, axis=0) <= 0).all()
    assert (np.diff(found.continuous_autonomy, axis=0) <= 0).all()
    # No less than 300 lx: the bands from there on.
    assert found.autonomy_at(300) == pytest.approx(found.useful[2:].sum(axis=0), abs=1e-12)
    assert found.autonomy_at(100) == pytest.approx(found.useful[1:].sum(axis=0), abs=1e-12)


def test_pieces_are_the_whole():
    whole = point_metrics(YEAR, HOURS)
    pieces = PointYear(12)
    for first in range(0, 600, 77):
        pieces.add(YEAR[first : first + 77], HOURS[first : first + 77])
    found = pieces.result()
    for name in ("hours", "autonomy", "continuous_autonomy", "useful", "exposure", "highest"):
        assert getattr(found, name) == pytest.approx(getattr(whole, name), rel=1e-12), name


def test_quarters_of_an_hour_are_the_hour():
    whole = point_metrics(YEAR, HOURS)
    found = point_metrics(np.repeat(YEAR, 4, axis=0), np.repeat(HOURS / 4, 4))
    for name in ("hours", "autonomy", "continuous_autonomy", "useful", "exposure", "highest"):
        assert getattr(found, name) == pytest.approx(getattr(whole, name), rel=1e-9), name
    dgp = 0.2 + YEAR / YEAR.max()
    quarters, weights = np.repeat(dgp, 4, axis=0), np.repeat(HOURS / 4, 4)
    assert class_shares(quarters, weights, DGP_CLASSES) == pytest.approx(class_shares(dgp, HOURS, DGP_CLASSES))
    assert en17037.exceeded(quarters, weights) == pytest.approx(en17037.exceeded(dgp, HOURS))
    assert lm83.sun_hours(quarters * 2000, weights) == pytest.approx(lm83.sun_hours(dgp * 2000, HOURS))


def test_spatial_autonomy_and_its_rating():
    autonomy = [0.5, 0.49, 0.51, 0.9]
    assert lm83.spatial_autonomy(autonomy) == 0.75
    assert lm83.spatial_autonomy(autonomy, [1, 7, 1, 1]) == pytest.approx(0.3)
    assert [lm83.rating(s) for s in (0.54, 0.55, 0.75)] == ["not accepted", "nominally accepted", "preferred"]


def test_exposure_to_sunlight():
    direct = np.zeros((400, 4))
    direct[:250, 0] = direct[:251, 1] = 1500.0
    direct[:, 2] = 1000.0  # not more than the limit
    hours = lm83.sun_hours(direct, np.ones(400))
    assert list(hours) == [250, 251, 0, 0]
    assert lm83.sunlight_exposure(hours) == 0.25
    assert lm83.sunlight_exposure(hours, [1, 3, 3, 3]) == pytest.approx(0.3)


def test_blinds_close_when_more_than_two_percent_is_in_the_sun():
    direct = np.zeros((4, 2, 100))
    direct[1, 0, :2] = 1000.0  # 2 %: not more
    direct[2, 0, :3] = 1000.0
    direct[3, 0, :3] = 999.0
    assert list(lm83.blind_states(direct)) == [0, 0, 1, 0]
    # By area: the three points are less than 2 % of it.
    assert list(lm83.blind_states(direct, np.where(np.arange(100) < 3, 0.5, 1.0))) == [0, 0, 0, 0]


def test_blinds_stop_at_the_first_state_that_keeps_the_sun_out():
    direct = np.full((3, 3, 10), 5000.0)
    direct[0] = 0.0
    direct[1, 1] = 0.0
    assert list(lm83.blind_states(direct)) == [0, 1, 2]


def test_groups_of_windows_close_by_themselves():
    light = np.array([[[400.0, 300.0], [40.0, 30.0]]] * 2)  # (2 steps, open and closed, 2 points)
    sunny, shady = np.full((2, 2, 2), 2000.0), np.zeros((2, 2, 2))
    sunny[1] = 0.0
    total, states = lm83.operated([(light, sunny), (light, shady)])
    assert states.tolist() == [[1, 0], [0, 0]]
    assert total == pytest.approx(np.array([[440, 330], [800, 600]]))


def test_daylight_provision_by_hand():
    # 20 points, 10 hours: 10 points always 600 lx, 9 have 350 lx in half of the hours and 90 else, 1 has 90 lx.
    illuminance = np.full((10, 20), 90.0)
    illuminance[:, :10] = 600.0
    illuminance[:5, 10:19] = 350.0
    levels = en17037.provision(point_metrics(illuminance, np.ones(10)))
    assert [(p.target_area, p.minimum_area) for p in levels] == [(0.95, 0.95), (0.5, 0.95), (0.0, 0.5)]
    assert [p.is_met for p in levels] == [True, True, False]
    assert en17037.provision_level(levels) == "medium"
    assert en17037.provision_level(en17037.provision(point_metrics(illuminance / 10, np.ones(10)))) is None


def test_glare_that_five_percent_of_the_hours_exceed():
    dgp = np.concatenate([np.full(5, 0.5), np.full(95, 0.3)])[:, None]
    assert en17037.exceeded(dgp, np.ones(100)) == pytest.approx([0.3])
    dgp[5] = 0.41  # now 6 of 100 are above 0.3
    assert en17037.exceeded(dgp, np.ones(100)) == pytest.approx([0.41])
    # An hour more counts for more.
    weights = np.ones(100)
    weights[0] = 3.0
    assert en17037.exceeded(dgp, weights) == pytest.approx([0.5])
    assert [en17037.glare_level(v) for v in (0.35, 0.36, 0.45, 0.46)] == ["high", "medium", "minimum", None]
    values = RANDOM.random((500, 3))
    limit = en17037.exceeded(values, np.ones(500))
    assert ((values > limit).mean(axis=0) <= 0.05).all()
    assert ((values >= limit).mean(axis=0) > 0.05).all()


def test_classes_of_glare():
    dgp = np.array([0.2, 0.35, 0.351, 0.40, 0.45, 0.46, np.float32(0.35), 0.9])[:, None]
    assert class_shares(dgp, np.ones(8), DGP_CLASSES)[:, 0] * 8 == pytest.approx([3, 2, 1, 2])
    dgi = np.array([0.0, 18.0, 18.5, 26.0, 31.0])[:, None]
    assert class_shares(dgi, [1, 1, 1, 2, 5], DGI_CLASSES)[:, 0] == pytest.approx([0.2, 0.1, 0.2, 0.5])
    assert DGP_CLASSES.ranges == ("≤ 0.35", "0.35 to 0.40", "0.40 to 0.45", "> 0.45")
    assert DGI_CLASSES.ranges == ("≤ 18", "18 to 24", "24 to 28", "> 28")
    assert class_shares(YEAR / 1000, HOURS, DGP_CLASSES).sum(axis=0) == pytest.approx(np.ones(12))


def test_how_often_illuminances_occur():
    values = np.array([0.0, 99.0, 100.0, 250.0, 5000.0, -1.0])[:, None]
    assert histogram(values, [1, 1, 1, 2, 4, 0], [0, 100, 200, 300])[:, 0] == pytest.approx([2, 1, 6])
    assert cumulated(values, [1, 1, 1, 2, 4, 0], [0, 100, 300])[:, 0] == pytest.approx([1, 7 / 9, 4 / 9])
    assert histogram(YEAR, HOURS, [0, 10, 100, 1000]).sum(axis=0) == pytest.approx(np.full(12, HOURS.sum()))


def test_simplified_glare_probability():
    assert simplified_dgp([0.0, 1000.0, 1e9]) == pytest.approx([0.184, 0.2462, 1.0])


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda: point_metrics(np.ones((3, 2)), [1, 1]), "do not go with hours"),
        (lambda: point_metrics(np.ones((2, 2)), [0, 0]), "no hour of the weather counts"),
        (lambda: point_metrics([[1.0], [np.nan]], [1, 1]), "a value of step 1 is not a number"),
        (lambda: point_metrics([[1.0]], [-1]), "numbers of at least 0"),
        (lambda: point_metrics([[1.0]], [1]).autonomy_at(50), "autonomy of 50 lx was not kept"),
        (lambda: point_metrics([[1.0]], [1], thresholds=[0]), "above 0 lx"),
        (lambda: PointYear(3).add([[1.0]], [1]), "1 points do not go with 3"),
        (lambda: share_of_area([True], [1, 2]), "do not go with"),
        (lambda: lm83.blind_states(np.ones((2, 2))), "are not of states"),
        (lambda: lm83.operated([]), "is dark"),
        (lambda: en17037.exceeded([[0.1]], [1], 1.5), "a share of 1.5"),
        (lambda: histogram([[1.0]], [1], [3, 2]), "edges of bins rise"),
        (lambda: class_shares([[1.0]], [0], DGP_CLASSES), "no hour"),
    ],
)
def test_what_makes_no_sense_is_refused(wrong, said):
    with pytest.raises(ClerestoryError, match=said):
        wrong()


def test_nights_with_gaps_that_do_not_count_do_no_harm():
    assert point_metrics([[np.nan], [500.0]], [0, 1]).autonomy_at(500) == [1.0]
