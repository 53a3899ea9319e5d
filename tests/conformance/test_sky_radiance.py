"""Skies against Radiance's generators, through their real output: scenes for rtrace, matrices of gendaymtx."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from clerestory import ClerestoryError, _core
from clerestory.cli import main
from clerestory.sky import Place, Sky, SunPosition
from clerestory.weather import SkyYear, read_weather
from clerestory.weather.wea import to_wea
from samples import ABSENT, sample_root

pyradiance = pytest.importorskip("pyradiance", reason="pyradiance carries the reference programs")

HOME = Path(pyradiance.__file__).parent
#: 1,000 directions, some below the horizon.
DIRECTIONS = np.random.default_rng(8).normal(size=(1000, 3))
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1)[:, None]
DOMES = """
skyfunc glow glow_ 0 0 4 1 1 1 0
glow_ source all 0 0 4 0 0 1 360
"""


def run(name, *arguments, stdin=None, folder=None):
    program = HOME / "bin" / name
    if not program.exists():
        pytest.skip(f"{name} is not in this pyradiance")
    environment = {**os.environ, "RAYPATH": f".:{HOME / 'lib'}", "PATH": f"{HOME / 'bin'}:{os.environ['PATH']}"}
    done = subprocess.run(
        [str(program), *(str(a) for a in arguments)],
        input=stdin,
        capture_output=True,
        cwd=folder,
        env=environment,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


def looked_at(scene, folder, directions=DIRECTIONS):
    """Radiances (n, 3) by rtrace from directions."""
    (folder / "sky.rad").write_text(scene)
    (folder / "sky.oct").write_bytes(run("oconv", "sky.rad", folder=folder))
    rays = np.column_stack([np.zeros_like(directions), directions]).astype("<f4").tobytes()
    raw = run("rtrace", "-h", "-w", "-fff", "-ab", "0", "-dv+", "sky.oct", stdin=rays, folder=folder)
    return np.frombuffer(raw, dtype="<f4").reshape(-1, 3).astype(float)


def parameters(text):
    """Numbers of the sky's function, direction and radiance of the sun, in a generator's output."""
    words = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    function = [float(w) for w in words[-1]][1:]
    sun = next((i for i, w in enumerate(words) if w[:2] == ["solar", "source"]), None)
    if sun is None:
        return function, None, 0.0
    radiance = float(words[sun - 1][1])
    return function, [float(w) for w in words[sun + 3][1:]], radiance


def agrees(sky, text, folder, tolerance=5e-3):
    """Ours and theirs at the directions and for the sun, both through rtrace for theirs."""
    theirs = looked_at(text + DOMES, folder)
    ours = sky.radiance(DIRECTIONS)
    # Within the sun's disc rtrace would see the sun, too; none of these directions is.
    assert np.abs(ours / theirs - 1).max() < tolerance


def angles(sun):
    """Radiance's -ang: altitude and azimuth from the south, west positive."""
    altitude, azimuth = sun
    return ["-ang", altitude, azimuth - 180.0]


SUNS = [(35.9, 125.0), (75.4, 190.4), (12.3, 226.8), (2.0, 90.0), (60.0, 300.0)]
WEATHER = [(700, 120), (850, 110), (0, 60), (300, 200), (150, 250), (900, 60), (50, 180)]


@pytest.mark.parametrize("sun", SUNS)
@pytest.mark.parametrize("weather", WEATHER)
def test_perez_is_gendaylits(sun, weather, tmp_path):
    direct, diffuse = weather
    text = run("gendaylit", *angles(sun), "-W", direct, diffuse).decode()
    if " 0.00 0.00  0.000" in text:  # its black sky
        with pytest.raises(ClerestoryError, match="black"):
            Sky.perez(sun, direct=direct, diffuse=diffuse, preset="radiance")
        return
    sky = Sky.perez(sun, direct=direct, diffuse=diffuse, preset="radiance")
    agrees(sky, text, tmp_path, 1.5e-3)
    _, disc, radiance = parameters(text)
    if radiance == 0:
        assert sky.sun is None
        return
    assert sky.sun.radiance == pytest.approx([radiance] * 3, rel=1e-3)
    assert sky.sun.direction == pytest.approx(disc[:3], abs=2e-6)
    assert 2 * sky.sun.half_angle_deg == pytest.approx(disc[3], abs=1e-6)


