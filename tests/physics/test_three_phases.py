"""Products of matrices beside paths through the same room."""

import numpy as np
import pytest

from clerestory import Bsdf, Model, room
from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.phases import Transfer, leaving
from clerestory.annual.year import RoomYear, Sampling
from clerestory.photometry import EFFICACY, LUMINANCE
from clerestory.sky import SkyPatches
from clerestory.weather import SkyYear, read_weather
from samples import ABSENT, sample_root
from short_study import BOX, HEAD, film

ROOM = {
    "room": BOX,
    "sky": {"kind": "overcast"},
    "sensors": {"plane": {"height_m": 0.8, "spacing_m": 1.0}},
}


def products(tables, tmp_path, *, returns):
    made = room.load(tables)
    points, normals = made.sensors("plane")
    matrices = RoomMatrices(made, cache=Cache(tmp_path / "cache"))
    patches = SkyPatches.named("reinhart:4")
    view = matrices.view(points, normals, samples=16384)
    daylight = matrices.daylight(0, patches, samples=16384)
    sky = made.sky._core.patches(patches._core, "sky", None, True) @ LUMINANCE
    transfers = [Transfer.of(made.system("window"), matrices.basis)]
    back = [matrices.returned(0, samples=16384).all] if returns else None
    light = leaving(transfers, back) @ (daylight.all @ sky)
    paths = made.illuminance(points=points, normals=normals, samples=65536)
    return EFFICACY * view.all @ light, paths.values


@pytest.mark.parametrize("name", ["glass", "diffuse", "blind"])
def test_three_phases_agree_with_paths(tmp_path, name):
    if name == "glass":
        system = {"glass": 0.7}
    elif name == "diffuse":
        system = film(tmp_path, 0.4)
    else:
        root = sample_root()
        if root is None:
            pytest.skip(ABSENT)
        system = {"file": str(root / "klems" / "blinds30.xml"), "treatment": "klems"}
    found, paths = products(ROOM | {"systems": {"window": system}}, tmp_path, returns=True)
    # What is seen straight through a pane is spread over the patches of the Klems basis; the others are as they are.
    assert found.mean() == pytest.approx(paths.mean(), rel=0.015 if name == "glass" else 0.006)
    assert np.allclose(found, paths, rtol=0.04 if name == "glass" else 0.025)


def test_what_windows_return_is_missed_without_it(tmp_path):
    parts = {("exterior", "transmission"): Model.lambertian(0.3), ("interior", "reflection"): Model.lambertian(0.7)}
    Bsdf.from_models(parts).save(tmp_path / "film.bsdf.npz")
    tables = ROOM | {"systems": {"window": {"file": str(tmp_path / "film.bsdf.npz")}}}
    found, paths = products(tables, tmp_path, returns=False)
    assert found.mean() < 0.97 * paths.mean()


WEA = (
    HEAD
    + """3 21 9.5 {direct} 200
3 21 12.5 {direct} 300
"""
)


@pytest.mark.parametrize("direct", [0, 500])
def test_daylight_coefficients(tmp_path, direct):
    (tmp_path / "day.wea").write_text(WEA.format(direct=direct))
    made = room.load(ROOM | {"systems": {"window": {"glass": 0.7}}})
    points, normals = made.sensors("plane")
    arrivals = Arrivals(
        RoomMatrices(made, cache=Cache(tmp_path / "cache")), SkyYear(read_weather(tmp_path / "day.wea"))
    )
    systems = {"glass": [made.system("window")]}
    found = {}
    for method in ("2-phase", "5-phase"):
        year = RoomYear(arrivals, points, normals, method=method, sampling=Sampling(view=4096))
        ((_, part),) = year.of(systems)
        found[method] = part.illuminance
    year = RoomYear(arrivals, points, normals, method="2-phase", sampling=Sampling(view=4096))
    skies = arrivals.sky.columns()
    by_hand = EFFICACY * year.coefficients(systems["glass"]).all @ skies
    assert np.allclose(found["2-phase"], by_hand.T, rtol=1e-4)
    if direct == 0:
        assert np.allclose(found["2-phase"], found["5-phase"], rtol=1e-3)
    else:
        # The sun is spread over ten degrees: its edges on the plane are blurred, its light is all there.
        assert found["2-phase"].mean() == pytest.approx(found["5-phase"].mean(), rel=0.2)
        assert not np.allclose(found["2-phase"], found["5-phase"], rtol=0.1)


def test_finer_patches_of_windows_come_nearer_to_five_phases(tmp_path):
    (tmp_path / "day.wea").write_text(WEA.format(direct=500))
    made = room.load(ROOM | {"systems": {"window": {"glass": 0.7}}})
    points, normals = made.sensors("plane")
    found = {}
    for basis, method in (("klems-quarter", "3-phase"), ("reinhart:2", "3-phase"), ("klems-full", "5-phase")):
        matrices = RoomMatrices(made, basis, cache=Cache(tmp_path / "cache"))
        arrivals = Arrivals(matrices, SkyYear(read_weather(tmp_path / "day.wea")), samples=1024)
        year = RoomYear(arrivals, points, normals, method=method, sampling=Sampling(view=8192, returned=256))
        ((_, part),) = year.of({"glass": [made.system("window")]})
        found[basis] = part.illuminance
    coarse, fine = (np.abs(found[name] - found["klems-full"]).mean() for name in ("klems-quarter", "reinhart:2"))
    assert fine < 0.6 * coarse
    assert found["reinhart:2"].mean() == pytest.approx(found["klems-full"].mean(), rel=0.1)
