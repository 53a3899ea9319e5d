"""Laws that choose the states of windows, on series that are made up."""

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.annual.control.cut_off import nearest_closed, needed_tilt_deg, tilt_states
from clerestory.annual.control.expression import Expression
from clerestory.annual.control.glare import cheap_dgp, most_open
from clerestory.annual.control.hysteresis import held, levels
from clerestory.annual.control.rules import Rule, chosen
from clerestory.annual.control.schedule import Span, from_spans
from clerestory.annual.control.slats import Slats, profile_angle
from clerestory.annual.frequencies import simplified_dgp

SOUTH = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])


def sun(altitude, azimuth):
    a, z = np.radians(altitude), np.radians(azimuth)
    return np.stack([np.cos(a) * np.sin(z), np.cos(a) * np.cos(z), np.sin(a)], axis=-1)


def test_profile_angle():
    altitude, azimuth = np.array([10.0, 45.0, 70.0, 20.0]), np.array([180.0, 120.0, 250.0, 20.0])
    found = profile_angle(sun(altitude, azimuth), SOUTH)
    expected = np.arctan(np.tan(np.radians(altitude)) / np.cos(np.radians(azimuth - 180.0)))
    assert np.allclose(found[:3], expected[:3])
    assert np.isnan(found[3])


def test_the_cut_off_curve_of_flat_slats():
    profile = np.radians([10.0, 20.0, 30.0, 40.0, 45.0, 50.0, 60.0])
    found = np.degrees(Slats(1.0, 0.9).cut_off(profile))
    assert np.allclose(found, [52.4, 37.7, 21.2, 3.6, -5.5, -14.7, -33.3], atol=0.05)
    # Level slats of 80 mm at 72 mm keep out a sun above 42.0°.
    level = Slats(80.0, 72.0)
    assert level.passed(0.0, np.radians(41.9)) > 0.0
    assert level.passed(0.0, np.radians(42.1)) == 0.0
    assert np.isnan(Slats(0.8, 1.0).cut_off(0.0))


def passed_by_segments(width, pitch, crown, tilt, profile, parts=2000):
    """Share of the rays that pass two neighbouring slats of many short segments."""
    across = np.linspace(-0.5, 0.5, parts) * width
    height = 0.0 * across
    if crown:
        radius = (crown**2 + width**2 / 4.0) / (2.0 * abs(crown))
        height = np.sign(crown) * (np.sqrt(radius**2 - across**2) - radius + abs(crown))
    x = across * np.cos(tilt) - height * np.sin(tilt)
    y = across * np.sin(tilt) + height * np.cos(tilt)
    offset = x * np.sin(profile) + y * np.cos(profile)
    return max(0.0, 1.0 - np.ptp(offset) / (pitch * np.cos(profile)))


@pytest.mark.parametrize("crown", [0.0, 4.0, 10.0, -10.0, 40.0])
def test_slats_keep_out_what_their_segments_do(crown):
    slats = Slats(80.0, 72.0, crown)
    for tilt, profile in np.random.default_rng(3).uniform(-1.5, 1.5, (200, 2)):
        expected = passed_by_segments(80.0, 72.0, crown, tilt, profile)
        assert slats.passed(tilt, profile) == pytest.approx(expected, abs=2e-4 / np.cos(profile))


@pytest.mark.parametrize("crown", [0.0, 4.0, 10.0, 20.0])
def test_the_cut_off_is_where_the_light_ends(crown):
    slats = Slats(80.0, 72.0, crown)
    for profile in np.radians(np.arange(2.0, 75.0, 3.0)):
        tilt = slats.cut_off(profile)
        if np.isneginf(tilt):
            assert slats.passed(np.radians(np.arange(-89.0, 90.0)), profile).max() == 0.0
            continue
        assert slats.passed(tilt + 1e-6, profile) == 0.0
        assert slats.passed(tilt - 1e-3, profile) > 0.0


def test_a_crown_helps_against_a_high_sun_only():
    profile = np.radians([10.0, 30.0, 50.0, 65.0])
    gained = Slats(80.0, 72.0).cut_off(profile) - Slats(80.0, 72.0, 10.0).cut_off(profile)
    assert np.allclose(gained[:3], 0.0, atol=1e-12)
    assert gained[3] > np.radians(0.3)