@pytest.mark.parametrize(
    ("option", "values", "ours"),
    [
        ("-L", (40000, 20000), {"direct_illuminance": 40000, "diffuse_illuminance": 20000}),
        ("-E", (500,), {"global_horizontal": 500}),
    ],
)
def test_other_supplies_are_gendaylits(option, values, ours, tmp_path):
    sun = (40.0, 190.0)
    sky = Sky.perez(sun, preset="radiance", **ours)
    text = run("gendaylit", *angles(sun), option, *values).decode()
    agrees(sky, text, tmp_path)
    assert sky.sun.radiance[0] == pytest.approx(parameters(text)[2], rel=5e-3)


def test_solar_watts_are_gendaylits(tmp_path):
    sky = Sky.perez((35.9, 125.0), direct=700, diffuse=120, preset="radiance", quantity="solar")
    agrees(sky, run("gendaylit", *angles((35.9, 125.0)), "-W", 700, 120, "-O", 1).decode(), tmp_path, 1.5e-3)


def test_high_suns_are_held_at_87_degrees(tmp_path):
    sky = Sky.perez((89.5, 200.0), direct=800, diffuse=100, preset="radiance")
    agrees(sky, run("gendaylit", *angles((89.5, 200.0)), "-W", 800, 100).decode(), tmp_path, 1.5e-3)
    assert sky.sun.direction[2] == pytest.approx(np.sin(np.radians(87)))
    assert Sky.perez((89.5, 200.0), direct=800, diffuse=100).sun.direction[2] > 0.9999


@pytest.mark.parametrize("sun", SUNS)
@pytest.mark.parametrize(
    ("option", "kind"),
    [("+s", "clear"), ("-s", "clear"), ("+i", "intermediate"), ("-c", "overcast"), ("-u", "uniform")],
)
def test_standard_skies_are_genskys(sun, option, kind, tmp_path):
    options = {"sunny": False} if option == "-s" else {}
    sky = getattr(Sky, kind)(sun, preset="radiance", **options)
    text = run("gensky", *angles(sun), option).decode()
    agrees(sky, text, tmp_path, 1.5e-3)
    _, disc, radiance = parameters(text)
    if radiance == 0:
        assert sky.sun is None
    else:
        assert sky.sun.radiance == pytest.approx([radiance] * 3, rel=1e-3)
        assert sky.sun.direction == pytest.approx(disc[:3], abs=2e-6)
        assert 2 * sky.sun.half_angle_deg == pytest.approx(disc[3])


@pytest.mark.parametrize("hour", [6.5, 9.5, 12.0, 15.75, 18.0])
@pytest.mark.parametrize("date", [(3, 21), (6, 21), (9, 23), (12, 21)])
def test_suns_are_genskys(hour, date):
    place = Place(37.87, -122.27, -8.0)
    for year in (None, 2024, 1997):
        more = [] if year is None else ["-y", year]
        text = run("gensky", *date, hour, "-a", 37.87, "-o", 122.27, "-m", 120, "+s", *more).decode()
        minutes = round(hour * 60)
        when = f"{year or 2001}-{date[0]:02d}-{date[1]:02d} {minutes // 60:02d}:{minutes % 60:02d}"
        sun = SunPosition.at(place, when, method="radiance" if year is None else "almanac")
        assert sun.direction == pytest.approx(parameters(text)[0][-3:], abs=3e-6), year


def ours_through_rtrace(sky, folder):
    functions = sky.radiance_functions()
    if functions is not None:
        (folder / "sky.cal").write_text(functions)
    return looked_at(sky.radiance_description(), folder)


SCENES = {
    "perez": lambda preset: Sky.perez((35.9, 125), direct=700, diffuse=120, preset=preset),
    "coloured": lambda preset: Sky.perez((35.9, 125), direct=700, diffuse=120, preset=preset, colour="radiance"),
    "cie1": lambda preset: Sky.cie(1, (35.9, 125), diffuse_illuminance=9000, preset=preset),
    "cie12": lambda preset: Sky.cie(12, (35.9, 125), zenith_luminance=4000, preset=preset),
    "clear": lambda preset: Sky.clear((35.9, 125), preset=preset),
    "intermediate": lambda preset: Sky.intermediate((35.9, 125), preset=preset),
    "overcast": lambda preset: Sky.overcast((35.9, 125), preset=preset),
    "uniform": lambda preset: Sky.uniform((35.9, 125), preset=preset),
    "preetham": lambda _preset: Sky.preetham((35.9, 125)),
    "grey": lambda _preset: Sky.preetham((35.9, 125), coloured=False),
    "solar": lambda preset: Sky.perez((35.9, 125), direct=700, diffuse=120, preset=preset, quantity="solar"),
}


