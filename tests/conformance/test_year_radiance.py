"""Hours of a year by three and five phases beside Radiance's programs, from the same weather file to illuminance.

The published method has windows that are black from inside, so the data sets have no reflection here: what ours follows
of the light that windows return to the room is checked against paths (tests/physics). Skies by themselves are compared
in test_sky_radiance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from clerestory import Bsdf, read, room
from clerestory.annual.arrivals import Arrivals
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
        arrivals = Arrivals(matrices, sky, value="centre")
        year = RoomYear(arrivals, POINTS, UP, method="3-phase", sampling=Sampling(view=16384))
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
    # Noise that is known from four runs is uncertain by more than a third itself.
    assert np.sqrt(np.quantile(np.maximum(rms**2 - (1.5 * noise) ** 2, 0.0), 0.95)) < 0.03, (rms, noise)
    # Their random numbers are new in every run: four of their own standard errors beside the tolerance.
    by_run = np.std([run.mean(axis=1) for run in runs], axis=0, ddof=1) / np.sqrt(RUNS)
    error = np.linalg.norm([by_run, *(part.mean(axis=1) for part in parts[1:])], axis=0)
    assert (np.abs(ours.mean(axis=1) - mean) < 0.01 * mean + 4.0 * error).all(), (
        ours.mean(axis=1) / mean,
        error / mean,
    )
    assert ours.mean() == pytest.approx(expected.mean(), rel=0.01)
    certain = np.abs(expected / 500.0 - 1.0) > 0.03 + 3.0 * noise[:, None]
    assert certain.mean() > 0.9
    assert ((ours >= 500.0) == (expected >= 500.0))[certain].all()


SUNNY = "1 17 11.5 700 80\n3 17 13.5 600 120\n6 17 12.5 850 110\n10 17 15.5 500 90\n"


def test_five_phases_are_those_of_radiance(theirs, folder):
    """I = V T D s - V_d T D_d s_d + C_ds s_sun at hours with the sun on the window, which has a blind.

    C_ds is found for the suns of the hours, as gendaymtx writes them, not for those of a grid: a room whose surfaces
    are black, with the data set in its window. Nothing is before the window, so D_d = D. A tree's beam is too small
    to be found there by chance within seconds, so that the blind is a matrix.
    """
    bsdf = transmitting("blinds30.xml")
    bsdf.write(folder / "system.xml")
    (folder / "sunny.wea").write_text(HEAD + SUNNY)
    sky, sun = (phases.skies(folder, "sunny.wea", more=more) for more in ((), ("-d", "-D", "suns.rad")))
    transmission = Transfer.of(bsdf, RoomMatrices(theirs.room, cache=Cache(folder / "cache")).basis).transmission
    daylight = theirs.daylight[1]
    view = theirs.views.mean(axis=0)
    direct_view = phases.view(folder, POINTS, UP, divisions=16000, bounces=1)[0]
    by_patches = EFFICACY * (view @ transmission @ daylight @ sky - direct_view @ transmission @ daylight @ sun)
    by_suns = phases.direct(folder, theirs.room, POINTS, UP, system="system.xml", suns="suns.rad", divisions=64000)

    skies = SkyYear(read_weather(folder / "sunny.wea"), "tregenza", preset="radiance-matrix")
    matrices = RoomMatrices(theirs.room, cache=Cache(folder / "cache"))
    arrivals = Arrivals(matrices, skies, value="centre")
    year = RoomYear(arrivals, POINTS, UP, method="5-phase", sampling=Sampling(view=16384))
    ((_, part),) = year.of({"blind": [bsdf]})
    # Where the sun's own patch is seen few of rtrace's rays find it, and its values are noisy; others are not.
    ratio = part.direct.T / by_suns
    assert np.median(np.abs(ratio - 1.0)) < 0.015, ratio
    assert np.quantile(np.abs(ratio - 1.0), 0.6) < 0.03, ratio
    assert part.direct.mean() == pytest.approx(by_suns.mean(), rel=0.15)
    # The light of the room besides the direct sun.
    rest = part.illuminance.T - part.direct.T
    assert rest == pytest.approx(by_patches, rel=0.15)
    assert rest.mean() == pytest.approx(by_patches.mean(), rel=0.03)
