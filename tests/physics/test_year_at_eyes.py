"""Steps of a year at an eye beside the same moments in the same room, followed path by path."""

import numpy as np
import pytest

from clerestory import room
from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.year import RoomYear, Sampling
from clerestory.weather import SkyYear, read_weather
from samples import ABSENT, sample_root
from short_study import BOX, HEAD, film

ROOM = {
    "place": {"latitude": 47.3, "longitude": 11.4, "timezone": "Etc/GMT-1"},
    "room": BOX,
    "views": {"desk": {"point_m": [1.5, 2.0, 1.2], "direction": [0.4, -1.0, 0.0]}},
}
WEA = (
    HEAD
    + """1 21 12.5 700 60
3 21 10.5 300 200
6 21 13.5 0 250
"""
)


def sample_of(kind, name, treatment):
    root = sample_root()
    if root is None:
        pytest.skip(ABSENT)
    return {"file": str(root / kind / name), "treatment": treatment}


@pytest.mark.parametrize("name", ["film", "dark glass", "blind, tree", "blind, Klems"])
def test_a_step_is_the_moment(tmp_path, name):
    system = {
        "film": lambda: film(tmp_path, 0.1),
        "dark glass": lambda: {"glass": 0.1},
        "blind, tree": lambda: sample_of("tensortree", "b30.xml", "high"),
        "blind, Klems": lambda: sample_of("klems", "blinds30.xml", "klems"),
    }[name]()
    (tmp_path / "days.wea").write_text(WEA)
    weather = read_weather(tmp_path / "days.wea")
    sky = SkyYear(weather)
    tables = ROOM | {"systems": {"window": system}, "sky": {"kind": "overcast"}}
    made = room.load(tables)
    view = made.view("desk")
    matrices = RoomMatrices(made, cache=Cache(tmp_path / "cache"))
    sampling = Sampling(view=32768, returned=8192)
    arrivals = Arrivals(matrices, sky, samples=8192)
    year = RoomYear(arrivals, eyes={"desk": (view.point_m, view.direction)}, sampling=sampling)
    ((_, part),) = year.of({name: [made.system("window")]})
    found = part.eyes["desk"]
    altitude, azimuth = weather.sun_positions("spa")
    for step in range(len(weather)):
        light = {"direct": float(weather.direct[step]), "diffuse": float(weather.diffuse[step])}
        sun = [float(altitude[step]), float(azimuth[step])]
        moment = room.load(tables | {"sky": {"kind": "perez", "sun_deg": sun, **light}})
        expected = moment.glare("desk", error=0.003)
        # The light of the room by patches: a few per cent where patches are bright and coarse.
        assert found["illuminance"][step] == pytest.approx(expected.vertical_illuminance, rel=0.03), step
        assert found["dgp"][step] == pytest.approx(expected.dgp, abs=0.015), step
    assert np.ptp(found["dgp"]) > 0.02
