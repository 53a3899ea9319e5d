"""Pictures of screens that a known sample lights come back as that sample."""

import json

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.cli import main
from clerestory.directions import direction
from clerestory.measure.camera import RIGS, Rig, develop, read_rig
from clerestory.measure.camera.gather import exit_grid
from clerestory.measure.camera.screen import homography, screens_of
from clerestory.picture import Picture
from clerestory.trace.keys import RecipeError
from clerestory.trace.recipe import read_toml

REFLECTANCE, AREA, LUX = 0.85, 400.0, 20000.0
TABLES = read_toml(RIGS.path_of("six-triangles"))
SMALL = json.loads(json.dumps(TABLES))
"""With a quarter of the pixels, where they need not be many."""
SMALL["screens"][0]["camera"] |= {"focal_pixels": 270.0, "size_pixels": [240, 220]}
MIDDLE = direction(30.0, 250.0, side="interior")


def lambertian(d):
    return np.full(d.shape[:-1], 0.5 / np.pi)


def lobe(d):
    return 0.05 + 0.4 * np.exp(-0.5 * (np.arccos(np.clip(d @ MIDDLE, -1, 1)) / np.radians(15.0)) ** 2)


def shown(screen, shape, btdf, theta_deg=0.0, lux=LUX):
    """Luminance of a screen that a small sample lights, at the middles of pixels: a picture without noise or blur."""
    rows, columns = np.indices(shape)
    places, _ = screen.places(np.column_stack([columns.ravel() + 0.5, rows.ravel() + 0.5]))
    points = screen.at(places)
    r = np.linalg.norm(points, axis=1)
    d = points / r[:, None]
    sample = btdf(d) * lux * np.cos(np.radians(theta_deg))
    onto = sample * AREA * np.abs(d[:, 2]) * np.abs(d @ screen.normal) / r**2
    seen = REFLECTANCE / np.pi * onto
    return np.where((d[:, 2] > 0.0) & np.isfinite(seen), seen, 0.0).reshape(shape)


def pictures(folder, btdf, tables=TABLES, screens=None, **options):
    folder.mkdir(exist_ok=True)
    width, height = tables["screens"][0]["camera"]["size_pixels"]
    names = []
    for n, screen in enumerate(screens or screens_of(Rig.of(tables).screens), start=1):
        grey = shown(screen, (height, width), btdf, **options)
        name = folder / f"{n}.exr"
        # Radiance of equal channels whose luminance is what is shown.
        Picture(np.repeat(grey[..., None] / 179.0, 3, axis=2)).write(name)
        names.append(str(name))
    return names


def rig_of(names, theta_deg=0.0, phi_deg=0.0, tables=TABLES, **changes):
    incidence = {"theta_deg": theta_deg, "phi_deg": phi_deg, "illuminance_lx": LUX, "pictures": names}
    return Rig.of({**tables, "incidences": [incidence], **changes})


def patch_means(btdf, basis):
    steps = (np.arange(8) + 0.5) / 8
    u = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    return np.array([btdf(basis.sample_outgoing(n, u, "interior")).mean() for n in range(len(basis))])


@pytest.fixture(scope="module")
def lit(tmp_path_factory):
    """Names of six pictures of a Lambertian sample and of a lobe."""
    folder = tmp_path_factory.mktemp("pictures")
    return {f.__name__: pictures(folder / f.__name__, f) for f in (lambertian, lobe)}


@pytest.mark.parametrize("btdf", [lambertian, lobe])
def test_a_known_sample_comes_back_within_one_percent_and_without_seams(lit, btdf):
    made = develop(rig_of(lit[btdf.__name__]))
    (scan,) = made.measurement.scans
    assert (made.directions, made.missing) == (1297, 0)
    assert (scan.side, scan.scatter, len(scan)) == ("interior", "transmission", 1297)
    expected = patch_means(btdf, exit_grid(5.0))
    np.testing.assert_allclose(scan.values[:, 0], expected, rtol=0.01)
    np.testing.assert_allclose(scan.values[:, 0].mean(), expected.mean(), rtol=0.002)
    assert made.measurement.warnings == ()
    # Each screen has a seam with both of its neighbours, at the least.
    pairs = {(seam.first, seam.second) for seam in made.seams[0]}
    assert len(pairs) >= 6
    assert max(seam.mismatch for seam in made.seams[0]) < 0.02


def test_a_grid_of_2_degrees_has_8101_directions(lit):
    basis = exit_grid(2.0)
    assert len(basis) == 1 + 45 * 180
    (scan,) = develop(rig_of(lit["lobe"], grid_deg=2.0)).measurement.scans
    assert len(scan) > 8000
    at = (np.rint(scan.theta_deg / 2.0) == 15) & (np.abs(scan.phi_deg - 250.0) < 0.1)
    assert scan.values[at, 0] == pytest.approx(0.45, rel=0.01)


