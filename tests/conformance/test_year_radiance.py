"""Hours of a year by three phases beside rfluxmtx, gendaymtx and dctimestep, from the same weather file to illuminance.

The published method has windows that are black from inside, so the data sets have no reflection here: what ours follows
of the light that windows return to the room is checked against paths (tests/physics). Skies by themselves are compared
in test_sky_radiance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from clerestory import Bsdf, read, room
from clerestory.annual.cache import Cache
from clerestory.annual.exchange import write as write_matrix
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.phases import Transfer
from clerestory.annual.year import RoomYear, Sampling
from clerestory.photometry import EFFICACY
from clerestory.system import pane_from_normal
from clerestory.weather import SkyYear, read_weather
from samples import ABSENT, sample_root

phases = pytest.importorskip("phases_radiance", reason="pyradiance is not installed")
room_radiance = pytest.importorskip("room_radiance", reason="pyradiance is not installed")

POINTS = np.array([(x, y, 0.8) for x in (0.6, 1.8, 3.0) for y in (0.5, 1.7, 3.1, 4.5)])
UP = np.tile([0.0, 0.0, 1.0], (len(POINTS), 1))
RUNS = 4
#: Days of clear and changing skies, of weak and strong sun: month, day, direct and diffuse irradiance at noon [W/m²].
DAYS = [(1, 17, 700, 80), (3, 17, 300, 250), (5, 17, 850, 110), (8, 17, 600, 150), (10, 17, 0, 180), (12, 17, 550, 70)]
HEAD = "place Innsbruck\nlatitude 47.3\nlongitude -11.4\ntime_zone -15\nsite_elevation 600\nweather_data_file_units 1\n"


@dataclass(frozen=True)
class Runs:
    """The room by Radiance's programs, in a folder with its matrices of daylight and sky."""

    room: room.Room
    views: np.ndarray
    """(runs, points, patches)."""
    daylight: list[np.ndarray]
    """Two matrices of other random numbers."""
    sky: np.ndarray


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("phases")


@pytest.fixture(scope="module")
def theirs(folder):
    made = room.load(room_radiance.tables({"glass": 0.8}, sun=False, sky=True))
    phases.prepare_room(folder, made)
    hours = np.arange(7.5, 17.0)
    shape = np.sin(np.pi * (hours - 7.0) / 10.0)
    rows = [
        f"{month} {day} {hour} {direct * s:.0f} {diffuse * s:.0f}"
        for month, day, direct, diffuse in DAYS
        for hour, s in zip(hours, shape, strict=True)
    ]
    (folder / "days.wea").write_text(HEAD + "\n".join(rows) + "\n")
    views = phases.view(folder, POINTS, UP, divisions=16000, runs=RUNS)
    daylight = [phases.daylight(folder, samples=samples) for samples in (2200, 3000)]
    return Runs(made, views, daylight, phases.skies(folder, "days.wea"))


def transmitting(name):
    if name == "pane":
        models = pane_from_normal(0.8, 0.08).to_matrix("klems-full").models["visible"]
    else:
        root = sample_root()
        if root is None:
            pytest.skip(ABSENT)
        models = read(root / "klems" / name).models["visible"]
    return Bsdf.from_models({key: model for key, model in models.items() if key[1] == "transmission"})


def relative_rms(difference, mean):
    """Root of the mean square over hours, by the mean of each point (points)."""
    return np.sqrt(np.mean(difference**2, axis=1)) / mean


@pytest.mark.parametrize("name", ["blinds30.xml", "pane"])
def test_hours_are_those_of_radiance(name, theirs, folder):
    """At each point 3 % of its mean (RMS over hours) besides the noise of both, and the same hours with 500 lx."""
    bsdf = transmitting(name)
    bsdf.write(folder / "system.xml")
    runs = []
    for view in theirs.views:
        write_matrix(folder / "view.mtx", view)
        found = phases.product(folder, "view.mtx", "system.xml", "daylight.mtx", "sky.mtx")
        runs.append(EFFICACY * found)
    (folder / "system.xml").unlink()
    expected = np.mean(runs, axis=0)

    sky = SkyYear(read_weather(folder / "days.wea"), "tregenza", preset="radiance-matrix")
    found = []
    for seed in (1, 2):
        matrices = RoomMatrices(theirs.room, cache=Cache(folder / "cache"), seed=seed)
        sampling = Sampling(view=16384, daylight=4096)
        year = RoomYear(matrices, sky, POINTS, UP, method="3-phase", sampling=sampling)
        found.append(np.concatenate([part.illuminance for _, part in year.of({name: [bsdf]})]).T)
    ours = np.mean(found, axis=0)

    # The matrix of daylight that was used, and another one, differ by the noise of both.
    transfer = Transfer.of(bsdf, matrices.basis).transmission
    daylight = EFFICACY * theirs.views.mean(axis=0) @ transfer @ np.subtract(*theirs.daylight) @ theirs.sky
    mean = expected.mean(axis=1)
    parts = [np.std(runs, axis=0, ddof=1) / np.sqrt(RUNS), daylight / np.sqrt(2.0), (found[0] - found[1]) / 2.0]
    noise = np.linalg.norm([relative_rms(part, mean) for part in parts], axis=0)
    assert np.median(noise) < 0.02, noise

    rms = relative_rms(ours - expected, mean)
    assert np.sqrt(np.quantile(np.maximum(rms**2 - noise**2, 0.0), 0.95)) < 0.03, (rms, noise)
    assert np.abs(ours.mean(axis=1) / mean - 1.0).max() < 0.015
    assert ours.mean() == pytest.approx(expected.mean(), rel=0.005)
    certain = np.abs(expected / 500.0 - 1.0) > 0.03 + 3.0 * noise[:, None]
    assert certain.mean() > 0.9
    assert ((ours >= 500.0) == (expected >= 500.0))[certain].all()