def test_needed_tilt():
    slats = Slats(1.0, 0.9)
    needed = needed_tilt_deg(slats, np.radians([30.0, 60.0, np.nan]), safety_deg=3.0, step_deg=5.0)
    assert needed.tolist() == [25.0, 0.0, 0.0]
    assert needed_tilt_deg(Slats(0.8, 1.0), np.array([0.0])).tolist() == [np.inf]
    assert nearest_closed([0.0, 15.0, 15.1, 46.0, np.inf], [0.0, 15.0, 45.0]).tolist() == [0, 1, 2, 2, 2]
    # It opens only where 10° more would do as well.
    assert tilt_states([20.0, 12.0, 4.0, 16.0], [0.0, 15.0, 30.0], hysteresis_deg=10.0).tolist() == [2, 2, 1, 2]
    with pytest.raises(ClerestoryError, match="rise"):
        nearest_closed([0.0], [15.0, 0.0])


def test_what_is_held():
    assert held([0, 2, 1, 0, 0, 1], [1, 2, 2, 1, 0, 1]).tolist() == [0, 2, 2, 1, 0, 1]


def test_levels_with_hysteresis_and_delays():
    values, hour = [100.0, 250.0, 180.0, 140.0, 450.0, 360.0, 100.0], np.ones(7)
    assert levels(values, [200.0, 400.0], hour).tolist() == [0, 1, 0, 0, 2, 1, 0]
    assert levels(values, [200.0, 400.0], hour, hysteresis=50.0).tolist() == [0, 1, 1, 0, 2, 2, 0]
    half = np.full(8, 0.5)
    bright = [0.0, 9.0, 9.0, 9.0, 0.0, 9.0, 0.0, 0.0]
    assert levels(bright, [5.0], half, close_after=0.5).tolist() == [0, 0, 1, 1, 0, 0, 0, 0]
    assert levels(bright, [5.0], half, open_after=0.5).tolist() == [0, 1, 1, 1, 1, 1, 1, 0]
    # A year in minutes waits as long as a year in hours.
    minutes = levels(np.repeat(bright, 30), [5.0], np.full(240, 1.0 / 60.0), close_after=0.5)
    assert minutes[30:60].sum() == 0
    assert minutes[60] == 1
    with pytest.raises(ClerestoryError, match="rise"):
        levels(values, [400.0, 200.0], hour)


def test_schedules_by_the_clock():
    times = np.datetime64("2001-01-05T00:30") + np.arange(72) * np.timedelta64(60, "m")  # from a Friday
    found = from_spans([Span(2, months=(2,)), Span(1, 9.0, 17.0, weekdays=(0, 1, 2, 3, 4)), Span(0)], times, 1)[0]
    assert found.reshape(3, 24).sum(axis=1).tolist() == [8, 0, 0]
    assert np.flatnonzero(found).tolist() == list(range(9, 17))
    night = from_spans([Span(1, 22.0, 6.0, groups=(1,)), Span(0)], times, 2)
    assert night[0].sum() == 0
    assert night[1, :24].tolist() == [1] * 6 + [0] * 16 + [1] * 2
    assert (from_spans([Span(1, 9.0, 17.0)], times, 1) == -1).sum() == 72 - 24


NAMES, CALLS = frozenset({"hour", "state", "facade_irradiance"}), frozenset({"mean"})


def test_expressions():
    hour = np.array([8.0, 12.0, 20.0])
    e = Expression('not (6 < hour <= 12) or mean("plane", "open") / 2 > max(400, 100) + 1e2', NAMES, CALLS)
    assert e.names == {"hour"}
    assert e.calls == {("mean", ("plane", "open"))}
    found = e.value({"hour": hour}, {("mean", ("plane", "open")): np.array([0.0, 1200.0, 0.0])})
    assert found.tolist() == [False, True, True]
    assert Expression("abs(-hour % 5) >= 2 and hour != 8", NAMES).value({"hour": hour}, {}).tolist() == [
        False,
        True,
        False,
    ]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("hour > ", "is no condition"),
        ("", "is no condition"),
        ("huor > 12", "did you mean hour?"),
        ("day > 12", "known are facade_irradiance, hour and state"),
        ("__import__('os').system('true')", "is not understood"),
        ("hour.real > 1", "is not understood"),
        ("[hour][0] > 1", "is not understood"),
        ("(lambda: 1)() > 0", "is not understood"),
        ("hour ** hour > 1", "is not understood"),
        ("hour in (1, 2)", "is not understood"),
        ("hour if hour else 1", "is not understood"),
        ("highest('plane') > 1", "there is no function highest"),
        ("mean(hour) > 1", "takes names in quotes"),
        ("mean() > 1", "takes a name"),
        ("max(1, 2, 3) > 1", "takes 2 numbers"),
        ("state > 'open'", "beside == and !="),
        ("'open'", "beside == and !="),
        ("(" * 300 + "hour" + ")" * 300, "is no condition"),
        ("-" * 2000 + "hour > 1", "(write such as|divide it|is no condition)"),
        (" + ".join(["hour"] * 2000) + " > 1", "divide it among rules"),
    ],
)
def test_expressions_are_refused(text, words):
    with pytest.raises(ClerestoryError, match=words.replace("?", r"\?")) as told:
        Expression(text, NAMES, CALLS)
    assert "\n" not in str(told.value)


