"""A year with windows that change is, step by step, the year of what stood in them."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from clerestory import Bsdf, Model, room
from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.control.outdoors import outdoors
from clerestory.annual.control.preview import Preview
from clerestory.annual.control.stage import Stage
from clerestory.annual.control.states import Operated
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.year import EYE, RoomYear, Sampling
from clerestory.sky import Place
from clerestory.system import pane_from_normal
from clerestory.weather import Hours, SkyYear, synthetic_year
from short_study import BOX

ROOM = {
    "room": BOX
    | {
        "openings": [
            *BOX["openings"],
            {"wall": "east", "width_m": 1.0, "height_m": 1.6, "sill_m": 0.9, "system": "window"},
        ]
    },
    "systems": {"window": {"glass": 0.7}},
    "sky": {"kind": "overcast"},
    "sensors": {"plane": {"height_m": 0.8, "spacing_m": 1.2}},
    "views": {"desk": {"point_m": [1.5, 2.0, 1.2], "direction": [0.3, -1.0, 0.0]}},
}
COARSE = Sampling(view=256, returned=64, cells=16, eye_cells=24, chunk=40)


@pytest.fixture(scope="module")
def arrivals(tmp_path_factory):
    weather = synthetic_year(Place(47.3, 11.4, 1.0), seed=2).selected(slice(24 * 75, 24 * 79))
    matrices = RoomMatrices(room.load(ROOM), cache=Cache(tmp_path_factory.mktemp("cache")))
    return Arrivals(matrices, SkyYear(weather, "reinhart:1"), samples=64)


@pytest.fixture(scope="module")
def states():
    film = {("exterior", "transmission"): Model.lambertian(0.2), ("interior", "reflection"): Model.lambertian(0.6)}
    return [pane_from_normal(0.7, 0.08), pane_from_normal(0.15, 0.08), Bsdf.from_models(film)]


def series(year, data_sets, when=None):
    """All that a year has, by data set."""
    count = len(year.arrivals)
    points = len(year.matrices.room.sensors("plane")[0])
    found = {}
    for name, part in year.of(data_sets, when=when):
        every, eye = found.setdefault(name, (np.full((2, count, points), np.nan), np.full((len(EYE), count), np.nan)))
        every[0, part.steps], every[1, part.steps] = part.illuminance, part.direct
        for k, key in enumerate(EYE):
            eye[k, part.steps] = part.eyes["desk"][key]
    return found


def test_every_step_is_that_of_its_state(arrivals, states):
    made = arrivals.matrices.room
    view = made.view("desk")
    eyes = {"desk": (view.point_m, view.direction)}
    year = RoomYear(arrivals, *made.sensors("plane"), eyes, sampling=COARSE)
    steps = len(arrivals)
    numbers = np.random.default_rng(4).integers(0, 3, (2, steps))
    numbers[:, 30:60] = [[1], [0]]
    operated = Operated(("open", "dim", "film"), ("south", "east"), numbers)
    combinations = operated.combinations()
    assert sum(when.sum() for _, when in combinations) == steps
    data_sets = {str(c): [states[k] for k in c] for c, _ in combinations}
    chosen = series(year, data_sets, {str(c): when for c, when in combinations})
    whole = series(year, data_sets)
    for combination, when in combinations:
        for found, expected in zip(chosen[str(combination)], whole[str(combination)], strict=True):
            # Bit for bit, and nothing at other steps.
            assert np.array_equal(found[:, when], expected[:, when], equal_nan=True)
            assert np.isnan(found[:, ~when]).all()
            assert np.nanmax(expected) > 100.0


def test_a_preview_is_the_three_phase_year(arrivals, states):
    points, normals = arrivals.matrices.room.sensors("plane")
    year = RoomYear(arrivals, points, normals, method="3-phase", sampling=COARSE)
    preview = Preview(arrivals.matrices, states, points, normals, samples=256, returned=64)
    part = year.chunks[0]
    lit = arrivals.sky.is_lit[part]
    every = preview.illuminance(arrivals.at(part)).sum(axis=0)
    for k, bsdf in enumerate(states):
        _, found = next(year.of({"all": [bsdf] * 2}))
        assert np.allclose(every[k].T, found.illuminance[lit], rtol=1e-4, atol=1e-2)
        direct = preview.direct(arrivals.at(part))[:, k].sum(axis=0).T
        if k == 2:
            # A film has no beam: its sun is spread over patches in both.
            assert np.allclose(direct, found.direct[lit], rtol=1e-4, atol=1e-2)
        else:
            # A pane's sun falls on points that see it, with all of its light.
            in_sun = direct > 1000.0
            assert in_sun.any()
            assert not in_sun.all()


def test_the_light_on_facades(arrivals):
    weather = arrivals.sky.weather
    seen = outdoors(arrivals.matrices, arrivals.sky, weather.times)
    assert np.allclose(seen.diffuse_horizontal, weather.diffuse, atol=0.01)
    assert np.allclose(seen.direct_normal, weather.direct, atol=0.1)
    step = int(np.argmax(weather.direct))
    sky = weather.sky(step, quantity="solar")
    for group, azimuth in enumerate((180.0, 90.0)):
        for part, found in (("sun", seen.direct), ("sky", seen.diffuse)):
            assert found[group, step] == pytest.approx(sky.irradiance(90.0, azimuth, part)[1], rel=0.01, abs=0.5)


def test_glare_is_judged_by_what_the_eye_gets(arrivals, states):
    """The cheap light at an eye is near that of the full method; the sun's disc is seen in the steps that have it."""
    made = arrivals.matrices.room
    names = dict(zip(("open", "dim", "film"), states, strict=True))
    stage = Stage(
        made,
        arrivals.sky.weather,
        names,
        [None] * 3,
        RoomMatrices.names_of(made),
        Hours(),
        Path(),
        lambda: arrivals,
        COARSE,
    )
    assert stage.groups == ["window south", "window east"]
    at_eye, disc = stage.at_eyes(["desk"])
    view = made.view("desk")
    year = RoomYear(arrivals, eyes={"desk": (view.point_m, view.direction)}, sampling=COARSE)
    full = {name: np.zeros(len(arrivals)) for name in names}
    for name, part in year.of({name: [bsdf] * 2 for name, bsdf in names.items()}):
        full[name][part.steps] = part.eyes["desk"]["illuminance"]
    lit = arrivals.sky.is_lit
    for k, name in enumerate(names):
        cheap = at_eye[0, :, k].sum(axis=0)
        # The sun that three phases spread over patches is at the wrong place for an eye in a beam.
        assert np.median(np.abs(cheap[lit] / full[name][lit] - 1.0)) < 0.1
        assert np.average(cheap) == pytest.approx(np.average(full[name]), rel=0.15)
    suns = arrivals.sky.suns
    seen = arrivals.matrices.outlooks(np.array([view.point_m], dtype=float), suns.directions[lit])[0]
    before = suns.directions[lit] @ np.asarray(view.direction) > 0.0
    shines = suns.irradiance[lit] > 0.0
    for group in (0, 1):
        assert np.array_equal(disc[0, group, 0, lit] > 0.0, (seen == group) & before & shines)
    assert (disc[0, :, 0] > 0.0).any()
    assert not disc[0, :, 2].any()


