"""Pictures of measured points show the points, and the command refuses what makes no sense."""

import json

import numpy as np
import pytest

from clerestory import Bsdf, ClerestoryError, MissingDataError, Model
from clerestory.cli import main
from clerestory.directions import angles, direction
from clerestory.integrals import continued
from clerestory.measure import Measurement, Scan, write
from clerestory.measure.plan.paths import circle_path, hemisphere_path
from clerestory.plot import measured
from clerestory.plot.style import render

WIDTH = 0.8


def scans_of(theta, phi, scatter="transmission", height=20.0):
    """A coarse scan of the hemisphere and a fine one of the beam: a diffuse floor of 0.1 and a Gaussian."""
    side = "interior" if scatter == "transmission" else "exterior"
    through = continued(direction(theta, phi), scatter)
    made = []
    for path in (
        hemisphere_path(side, step_deg=6.0, largest_theta_deg=84.0),
        circle_path(through, radius_deg=3.0, step_deg=0.3),
    ):
        d = direction(path.theta_deg, path.phi_deg, side=side)
        away = np.degrees(np.arccos(np.clip(d @ through, -1.0, 1.0)))
        bsdf = 0.1 + height * np.exp(-0.5 * (away / WIDTH) ** 2)
        made.append(Scan("exterior", scatter, theta, phi, path.theta_deg, path.phi_deg, bsdf[:, None]))
    return made


ONE = scans_of(40.0, 90.0)
MANY = [scan for theta in (0.0, 30.0, 60.0) for phi in (0.0, 90.0) for scan in scans_of(theta, phi)]


def words(figure):
    texts = [t.get_text() for ax in figure.axes for t in (*ax.texts, ax.title)]
    texts += [figure.get_suptitle()]
    legends = [ax.get_legend() for ax in figure.axes] + list(figure.legends)
    texts += [
        t.get_text() for legend in legends if legend is not None for t in (*legend.get_texts(), legend.get_title())
    ]
    return "\n".join(texts)


def test_points_stand_where_they_were_measured():
    figure = measured.points_figure(ONE, label="Twill", projection="orthographic")
    (marks,) = figure.axes[0].collections
    places, values = marks.get_offsets(), marks.get_array()
    assert len(places) == sum(len(scan) for scan in ONE)
    # The highest is drawn last, at the beam: a sun above goes down.
    assert values[-1] == pytest.approx(20.1)
    np.testing.assert_allclose(places[-1], [0.0, -np.sin(np.radians(40.0))], atol=1e-9)
    said = words(figure)
    assert "Twill" in said
    assert "from above, 40°" in said
    assert "of 2 scans" in said


def test_values_without_a_logarithm_are_counted():
    dark = Scan("exterior", "transmission", 0.0, 0.0, [10.0, 20.0, 30.0], [0.0, 90.0, 180.0], [[0.1], [0.0], [-0.01]])
    assert "2 values of 0 or less" in words(measured.points_figure([dark]))
    assert "of 0 or less" not in words(measured.points_figure([dark], scale="linear"))


def test_the_surface_is_that_between_points_and_hatched_beyond():
    figure = measured.surface_figure(ONE, pixels=181, projection="orthographic", scale="linear", quantity="dsf")
    image = np.ma.filled(figure.axes[0].images[0].get_array().astype(float), np.nan)
    x = (np.arange(181) + 0.5) / 90.5 - 1.0
    r = np.hypot(*np.meshgrid(x, x))
    assert np.isnan(image[r > np.sin(np.radians(84.5))]).all()
    assert np.isfinite(image[r < np.sin(np.radians(83.0))]).all()
    flat = (r < 0.95) & (np.hypot(x[None, :], x[:, None] + 0.643) > 0.3)
    np.testing.assert_allclose(image[flat], 0.1 * np.sqrt(1.0 - r[flat] ** 2), rtol=0.02)
    assert "not measured" in words(figure)


def test_a_mountain_has_a_corner_at_every_point():
    figure = measured.mountain_figure(ONE, scale="linear")
    ax = figure.axes[0]
    assert ax.get_zlim()[1] == pytest.approx(20.1)
    assert len(ax.collections) == 1
    assert render(figure, ".png", dpi=30).startswith(b"\x89PNG")


def test_a_cut_has_a_line_a_set_and_the_points_near_the_plane():
    wide = scans_of(40.0, 90.0, height=10.0)
    figure = measured.cut_figure({"one": ONE, "other": wide})
    lines = {line.get_label(): line for line in figure.axes[0].lines if line.get_label() in ("one", "other")}
    for name, height in (("one", 20.1), ("other", 10.1)):
        x, y = lines[name].get_data()
        assert np.nanmax(y) == pytest.approx(height, rel=0.01)
        assert x[np.nanargmax(y)] == pytest.approx(40.0, abs=0.1)
        assert np.isnan(y[np.abs(x) > 85.0]).all()


