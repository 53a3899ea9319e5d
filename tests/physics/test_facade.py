"""The six-phase method: daylight through ports before a façade beside that through the whole scene."""

import numpy as np
import pytest

from clerestory import room
from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.facade import Facade
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.year import RoomYear, Sampling
from clerestory.sky import SkyPatches
from clerestory.trace.keys import RecipeError
from clerestory.weather import SkyYear, read_weather
from short_study import BOX, HEAD

#: An awning of 1.2 m before the window, and a wall far away.
AWNING = "void plastic grey 0 0 5 .5 .5 .5 0 0\ngrey polygon awning 0 0 12 0 -1.2 2.7 3 -1.2 2.7 3 0 2.7 0 0 2.7\n"
WALL = "void plastic dark 0 0 5 .2 .2 .2 0 0\ndark polygon wall 0 0 12 -30 -12 0 30 -12 0 30 -12 6 -30 -12 6\n"
ROOM = {
    "room": BOX,
    "systems": {"window": {"glass": 0.7}},
    "sky": {"kind": "overcast"},
    "sensors": {"plane": {"height_m": 0.8, "spacing_m": 1.0}},
    "geometry": [{"file": "awning.rad", "facade": True}, {"file": "wall.rad"}],
    # A plane 1.5 m before the façade; what comes from above and from the sides comes beside it.
    "ports": {"front": {"corners_m": [[-1.0, -1.5, 0.0], [-1.0, -1.5, 4.0], [4.0, -1.5, 4.0], [4.0, -1.5, 0.0]]}},
}
WEA = (
    HEAD
    + """3 21 9.5 500 200
3 21 12.5 0 300
"""
)


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "awning.rad").write_text(AWNING)
    (tmp_path / "wall.rad").write_text(WALL)
    return tmp_path


def load(scene, tables=ROOM):
    return room.Room(room.recipe.Recipe.of(tables), scene)


@pytest.mark.parametrize(("far", "tolerance"), [([], 0.003), ([{"file": "wall.rad"}], 0.05)])
def test_daylight_through_ports_is_daylight(scene, far, tolerance):
    matrices = RoomMatrices(load(scene, ROOM | {"geometry": ROOM["geometry"][:1] + far}), cache=Cache(scene / "cache"))
    patches = SkyPatches.named("reinhart:2")
    whole = matrices.daylight(0, patches, samples=8192)
    parts = Facade(matrices).daylight(0, patches, samples=8192)
    weights = matrices.basis.projected_solid_angles
    # Irradiance of the window by an even ground and an even sky. Light is the same all over a port: the mean of its
    # height sees more of a near wall and less of the ground than what goes down to the window's.
    for rows in (slice(0, 1), slice(1, None)):
        for part in ("all", "direct"):
            found, expected = (weights @ getattr(m, part)[:, rows].astype(float).sum(axis=1) for m in (parts, whole))
            assert found == pytest.approx(expected, rel=tolerance)
    # Patches of the window blur what stands between it and the port: by rows, not patch by patch.
    by_row = (weights * parts.all.sum(axis=1), weights * whole.all.sum(axis=1))
    assert np.abs(by_row[0] - by_row[1]).sum() < 0.05 * by_row[1].sum()
    assert (parts.standard_error >= 0.0).all()


def test_another_awning_asks_for_its_own_matrix_alone(scene):
    patches = SkyPatches.named("reinhart:1")
    cache = Cache(scene / "cache")
    Facade(RoomMatrices(load(scene), cache=cache)).daylight(0, patches, samples=256)
    assert cache.computed == ["facade", "beside", "before"]
    (scene / "awning.rad").write_text(AWNING.replace("-1.2", "-0.6"))
    cache = Cache(scene / "cache")
    Facade(RoomMatrices(load(scene), cache=cache)).daylight(0, patches, samples=256)
    assert (cache.computed, cache.found) == (["facade", "beside"], ["before"])


def test_a_year_through_ports_is_the_year(scene):
    (scene / "day.wea").write_text(WEA)
    made = load(scene)
    matrices = RoomMatrices(made, cache=Cache(scene / "cache"))
    points, normals = made.sensors("plane")
    sky = SkyYear(read_weather(scene / "day.wea"))
    found = []
    for facade in (None, Facade(matrices)):
        year = RoomYear(Arrivals(matrices, sky, facade=facade), points, normals, sampling=Sampling(view=4096))
        ((_, part),) = year.of({"glass": [made.system("window")]})
        found.append(part.illuminance)
    assert np.allclose(found[1].mean(axis=1), found[0].mean(axis=1), rtol=0.03)
    assert np.allclose(found[1], found[0], rtol=0.12)


def test_ports_are_asked_for(scene):
    with pytest.raises(RecipeError, match=r"ports: the six-phase method needs openings before the façade"):
        Facade(RoomMatrices(load(scene, {k: v for k, v in ROOM.items() if k != "ports"}), cache=Cache(scene / "cache")))
