"""A program that is killed while it imports leaves the laboratory's database as it was."""

import os
import signal
import subprocess
import sys

import laboratory
from clerestory.measure.database import Database

HALF = """
import sys
import laboratory
from clerestory.measure.database import Database

with Database.open(sys.argv[1]) as database, database.transaction():
    for k in range(8):
        database.add(laboratory.contents(laboratory.scan(of=f"{k}.txt", seed=k, points=200_000), sample="blind"))
    print("half", flush=True)
    sys.stdin.read()
"""


def test_kill_half_way(database_place):
    with Database.open(database_place, create=True) as database:
        database.add(laboratory.contents(laboratory.scan()))
        before = (database.samples(), database.files(), database.stored_scans())
    importer = subprocess.Popen(
        [sys.executable, "-c", HALF, database_place],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert importer.stdout.readline() == "half\n"
    importer.send_signal(signal.SIGKILL)
    assert importer.wait(30.0) == -signal.SIGKILL
    importer.stdin.close()
    importer.stdout.close()
    with Database.open(database_place) as database:
        assert (database.samples(), database.files(), database.stored_scans()) == before
        laboratory.same(database.measurement("twill").scans[0], laboratory.scan())
        # Nothing of it is in the way of the next one.
        added = database.add(laboratory.contents(laboratory.scan(of="0.txt", seed=0), sample="blind"))
        assert added.scans == 1
