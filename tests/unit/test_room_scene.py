"""Scene files of rooms: what they hold, beside Radiance's own programs, and what is told of faults."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.room.scene import RoomScene

SURFACES = {"polygon", "sphere", "bubble", "ring", "cylinder", "tube", "cone", "cup"}
FRADS = "ceiling extwalls floor ground horframe lower_glass overhang upper_glass walls windowframe"
HONEYBEE = "materials geometry glazingEast glazingSkylight glazingSouth"
TUTORIAL = "Ceiling ExteriorWalls Floor Ground InteriorWall Glazing"
FPORTS = ("F1", "FH", "FN", *(f"FN{k}" for k in "abcdefg"))
#: Files that are one scene, by a name.
SCENES = {
    "cornell": ["cornell_box/cornell.rad"],
    "cornell-window": ["cornell_box/cornell_window.rad"],
    "frads": ["frads_testroom/materials.mat", *(f"frads_testroom/{f}.rad" for f in FRADS.split())],
    "honeybee": [f"honeybee_room2/{f}.rad" for f in HONEYBEE.split()],
    "tutorial": ["tutorial_room/materials.rad", "tutorial_room/room.rad", "tutorial_room/objects/Glazing.rad"],
    "parts": ["tutorial_room/materials.rad", *(f"tutorial_room/objects/{f}.rad" for f in TUTORIAL.split())],
    "black": ["tutorial_room/materialBlack.rad", "tutorial_room/roomBlack.rad"],
    "sky": ["tutorial_room/materials.rad", "tutorial_room/room.rad", "tutorial_room/skyDomes__skyglow.rad"],
    "bsdf": ["tutorial_room/matrices__tmtx__GlazingBSDF.rad"],
    "blinds": ["tutorial_room/blinds__blindsOnly.rad"],
    "facade": [f"tutorial_room/fports/{f}.rad" for f in FPORTS],
    "panes": [f"tutorial_room/varShading/GlazingVmtx{k}.rad" for k in (1, 2, 3, 4)],
    "vmtx": ["tutorial_room/objects/GlazingVmtx.rad"],
    "vmtxx": ["tutorial_room/objects/GlazingVmtxx.rad"],
    "vmtx-black": ["tutorial_room/objects/GlazingVmtxBlack.rad"],
}
#: Files with a surface whose material is in none of the samples.
INCOMPLETE = ["tutorial_room/objects/GlazingGlow.rad", "tutorial_room/blinds__GlazingGlow.rad"]


def objects(text: str) -> list[tuple[str, str]]:
    """Types and names of the surfaces of a scene file without commands."""
    words = [w for line in text.splitlines() for w in line.split("#")[0].split()]
    found, at = [], 0
    while at < len(words):
        kind, name = words[at + 1 : at + 3]
        at += 3
        if kind == "alias":
            at += 1
            continue
        for _ in range(3):
            at += 1 + int(words[at])
        if kind in SURFACES:
            found.append((kind, name))
    return found


def program(radiance, folder: Path, *words: str) -> str:
    """Output of one of Radiance's programs."""
    path = Path(radiance.__file__).parent / "bin" / words[0]
    return subprocess.run([path, *words[1:]], cwd=folder, check=True, capture_output=True, text=True).stdout


