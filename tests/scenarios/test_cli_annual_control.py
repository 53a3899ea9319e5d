"""Windows that change over the year, from the command line."""

import csv
import json

import numpy as np
import pytest

from clerestory import trace
from clerestory.cli import main
from short_study import HEAD, ROOM

EAST = """[[room.openings]]
wall = "east"
width_m = 1.0
height_m = 1.6
sill_m = 0.9
system = "pane"
"""
ROOM = ROOM.replace("[systems.pane]", f"{EAST}[systems.pane]")
STUDY = """
room = "room.toml"
weather = "days.wea"
method = "3-phase"
patches = "reinhart:2"
paths = 256
[data_sets.panes.states.open]
glass = 0.7
[data_sets.panes.states.closed]
glass = 0.1
[data_sets.panes.control]
"""
BY_CLOCK = """kind = "schedule"
times = [{state = "closed", start = 10, end = 12, groups = ["pane east"]}, {state = "open"}]
"""


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    """The room's matrices, which are the same in nearly all tests."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def folder(tmp_path, cache, monkeypatch):
    monkeypatch.setenv("CLERESTORY_CACHE", str(cache))
    lines = []
    for day in (20, 21):
        for hour in range(24):
            high = max(0.0, np.sin(np.pi * (hour + 0.5 - 6.0) / 12.0))
            lines.append(f"3 {day} {hour + 0.5} {800 * high * (day == 20):.0f} {150 * high:.0f}")
    (tmp_path / "days.wea").write_text(HEAD + "\n".join(lines) + "\n")
    (tmp_path / "room.toml").write_text(ROOM)
    return tmp_path


def run(folder, study, *args):
    (folder / "study.toml").write_text(study)
    return main(["annual", str(folder / "study.toml"), *map(str, args)])


def states_of(path):
    with path.open() as stream:
        return list(csv.DictReader(stream))


def test_a_schedule_by_the_clock_and_the_same_from_a_file(folder, capsys):
    out = folder / "out"
    assert run(folder, STUDY + BY_CLOCK, "-o", out, "--json") == 0
    told = json.loads(capsys.readouterr().out)["data_sets"][0]
    assert told["control"] == "schedule"
    assert told["states"]["pane south"] == {"open": 1.0, "closed": 0.0}
    assert told["states"]["pane east"]["closed"] == pytest.approx(0.2)
    rows = states_of(out / "states-panes.csv")
    assert [row["time"][11:16] for row in rows if row["pane east"] == "closed"] == ["10:30", "11:30"] * 2
    assert (out / "states-panes.png").stat().st_size > 5000
    import xarray

    with xarray.open_dataset(out / "results.nc") as stored:
        found = stored.state.sel(data_set="panes", group="pane east").values
        assert found.tolist() == [row["pane east"] for row in rows]
        light = stored.illuminance.values[0]
    # What was written is a schedule, and gives the same year.
    again = STUDY + 'kind = "schedule"\nfile = "out/states-panes.csv"\n'
    assert run(folder, again, "-o", folder / "again", "--json") == 0
    assert json.loads(capsys.readouterr().out)["data_sets"][0]["sensors"] == told["sensors"]
    with xarray.open_dataset(folder / "again" / "results.nc") as stored:
        assert np.array_equal(stored.illuminance.values[0], light)
    pytest.importorskip("pyarrow")
    import pyarrow
    from pyarrow import parquet

    parquet.write_table(pyarrow.table({"all": ["closed"] * 48}), folder / "closed.parquet")
    assert run(folder, STUDY + 'kind = "schedule"\nfile = "closed.parquet"\n', "--json") == 0
    closed = json.loads(capsys.readouterr().out)["data_sets"][0]
    assert closed["states"]["pane south"]["closed"] == 1.0
    assert closed["sensors"]["plane"]["mean_illuminance_lx"] < 0.3 * told["sensors"]["plane"]["mean_illuminance_lx"]


def test_lm83_and_en17037(folder, capsys):
    clear = "[data_sets.clear]\nglass = 0.7\n"
    assert run(folder, STUDY + 'kind = "lm-83"\n' + clear, "--json") == 0
    panes, clear = json.loads(capsys.readouterr().out)["data_sets"]
    assert clear["sensors"]["plane"]["sDA_blinds"] == "without blinds"
    assert panes["sensors"]["plane"]["sDA_blinds"] == "LM-83's, open to closed"
    # The south is closed in the sun, not on the grey day.
    assert 0.3 < panes["states"]["pane south"]["closed"] <= 0.5
    for key in ("sDA300_50", "mean_illuminance_lx"):
        assert panes["sensors"]["plane"][key] <= clear["sensors"]["plane"][key]
    # Exposure to the sun is without blinds, so it is the same.
    for told in (clear, panes):
        assert told["sensors"]["plane"]["ASE1000_250"] == 0.0
        assert told["sensors"]["plane"]["sDA_rating"] in ("preferred", "nominally accepted", "not accepted")
    areas = clear["sensors"]["plane"]["en17037_areas"]
    assert set(areas) == {"minimum", "medium", "high"}
    assert areas["minimum"]["target"] >= areas["medium"]["target"] >= areas["high"]["target"]


def test_provision_counts_daylight_hours_alone(folder, capsys):
    """Working hours by night change autonomy, not EN 17037's provision nor LM-83's autonomy."""
    study = STUDY.split("[data_sets")[0] + "[data_sets.clear]\nglass = 0.7\n"
    found = []
    for hours in ("", "[hours]\nstart = 0.0\nend = 9.0\n"):
        assert run(folder, study + hours, "--json") == 0
        found.append(json.loads(capsys.readouterr().out)["data_sets"][0]["sensors"]["plane"])
    assert found[0]["daylight_autonomy"] > found[1]["daylight_autonomy"]
    for key in ("en17037_provision", "en17037_areas", "sDA300_50", "ASE1000_250"):
        assert found[0][key] == found[1][key]


def blind(tilt_deg):
    """A blind of black slats, small to trace."""
    return {
        "sample": {
            "kind": "venetian-blind",
            "pitch_mm": 72.0,
            "tilt_deg": tilt_deg,
            "slat": {"width_mm": 80.0, "crown_mm": 8.0, "upper": "slat"},
        },
        "materials": {"slat": {"kind": "lambertian", "reflectance": 0.4}},
    }


def test_a_blind_by_cut_off(folder, capsys):
    tilts = (0, 20, 40, 60)
    states = ""
    for tilt in tilts:
        trace.measure(blind(float(tilt)), samples=64).save(folder / f"{tilt}.bsdf.npz")
        states += f'[data_sets.blind.states."{tilt}"]\nfile = "{tilt}.bsdf.npz"\ntilt_deg = {tilt}\n'
    study = STUDY.split("[data_sets")[0] + "[data_sets.blind.states.up]\nglass = 0.9\n" + states
    law = '[data_sets.blind.control]\nkind = "cut-off"\nwidth_mm = 80\npitch_mm = 72\ncrown_mm = 8\n'
    out = folder / "out"
    assert run(folder, study + law, "-o", out, "--json") == 0
    told = json.loads(capsys.readouterr().out)["data_sets"][0]
    rows = states_of(out / "states-blind.csv")
    assert {row["pane south"] for row in rows[24:]} == {"up"}  # the grey day
    # At the equinox the sun stands at 42 to 43° in the section all day: level slats do, but for the 3° of safety.
    assert [row["pane south"] for row in rows[8:16]] == ["20"] * 8
    # In the east it rises from the horizon, and is behind the façade after noon.
    east = [row["pane east"] for row in rows[:24]]
    assert east[8] == "40"
    assert {*east[12:]} == {"up"}
    assert sum(told["states"]["pane east"].values()) == pytest.approx(1.0)
    assert run(folder, study + law.replace("crown_mm = 8", "safety_deg = 0"), "-o", out, "--json") == 0
    assert [row["pane south"] for row in states_of(out / "states-blind.csv")[9:15]] == ["0"] * 6


def test_a_year_with_states_in_words(folder, cache, capsys):
    rules = """kind = "expression"