def test_what_laws_look_at_takes_little_memory(arrivals, states, monkeypatch):
    """Steps are looked at a few at a time where there are many points and states, with the same result."""
    made = arrivals.matrices.room
    rng = np.random.default_rng(6)
    points = rng.uniform([0.3, 0.3, 0.8], [2.7, 3.7, 0.8], (1000, 3))
    normals = np.tile([0.0, 0.0, 1.0], (1000, 1))
    names = {f"state {k}": states[k % 3] for k in range(8)}
    stage = Stage(
        made,
        arrivals.sky.weather,
        names,
        [None] * 8,
        RoomMatrices.names_of(made),
        Hours(),
        Path(),
        lambda: arrivals,
        COARSE,
    )
    arrivals.matrices.view(points, normals, samples=COARSE.view)
    hours = np.ones(len(arrivals))

    def looked(tile):
        monkeypatch.setattr("clerestory.annual.control.stage._TILE", tile)
        tracemalloc.start()
        try:
            metrics, in_sun = stage.lm83_year(points, normals, hours)
            return metrics, in_sun, stage.by_lm83(points, normals), tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    *whole, much = looked(1e12)
    *found, little = looked(4e6)
    *_, least = looked(1.0)
    # Beside what there is anyway, matrices above all.
    assert little < least + 4e6
    assert much > least + 6e6
    assert np.allclose(found[0].mean, whole[0].mean, rtol=1e-5)
    assert np.array_equal(found[1], whole[1])
    assert np.array_equal(found[2], whole[2])
    assert len(np.unique(found[2])) > 1