def test_a_scan_of_a_line_is_a_cut_of_dots():
    alpha = np.linspace(5.0, 80.0, 80)
    line = Scan("exterior", "transmission", 0.0, 0.0, alpha, np.full(80, 270.0), 0.2 * np.ones((80, 1)))
    figure = measured.cut_figure({"line": [line]})
    dots = next(one for one in figure.axes[0].lines if one.get_label() == "line")
    np.testing.assert_allclose(dots.get_xdata(), alpha)
    with pytest.raises(ClerestoryError, match="on one line"):
        measured.surface_figure([line])
    with pytest.raises(MissingDataError, match="no points within 1° of the plane"):
        measured.cut_figure({"line": [line]}, azimuth_deg=0.0)


def test_a_close_up_is_in_arc_minutes_and_says_how_wide_the_peak_is():
    figure = measured.close_up_figure(ONE)
    ax = figure.axes[0]
    assert "arc-minutes" in ax.get_xlabel()
    said = words(figure)
    width = float(said.split("half of the largest: ")[1].split("'")[0])
    assert width == pytest.approx(2.355 * WIDTH * 60.0, rel=0.03)
    near = measured.close_up_figure(ONE, centre=(40.0, 270.0), half_width_arcmin=30.0)
    assert near.axes[0].get_xlim() == pytest.approx((-30.0, 30.0))
    with pytest.raises(MissingDataError, match="no point was measured within"):
        measured.close_up_figure(ONE, centre=(61.0, 92.0), half_width_arcmin=5.0)
    with pytest.raises(ClerestoryError, match="not possible"):
        measured.close_up_figure(ONE, half_width_arcmin=0.0)


def test_an_overview_has_a_panel_a_direction():
    figure = measured.overview_figure(MANY)
    titles = [ax.get_title() for ax in figure.axes if ax.get_visible() and ax.get_title()]
    assert titles[0] == "light comes from"
    # Along the normal there is one direction whatever its azimuth.
    assert titles[1:] == ["θ 0°, φ 0°", "θ 30°, φ 0°", "θ 30°, φ 90°", "θ 60°, φ 0°", "θ 60°, φ 90°"]


def test_one_of_several_directions_must_be_named():
    with pytest.raises(ClerestoryError, match=r"5 incident directions: 0,0 30,0 .*name one"):
        measured.points_figure(MANY)
    assert "from above, 60°" in words(measured.points_figure(MANY, incident=(60.0, 90.0)))
    with pytest.raises(MissingDataError, match="no scan of light from 45,0"):
        measured.points_figure(MANY, incident=(45.0, 0.0))
    with pytest.raises(MissingDataError, match="no scan of reflection"):
        measured.points_figure(ONE, scatter="reflection")
    with pytest.raises(MissingDataError, match="no channel 'solar'"):
        measured.points_figure(ONE, channel="solar")


def test_reflection_is_seen_from_the_room_too():
    figure = measured.points_figure(scans_of(40.0, 0.0, "reflection"), projection="orthographic")
    (marks,) = figure.axes[0].collections
    # Light from the right is mirrored to the left.
    np.testing.assert_allclose(marks.get_offsets()[-1], [-np.sin(np.radians(40.0)), 0.0], atol=1e-9)
    theta, phi = angles(continued(direction(40.0, 0.0), "reflection"))
    assert (float(theta), float(phi)) == pytest.approx((40.0, 180.0))


def test_points_beside_a_model():
    bsdf = Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.1 * np.pi)})
    figure = measured.beside_figure(ONE, bsdf, label="Twill", scale="linear", azimuth_deg=0.0)
    points, disk, cut = figure.axes[0], figure.axes[1], next(ax for ax in figure.axes if ax.get_xlabel())
    assert len(points.collections[0].get_offsets()) == sum(int((scan.theta_deg <= 85.0).sum()) for scan in ONE)
    (image,) = disk.images
    shown = np.ma.masked_invalid(image.get_array())
    assert shown.mask.any()  # the ring at the horizon is left out
    assert float(shown.max()) == pytest.approx(0.1)
    # Both have one scale, and the cut has the floor that was measured on the model.
    assert image.norm.vmax == points.collections[0].norm.vmax == pytest.approx(20.1)
    dots, line = cut.lines[:2]
    assert np.median(dots.get_ydata()) == pytest.approx(np.median(line.get_ydata()), rel=1e-6)
    assert "Twill" in words(figure)