rules = [{state = "closed", when = 'highest("plane") > 2000 and facade_irradiance > 100'}, {state = "open"}]
"""
    assert run(folder, STUDY + rules, "--dry-run") == 0
    told = capsys.readouterr().out
    assert "windows: pane south; pane east" in told
    assert "control: panes by expression" in told
    assert run(folder, STUDY + rules) == 0
    told = capsys.readouterr().out
    for words in ("EN 17037 provision", "LM-83's, open to closed, by three phases", "open ", "closed "):
        assert words in told
    # States are kept as matrices are; another law is another choice.
    kept = {path.name for path in cache.glob("states-*")}
    assert kept
    assert run(folder, STUDY + rules) == 0
    assert capsys.readouterr().out == told
    assert {path.name for path in cache.glob("states-*")} == kept
    assert run(folder, STUDY + rules.replace("2000", "3000")) == 0
    assert len(list(cache.glob("states-*"))) == len(kept) + 1


def test_sensors_in_the_wrong_place_are_numbered(folder, capsys):
    """A sensor behind the wall and one in a box are named before the year, which goes on with the others."""
    room = ROOM.replace(
        "[sensors.plane]\nheight_m = 0.8\nspacing_m = 1.5\n",
        "[sensors.plane]\npoints_m = [[1.5, 2.0, 0.8], [1.5, -1.0, 0.8], [0.5, 3.5, 0.4]]\n"
        "[[room.furniture]]\ncorner_m = [0.1, 3.0, 0.0]\nsize_m = [0.8, 0.8, 0.7]\n",
    )
    (folder / "room.toml").write_text(room)
    assert run(folder, STUDY + BY_CLOCK, "--json") == 0
    captured = capsys.readouterr()
    within, outside = json.loads(captured.out)["warnings"]
    assert "1 of 3 sensors plane lies within furniture 1, number 3 at (0.5, 3.5, 0.4) m" in within
    assert "1 of 3 sensors plane lies outside of the room, number 2 at (1.5, -1, 0.8) m" in outside
    assert captured.err.count("warning: ") == 2


SCHEDULE = 'kind = "schedule"\nfile = "s.csv"\n'
CUT_OFF = 'kind = "cut-off"\nwidth_mm = 80\npitch_mm = 72\n'


@pytest.mark.parametrize(
    ("law", "table", "words"),
    [
        (SCHEDULE, None, "control.file: "),
        (SCHEDULE, "all\n" + "open\n" * 47, "the schedule is shorter than the year"),
        (SCHEDULE, "all\n" + "open\n" * 49, "the schedule is longer than the year"),
        (SCHEDULE, "all\n" + "opne\n" * 48, "line 2, column all: no state 'opne' (did you mean open?)"),
        (SCHEDULE, "pane\n" + "open\n" * 48, "column 'pane' is no group of windows (did you mean pane east?)"),
        (SCHEDULE, "pane east\n" + "open\n" * 48, "no column for the group of windows 'pane south'"),
        (SCHEDULE, "all,all\n" + "open,open\n" * 48, "is there twice"),
        (SCHEDULE, "all,pane east\n" + "open\n" * 48, "line 2: 1 cell for 2 columns"),
        (SCHEDULE, "time,all\n" + "2001-03-20 07:00,open\n" * 48, "where the weather has 03-20 00:30"),
        (SCHEDULE, "time,all\n" + "noon,open\n" * 48, "time 'noon' is not understood"),
        (SCHEDULE, "", "it is empty"),
        (BY_CLOCK.replace('"closed"', '"shut"'), None, "times[1].state: there is no state 'shut'"),
        (BY_CLOCK.replace("pane east", "north"), None, "times[1].groups: there is no group of windows 'north'"),
        (BY_CLOCK.replace(', {state = "open"}', ""), None, "without a state, the first at 03-20 00:30"),
        (BY_CLOCK.replace("start = 10", "start = 25"), None, "control.times[1].start"),
        (BY_CLOCK.replace("end = 12", "end = 10"), None, "times[1].end: the hours end at 10, where they start"),
        ('kind = "schedule"\n', None, "either a file or times are asked for"),
        (CUT_OFF, None, "states.closed.tilt_deg: is missing"),
        (CUT_OFF.replace("72", "0"), None, "control.pitch_mm"),
        (CUT_OFF + 'rest = "closed"\n', None, "states.open.tilt_deg: is missing"),
        (CUT_OFF + "crown_mm = 50\n", None, "control.crown_mm: a crown of 50 is more than a half circle"),
        ('kind = "threshold"\n', None, "either irradiance_w_m2 or illuminance_lx"),
        ('kind = "threshold"\nirradiance_w_m2 = [100, 200]\n', None, "2 limits for 2 states (give 1,"),
        ('kind = "threshold"\nilluminance_lx = 300\n', None, "sensors go with illuminance_lx"),
        ('kind = "threshold"\nilluminance_lx = 300\nsensors = "plan"\n', None, "there are no sensors 'plan'"),
        ('kind = "threshold"\nirradiance_w_m2 = 100\nhysteresis = 100\n', None, "reaches below 0"),
        ('kind = "glare"\nviews = ["sofa"]\n', None, "control.views: there is no view 'sofa'"),
        ('kind = "glare"\nlimit = 0.1\n', None, "control.limit"),
        ('kind = "lm-83"\nsensors = ["roof"]\n', None, "control.sensors: there are no sensors 'roof'"),
        ('kind = "magic"\n', None, "control.kind: 'magic' is not known"),
        ('kind = "expression"\nrules = []\n', None, "control.rules"),
        (
            'kind = "expression"\nrules = [{state = "open", when = "sun_altitude > 10"}]\n',
            None,
            "rules[1].when: 'sun_altitude' in 'sun_altitude > 10': no such name (did you mean sun_altitude_deg?)",
        ),
        ('kind = "expression"\nrules = [{state = "open", when = "qqq"}]\n', None, "known are day, diffuse_horizontal"),
        ('kind = "expression"\nrules = [{state = "open", when = "hour > 12"}]\n', None, "add a rule without when"),
        ('kind = "expression"\nrules = [{state = "open", when = "hour"}]\n', None, "is a number, not a condition"),
        (
            'kind = "expression"\nrules = [{state = "open", when = \'mean("desk") > 1\'}]\n',
            None,
            "there are no sensors 'desk'",
        ),
        (
            'kind = "expression"\nrules = [{state = "open", when = \'at_eye("desk", "up") > 1\'}]\n',
            None,
            "there is no state 'up'",
        ),
    ],
)
def test_faults_of_laws_are_named(folder, capsys, law, table, words):
    if table is not None:
        (folder / "s.csv").write_text(table)
    assert run(folder, STUDY + law) == 1
    told = capsys.readouterr().err
    assert told.startswith(f"error: {folder / 'study.toml'}: ")
    assert words in told
    assert told.count("\n") == 1


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[data_sets.panes.control]\n" + BY_CLOCK, "", "data_sets.panes.control: is missing"),
        ("[data_sets.panes.states.closed]\nglass = 0.1\n", "", "data_sets.panes.states: there is one alone"),
        (
            "[data_sets.panes.control]",
            "[data_sets.panes]\nglass = 0.3\n[data_sets.panes.control]",
            "each state says it",
        ),
        ("glass = 0.1", 'file = "lost.xml"', "data_sets.panes.states.closed.file: "),
        ("glass = 0.1", "glass = 0.1\ntilt = 4", "did you mean tilt_deg?"),
        ("paths = 256", "paths = 256\n[hours]\nstart = 23.8\nend = 24.0", "hours: no step of the weather lies in"),
    ],
)
def test_faults_of_states_are_named(folder, capsys, old, new, words):
    study = STUDY + BY_CLOCK
    assert old in study
    assert run(folder, study.replace(old, new)) == 1
    told = capsys.readouterr().err
    assert told.startswith("error: ")
    assert words in told
    assert told.count("\n") == 1
