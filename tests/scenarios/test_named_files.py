"""Files that TOML files name: whatever is wrong with one, every command tells its key, its path and the remedy."""

import os
import shutil
import tempfile
from pathlib import Path

import pytest

from blind_recipe import BLIND
from camera import TIMES, Maker
from clerestory import Bsdf, Model
from clerestory.cli import main
from clerestory.measure.camera import RIGS
from clerestory.photo import Lens
from short_study import ROOM, days

SIDES = [(side, scatter) for side in ("exterior", "interior") for scatter in ("transmission", "reflection")]
PANE = '[sample]\nkind = "pane"\nthickness_mm = 0\nexterior = "m"\n[materials.m]\n'
FILM = '[sample]\nkind = "height-map"\nstep_um = 1\nmedium = "g"\nbase_um = 1\n[media.g]\nindex = 1.5\n'
SCANNED = '[sample]\nkind = "scanned-profile"\nmedium = "g"\nbase_um = 200\ntolerance_um = 1\n[media.g]\nindex = 1.5\n'
SCENE = '[sample]\nkind = "scene"\nunit = "m"\nperiod_mm = [1, 1]\n'
FAMILY = '[family]\nparameter = "height"\nvalues = [0, 1]\nbasis = "klems-quarter"\nsamples = 16\n'
TILTS = '[family]\nparameter = "tilt_deg"\nvalues = [0, 30]\n'
LAYER = '[[layers]]\nname = "x"\n'
STUDY = 'room = "room.toml"\nweather = "days.wea"\nmethod = "3-phase"\npatches = "reinhart:1"\npaths = 64\n'
LAW = STUDY + '[data_sets.law.control]\nkind = "schedule"\n'
STATES = "[data_sets.law.states]\nup = { glass = 0.7 }\ndown = { glass = 0.1 }\n"
ROUND = """
[moments]
room = "room.toml"
times = ["2021-02-21 12:00"]
size_px = 32
samples = 1
[year]
room = "room.toml"
view = "desk"
sensors = "plane"
weather = "days.wea"
paths = 64
[systems.s]
data_sets = [{ laboratory = "North", file = "film.npz" }, { laboratory = "South", file = "other.npz" }]
"""
JOB = "[sample]\nwidth_mm = 210\nheight_mm = 297\n"
SESSION = 'pictures = ["IMG_*.JPG"]\n[output]\nsize_px = 64\n'
RIG = RIGS.path_of("six-triangles").read_text()

# What the case is called: the command, the text of its file with {} for the name of the file that is faulty and that
# name's ending, and the key that names it.
CASES = {
    "room of a study": ("annual", STUDY.replace("room.toml", "{}"), ".toml", "room"),
    "weather of a study": ("annual", STUDY.replace("days.wea", "{}"), ".epw", "weather"),
    "data set of a study": ("annual", STUDY + '[data_sets.a]\nfile = "{}"\n', ".xml", "data_sets.a.file"),
    "window of a study": ("annual", STUDY + '[data_sets.a]\nfile = "{}"\n', ".toml", "data_sets.a.file"),
    "spectra of a study": ("annual", STUDY + '[data_sets.a]\nglass = "{}"\n', ".csv", "data_sets.a.glass"),
    "family of a study": ("annual", STUDY + '[data_sets.a]\nfamily = "{}"\n', ".toml", "data_sets.a.family"),
    "manifest of a study": ("annual", STUDY + '[data_sets.a]\nfamily = "{}"\n', ".json", "data_sets.a.family"),
    "schedule of a study": ("annual", LAW + 'file = "{}"\n' + STATES, ".csv", "data_sets.law.control.file"),
    "state of a study": ("annual", LAW + 'times = [{state = "up"}]\n' + STATES.replace("glass = 0.7", 'file = "{}"'),
                         ".npz", "data_sets.law.states.up.file"),
    "data set of a room": ("render", ROOM.replace("glass = 0.7", 'file = "{}"'), ".xml.gz", "systems.pane.file"),
    "recipe of a room": ("render", ROOM.replace("glass = 0.7", 'file = "{}"'), ".toml", "systems.pane.file"),
    "spectra of a room": ("render", ROOM.replace("glass = 0.7", 'glass = "{}"'), ".txt", "systems.pane.glass"),
    "scene of a room": ("render", ROOM + '[[geometry]]\nfile = "{}"\n', ".rad", "geometry[1].file"),
    "façade of a room": ("render", ROOM + '[[geometry]]\nfile = "{}"\nfacade = true\nmaterial = "m"\n'
                         '[materials.m]\nkind = "black"\n', ".obj", "geometry[1].file"),
    "material of a room": ("render", ROOM + '[materials.m]\nkind = "bsdf"\nfile = "{}"\n', ".xml", "materials.m.file"),
    "layer of a window": ("system build", LAYER + 'kind = "file"\nfile = "{}"\n', ".xml", "layer 1 (x)"),
    "pane of a window": ("system build", LAYER + 'kind = "glass"\nfile = "{}"\n', ".dat", "layer 1 (x)"),
    "recipe of a window": ("system build", LAYER + 'kind = "recipe"\nrecipe = "{}"\n', ".toml",
                           "layer 1 (x)"),
    "rated window": ("system rate", LAYER + 'kind = "file"\nfile = "{}"\n', ".xml", "layer 1 (x)"),
    "product of a family": ("system family", TILTS + 'product = "{}"\n', ".toml", "family.product"),
    "layer of a family": ("system family", TILTS + LAYER + 'kind = "recipe"\nrecipe = "{}"\n', ".toml",
                          "layer 1 (x)"),
    "window without the product": ("system family", FAMILY + 'without = "{}"\n' + BLIND, ".xml", "family.without"),
    "glass without the product": ("system family", FAMILY + 'without = "{}"\n' + BLIND, ".toml", "family.without"),
    "material of a sample": ("trace", PANE + 'kind = "bsdf"\nfile = "{}"\n', ".xml", "materials.m.file"),
    "heights of a sample": ("trace", FILM.replace("step_um", 'file = "{}"\nstep_um'), ".csv", "sample.file"),
    "array of a sample": ("trace", FILM.replace("step_um", 'file = "{}"\nstep_um'), ".npy", "sample.file"),
    "section of a sample": ("trace", SCANNED.replace("base", 'file = "{}"\nbase'), ".csv", "sample.file"),
    "scene of a sample": ("trace", SCENE + 'file = "{}"\n', ".rad", "sample.file"),
    "mesh of a sample": ("trace", SCENE + 'file = "{}"\n', ".stl", "sample.file"),
    "data set of a round robin": ("roundrobin", ROUND.replace("film.npz", "{}"), ".xml", "systems.s.data_sets[1].file"),
    "window of a round robin": ("roundrobin", ROUND.replace("other.npz", "{}"), ".toml", "systems.s.data_sets[2].file"),
    "pane of a round robin": ("roundrobin", 'pane = { file = "{}" }' + ROUND, ".xml", "pane.file"),
    "room of its moments": ("roundrobin", ROUND.replace("room.toml", "{}", 1), ".toml", "moments.room"),
    "room of its year": ("roundrobin", ROUND.replace('[year]\nroom = "room.toml"', '[year]\nroom = "{}"'), ".toml",
                         "year.room"),
    "weather of its year": ("roundrobin", ROUND.replace("days.wea", "{}"), ".epw", "year.weather"),
    "instrument of a plan": ("measure plan", 'instrument = "{}"\n' + JOB, ".toml", "instrument"),
    "picture of a rig": ("measure camera", RIG.replace("0_1.hdr", "{}"), ".hdr", "incidences[1].pictures"),
    "pictures of a session": ("photo", SESSION.replace('"]', '", "{}"]'), ".JPG", "pictures"),
    "exposures of a session": ("photo", 'exposures = "{}"\n' + SESSION, ".csv", "exposures"),
    "response of a session": ("photo", SESSION + '[camera]\nresponse = "{}"\n', ".json", "camera.response"),
    "vignetting of a session": ("photo", SESSION + '[vignetting]\npoints = "{}"\n', ".csv", "vignetting.points"),
    "lens of a session": ("photo", SESSION + '[lens]\nprojection = "table"\ntable = "{}"\n', ".csv", "lens.table"),
}  # fmt: skip
OUTPUTS = {"render": "out.hdr", "photo": "out.hdr", "system build": "out.bsdf.npz", "trace": "out.npz"}
REMEDIES = {
    "missing": "does not exist (check it; in a TOML file paths are relative to that file)",
    "folder": "is a folder (give a file)",
    "forbidden": "may not be read (check its permissions)",
}


