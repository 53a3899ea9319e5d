"""A picture that was interrupted goes on as if it had not been."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from clerestory import ClerestoryError, room
from clerestory.cli import main
from clerestory.picture import Picture

TABLES = {
    "sky": {"kind": "clear", "sun_deg": [40.0, 180.0]},
    "room": {
        "width_m": 3.0,
        "depth_m": 4.0,
        "height_m": 2.5,
        "openings": [{"width_m": 1.0, "height_m": 1.2, "sill_m": 0.9, "system": "glass"}],
    },
    "systems": {"glass": {"glass": 0.8}},
    "views": {"eye": {"point_m": [1.5, 2.0, 1.2], "direction": [0.0, -1.0, 0.0], "size_px": [24, 24]}},
}


@pytest.fixture
def made():
    return room.load(TABLES)


def stopped_after(calls):
    """A report that presses Ctrl-C at its n-th call."""
    count = 0

    def tell(_share):
        nonlocal count
        count += 1
        if count >= calls:
            raise KeyboardInterrupt

    return tell


def test_going_on_gives_the_same_bits(made, tmp_path):
    view = made.view("eye")
    state = room.State.new(made, view)
    made.picture("eye", samples=8, state=state)
    assert state.samples == 8
    state.save(tmp_path / "eye.partial.npz")
    again = room.State.load(tmp_path / "eye.partial.npz", made, view)
    assert again.samples == 8
    found, whole = made.picture("eye", samples=20, state=again), made.picture("eye", samples=20)
    assert (found.radiance == whole.radiance).all()
    assert (found.noise == whole.noise).all()


def test_what_is_there_already_is_not_traced_again(made):
    state = room.State.new(made, made.view("eye"))
    first = made.picture("eye", noise=0.3, state=state)
    again = made.picture("eye", noise=0.3, state=state)
    assert again.samples == first.samples
    assert (again.radiance == first.radiance).all()


def test_a_pass_that_is_stopped_leaves_what_was_there(made):
    view = made.view("eye").model_copy(update={"size_px": [400, 400]})
    state = room.State.new(made, view)
    made.picture(view, samples=4, state=state)
    before = state.core.sums()
    with pytest.raises(KeyboardInterrupt):
        made.picture(view, samples=40_000, state=state, progress=stopped_after(1))
    paths = state.samples
    assert paths % 4 == 0
    if paths == 4:
        assert all((a == b).all() for a, b in zip(before, state.core.sums(), strict=True))
    whole = made.picture(view, samples=paths)
    assert (made.picture(view, samples=paths, state=state).radiance == whole.radiance).all()


CHANGES = {
    "the sky": ("sky", {"kind": "clear", "sun_deg": [41.0, 180.0]}),
    "the room": ("room", {**TABLES["room"], "walls": 0.55}),
    "furniture": ("room", {**TABLES["room"], "furniture": [{"corner_m": [0, 0, 0], "size_m": [0.1, 0.1, 0.1]}]}),
    "glass": ("systems", {"glass": {"glass": 0.7}}),
    "the eye": ("views", {"eye": {**TABLES["views"]["eye"], "point_m": [1.5, 2.0, 1.3]}}),
    "the size": ("views", {"eye": {**TABLES["views"]["eye"], "size_px": [24, 25]}}),
}


@pytest.mark.parametrize(("key", "value"), CHANGES.values(), ids=list(CHANGES))
def test_another_picture_is_refused(made, tmp_path, key, value):
    state = room.State.new(made, made.view("eye"))
    made.picture("eye", samples=4, state=state)
    path = tmp_path / "eye.partial.npz"
    state.save(path)
    other = room.load({**copy.deepcopy(TABLES), key: value})
    with pytest.raises(ClerestoryError, match="it is of another scene, view, size, seed or version"):
        room.State.load(path, other, other.view("eye"))
    with pytest.raises(ClerestoryError, match="the state is of another picture"):
        other.picture("eye", samples=8, state=state)
    with pytest.raises(ClerestoryError, match="another scene"):
        room.State.load(path, made, made.view("eye"), seed=2)


def test_another_data_file_is_refused(tmp_path):
    from clerestory.system import pane_from_normal

    file = tmp_path / "window.xml"
    tables = {**TABLES, "systems": {"glass": {"file": str(file)}}}
    pane_from_normal(0.8, 0.1).to_matrix("klems-full").write(file)
    made = room.load(tables)
    room.State.new(made, made.view("eye")).save(tmp_path / "kept.npz")
    pane_from_normal(0.7, 0.1).to_matrix("klems-full").write(file)
    with pytest.raises(ClerestoryError, match="another scene"):
        room.State.load(tmp_path / "kept.npz", room.load(tables), made.view("eye"))


def test_damaged_files_are_refused(made, tmp_path):
    path = tmp_path / "kept.npz"
    state = room.State.new(made, made.view("eye"))
    made.picture("eye", samples=4, state=state)
    state.save(path)
    whole = path.read_bytes()
    for data in (b"", b"nothing", whole[: len(whole) // 2]):
        path.write_bytes(data)
        with pytest.raises(ClerestoryError, match="not what an interrupted picture leaves"):
            room.State.load(path, made, made.view("eye"))
    sums, squares = state.core.sums()
    for wrong in ({"sums": sums[:5]}, {"sums": sums * np.nan}, {"squares": squares[:5]}, {"samples": np.array(-1)}):
        kept = {"fingerprint": state.fingerprint, "samples": 4, "sums": sums, "squares": squares, **wrong}
        np.savez(path, **kept)
        with pytest.raises(ClerestoryError, match="not what an interrupted picture leaves"):
            room.State.load(path, made, made.view("eye"))


def test_the_command_keeps_its_paths(tmp_path, capsys, monkeypatch):
    output, partial = tmp_path / "office.hdr", tmp_path / "office.partial.npz"
    words = ["render", "office", "-o", str(output), "--size", "64,64", "--samples", "12"]
    passes = 0
    go_on = room.State.new.__func__

    def new(cls, *given, **named):
        state = go_on(cls, *given, **named)
        state.core = Interrupting(state.core)
        return state

    class Interrupting:
        """A picture in whose third pass Ctrl-C is pressed."""

        def __init__(self, core):
            self.core = core

        def __getattr__(self, name):
            return getattr(self.core, name)

        def add(self, *given):
            nonlocal passes
            passes += 1
            if passes == 3:
                raise KeyboardInterrupt
            self.core.add(*given)

    with monkeypatch.context() as patch:
        patch.setattr(room.State, "new", classmethod(new))
        assert main(words) == 130
    told = capsys.readouterr().err
    assert f"note: 8 paths a pixel are kept in {partial} (the same command with --resume goes on)" in told
    assert not output.exists()
    assert main([*words, "--seed", "2", "--resume"]) == 1
    assert "another scene, view, size, seed" in capsys.readouterr().err
    assert main([*words, "--resume"]) == 0
    assert not partial.exists()
    resumed = Picture.read(output).pixels
    assert main(words) == 0
    assert (Picture.read(output).pixels == resumed).all()
    assert main([*words, "--resume"]) == 2
    assert "there is no" in capsys.readouterr().err
    assert main(["render", "office", "--glare", "--resume"]) == 2
    assert "only a picture with an output is kept" in capsys.readouterr().err
