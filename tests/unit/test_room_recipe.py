"""Room recipes: what they build, and what they refuse."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from clerestory import room
from clerestory.room.builder import build
from clerestory.room.recipe import Box
from clerestory.trace.keys import RecipeError

TABLES = {
    "sky": {"kind": "clear", "sun_deg": [40.0, 180.0]},
    "room": {
        "width_m": 3.0,
        "depth_m": 4.0,
        "height_m": 2.5,
        "openings": [{"width_m": 1.0, "height_m": 1.2, "sill_m": 0.9, "system": "glass"}],
    },
    "systems": {"glass": {"glass": 0.8}},
    "views": {"eye": {"point_m": [1.5, 2.0, 1.2], "direction": [0.0, -1.0, 0.0], "size_px": [16, 16]}},
    "sensors": {"plane": {"height_m": 0.8}},
}


def tables(**changes):
    """The recipe with other values, keys by `__`."""
    made = copy.deepcopy(TABLES)
    for key, value in changes.items():
        *path, last = key.split("__")
        part = made
        for name in path:
            part = part[name]
        if value is None:
            part.pop(last, None)
        else:
            part[last] = value
    return made


def areas(quads):
    """Area of each surface by name, and the sum of the normals times the areas."""
    found, sums = {}, np.zeros(3)
    for quad in quads:
        c = quad.corners
        vectors = np.cross(c[:, 2] - c[:, 0], c[:, 3] - c[:, 1]) / 2
        found[quad.name] = np.linalg.norm(vectors, axis=1).sum()
        sums += vectors.sum(axis=0)
    return found, sums


def test_a_room_is_closed_but_for_its_windows():
    openings = [
        {"width_m": 1.0, "height_m": 1.2, "sill_m": 0.9, "left_m": 0.2, "system": "g"},
        {"width_m": 0.8, "height_m": 0.5, "sill_m": 0.1, "left_m": 1.9, "system": "g"},
        {"wall": "east", "width_m": 2.0, "height_m": 1.0, "sill_m": 1.0, "system": "g"},
    ]
    box = Box.model_validate({**TABLES["room"], "wall_thickness_m": 0.3, "openings": openings})
    quads, windows = build(box)
    found, normals = areas(quads)
    assert found["south wall"] == pytest.approx(3.0 * 2.5 - 1.2 - 0.4)
    assert found["east wall"] == pytest.approx(4.0 * 2.5 - 2.0)
    # With the windows in the outer plane the border is closed: its area vectors sum to zero.
    for name, corners, _ in windows:
        c = np.array(corners)
        normals += np.cross(c[2] - c[0], c[3] - c[1]) / 2
        assert name in ("south 1", "south 2", "east")
    assert normals == pytest.approx(np.zeros(3), abs=1e-9)


def test_what_looks_out_faces_the_room():
    made = room.load(tables())
    (window,) = made.windows
    c = window.corners
    assert np.cross(c[1] - c[0], c[2] - c[0])[1] > 0.0
    assert c[:, 1] == pytest.approx(0.0)


def test_a_grid_keeps_its_margin():
    points, normals = room.load(tables()).sensors("plane")
    assert points[:, 0].min() == pytest.approx(0.3)
    assert points[:, 1].max() == pytest.approx(3.7)
    assert (points[:, 2] == 0.8).all()
    assert (normals == [0.0, 0.0, 1.0]).all()


FAULTS = {
    "room.openings[1]: reaches from": {"room__openings": [{**TABLES["room"]["openings"][0], "left_m": 2.5}]},
    "above the ceiling": {"room__openings": [{**TABLES["room"]["openings"][0], "sill_m": 2.0}]},
    "there is no system 'glas' (did you mean glass?)": {
        "room__openings": [{**TABLES["room"]["openings"][0], "system": "glas"}]
    },
    "where the sun is in a clear sky is not given": {"sky": {"kind": "clear"}},
    "a time needs a place": {"sky": {"kind": "clear", "time": "2021-02-21 14:00"}},
    "room.width_m": {"room__width_m": -3.0},
    "room.widht_m: there is no such key (did you mean width_m?)": {"room__widht_m": 3.0},
    "either a file or glass": {"systems__glass": {}},
    "nowhere.xml does not exist": {"systems__glass": {"file": "nowhere.xml"}},
    "there is no material 'wood'": {"room__floor": "wood"},
    "there is no room": {"room": None, "sensors": None},
    "only a CIE general sky has a type": {"sky": {"kind": "clear", "type": 3, "sun_deg": [40.0, 180.0]}},
    "below the horizon": {"sky": {"kind": "clear", "sun_deg": [-10.0, 180.0]}},
    "not flat": {"windows": {"w": {"corners_m": [[0, 0, 0], [1, 0, 0], [1, 0.5, 1], [0, 0, 1]], "system": "glass"}}},
}


@pytest.mark.parametrize(("text", "changes"), FAULTS.items(), ids=list(FAULTS))
def test_faults_are_named(text, changes):
    with pytest.raises(RecipeError) as error:
        room.load(tables(**changes))
    assert text in str(error.value), str(error.value)
    assert "\n" not in str(error.value)


def test_unknown_names_are_named():
    made = room.load(tables())
    with pytest.raises(RecipeError, match=r"there is no view 'eyes' \(did you mean eye\?\)"):
        made.picture("eyes")
    with pytest.raises(RecipeError, match="there are no sensors 'plan'"):
        made.illuminance("plan")


@pytest.mark.parametrize("name", room.names())
def test_shipped_rooms_can_be_looked_at(name):
    made = room.load(name)
    view = next(iter(made.recipe.views.values())).model_copy(update={"size_px": [24, 24]})
    picture = made.picture(view, samples=4)
    assert picture.luminance.max() > 10.0
    assert picture.noise.shape == (24, 24)
    assert made.illuminance("workplane", samples=256).values.min() > 0.0


def test_more_passes_are_the_same_paths():
    made = room.load(tables())
    whole = made.picture("eye", samples=8)
    again = made.picture("eye", samples=8, seconds=1000.0)
    assert (whole.radiance == again.radiance).all()
    other = made.picture("eye", samples=8, seed=2)
    assert (whole.radiance != other.radiance).any()