@pytest.fixture(scope="module")
def folder():
    # Not below pytest's own folder, which nobody else may enter.
    made = Path(tempfile.mkdtemp(prefix="named-files-"))
    made.chmod(0o777)
    (made / "room.toml").write_text(ROOM)
    (made / "days.wea").write_text(days((20,)))
    for name, value in (("film.npz", 0.4), ("other.npz", 0.5)):
        Bsdf.from_models({"visible": dict.fromkeys(SIDES, Model.lambertian(value))}).save(made / name)
    Maker(Lens("equisolid", (120.0, 80.0), 75.0), shape=(160, 240), noise=0.2).jpegs(made, TIMES)
    yield made
    shutil.rmtree(made)


@pytest.fixture
def powerless():
    """Someone who may not read all files; whoever runs the tests is, unless it is root."""
    own = os.geteuid()
    if own == 0:
        os.seteuid(65534)
    yield
    os.seteuid(own)


@pytest.mark.parametrize("fault", REMEDIES)
@pytest.mark.parametrize("case", CASES)
def test_the_key_the_path_and_the_remedy_are_told(folder, capsys, monkeypatch, request, case, fault):
    command, text, ending, key = CASES[case]
    name = f"{fault}{ending}"
    path = folder / name
    if fault == "folder":
        path.mkdir(exist_ok=True)
    if fault == "forbidden":
        path.write_text("")
        path.chmod(0)
    toml = folder / "given.toml"
    toml.write_text(text.replace("{}", name))
    output = folder / OUTPUTS.get(command, "out")
    words = [*command.split(), str(toml), *(["-o", str(output)] if command != "system rate" else [])]
    monkeypatch.setenv("CLERESTORY_CACHE", str(folder / f"cache-{fault == 'forbidden'}"))
    if fault == "forbidden":
        request.getfixturevalue("powerless")
    assert main(words) == 1
    out, err = capsys.readouterr()
    told = [line for line in err.splitlines() if not line.startswith(("warning: ", "note: ", "tracing "))]
    assert out == ""
    assert len(told) == 1
    assert told[0].startswith(f"error: {toml}: ")
    assert f"{key}: " in told[0]
    if case == "pictures of a session" and fault == "folder":
        assert "holds no photographs (give " in told[0]
    elif case in ("family of a study", "manifest of a study") and fault == "folder":
        assert f"{path / 'family.json'} {REMEDIES['missing']}" in told[0]
    else:
        assert told[0].endswith(f"{path} {REMEDIES[fault]}")
    assert not output.exists()
