"""A cache that is looked at and made smaller: what was used last stays, and what a study uses."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.annual.cache import FOLDERS, Cache
from clerestory.annual.pruning import UNFINISHED, entries, prune
from clerestory.cli import main
from clerestory.system.family.manifest import MANIFEST

DAY = 86400


@pytest.fixture
def folder(tmp_path):
    """Five entries of 8 kB, last used one to five days ago; one read just now; and what is not the cache's."""
    place = tmp_path / "cache"
    cache = Cache(place)
    for k in range(5):
        cache.get("part" if k else "view", {"k": k}, lambda k=k: {"a": np.full(1000, float(k))})
        path = cache.path_of("part" if k else "view", {"k": k})
        when = path.stat().st_mtime - (5 - k) * DAY
        os.utime(path, (when, when))
    (place / "notes.txt").write_text("mine")
    return place


def names(folder):
    return [entry.path.name for entry in entries(folder)]


def test_what_was_used_last_stays(folder):
    before = entries(folder)
    assert [entry.kind for entry in before] == ["part"] * 4 + ["view"]
    # Reading the oldest makes it the one that was used last.
    Cache(folder).get("view", {"k": 0}, lambda: pytest.fail("it is there"))
    assert entries(folder)[0].kind == "view"
    size = before[0].size
    removed = prune(folder, 3 * size)
    assert len(removed) == 2
    assert [entry.kind for entry in entries(folder)] == ["view", "part", "part"]
    assert {entry.path for entry in removed} == {before[2].path, before[3].path}
    assert sum(entry.size for entry in entries(folder)) <= 3 * size
    assert prune(folder, 3 * size) == []
    prune(folder, 0)
    assert [path.name for path in folder.iterdir()] == ["notes.txt"]


def test_what_was_left_half_written_goes(folder):
    left = folder / f".{names(folder)[0]}.abc"
    left.write_bytes(b"half")
    assert UNFINISHED in [entry.kind for entry in entries(folder)]
    (removed,) = prune(folder, 10**9)
    assert removed.path == left


def test_nothing_goes_while_a_study_runs(folder):
    code = (
        "import sys; from clerestory.annual.cache import Cache;"
        "cache = Cache(sys.argv[1]); print('ready', flush=True); sys.stdin.readline()"
    )
    study = subprocess.Popen(
        [sys.executable, "-c", code, str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        assert study.stdout.readline() == "ready\n"
        before = names(folder)
        with pytest.raises(ClerestoryError, match="a study that runs uses it"):
            prune(folder, 0)
        assert names(folder) == before
    finally:
        study.kill()  # nothing tidies up behind it
        study.wait()
        study.stdin.close()
        study.stdout.close()
    assert len(prune(folder, 0)) == len(before)


def family(place, days_ago, *, states=3):
    """A folder of a family as a study keeps it, last used so many days ago."""

    def make(home):
        home.mkdir()
        for k in range(states):
            (home / f"tilt_{k}.bsdf.npz").write_bytes(bytes(8000))
        (home / MANIFEST).write_text("{}")
        when = home.stat().st_mtime - days_ago * DAY
        for path in (*home.iterdir(), home):
            os.utime(path, (when, when))

    return Cache(place).folder_of("family", [days_ago], make)


def test_families_are_listed_and_go_whole(folder, capsys):
    old, new = family(folder, 10), family(folder, 0.5)
    assert FOLDERS["family"] == MANIFEST
    found = {entry.path: entry for entry in entries(folder)}
    assert (found[old].kind, found[old].size) == ("family", 3 * 8000 + 2)
    assert main(["cache", "--cache", str(folder), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["kinds"]["family"] == {
        "entries": 2, "bytes": 2 * found[old].size, "used_days_ago": [0.5, 10.0]
    }  # fmt: skip
    # The older one was used for longest not; the newer one is what was used last.
    (removed,) = prune(folder, sum(entry.size for entry in found.values()) - 1)
    assert (removed.path, old.exists(), len([*new.iterdir()])) == (old, False, 4)
    prune(folder, found[new].size)
    assert [entry.path for entry in entries(folder)] == [new]
    prune(folder, 0)
    assert [path.name for path in folder.iterdir()] == ["notes.txt"]


def test_a_family_that_a_study_takes_is_used(folder):
    old = family(folder, 10)
    cache = Cache(folder)
    assert cache.folder_of("family", [10], lambda home: pytest.fail(f"{home} is there")) == old
    assert entries(folder)[0].path == old
    assert cache.found == ["family"]


def test_a_family_is_safe_while_its_study_runs(tmp_path):
    """Also where the folder of the cache comes into being with it."""
    code = (
        "import sys; from pathlib import Path; from clerestory.annual.cache import Cache; cache = Cache(sys.argv[1]);"
        "cache.folder_of('family', [1], lambda home: (home.mkdir(), (home / 'family.json').write_text('{}')));"
        "print('ready', flush=True); sys.stdin.readline()"
    )
    place = tmp_path / "new"
    study = subprocess.Popen(
        [sys.executable, "-c", code, str(place)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        assert study.stdout.readline() == "ready\n"
        with pytest.raises(ClerestoryError, match="a study that runs uses it"):
            prune(place, 0)
        assert len(entries(place)) == 1
    finally:
        study.kill()
        study.wait()
        study.stdin.close()
        study.stdout.close()
    assert len(prune(place, 0)) == 1


def test_a_family_that_is_not_whole_goes_first(folder):
    left = family(folder, 0)
    (left / MANIFEST).unlink()
    (left / ".family-abc").mkdir()
    (removed,) = prune(folder, 10**9)
    assert (removed.path, removed.kind, left.exists()) == (left, UNFINISHED, False)


def test_folders_of_others_are_left_alone(folder):
    hexed = "0" * 40
    for name in (f"photos-{hexed}", f"family-{hexed[1:]}", "family-album"):
        (folder / name).mkdir()
    elsewhere = folder.parent / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / MANIFEST).write_text("{}")
    (folder / f"family-{hexed}").symlink_to(elsewhere)
    assert len(prune(folder, 0)) == 5
    assert len([*folder.iterdir()]) == 5
    assert (elsewhere / MANIFEST).exists()


def test_the_command(folder, capsys):
    assert main(["cache", "--cache", str(folder), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert {name: kind["entries"] for name, kind in told["kinds"].items()} == {"part": 4, "view": 1}
    assert told["kinds"]["view"]["used_days_ago"] == [5.0, 5.0]
    assert told["bytes"] == sum(entry.size for entry in entries(folder))
    assert main(["cache", "--cache", str(folder), "--prune-to", "20kB"]) == 0
    assert "removed 3 of 5 entries" in capsys.readouterr().out
    assert len(entries(folder)) == 2


@pytest.mark.parametrize("size", ["lots", "-1", "2XB", "1e9GB"])
def test_a_size_that_is_none(folder, size, capsys):
    assert main(["cache", "--cache", str(folder), f"--prune-to={size}"]) == 2
    assert "not a size" in capsys.readouterr().err
    assert len(entries(folder)) == 5


def test_a_folder_that_is_not_there(tmp_path, monkeypatch, capsys):
    assert main(["cache", "--cache", str(tmp_path / "none")]) == 2
    capsys.readouterr()
    monkeypatch.setenv("CLERESTORY_CACHE", str(tmp_path / "none"))
    assert main(["cache", "--prune-to", "0"]) == 0
    assert "0.0 MB" in capsys.readouterr().out
    assert not (tmp_path / "none").exists()