def test_rules():
    series = {"facade_irradiance": np.array([100.0, 300.0, 180.0, 120.0])}
    closed = Rule(1, Expression("facade_irradiance > 200", NAMES))
    assert chosen([closed, Rule(0)], ["open", "closed"], series, {}, 4).tolist() == [0, 1, 0, 0]
    assert chosen([closed], ["open", "closed"], series, {}, 4).tolist() == [-1, 1, -1, -1]
    # A rule that knows the state before has hysteresis.
    held_closed = Rule(1, Expression("state == 'closed' and facade_irradiance > 150", NAMES))
    assert chosen([closed, held_closed, Rule(0)], ["open", "closed"], series, {}, 4).tolist() == [0, 1, 1, 0]
    # A reading is that of the rule's own state, unless it names another.
    light = {("mean", "plane"): np.array([[900.0, 900.0], [300.0, 600.0]])}
    enough = Rule(1, Expression("mean('plane') >= 500", NAMES, CALLS))
    assert chosen([enough, Rule(0)], ["open", "closed"], {}, light, 2).tolist() == [0, 1]
    much = Rule(1, Expression("mean('plane', 'open') >= 500", NAMES, CALLS))
    assert chosen([much, Rule(0)], ["open", "closed"], {}, light, 2).tolist() == [1, 1]
    with pytest.raises(ClerestoryError, match="is a number, not a condition"):
        chosen([Rule(1, Expression("hour", NAMES))], ["open", "closed"], {"hour": np.arange(2.0)}, {}, 2)


def test_glare_closes_what_helps():
    # (views, groups, states, steps): the first group is bright at the first step, the second at the second.
    at_eye = np.array([[[[5000.0, 500.0], [1000.0, 100.0]], [[500.0, 5000.0], [100.0, 1000.0]]]])
    dark = np.zeros_like(at_eye)
    assert most_open(at_eye, dark, 0.4).tolist() == [[1, 0], [0, 1]]
    assert simplified_dgp(5500.0) > 0.4
    assert most_open(at_eye, dark, 0.6).tolist() == [[0, 0], [0, 0]]
    # The sun's disc closes the group that it is seen through, in little light.
    disc = dark.copy()
    disc[0, 1, 0, 0] = 1e11
    assert most_open(0.1 * at_eye, disc, 0.4).tolist() == [[0, 0], [1, 0]]
    # What nothing helps is closed.
    assert most_open(20.0 * at_eye, dark, 0.4).tolist() == [[1, 1], [1, 1]]
    # Between the limit and the limit less the hysteresis nothing opens.
    one = np.array([[[[5000.0, 3300.0, 2000.0], [0.0, 0.0, 0.0]]]])
    assert most_open(one, np.zeros_like(one), 0.4, hysteresis=0.05).tolist() == [[1, 1, 0]]


def test_the_cheap_glare_of_a_disc_is_dgp():
    from clerestory.glare import rate
    from clerestory.picture import View

    view = View.fisheye((0.0, 0.0, 1.0), (0.0, -1.0, 0.0))
    direction, luminance, omega, e = sun(30.0, 190.0), 1e7, 6.8e-5, 2500.0
    rated = rate([(direction, luminance, omega)], view, e)
    index = rated.sources[0].position_index
    assert cheap_dgp(e, luminance**2 * omega / index**2) == pytest.approx(rated.dgp, abs=0.002)
    assert cheap_dgp(e, 0.0) == pytest.approx(rated.dgps, abs=0.001)
    assert cheap_dgp(0.0, 0.0) == pytest.approx(0.184)
