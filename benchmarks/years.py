"""A year of three phases beside rfluxmtx, gendaymtx and dctimestep, and the room of Radiance's tutorial."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import phases_radiance as phases
import room_radiance
import tutorial_room
from clerestory import Bsdf, read, room
from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.exchange import write as write_matrix
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.phases import Transfer
from clerestory.annual.year import RoomYear, Sampling
from clerestory.photometry import EFFICACY
from clerestory.weather import SkyYear, Weather, read_weather
from clerestory.weather.wea import to_wea
from timing import table

#: Points, divisions of a run, runs.
POINTS, DIVISIONS, RUNS = 100, 12_000, 4
BLIND = Path("klems") / "blinds30.xml"
WEATHER = Path("weather") / "USA_CA_Oakland.Intl.AP.724930_TMY3.epw"


def grid(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points on the working plane of the room (n, 3) [m], about so many and no fewer, and their normals (n, 3)."""
    width, depth = room_radiance.SIZE["width_m"], room_radiance.SIZE["depth_m"]
    along = int(np.ceil(np.sqrt(count * width / depth)))
    x, y = np.meshgrid(np.linspace(0.2, width - 0.2, along), np.linspace(0.2, depth - 0.2, -(-count // along)))
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 0.8)])[:count]
    return points, np.tile([0.0, 0.0, 1.0], (len(points), 1))


def lit_room() -> room.Room:
    return room.load(room_radiance.tables({"glass": 0.8}, sun=False, sky=True))


def passing(path: Path) -> Bsdf:
    """A data set without reflections: the published method has windows that are black from inside."""
    models = read(path).models["visible"]
    return Bsdf.from_models({key: model for key, model in models.items() if key[1] == "transmission"})


def weather_of(data: Path, folder: Path) -> Weather:
    """Of a year, as both read it."""
    (folder / "year.wea").write_text(to_wea(read_weather(data / WEATHER)))
    return read_weather(folder / "year.wea")


def report(data: Path) -> str:
    """Text of the section."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made, weather, bsdf = lit_room(), weather_of(data, folder), passing(data / BLIND)
        points, normals = grid(POINTS)
        bsdf.write(folder / "blind.xml")
        phases.prepare_room(folder, made, sky="r4")
        views = phases.view(folder, points, normals, divisions=DIVISIONS, runs=RUNS)
        other, daylight = (phases.daylight(folder, samples=samples) for samples in (7000, 10_000))
        sky = phases.skies(folder, "year.wea", divisions=4)
        write_matrix(folder / "view.mtx", views.mean(axis=0))
        theirs = EFFICACY * phases.product(folder, "view.mtx", "blind.xml", "daylight.mtx", "sky.mtx")

        found = []
        for seed in (1, 2):
            matrices = RoomMatrices(made, cache=Cache(folder / "cache"), seed=seed)
            skies = SkyYear(weather, "reinhart:4", preset="radiance-matrix")
            arrivals = Arrivals(matrices, skies, value="centre")
            year = RoomYear(arrivals, points, normals, method="3-phase", sampling=Sampling(view=16384))
            found.append(np.concatenate([part.illuminance for _, part in year.of({"blind": [bsdf]})]).T)
        ours = np.mean(found, axis=0)

        lit = skies.is_lit
        mean = theirs[:, lit].mean(axis=1)
        transmission = Transfer.of(bsdf, matrices.basis).transmission

        def rms(difference: np.ndarray) -> np.ndarray:
            return np.sqrt(np.mean(difference[:, lit] ** 2, axis=1)) / mean

        arrives = transmission @ daylight @ sky
        spread = [rms(EFFICACY * (view - views.mean(axis=0)) @ arrives) for view in views]
        by_view = np.linalg.norm(spread, axis=0) / np.sqrt(RUNS * (RUNS - 1))
        by_daylight = rms(EFFICACY * views.mean(axis=0) @ transmission @ (daylight - other) @ sky) / np.sqrt(2.0)
        noises = [np.hypot(by_view, by_daylight), rms(found[0] - found[1]) / 2.0]
        differ = rms(ours - theirs)
        rows = [
            [words, *(f"{100 * value:.2f} %" for value in (np.median(v), np.quantile(v, 0.95), v.max()))]
            for words, v in (
                ("difference", differ),
                ("noise of Radiance's matrices", noises[0]),
                ("noise of Clerestory's matrices", noises[1]),
            )
        ]
        autonomy = [100.0 * (e[:, lit] >= 500.0).mean(axis=1) for e in (ours, theirs)]
        apart = np.abs(autonomy[0] - autonomy[1])
        bias = ours[:, lit].mean() / theirs[:, lit].mean() - 1.0
        tutorial = [
            [
                name,
                f"{100 * np.mean(c.again / c.published - 1.0):+.1f} %",
                f"{100 * np.mean(c.enough / c.again - 1.0):+.1f} %",
                f"{100 * np.mean(c.ours / (c.published * c.enough / c.again) - 1.0):+.1f} %",
                f"{100 * np.mean(c.ours / c.enough - 1.0):+.1f} %",
                f"{100 * np.std(c.ours / c.enough):.1f} %",
            ]
            for name, c in tutorial_room.compare(data, folder, every=2).items()
        ]
    head = ["of the points' mean, RMS over daylight hours", "median point", "95 % of points", "worst point"]
    published = [
        "data set",
        "again / published",
        "12 / 4 bounces",
        "ours / published, raised",
        "ours / 12 bounces",
        "σ",
    ]
    return f"""### Three phases of a year, and of the tutorial's room

{POINTS} points of the working plane, {WEATHER.stem}, {int(lit.sum())} daylight hours,
{BLIND.name} without reflections: the published method has windows that are black from inside, and what ours follows of
the light that the room sends back to them is checked against paths (tests/physics). Radiance: rfluxmtx (V, {RUNS} runs
of {DIVISIONS} divisions; D, 10,000 rays a patch), gendaymtx -m 4, dctimestep. Noise of V is from the spread of its
runs, that of D from a second one. Skies by themselves agree within 0.5 % a patch
(tests/conformance/test_sky_radiance.py). Aims: 3 % for 95 % of the points, and 1 percentage point of autonomy.

{table(head, rows)}

Mean of all points and hours, relative to Radiance's: {100 * bias:+.2f} %. Daylight autonomy of 500 lx: apart by
{apart.mean():.2f} percentage points on average, {np.quantile(apart, 0.95):.2f} for 95 % of the points,
{apart.max():.2f} at most.

The room of Radiance's tutorial on matrix methods, 50 of its points. Its published illuminances were made with 4
bounces; they are raised by what rfluxmtx finds with 12.

{table(published, tutorial)}
"""