def test_the_projected_illuminance_counts(tmp_path):
    names = pictures(tmp_path / "oblique", lambertian, SMALL, theta_deg=60.0)
    given = rig_of(names, 60.0, 90.0, SMALL)
    (scan,) = develop(given).measurement.scans
    assert np.median(scan.values) == pytest.approx(0.5 / np.pi, rel=0.005)
    (wrong,) = develop(given.model_copy(update={"illuminance_on": "sample"})).measurement.scans
    assert np.median(wrong.values) == pytest.approx(0.25 / np.pi, rel=0.005)
    # An aperture across the beam lights twice its area at 60°.
    (wide,) = develop(given.model_copy(update={"aperture_on": "beam"})).measurement.scans
    assert np.median(wide.values) == pytest.approx(0.25 / np.pi, rel=0.005)


def test_a_misplaced_screen_is_found_by_its_seams(tmp_path):
    moved = json.loads(json.dumps(SMALL))
    for corner in moved["screens"][0]["corners_mm"]:
        corner[0] += 40.0 * (corner[2] == 0.0)
    screens = screens_of(Rig.of(SMALL).screens)
    screens[2] = screens_of(Rig.of(moved).screens)[2]
    names = pictures(tmp_path / "moved", lambertian, SMALL, screens)
    made = develop(rig_of(names, tables=SMALL))
    (warning,) = made.measurement.warnings
    assert "only seams of screen 1 turned by 120° do" in warning
    assert "along their seam" in warning


def test_what_no_screen_sees_is_absent_and_not_zero(lit):
    screens = [{**TABLES["screens"][0], "turned_deg": [0, 60, 120, 240, 300]}]
    made = develop(rig_of([n for k, n in enumerate(lit["lambertian"]) if k != 3], screens=screens))
    (scan,) = made.measurement.scans
    assert made.missing == 1297 - len(scan)
    assert 180 < made.missing < 230  # a sixth, less what its neighbours reach into
    gone = (np.abs(scan.phi_deg - 180.0) < 20.0) & (scan.theta_deg > 0.0)
    assert not gone.any()
    assert scan.values.min() > 0.99 * 0.5 / np.pi
    (warning,) = made.measurement.warnings
    assert "absent, not zero" in warning
    assert "150 to 180°, 180 to 210°" in warning


def test_marks_stand_for_a_camera():
    given = Rig.of(TABLES).screens
    screen = screens_of(given)[0]
    places = np.array([[100.0, 50.0], [800.0, 60.0], [600.0, 500.0], [450.0, 300.0], [420.0, 700.0]])
    marks = [
        {"mm": mm.tolist(), "pixel": pixel.tolist()}
        for mm, pixel in zip(screen.at(places), screen.pixels(places), strict=True)
    ]
    table = {k: v for k, v in TABLES["screens"][0].items() if k not in ("camera", "turned_deg")}
    marked = screens_of(Rig.of({**TABLES, "screens": [{**table, "marks": marks}], "incidences": [
        {"theta_deg": 0, "illuminance_lx": 1, "pictures": ["1.hdr"]}]}).screens)[0]  # fmt: skip
    pixels = np.random.default_rng(1).random((50, 2)) * [480, 440]
    found, area = marked.places(pixels)
    expected, areas = screen.places(pixels)
    np.testing.assert_allclose(found, expected, atol=1e-6)
    np.testing.assert_allclose(area, areas, rtol=1e-6)


def test_the_area_of_pixels_is_the_screens():
    screen = screens_of(Rig.of(TABLES).screens)[0]
    rows, columns = np.indices((440, 480))
    places, area = screen.places(np.column_stack([columns.ravel() + 0.5, rows.ravel() + 0.5]))
    inside = screen.edge_distance(places) >= 0.0
    a, b, c = screen.corners
    expected = 0.5 * abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
    assert area[inside].sum() == pytest.approx(expected, rel=0.005)


def test_a_camera_that_sees_the_sample_itself(tmp_path):
    view = "-vta -vp 0 0 0 -vd 0 0 1 -vu 0 1 0 -vh 180 -vv 180"
    from clerestory.picture import View

    d = View(view).pixel_directions(900, 900)
    grey = np.nan_to_num(lobe(d) * LUX, nan=0.0)
    Picture(np.repeat(grey[..., None] / 179.0, 3, axis=2)).write(tmp_path / "direct.exr")
    tables = {k: v for k, v in TABLES.items() if k not in ("screens", "aperture_mm2")}
    incidence = {"theta_deg": 0, "illuminance_lx": LUX, "pictures": [str(tmp_path / "direct.exr")]}
    made = develop(Rig.of({**tables, "direct": {"view": view}, "incidences": [incidence]}))
    (scan,) = made.measurement.scans
    assert made.missing == 0
    # About the normal patches are as narrow as two pixels.
    wide, expected = scan.theta_deg >= 15.0, patch_means(lobe, exit_grid(5.0))
    np.testing.assert_allclose(scan.values[wide, 0], expected[wide], rtol=0.01)
    np.testing.assert_allclose(scan.values[:, 0], expected, rtol=0.03)
    assert made.seams == ((),)
    assert made.measurement.warnings == ()
    # Too few pixels for the narrow patches about the normal are told.
    Picture(np.repeat(grey[::4, ::4, None] / 179.0, 3, axis=2)).write(tmp_path / "direct.exr")
    (warning,) = develop(Rig.of({**tables, "direct": {"view": view}, "incidences": [incidence]})).measurement.warnings
    assert "fewer than 4 pixels" in warning


