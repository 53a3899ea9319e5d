"""A study on a Dask cluster of two workers, one of which is killed half-way."""

import json
import subprocess
import sys

import pytest

from short_study import ROOM, days

STUDY = """
room = "room.toml"
weather = "days.wea"
patches = "reinhart:2"
paths = 512
[data_sets.clear]
glass = 0.7
[data_sets.dark]
glass = 0.1
"""
KILLED = """
import os, signal, sys, threading, time
from pathlib import Path

from clerestory.annual import cluster, results
from clerestory.annual.study import load


def parts(folder):
    return list(folder.glob("part-*.npz"))


def kill(client, folder, told):
    while not parts(folder):
        time.sleep(0.01)
    pids = client.run(os.getpid)
    os.kill(next(iter(pids.values())), signal.SIGKILL)
    told.append(len(parts(folder)))


if __name__ == "__main__":
    source, folder = Path(sys.argv[1]), Path(sys.argv[2])
    study, told = load(source, cache=folder), []
    # A part a task, so that the killed worker leaves some undone.
    cluster._TOGETHER = 1
    with cluster.cluster(workers=2) as client:
        killer = threading.Thread(target=kill, args=(client, folder, told))
        killer.start()
        cluster.spread(study, source, client)
        killer.join()
    wanted = sum(len(study.year(b).chunks) for b in study.blocks) * len(study.choices)
    assert 0 < told[0] < wanted == len(parts(folder)), (told, wanted, len(parts(folder)))
    study.run()
    assert "part" not in study.cache.computed
"""


@pytest.fixture
def study(tmp_path):
    # Enough days for several parts.
    (tmp_path / "days.wea").write_text(days(range(1, 29), months=(2, 3)))
    (tmp_path / "room.toml").write_text(ROOM)
    (tmp_path / "study.toml").write_text(STUDY)
    return tmp_path


def annual(*args):
    command = [sys.executable, "-m", "clerestory", "annual", *map(str, args)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_a_killed_workers_tasks_are_done_by_another(study):
    local = annual(study / "study.toml", "--cache", study / "local", "--json")
    assert local.returncode == 0, local.stderr
    (study / "killed.py").write_text(KILLED)
    words = [sys.executable, study / "killed.py", study / "study.toml", study / "shared"]
    killed = subprocess.run(words, capture_output=True, text=True, check=False)
    assert killed.returncode == 0, killed.stderr
    names = sorted(path.name for path in (study / "local").iterdir())
    assert sorted(path.name for path in (study / "shared").iterdir()) == names
    for name in names:
        assert (study / "local" / name).read_bytes() == (study / "shared" / name).read_bytes()
    shared = annual(study / "study.toml", "--cache", study / "shared", "--json")
    assert json.loads(shared.stdout) == json.loads(local.stdout)


def test_a_scheduler_that_does_not_answer_is_named(study, monkeypatch, capsys):
    monkeypatch.setattr("clerestory.annual.cluster._PATIENCE", "1s")
    from clerestory.cli import main

    given = [str(study / "study.toml"), "--cache", str(study / "cache"), "--scheduler"]
    assert main(["annual", *given, "tcp://127.0.0.1:9"]) == 1
    # What is odd in the weather is told first.
    told = capsys.readouterr().err.splitlines()[-1]
    assert told.startswith("error: tcp://127.0.0.1:9: no Dask scheduler answers")
    assert main(["annual", *given, "tcp://127.0.0.1:9", "--workers", "2"]) == 2
    assert "give one" in capsys.readouterr().err
