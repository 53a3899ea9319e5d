"""Eyes, sensors and windows in the wrong place are named, those in the right place are not."""

from __future__ import annotations

import pytest

from clerestory import room
from clerestory.cli import main
from clerestory.trace.keys import RecipeError

OUTSIDE, INSIDE, WITHIN = [1.5, -2.0, 1.2], [1.5, 2.0, 1.2], [0.5, 0.5, 0.4]
GLASS = {"glass": {"glass": 0.8}}
SKY = {"kind": "clear", "sun_deg": [40.0, 180.0]}
BOX = {
    "width_m": 3.0,
    "depth_m": 4.0,
    "height_m": 2.5,
    "openings": [{"width_m": 1.0, "height_m": 1.2, "sill_m": 0.9, "system": "glass"}],
    "furniture": [{"corner_m": [0.2, 0.2, 0.0], "size_m": [0.8, 0.8, 0.8]}],
}
#: Five faces of a room of 2 m, open to the south.
WALLS = """
void plastic wall 0 0 5 .5 .5 .5 0 0
wall polygon north 0 0 12 0 2 0 2 2 0 2 2 2 0 2 2
wall polygon west 0 0 12 0 0 0 0 2 0 0 2 2 0 0 2
wall polygon east 0 0 12 2 0 0 2 0 2 2 2 2 2 2 0
wall polygon floor 0 0 12 0 0 0 2 0 0 2 2 0 0 2 0
wall polygon ceiling 0 0 12 0 0 2 0 2 2 2 2 2 2 0 2
"""
SOUTH = [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, 0.0]]


def built(**more):
    return {"sky": SKY, "room": BOX, "systems": GLASS, **more}


def from_file(folder, corners, **more):
    (folder / "walls.rad").write_text(WALLS)
    tables = {
        "sky": SKY,
        "geometry": [{"file": "walls.rad"}],
        "windows": {"w": {"corners_m": corners, "system": "glass"}},
        "systems": GLASS,
        **more,
    }
    return room.Room(room.Recipe.of(tables), folder)


def eye(point):
    return {"views": {"eye": {"point_m": point, "direction": [0.0, -1.0, 0.0]}}}


def test_an_eye_outside_or_in_furniture_is_named():
    assert room.load(built(**eye(INSIDE))).doubts(view="eye") == []
    (text,) = room.load(built(**eye(OUTSIDE))).doubts(view="eye")
    assert "the eye of view eye at (1.5, -2, 1.2) m lies outside of the room" in text
    assert "(move it inside)" in text
    (text,) = room.load(built(**eye(WITHIN))).doubts(view="eye")
    assert "lies within furniture 1 (move it out)" in text


def test_sensors_outside_are_counted():
    made = room.load(built(sensors={"plane": {"points_m": [INSIDE, OUTSIDE, [-1.0, 1.0, 1.0], WITHIN]}}))
    within, outside = made.doubts(sensors="plane")
    assert "1 of 4 sensors plane lies within furniture 1, number 4 at (0.5, 0.5, 0.4) m" in within
    assert (
        "2 of 4 sensors plane lie outside of the room, number 2 at (1.5, -2, 1.2) m, number 3 at (-1, 1, 1) m"
        in outside
    )


@pytest.mark.parametrize("name", room.names())
def test_shipped_rooms_have_nothing_in_the_wrong_place(name):
    made = room.load(name)
    assert made.warnings == []
    found = [*(made.doubts(view=v) for v in made.recipe.views), *(made.doubts(sensors=s) for s in made.recipe.sensors)]
    assert not any(found)


def test_windows_the_wrong_way_round(tmp_path):
    right = from_file(tmp_path, SOUTH)
    assert right.warnings == []
    wrong = from_file(tmp_path, SOUTH[::-1])
    (text,) = wrong.warnings
    assert text.startswith("window w: its face to the room sees the sky or the ground in 100 %")
    assert "counter-clockwise as seen from the room" in text


def test_windows_in_a_wall_without_an_opening():
    west = [[0.0, 1.0, 1.0], [0.0, 2.0, 1.0], [0.0, 2.0, 2.0], [0.0, 1.0, 2.0]]
    made = room.load(built(windows={"w": {"corners_m": west, "system": "glass"}}))
    (text,) = made.warnings
    assert "it lies in the plane of west wall, which has no opening there" in text


BSDF_SCENE = """
void BSDF thick 6 0.1 window.xml 0 0 1 . 0 0
void BSDF lying 6 0 window.xml 0 1 0 . 0 0
void aBSDF beam 5 window.xml 0 0 1 . 0 0
void spotlight lamp 0 0 7 100 100 100 30 0 0 -1
thick polygon p 0 0 12 0 0 0 0 0 2 1 0 2 1 0 0
beam polygon q 0 0 12 1 0 0 1 0 2 2 0 2 2 0 0
lying polygon r 0 0 12 0 3 3 0 4 3 1 4 3 1 3 3
lamp polygon s 0 0 12 1 1 1.9 1 1.1 1.9 1.1 1.1 1.9 1.1 1 1.9
"""


def test_what_a_scene_file_says_of_its_windows_and_lamps(tmp_path):
    from clerestory.system import pane_from_normal

    pane_from_normal(0.8, 0.1).to_matrix("klems-full").write(tmp_path / "window.xml")
    (tmp_path / "walls.rad").write_text(WALLS + BSDF_SCENE)
    made = room.Room(room.Recipe.of({"sky": SKY, "geometry": [{"file": "walls.rad"}]}), tmp_path)
    p, q, r = made.windows
    assert p.system != q.system
    assert r.up == (0.0, 1.0, 0.0)
    told = "\n".join(made.warnings)
    assert "p: its data set stands for the shapes within 0.1 m of it" in told
    assert "s: the spotlight lamp is left dark" in told
    assert made.illuminance(points=[[1.0, 1.0, 0.1]], normals=[[0.0, 0.0, 1.0]], samples=256).values[0] > 100.0


WRONG_VIEWS = {
    "view eye: the upward direction is parallel": {"direction": "[0.0, 0.0, 1.0]"},
    "view eye: the line of sight or the upward direction is 0 0 0": {"direction": "[0.0, 0.0, 0.0]"},
    "view eye: a perspective picture does not hold the illuminance at the eye": {
        "direction": "[0.0, -1.0, 0.0]",
        "projection": '"perspective"',
        "angle_deg": "[60.0, 60.0]",
    },
}


@pytest.mark.parametrize(("text", "keys"), WRONG_VIEWS.items(), ids=list(WRONG_VIEWS))
def test_views_that_cannot_be_are_refused_before_the_work(text, keys, tmp_path, capsys):
    recipe = tmp_path / "room.toml"
    lines = "\n".join(f"{key} = {value}" for key, value in keys.items())
    recipe.write_text(
        '[sky]\nkind = "overcast"\n[room]\nwidth_m = 3.0\ndepth_m = 4.0\nheight_m = 2.5\n'
        f"[views.eye]\npoint_m = [1.5, 2.0, 1.2]\n{lines}\n"
    )
    assert main(["render", str(recipe), "--glare", "--samples", "1000000"]) == 1
    told = [line for line in capsys.readouterr().err.splitlines() if not line.startswith("warning: ")]
    assert len(told) == 1
    assert told[0].startswith(f"error: {text}")


def test_night_is_an_error():
    sky = {"kind": "clear", "time": "2021-02-21 22:00"}
    place = {"latitude": 47.3, "longitude": 11.4, "timezone": 1.0}
    with pytest.raises(RecipeError, match=r"it is night: the sun is .*below the horizon \(choose"):
        room.load(built(sky=sky, place=place))