@pytest.mark.parametrize("preset", ["clerestory", "radiance"])
@pytest.mark.parametrize("name", SCENES)
def test_written_scenes_look_as_they_should(name, preset, tmp_path):
    sky = SCENES[name](preset)
    theirs = ours_through_rtrace(sky, tmp_path)
    # The two domes of a scene meet at the horizon: leave out what 32 bits put on the other side.
    clear = np.abs(DIRECTIONS[:, 2]) > 1e-5
    assert np.abs(sky.radiance(DIRECTIONS)[clear] / theirs[clear] - 1).max() < 1e-4
    if sky.sun is not None:
        seen = looked_at(sky.radiance_description(), tmp_path, sky.sun.direction[None, :])
        assert seen[0] == pytest.approx(sky.sun.radiance + sky.radiance(sky.sun.direction), rel=1e-3)


STEPS = [(3, 21, 9.5, 700, 120), (6, 21, 12.0, 850, 110), (12, 21, 15.5, 300, 80), (9, 23, 18.0, 0, 25)]
#: Turbid and clear skies, a low sun, the sun in the zenith, and light for which Perez's sky is undefined.
TROPICS = [
    (3, 21, 12.0, 900, 80),
    (3, 22, 12.1, 200, 400),
    (4, 1, 6.5, 30, 40),
    (10, 5, 9.0, 500, 90),
    (7, 1, 17.0, 5, 60),
    (3, 21, 12.3, 90, 20),
    (3, 21, 12.3, 1300, 300),
    (3, 21, 12.3, 60, 30),
]


def daymtx(folder, steps, place, *options):
    head = (
        f"place x\nlatitude {place.latitude}\nlongitude {-place.longitude}\ntime_zone {-15 * place.timezone}\n"
        "site_elevation 0\nweather_data_file_units 1\n"
    )
    (folder / "steps.wea").write_text(head + "".join(" ".join(map(str, step)) + "\n" for step in steps))
    raw = run("gendaymtx", "-od", *options, "steps.wea", folder=folder)
    values = np.frombuffer(raw[raw.index(b"\n\n") + 2 :], dtype="<f8")
    return values.reshape(-1, len(steps), 3)


def ours(steps, place, basis, part="all", colour="grey", quantity="visible", north_deg=0.0, **sun):
    columns = []
    for month, day, hour, direct, diffuse in steps:
        altitude, azimuth = _core.sun_by_radiance(
            (place.latitude, place.longitude, place.timezone), month, day, hour, None
        )
        in_year = SunPosition.at(place, f"2001-{month:02d}-{day:02d} 00:00").day
        sky = Sky.perez(
            SunPosition(altitude, azimuth, in_year),
            direct=direct,
            diffuse=diffuse,
            preset="radiance-matrix",
            colour=colour,
            quantity=quantity,
            north_deg=north_deg,
        )
        columns.append(sky.patches(basis, part=part, **sun))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("factor", [1, 2, 4])
@pytest.mark.parametrize(
    ("where", "steps"), [((37.87, -122.27, -8.0), STEPS), ((0.5, 10.0, 1.0), TROPICS)], ids=["berkeley", "tropics"]
)
@pytest.mark.parametrize(
    ("options", "part", "more"),
    [
        ((), "all", {}),
        (("-s",), "sky", {}),
        (("-d",), "sun", {}),
        (("-O1",), "all", {"quantity": "solar"}),
        (("-r", "30"), "all", {"north_deg": 30.0}),
    ],
    ids=["all", "sky", "sun", "solar", "turned"],
)
def test_matrices_are_gendaymtxs(factor, where, steps, options, part, more, tmp_path):
    place = Place(*where)
    theirs = daymtx(tmp_path, steps, place, "-m", factor, "-c", 1, 1, 1, *options)
    found = ours(steps, place, f"reinhart:{factor}", part, **more)
    assert found.shape == theirs.shape
    scale = np.maximum(np.abs(theirs), 1e-9)
    assert (np.abs(found - theirs) / scale).max() < 1e-5