def test_darkening_and_dark_signal_are_taken_off(tmp_path):
    names = pictures(tmp_path / "dim", lambertian, SMALL)
    rows, columns = np.indices((220, 240))
    angle = np.arctan(np.hypot(columns + 0.5 - 120.0, rows + 0.5 - 110.0) / 270.0)
    for name in names:
        grey = Picture.read(name).pixels * (1.0 - 0.3 * angle**2)[..., None] + 3.0 / 179.0
        Picture(grey).write(name)
    rig = rig_of(names, tables=SMALL, dark_cd_m2=3.0, vignetting={"focal_pixels": 270.0, "coefficients": [-0.3]})
    (scan,) = develop(rig).measurement.scans
    np.testing.assert_allclose(scan.values, 0.5 / np.pi, rtol=0.01)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"screens": []}, "screens: light is seen on screens or directly"),
        ({"aperture_mm2": None}, "aperture_mm2: is missing"),
        ({"grid_deg": 7.0}, "grid_deg: 7° does not divide 90°"),
        ({"screens": [{**TABLES["screens"][0], "turned_deg": [0, 60]}]}, "6 pictures of 2 positions"),
        ({"screens": [{**TABLES["screens"][0], "reflectance": 85}]}, "screens[1].reflectance"),
        ({"screens": [{**TABLES["screens"][0], "marks": []} | {"camera": None}]}, "marks or a camera"),
        ({"lamp": "HMI"}, "lamp: there is no such key"),
    ],
)
def test_a_faulty_rig_is_refused(change, complaint):
    tables = {k: v for k, v in (TABLES | change).items() if v is not None}
    with pytest.raises(RecipeError) as told:
        Rig.of(tables)
    assert complaint in str(told.value)


def test_impossible_geometry_is_refused(lit):
    base = TABLES["screens"][0]
    flat = {**base, "corners_mm": [[0, 0, 100], [1, 0, 100], [2, 0, 100]]}
    with pytest.raises(ClerestoryError, match="on one line"):
        develop(rig_of(lit["lambertian"], screens=[flat]))
    behind = {**base, "camera": {**base["camera"], "target_mm": [-2000.0, 0.0, 300.0]}}
    with pytest.raises(ClerestoryError, match="behind the camera"):
        develop(rig_of(lit["lambertian"], screens=[behind]))
    bent = {**base, "corners_mm": [*base["corners_mm"], [400.0, 100.0, 700.0]]}
    with pytest.raises(ClerestoryError, match="out of its plane"):
        develop(rig_of(lit["lambertian"], screens=[bent]))
    below = {**base, "corners_mm": [[x, y, -z] for x, y, z in base["corners_mm"]]}
    with pytest.raises(ClerestoryError, match="sign of z"):
        develop(rig_of(lit["lambertian"], screens=[below]))
    sized = {**base, "camera": {**base["camera"], "size_pixels": [640, 440]}}
    with pytest.raises(ClerestoryError, match="not the camera's"):
        develop(rig_of(lit["lambertian"], screens=[sized]))
    with pytest.raises(ClerestoryError, match="perspective"):
        homography([[0, 0], [1, 0], [2, 0], [0, 1]], [[0, 0], [1, 0], [2, 0], [0, 1]])


def test_the_command_writes_files_of_a_format(lit, tmp_path, capsys):
    text = RIGS.path_of("six-triangles").read_text()
    for n, name in enumerate(lit["lobe"], start=1):
        text = text.replace(f'"0_{n}.hdr"', f'"{name}"')
    (tmp_path / "rig.toml").write_text(text)
    assert main(["measure", "camera", str(tmp_path / "rig.toml"), "-o", str(tmp_path / "out"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["directions"] == 1297
    from clerestory.measure import read

    (back,) = read(tmp_path / "out").measurements
    assert len(back.scans[0]) == 1297
    assert back.scans[0].values.max() == pytest.approx(0.45, rel=0.02)
    assert (back.scans[0].incident_side, back.scans[0].scatter) == ("exterior", "transmission")
    assert read_rig(tmp_path / "rig.toml").positions == 6


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["nowhere.toml", "-o", "out"], "nowhere.toml"),
        (["six-triangles", "-o", "out"], "0_1.hdr"),
        (["seven-triangles", "-o", "out"], "did you mean six-triangles"),
        (["six-triangles", "-o", "out", "--format", "xml"], "--format xml: not known"),
        ([], "none is given"),
    ],
)
def test_what_makes_no_sense_is_refused(tmp_path, capsys, monkeypatch, words, complaint):
    monkeypatch.chdir(tmp_path)
    assert main(["measure", "camera", *words]) in (1, 2)
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("error: ")
    assert said.err.count("\n") == 1
    assert complaint in said.err
    assert list(tmp_path.iterdir()) == []
