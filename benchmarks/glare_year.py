"""Glare of a year in three ways: without pictures, by pictures of every step, and path by path at chosen steps."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clerestory import room
from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.year import RoomYear
from clerestory.glare import dgp_class
from clerestory.room import Room
from clerestory.sky import Place
from clerestory.trace.recipe import read_toml
from clerestory.weather import SkyYear, synthetic_year
from short_study import film
from timing import table
from treatments import fabric

#: Length of a step of the year from which steps are drawn [h], and how many: with the sun in view, with the sun on the
#: façade but not in view, and others.
STEP, COUNTS = 0.25, (260, 130, 130)
#: Steps of each data set that are followed path by path, and the standard error of E_v there over E_v.
MOMENTS, ERROR = 8, 0.003
#: Pixels across a picture: a pixel is as large as the sun.
SIZE = 380
PLACE = Place(47.3, 11.4, 1.0)
#: Turned a little from the window's normal, so that the sun is at the side of the view, too.
DIRECTION = [0.3, -1.0, 0.0]


def _systems(data: Path, folder: Path) -> dict[str, Callable[[], dict[str, Any]]]:
    return {
        "clear glass, 0.7": lambda: {"glass": 0.7},
        "twill of 1 %, tree with peaks": lambda: {"file": str(fabric(folder)), "treatment": "high-peaks"},
        "blind of 30°, tree": lambda: {"file": str(data / "tensortree" / "b30.xml"), "treatment": "high"},
        "blind of 30°, Klems": lambda: {"file": str(data / "klems" / "blinds30.xml"), "treatment": "klems"},
        "diffuse film, 0.1": lambda: film(folder, 0.1),
    }


def _office(system: dict[str, Any], sky: dict[str, Any]) -> Room:
    tables = read_toml(room.shipped.ROOMS.path_of("office") or "")
    tables["systems"] = {"window": system}
    tables["sky"] = sky
    tables["place"]["timezone"] = 1.0
    tables["views"]["desk"]["direction"] = DIRECTION
    return room.load(tables)


def _chosen(made: Room) -> tuple[SkyYear, np.ndarray]:
    """Steps in the order of time, and whether each has the sun in view."""
    sky = SkyYear(synthetic_year(PLACE, step=STEP))
    matrices = RoomMatrices(made)
    suns, shines = sky.suns.directions, sky.suns.irradiance > 0.0
    view = made.view("desk")
    seen = matrices.outlooks(np.array([view.point_m]), suns)[0] >= 0
    in_view = shines & seen & (suns @ np.array(view.direction) > 0.0)
    on_facade = shines & (suns[:, 1] < 0.0) & ~in_view
    draw = np.random.default_rng(1)
    parts = (in_view, on_facade, sky.is_lit & ~in_view & ~on_facade)
    drawn = [draw.choice(np.flatnonzero(p), n, replace=False) for p, n in zip(parts, COUNTS, strict=True)]
    steps = np.sort(np.concatenate(drawn))
    return SkyYear(sky.weather.selected(steps)), in_view[steps]


def _spread(suns: np.ndarray, among: np.ndarray, count: int) -> list[int]:
    """Steps whose suns are far from each other."""
    found = [int(among[0])]
    while len(found) < count:
        nearest = np.max(suns[among] @ suns[found].T, axis=1)
        found.append(int(among[np.argmin(nearest)]))
    return found


@dataclass(frozen=True)
class _Ways:
    """Glare of a data set at the chosen steps."""

    without: dict[str, np.ndarray]
    pictured: dict[str, np.ndarray]
    #: Step, E_v [lx] and DGP, path by path.
    moments: list[tuple[int, float, float]]


def _ways(system: dict[str, Any], sky: SkyYear, in_view: np.ndarray, cache: Path) -> _Ways:
    made = _office(system, {"kind": "overcast"})
    matrices = RoomMatrices(made, cache=Cache(cache))
    view = made.view("desk")
    eyes = {"desk": (view.point_m, view.direction)}
    found = []
    for size in (None, SIZE):
        year = RoomYear(Arrivals(matrices, sky), eyes=eyes, picture_px=size)
        parts = [part.eyes["desk"] for _, part in year.of({"": [made.system("window")]})]
        found.append({key: np.concatenate([part[key] for part in parts]) for key in ("illuminance", "dgp")})
    weather, suns = sky.weather, sky.suns
    altitude, azimuth = weather.sun_positions("spa")
    shining = np.flatnonzero((suns.irradiance > 0.0) & (suns.directions[:, 1] < 0.0))
    seen = _spread(suns.directions, shining[in_view[shining]], MOMENTS // 2)
    others = _spread(suns.directions, shining[~in_view[shining]], MOMENTS - MOMENTS // 2)
    moments = []
    for step in [*seen, *others]:
        light = {"direct": float(weather.direct[step]), "diffuse": float(weather.diffuse[step])}
        position = [float(altitude[step]), float(azimuth[step])]
        rated = _office(system, {"kind": "perez", "sun_deg": position, **light}).glare("desk", error=ERROR)
        moments.append((step, rated.vertical_illuminance, rated.dgp))
    return _Ways(*found, moments)


def _shares(name: str, ways: _Ways, in_view: np.ndarray) -> list[list[str]]:
    rows = []
    for words, chosen in (("in view", in_view), ("not in view", ~in_view)):
        a, b = ({key: values[chosen] for key, values in way.items()} for way in (ways.pictured, ways.without))
        difference = np.abs(a["dgp"] - b["dgp"])
        same = np.mean([dgp_class(x) == dgp_class(y) for x, y in zip(a["dgp"], b["dgp"], strict=True)])
        at_eye = np.abs(a["illuminance"] / b["illuminance"] - 1.0)
        p95, p99 = np.percentile(difference, [95, 99])
        figures = [f"{p95:.4f}", f"{p99:.4f}", f"{difference.max():.4f}", f"{100 * same:.1f} %"]
        rows.append([name, words, str(chosen.sum()), *figures, f"{100 * np.percentile(at_eye, 95):.2f} %"])
    return rows


def _beside(name: str, ways: _Ways, sky: SkyYear) -> list[list[str]]:
    rows = []
    for step, at_eye, dgp in ways.moments:
        cells = [name, sky.weather.words(step), f"{at_eye:.0f}", f"{dgp:.3f}"]
        for way in (ways.without, ways.pictured):
            cells += [f"{100 * (way['illuminance'][step] / at_eye - 1):+.1f} %", f"{way['dgp'][step] - dgp:+.4f}"]
        rows.append(cells)
    return rows


def report(data: Path) -> str:
    """Text of the section."""
    shares, beside = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        systems = _systems(data, folder)
        sky, in_view = _chosen(_office({"glass": 0.7}, {"kind": "overcast"}))
        for words, system in systems.items():
            ways = _ways(system(), sky, in_view, folder / "cache")
            shares += _shares(words, ways, in_view)
            beside += _beside(words, ways, sky)
    near = [sum(abs(float(row[k])) < 0.01 for row in beside) for k in (5, 7)]
    lit = [sum(abs(float(row[k][:-2])) < 3.0 for row in beside) for k in (4, 6)]
    return f"""### Glare of a year

The shipped office, the eye of the view `desk` turned to look along ({DIRECTION[0]:g}, {DIRECTION[1]:g}), and
{len(in_view)} steps of {60 * STEP:.0f} minutes of a synthetic year at {PLACE.latitude}° N, drawn at random from those
with the sun in view, on the façade, and elsewhere. Differences of the DGP between pictures of {SIZE} × {SIZE} pixels,
rated as pictures are, and glare without pictures: 95th and 99th percentile, and the largest; steps in the same class of
EN 17037; 95th percentile of the relative difference of E_v.

{table(["data set", "sun", "steps", "95 %", "99 %", "largest", "same class", "E_v, 95 %"], shares)}

What differs with the sun in view is the size of its disc, which in a picture is a number of whole pixels.

The same steps path by path (`Room.glare`, standard error of E_v at most {100 * ERROR:g} %), at {MOMENTS} positions of
the sun far from each other, half of them in view. Of {len(beside)} moments {lit[0]} have E_v within 3 % and {near[0]}
the DGP within 0.01 without pictures; {lit[1]} and {near[1]} with pictures.

{table(["data set", "step", "E_v [lx]", "DGP", "without pictures: E_v", "DGP", "pictures: E_v", "DGP"], beside)}
"""
