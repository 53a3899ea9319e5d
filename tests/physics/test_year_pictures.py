"""Pictures of a year beside what is known of them, and beside the same steps without pictures."""

import numpy as np
import pytest

from clerestory import room
from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.pictures import YearPictures
from clerestory.annual.year import RoomYear
from clerestory.glare import evaluate
from clerestory.picture import View
from clerestory.weather import SkyYear, read_weather
from short_study import BOX, HEAD, film

ROOM = {
    "place": {"latitude": 47.3, "longitude": 11.4, "timezone": "Etc/GMT-1"},
    "room": BOX,
    "sky": {"kind": "overcast"},
}
EYE = ([1.5, 2.0, 1.2], [0.2, -1.0, 0.0])
WEA = (
    HEAD
    + """1 21 11.5 700 60
1 21 12.5 700 60
3 21 8.5 300 200
6 21 13.5 0 250
12 21 23.5 0 0
"""
)


@pytest.fixture
def sky(tmp_path):
    (tmp_path / "days.wea").write_text(WEA)
    return SkyYear(read_weather(tmp_path / "days.wea"))


def matrices_of(system, folder, **surfaces):
    tables = ROOM | {"room": ROOM["room"] | surfaces, "systems": {"window": system}}
    return RoomMatrices(room.load(tables), cache=Cache(folder / "cache"))


def test_an_even_window_in_a_black_room_is_its_luminance(tmp_path, sky):
    matrices = matrices_of(film(tmp_path, 0.3), tmp_path, floor=0.0, walls=0.0, ceiling=0.0)
    year = YearPictures(Arrivals(matrices, sky), View.fisheye(*EYE), (100, 100), samples=16)
    pictures = dict(year.of([matrices.room.system("window")]).at(range(5)))
    assert list(pictures) == list(range(5))
    for step in range(4):
        light = sky.columns(np.array([step]), part="sky")[:, 0]
        facing = np.clip(-sky.patches.centres[:, 1], 0.0, None)
        falls = float((light * sky.patches.solid_angles * facing)[1:].sum()) + np.pi / 2.0 * float(light[0])
        falls += float(sky.suns.irradiance[step] * max(-sky.suns.directions[step, 1], 0.0))
        seen = pictures[step].pixels[..., 0]
        # The rest is cut by the window's edge.
        assert np.median(seen[seen > 0.0]) == seen.max() == pytest.approx(0.3 * falls / np.pi, rel=1e-3)
    assert not pictures[4].pixels.any()


@pytest.mark.parametrize("size", [100, 180])
def test_the_sun_through_glass_gives_its_light_and_glares_as_large_as_it_is(tmp_path, sky, size):
    matrices = matrices_of({"glass": 0.1}, tmp_path, floor=0.0, walls=0.0, ceiling=0.0)
    view = View.fisheye(*EYE).updated("-vh 45 -vv 45 -vd 0 -1 0.35")
    made = YearPictures(Arrivals(matrices, sky), view, (size, size), samples=16).of([matrices.room.system("window")])
    ((_, picture),) = made.at([1])
    found = max(evaluate(picture).sources, key=lambda source: source.luminance)
    sun = sky.suns.directions[1]
    # 0.1 at normal incidence; less at the sun's.
    incident = matrices.frame(0) @ sun
    ((passed,),) = ([p.value for p in matrices.room.system("window").peaks(incident, "transmission")],)
    expected = 179.0 * passed * sky.suns.irradiance[1]
    assert found.luminance * found.solid_angle == pytest.approx(expected, rel=0.02)
    assert np.degrees(np.arccos(np.dot(found.direction, sun))) < 45.0 / size
    # Glare goes with the square: of whole pixels it is that of the disc but for their number.
    assert 0.8 < found.solid_angle / 6.797e-5 < 1.25


def test_pictures_say_what_is_found_without_them(tmp_path, sky):
    matrices = matrices_of({"glass": 0.1}, tmp_path)
    systems = [matrices.room.system("window")]
    arrivals = Arrivals(matrices, sky)
    year = RoomYear(arrivals, eyes={"desk": EYE})
    ((_, part),) = year.of({"dark glass": systems})
    # A pixel is not larger than the sun.
    pictures = YearPictures(arrivals, View.fisheye(*EYE), (380, 380), samples=16).of(systems)
    for step, picture in pictures.at(range(4)):
        found = evaluate(picture)
        expected = {key: values[step] for key, values in part.eyes["desk"].items()}
        assert found.vertical_illuminance == pytest.approx(expected["illuminance"], rel=0.02), step
        assert found.dgp == pytest.approx(expected["dgp"], abs=0.01), step


def test_pixels_of_surfaces_are_those_of_a_rendering(tmp_path):
    """A window that is evenly bright, and black from inside: the rows' sums are the rendering by its radiance."""
    view = {"point_m": EYE[0], "direction": EYE[1], "size_px": [32, 32]}
    parts = {"systems": {"window": film(tmp_path, 0.3, 0.0)}, "views": {"eye": view}}
    made = room.load(ROOM | parts)
    renderings = [made.picture("eye", samples=1024, seed=seed) for seed in (1, 2)]
    window = max(rendering.radiance[..., 1].max() for rendering in renderings)
    rendered = np.array([rendering.radiance[..., 1].ravel() / window for rendering in renderings])
    matrices = [RoomMatrices(made, cache=Cache(tmp_path / "cache"), seed=seed) for seed in (1, 2)]
    seen = View(renderings[0].view)
    sums = np.array([m.surfaces(seen, (32, 32), samples=1024).all.sum(axis=1, dtype=float) for m in matrices])

    surfaces = np.ones(32 * 32, dtype=bool)
    surfaces[matrices[0].windows_seen(seen, (32, 32)).pixel] = False
    surfaces &= rendered.mean(axis=0) > 0.0
    assert surfaces.sum() > 600
    sums, rendered = sums[:, surfaces], rendered[:, surfaces]
    mean = rendered.mean(axis=0)
    difference = sums.mean(axis=0) / mean - 1.0
    # Pairs of runs tell the noise of both, as so many pixels share it.
    noise = np.hypot(*((runs[0] - runs[1]) / 2.0 / mean for runs in (sums, rendered)))
    assert np.sqrt(np.mean(noise**2)) < 0.05
    assert np.sqrt(np.mean(difference**2)) < 1.15 * np.sqrt(np.mean(noise**2)) + 0.005
    assert sums.mean() == pytest.approx(rendered.mean(), rel=0.003)