def test_the_direct_part_of_five_phases_is_gendaymtxs(tmp_path):
    place = Place(37.87, -122.27, -8.0)
    theirs = daymtx(tmp_path, STEPS, place, "-m", 6, "-c", 1, 1, 1, "-d", "-5", 0.533)
    found = ours(STEPS, place, "reinhart:6", "sun", sun="nearest", disc_deg=0.533)
    assert [list(np.flatnonzero(theirs[:, k, 0])) for k in range(3)] == [[2787], [4931], [1014]]
    assert found == pytest.approx(theirs, rel=1e-5)


def test_the_colour_is_gendaymtxs(tmp_path):
    place = Place(37.87, -122.27, -8.0)
    theirs = daymtx(tmp_path, STEPS, place, "-m", 1)
    assert ours(STEPS, place, "tregenza", colour="radiance") == pytest.approx(theirs, rel=1e-5)


@pytest.mark.parametrize("suffix", ["hdr", "exr"])
def test_pictures_show_the_sky_as_rpict_does(suffix, tmp_path, capsys):
    """The file's own view, looked at by Radiance in our scene; the picture's sun aside."""
    words = ["--sun", "35.9,125", "--direct", "0", "--diffuse", "120"]
    assert main(["sky", "perez", *words, "-o", str(tmp_path / f"sky.{suffix}"), "--size", "64"]) == 0
    if suffix == "exr":
        assert (tmp_path / "sky.exr").read_bytes()[:4] == b"v/1\x01"
        return
    ours = np.array(run("pvalue", "-h", "-H", "-d", "sky.hdr", folder=tmp_path).split(), float).reshape(64, 64, 3)
    sky = Sky.perez((35.9, 125.0), direct=0, diffuse=120)
    (tmp_path / "sky.cal").write_text(sky.radiance_functions())
    (tmp_path / "sky.rad").write_text(sky.radiance_description())
    (tmp_path / "sky.oct").write_bytes(run("oconv", "sky.rad", folder=tmp_path))
    rays = run("vwrays", "-fd", "-vf", "sky.hdr", "-x", "64", "-y", "64", "-pj", "0", folder=tmp_path)
    directions = np.frombuffer(rays, "<f8").reshape(64, 64, 6)[..., 3:]
    inside = (np.linalg.norm(directions, axis=-1) > 0.5) & (ours[..., 0] > 0)
    assert inside.sum() > 3000
    theirs = looked_at(sky.radiance_description(), tmp_path, directions[inside])
    # RGBE keeps 8 bits.
    assert np.abs(ours[inside] / theirs - 1).max() < 0.01


@pytest.mark.parametrize(
    ("options", "more"),
    [((), {}), (("-s",), {"part": "sky"}), (("-d", "-5", "0.533"), {"part": "sun", "sun": "nearest"})],
    ids=["all", "sky", "five-phase sun"],
)
def test_years_are_gendaymtxs(options, more):
    """Every element of a whole year, hours of sunset among them: sun, efficacy, patches together."""
    root = sample_root()
    if root is None:
        pytest.skip(ABSENT)
    path = root / "weather" / "oak.wea"
    raw = run("gendaymtx", "-of", "-m", "2", "-c", "1", "1", "1", *options, path)
    theirs = np.frombuffer(raw[raw.index(b"\n\n") + 2 :], dtype="<f4").reshape(578, 8760, 3)[..., 1]
    weather = read_weather(path)
    ours = SkyYear(weather, "reinhart:2", preset="radiance-matrix").columns(**more)
    # The sky of an hour without diffuse light is black here.
    lit = weather.diffuse > 0
    assert lit.sum() > 4000
    scale = np.maximum(theirs.max(axis=0), 1e-6)
    assert (np.abs(ours - theirs).max(axis=0) / scale)[lit].max() < 2e-5
    assert not ours[:, ~lit].any()


def test_wea_files_are_epw2weas(tmp_path):
    root = sample_root()
    if root is None:
        pytest.skip(ABSENT)
    path = root / "weather" / "AUT_Innsbruck.111200_IWEC.epw"
    run("epw2wea", path, "theirs.wea", folder=tmp_path)
    (tmp_path / "ours.wea").write_text(to_wea(read_weather(path)))
    theirs, ours = (read_weather(tmp_path / f"{name}.wea") for name in ("theirs", "ours"))
    assert (theirs.place.latitude, theirs.place.longitude) == (ours.place.latitude, ours.place.longitude)
    assert theirs.time_zone == ours.time_zone
    for name in ("times", "direct", "diffuse"):
        assert np.array_equal(getattr(theirs, name), getattr(ours, name)), name