@pytest.mark.parametrize("name", SCENES)
def test_sample_scenes_are_as_radiance_has_them(name: str, sample_data: Path, require_pyradiance) -> None:
    files = [sample_data / "scenes" / f for f in SCENES[name]]
    scene = RoomScene.read(files)
    # Scene files that a command names are looked for from the folder that the programs run in.
    texts = [program(require_pyradiance, f.parent, "xform", f.name) for f in files]
    expected = [o for text in texts for o in objects(text)]
    assert list(scene.objects) == [name for _, name in expected]
    assert len(scene.polygons) == sum(kind == "polygon" for kind, _ in expected)
    solid = [f for f, text in zip(files, texts, strict=True) if objects(text)]
    boxes = [program(require_pyradiance, f.parent, "getbbox", "-h", f.name) for f in solid]
    limits = np.array([[float(w) for w in box.split()] for box in boxes]).reshape(-1, 3, 2)
    bounds = scene.bounds()
    assert bounds is not None
    # Six digits are printed.
    np.testing.assert_allclose(bounds[0], limits[:, :, 0].min(axis=0), rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(bounds[1], limits[:, :, 1].max(axis=0), rtol=1e-5, atol=1e-6)
    assert len(scene.materials) == len(scene.surfaces)
    assert scene.elements.max() < len(scene.objects)


def test_every_type_of_surface_is_where_radiance_has_it(tmp_path: Path, require_pyradiance) -> None:
    (tmp_path / "part.rad").write_text(
        "grey sphere s 0 0 4 1 2 3 .5\ngrey bubble b 0 0 4 -1 2 3 .25\ngrey ring r 0 0 8 0 1 0 1 2 3 .2 .7\n"
        "grey cylinder c 0 0 7 0 0 0 1 1 2 .3\ngrey tube t 0 0 7 0 0 0 1 -1 2 .3\ngrey cone k 0 0 8 3 0 0 1 1 2 .3 .1\n"
        "grey cup u 0 0 8 3 0 0 1 1 2 .3 0\n!genbox grey box 1 2 3 | xform -rz 20 -t 4 4 4\n"
        "!genprism grey p 3 0 0 1 0 0 1 -l 0 .2 2\n!genblinds grey bl .08 1 2 3 30 +r .1\n"
    )
    (tmp_path / "room.rad").write_text(
        "void plastic grey 0 0 5 .5 .5 .5 0 0\n!xform -n x -rx 30 -mx -a 3 -t 5 0 1 -i 1 -s 2 part.rad\n"
    )
    scene = RoomScene.read(tmp_path / "room.rad")
    expected = objects(program(require_pyradiance, tmp_path, "xform", "room.rad"))
    assert list(scene.objects) == [name for _, name in expected]
    box = [float(w) for w in program(require_pyradiance, tmp_path, "getbbox", "-h", "room.rad").split()]
    bounds = scene.bounds()
    assert bounds is not None
    np.testing.assert_allclose(np.transpose(bounds).ravel(), box, rtol=1e-5)


def test_all_samples_are_read(sample_data: Path) -> None:
    folder = sample_data / "scenes"
    known = {f for files in SCENES.values() for f in files} | set(INCOMPLETE)
    assert {str(p.relative_to(folder)) for p in folder.rglob("*.rad")} <= known
    for file in INCOMPLETE:
        with pytest.raises(
            ClerestoryError, match=r"GlazingGlow.rad, line \d+: polygon .* \"GlazingGlow\" is not defined"
        ):
            RoomScene.read(folder / file)


def test_what_the_tutorial_room_holds(sample_data: Path) -> None:
    folder = sample_data / "scenes" / "tutorial_room"
    scene = RoomScene.read([folder / f for f in ("materials.rad", "room.rad", "skyDomes__skyglow.rad")])
    assert {m.name: m.numbers[0] for m in scene.materials}["Floor"] == 0.65
    ground, sky = scene.sources
    assert (ground.direction, sky.direction, sky.angle_deg, sky.sky) == ((0, 0, -1), (0, 0, 1), 180, None)
    assert sky.place.endswith("skyDomes__skyglow.rad, line 18")
    window = RoomScene.read(folder / "matrices__tmtx__GlazingBSDF.rad", unit="foot")
    (pane,) = window.data_sets
    assert (pane.file, pane.path, pane.peaks) == ("matrices/tmtx/Clear.xml", None, False)
    np.testing.assert_allclose(pane.up, [0, 0, 1])
    assert "Clear.xml" in window.warnings[0]
    (polygon,) = window.polygons
    assert (polygon.surface, polygon.corners.shape) == ("Glazing", (4, 3))
    np.testing.assert_allclose(polygon.corners[2], [6.096 * 0.3048, 0, 2.4384 * 0.3048])
    (light,) = RoomScene.read(folder / "fports" / "F1.rad").lights
    assert (light.kind, light.radiance, light.reach) == ("glow", (1, 1, 1), 0)


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        ("gensky 6 21 12 -a 40 -o 75 -m 75 +s", "cie"),
        ("gensky 6 21 12 -i", "cie"),
        ("gensky 6 21 12 -c -B 50", "cie"),
        ("gensky -ang 30 10 -u", "cie"),
        ("gendaylit 3 20 10:30 -m 75 -o 73.96 -a 40.78 -W 706 162", "perez"),
        ("gendaylit -ang 30 10 -W 706 162 -O 1 -s", "perez"),
    ],
)
def test_skies_of_the_generators_are_read(line: str, kind: str, tmp_path: Path, require_pyradiance) -> None:
    written = program(require_pyradiance, tmp_path, *line.split())
    dome = "skyfunc glow dome 0 0 4 1 1 1 0\ndome source sky 0 0 4 0 0 1 180\n"
    (tmp_path / "sky.rad").write_text(written + dome)
    (tmp_path / "line.rad").write_text(f"!{line} | xform -rz 90\n{dome}")
    scene = RoomScene.read(tmp_path / "sky.rad")
    (sky,) = scene.skies
    numbers = [float(w) for w in written.split("brightfunc")[1].splitlines()[3].split()[1:]]
    assert (sky.kind, scene.sources[-1].sky, sky.turn_deg) == (kind, 0, 0)
    values = sky.values
    if kind == "cie":
        assert [values["zenith"], values["ground"]] == numbers[1:3]
        assert (values["sun"] is None) == (len(numbers) == 3)
    else:
        assert [values["factor"], values["ground"], *values["coefficients"]] == numbers[:7]
    with_sun = [s for s in scene.sources if s.kind == "light"]
    if values["sun"] is not None and with_sun:
        np.testing.assert_allclose(values["sun"], with_sun[0].direction, atol=1e-6)
    command = RoomScene.read(tmp_path / "line.rad")
    (made,) = command.skies
    assert (made.kind, made.turn_deg, command.sources[0].sky) == (line.split()[0], 90, 0)
    assert made.values["sun"] == bool(with_sun)