def test_a_sample_of_the_database_beside_its_model(files, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    bsdf = Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.3)})
    bsdf.to_matrix("klems-quarter").write("m.xml")
    assert main(["measure", "import", str(files / "one"), "--db", "lab.sqlite"]) == 0
    capsys.readouterr()
    code, out, err = run(capsys, "one", "--db", "lab.sqlite", "-o", "a.png", "--model", "m.xml", "--dpi", 30)
    assert (code, out) == (0, ""), err
    assert (tmp_path / "a.png").stat().st_size > 1000
    code, _, err = run(capsys, "two", "--db", "lab.sqlite", "-o", "b.png")
    assert (code, "two: neither a file nor a sample of lab.sqlite" in err) == (1, True)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scans")
    write(Measurement("one", tuple(scans_of(40.0, 90.0)[:1])), folder / "one", "mountain")
    write(Measurement("many", tuple(MANY[::2])), folder / "many", "mountain")
    return folder


def run(capsys, *given):
    code = main(["measure", "plot", *(str(w) for w in given)])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.mark.parametrize(
    ("kind", "suffix", "options"),
    [
        (None, "png", []),
        ("points", "pdf", ["--quantity", "dsf"]),
        ("surface", "png", ["--scale", "linear"]),
        ("mountain", "png", ["--incident", "40,90"]),
        ("cut", "svg", ["--azimuth", "0"]),
        ("close-up", "png", ["--half-width", "600"]),
        ("overview", "png", []),
        ("cut", "png", ["--clip", "0"]),
        ("points", "png", ["--projection", "orthographic"]),
    ],
)
def test_every_kind_becomes_a_file(files, tmp_path, capsys, kind, suffix, options):
    target = tmp_path / f"picture.{suffix}"
    chosen = ["--kind", kind] if kind else []
    code, out, err = run(capsys, files / "one", "-o", target, "--dpi", 30, *chosen, *options)
    assert (code, out) == (0, ""), err
    assert err.endswith(f"wrote {target}\n")
    assert target.stat().st_size > 1000


def test_several_directions_make_an_overview(files, tmp_path, capsys):
    code, out, _ = run(capsys, files / "many", "-o", tmp_path / "a.png", "--dpi", 30, "--json")
    assert code == 0
    told = json.loads(out)
    assert told["kind"] == "overview"
    assert told["samples"]["many"]["scans"] == 6


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        (["one", "-o", "x.gif"], "x.gif: the name of a picture ends in .gif"),
        (["one", "-o", "x.png", "--kind", "cake"], "--kind cake: not known"),
        (["one", "-o", "x.png", "--scale", "cubic"], "--scale cubic: not known"),
        (["one", "-o", "x.png", "--incident", "40"], "not two angles"),
        (["one", "-o", "x.png", "--incident", "45,90"], "no scan of light from 45,90"),
        (["one", "-o", "x.png", "--centre", "1,2"], "--centre: has no effect on --kind points"),
        (["many", "-o", "x.png", "--kind", "points"], "name one of them"),
        (["many", "one", "-o", "x.png", "--kind", "points"], "shows one sample, not many, one"),
        (["nowhere", "-o", "x.png"], "no such file"),
        (["one", "-o", "x.png", "--clip", "5"], "--clip: has no effect on --kind points"),
        (["one", "-o", "x.png", "--kind", "cut", "--clip", "95"], "--clip 95: an angle from 0 to 90°"),
        (["one", "-o", "x.png", "--kind", "cut", "--projection", "polar"], "--projection: has no effect on --kind cut"),
        (["one", "-o", "x.png", "--kind", "cut", "--model", "m.xml"], "--model: is a picture of its own"),
        (["one", "-o", "x.png", "--model", "nowhere.xml"], "nowhere.xml: no such file"),
        (["one", "-o", "x.png", "--laboratory", "HSLU"], "choose scans of the database"),
    ],
)
def test_what_makes_no_sense_is_refused(files, tmp_path, capsys, monkeypatch, given, complaint):
    monkeypatch.chdir(tmp_path)
    named = [str(files / word) if word in ("one", "many", "nowhere") else word for word in given]
    code, out, err = run(capsys, *named)
    assert code in (1, 2)
    assert out == ""
    errors = [line for line in err.splitlines() if not line.startswith("warning: ")]
    assert len(errors) == 1
    assert errors[0].startswith("error: ")
    assert complaint in errors[0]
    assert list(tmp_path.iterdir()) == []