ZONES = """YST YDT PST PDT MST MDT CST CDT EST EDT AST ADT NST NDT GMT BST CET CEST EET EEST GST GDT IST IDT JST
NZST NZDT"""


def test_time_zones_are_those_of_gensky(tmp_path: Path, require_pyradiance) -> None:
    for zone in ZONES.split():
        (tmp_path / "line.rad").write_text(f"!gensky 3 20 12{zone} -a 0 -o 0\n")
        (sky,) = RoomScene.read(tmp_path / "line.rad").skies
        meridian = sky.values["meridian_deg"]
        same = [
            program(require_pyradiance, tmp_path, "gensky", *words.split()).split("\n", 1)[1]
            for words in (f"3 20 12{zone} -a 0 -o 0", f"3 20 12 -a 0 -o 0 -m {meridian}")
        ]
        assert same[0] == same[1], zone


def test_obj_files_bring_their_libraries(tmp_path: Path) -> None:
    (tmp_path / "room.obj").write_text(
        "mtllib my room.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no wall\n"
        "usemtl plaster\nf 1 2 3 4\nusemtl pane\nf 1 2 3\n"
    )
    (tmp_path / "library").mkdir()
    (tmp_path / "library" / "my room.mtl").write_text(
        "newmtl plaster\nKd 0.7 0.7 0.6\nmap_Kd wall.png\nnewmtl pane\nKd 0 0 0\nTr 0.9\n"
    )
    with pytest.raises(ClerestoryError, match=r"room.obj, line 1: the material library .* was not found"):
        RoomScene.read(tmp_path / "room.obj")
    scene = RoomScene.read(tmp_path / "room.obj", unit="cm", search=[tmp_path / "library"])
    assert scene.surfaces == ("plaster", "pane")
    assert [m.kind for m in scene.materials] == ["plastic", "trans"]
    assert scene.materials[0].numbers == [0.7, 0.7, 0.6, 0, 0]
    np.testing.assert_allclose(scene.materials[1].numbers, [0.9, 0.9, 0.9, 0, 0, 1, 1])
    assert [len(p.corners) for p in scene.polygons] == [4, 3]
    assert scene.bounds() == ((0, 0, 0), (0.01, 0.01, 0))
    (warning,) = scene.warnings
    assert "map_Kd" in warning
    (tmp_path / "bare.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\ng part\nf 1 2 3\n")
    with pytest.raises(ClerestoryError, match=r"bare.obj, line 5: a face of \"part\" without a material"):
        RoomScene.read(tmp_path / "bare.obj")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "void antimatter a 1 x 0 0\na sphere s 0 0 4 0 0 0 1",
            r'line 2: sphere "s": its material "a" is of type "antimatter"',
        ),
        ("void instance i 1 a.oct 0 0", r"line 1: instance"),
        ("!gensky 6 21 12 -q", r'line 1: gensky: option "-q"'),
        ("!obj2rad a.obj", r'line 1: the command "obj2rad"'),
        ("!xform none.rad", r"line 1: none.rad: not found beside .*room.rad or on the search path"),
        ("void glow g 0 0 3 1 1 1\ng sphere s 0 0 4 0 0 0 1", r'line 1: glow "g": 3 real arguments, not 4'),
    ],
)
def test_faults_name_file_and_line(text: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "room.rad").write_text(text)
    with pytest.raises((ClerestoryError, OSError), match=f"room.rad, {told}") as caught:
        RoomScene.read(tmp_path / "room.rad")
    assert "\n" not in str(caught.value)


def test_data_sets_are_found(tmp_path: Path) -> None:
    (tmp_path / "bsdf").mkdir()
    (tmp_path / "bsdf" / "film.xml").touch()
    (tmp_path / "room.rad").write_text(
        "void aBSDF film 5 film.xml 0 0 1 . 0 0\nfilm polygon p 0 0 9 0 0 0 1 0 0 0 0 1\n"
    )
    scene = RoomScene.read(tmp_path / "room.rad", search=[tmp_path / "bsdf"])
    assert (scene.data_sets[0].path, scene.warnings) == (tmp_path / "bsdf" / "film.xml", ())
    (tmp_path / "film.xml").touch()
    scene = RoomScene.read([tmp_path / "room.rad"], search=[tmp_path / "bsdf"])
    assert (scene.data_sets[0].path, scene.data_sets[0].peaks) == (tmp_path / "film.xml", True)
    with pytest.raises(ClerestoryError, match="no scene file"):
        RoomScene.read([])
