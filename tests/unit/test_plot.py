"""Pictures show the numbers that the data set gives, where someone in the room would see them."""

import subprocess
import sys

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.path import Path
from mpl_toolkits.mplot3d import Axes3D

from clerestory import Basis, Bsdf, ClerestoryError, MissingDataError, Model, plot
from clerestory.bsdf import Region
from clerestory.directions import direction
from clerestory.plot import disk, style
from clerestory.plot.view import View
from registry import tree

KLEMS = Basis.named("klems-full")


def table(of):
    """A matrix from f(outgoing (n, 1, 3), travel of the incident light (1, n, 2))."""
    outgoing = KLEMS.outgoing_centres("interior")[:, None]
    travel = -KLEMS.incident_centres("exterior")[None, :, :2]
    return Model.matrix(np.broadcast_to(of(outgoing, travel), (len(KLEMS), len(KLEMS))), KLEMS)


def lobe(centre, width=0.15):
    return lambda o, t: 0.01 + np.exp(-((o[..., :2] - np.asarray(centre(t))) ** 2).sum(-1) / width)


@pytest.fixture(scope="module")
def redirecting():
    """Light from above goes up: the mirror of a light shelf. What is reflected goes to the right."""
    return Bsdf.from_models(
        {
            ("exterior", "transmission"): table(lobe(lambda t: t * [1, -1])),
            ("exterior", "reflection"): table(lobe(lambda t: [0.7, 0.0])),
        }
    )


@pytest.fixture(scope="module")
def fabric():
    return Bsdf.from_models(
        {("exterior", "transmission"): Model.sum([(1, Model.specular(0.05)), (1, Model.lambertian(0.2))])}
    )


@pytest.fixture(scope="module")
def diffuser():
    return Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.5)})


def picture(figure, axes=0):
    """The numbers of a falsecolour picture."""
    return np.ma.filled(figure.axes[axes].images[0].get_array().astype(float), np.nan)


def texts(figure):
    """Everything that is written in a figure."""
    found = [t.get_text() for t in figure.findobj(matplotlib.text.Text)]
    return "\n".join(t for t in found if t)


def pixel_angles(count, projection):
    """Polar angle and azimuth at pixel centres, and projected solid angle of pixels [sr], by the book."""
    at = (np.arange(count) + 0.5) / count * 2 - 1
    x, y = np.meshgrid(at, at)
    r = np.hypot(x, y)
    inside = r < 1
    area = (2 / count) ** 2
    if projection == "polar":
        theta = np.where(inside, r * np.pi / 2, np.nan)
        # dΩ cos θ = sin θ cos θ dθ dφ, and dx dy = r dr dφ with θ = r π/2; sinc has the limit in the middle.
        weight = area * np.sinc(theta / np.pi) * np.cos(theta) * (np.pi / 2) ** 2
    else:
        theta = np.arcsin(np.where(inside, r, np.nan))
        weight = np.where(inside, area, np.nan)
    return np.degrees(theta), np.degrees(np.arctan2(y, x)), weight


def test_importing_the_package_does_not_import_matplotlib():
    code = "import sys, clerestory; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_settings_of_matplotlib_stay(redirecting, tmp_path):
    before = dict(matplotlib.rcParams)
    plot.save(plot.hemisphere(redirecting, 41, pixels=40), tmp_path / "a.png")
    assert dict(matplotlib.rcParams) == before


def test_a_person_s_style_does_not_show(redirecting, tmp_path):
    plot.save(plot.hemisphere(redirecting, 41, pixels=40), tmp_path / "a.svg")
    with matplotlib.rc_context({"font.size": 20, "axes.facecolor": "black", "image.cmap": "jet"}):
        plot.save(plot.hemisphere(redirecting, 41, pixels=40), tmp_path / "b.svg")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


@pytest.mark.parametrize("projection", ["polar", "orthographic"])
@pytest.mark.parametrize("quantity", ["bsdf", "dsf"])
@pytest.mark.parametrize("scatter", ["transmission", "reflection"])
def test_a_hemisphere_holds_what_evaluate_gives(redirecting, projection, quantity, scatter):
    figure = plot.hemisphere(redirecting, 88, scatter=scatter, projection=projection, quantity=quantity, pixels=91)
    theta, phi, _ = pixel_angles(91, projection)
    inside = np.isfinite(theta)
    side = "interior" if scatter == "transmission" else "exterior"
    expected = redirecting.evaluate(direction(50, 90), direction(theta[inside], phi[inside], side=side))
    if quantity == "dsf":
        expected = expected * np.cos(np.radians(theta[inside]))
    shown = picture(figure)
    # A pixel centre on a patch's border may fall to either side by rounding.
    assert np.mean(np.isclose(shown[inside], expected, rtol=1e-9)) > 0.999
    assert np.isnan(shown[~inside]).all()


@pytest.mark.parametrize("projection", ["polar", "orthographic"])
def test_the_weighted_sum_of_a_picture_is_the_integral(redirecting, projection):
    shown = picture(plot.hemisphere(redirecting, 41, projection=projection, pixels=401))
    _, _, weight = pixel_angles(401, projection)
    expected = redirecting.integrate(direction(30, 90), "transmission")
    assert np.nansum(shown * weight) == pytest.approx(expected, rel=0.01)


def test_light_that_is_sent_up_is_in_the_upper_half(redirecting):
    shown = picture(plot.hemisphere(redirecting, 88, pixels=100))
    row, column = np.unravel_index(np.nanargmax(shown), shown.shape)
    # Rows run upward: the first is the lowest.
    assert row > 60
    assert 40 < column < 60
    assert plot.hemisphere(redirecting, 88, pixels=100).axes[0].images[0].origin == "lower"


def test_right_is_right_outdoors_too(redirecting):
    figure = plot.hemisphere(redirecting, 88, scatter="reflection", pixels=100)
    shown = picture(figure)
    row, column = np.unravel_index(np.nanargmax(shown), shown.shape)
    assert column > 65
    assert 40 < row < 60
    assert "leaving to the exterior, as seen from the room" in texts(figure)
    where = {t.get_text(): t.get_position() for t in figure.axes[0].texts}
    assert where["right"][0] > 1
    assert where["left"][0] < -1
    assert where["up"][1] > 1
    assert where["down"][1] < -1


def test_a_hemisphere_says_what_it_shows(redirecting):
    figure = plot.hemisphere(redirecting, 41, label="LBNL 2021", quantity="dsf", pixels=40)
    words = texts(figure)
    total = float(redirecting.integrate(direction(30, 90), "transmission"))
    for part in [
        "LBNL 2021",
        "visible transmission, light from the exterior",
        "from above, 30° (Klems 41)",
        f"= {total:.3g}",
        "DSF = BSDF·cos θ [1/sr]",
        "straight through: downward, 30°",
        "leaving to the interior, as seen from the room",
        "45°",
    ]:
        assert part in words


def test_reciprocity_is_named(redirecting):
    figure = plot.hemisphere(redirecting, 1, side="interior", pixels=40)
    assert "light from the interior (by reciprocity)" in texts(figure)


def test_the_cross_is_where_light_goes_straight_on(redirecting):
    ax = plot.hemisphere(redirecting, direction(45, 90), pixels=40).axes[0]
    (mark,) = (m for m in ax.lines if isinstance(m.get_marker(), Path) and m.get_linestyle() == "None")
    assert mark.get_xydata() == pytest.approx(np.array([[0.0, -0.5]]), abs=1e-12)


def test_peaks_are_marked_with_their_value_and_not_coloured(fabric):
    figure = plot.hemisphere(fabric, direction(45, 0), pixels=60)
    shown = picture(figure)
    assert np.nanmax(shown) == pytest.approx(0.2 / np.pi)
    (mark,) = (m for m in figure.axes[0].lines if m.get_marker() == "o")
    assert mark.get_xydata() == pytest.approx(np.array([[-0.5, 0.0]]), abs=1e-12)
    assert "peak 0.05: to the left, 45°" in texts(figure)


def test_regions_are_outlined_and_integrated(redirecting):
    cone = Region.cone(direction(50, 90, side="interior"), 15)
    ring = Region.ring(direction(50, 90, side="interior"), 15, 40)
    patches = Region.patches(KLEMS, range(100, 110))
    figure = plot.hemisphere(redirecting, 88, regions=[cone, ring, patches], pixels=40)
    words = texts(figure)
    assert "within 15° of upward, 50°: " in words
    for region in (cone, ring, patches):
        value = float(redirecting.integrate(direction(50, 90), "transmission", region))
        assert f": {value:.3g}" in words
    border = np.concatenate([p.vertices for p in figure.axes[0].collections[0].get_paths()])
    theta, phi = np.hypot(*border.T) * 90, np.degrees(np.arctan2(border[:, 1], border[:, 0]))
    away = np.degrees(np.arccos(direction(theta, phi, side="interior") @ direction(50, 90, side="interior")))
    assert away == pytest.approx(15, abs=0.2)


def test_what_is_missing_is_refused_alone_and_hatched_among_others(redirecting, diffuser):
    with pytest.raises(MissingDataError, match="reflection"):
        plot.hemisphere(diffuser, 1, scatter="reflection")
    figure = plot.hemisphere_grid({"A": redirecting, "B": diffuser}, [1, 41], scatter="reflection", pixels=40)
    panels = {ax.get_label(): ax for ax in figure.axes}
    blank = [ax for name, ax in panels.items() if name.startswith("B|")]
    assert len(blank) == 2
    for ax in blank:
        assert not ax.images
        assert "no data" in [t.get_text() for t in ax.texts]
        assert ax.patches[0].get_hatch()


def test_a_grid_has_one_scale_for_all(redirecting, fabric, diffuser):
    sets = {"Lucerne": redirecting, "Freiburg": fabric, "Berkeley": diffuser}
    figure = plot.hemisphere_grid(sets, pixels=41)
    images = [ax.images[0] for ax in figure.axes if ax.images]
    assert len(images) == 12
    assert len({image.get_clim() for image in images}) == 1
    highest = max(np.nanmax(np.ma.filled(image.get_array().astype(float), np.nan)) for image in images)
    assert images[0].get_clim()[1] == pytest.approx(highest)
    words = texts(figure)
    for part in [*sets, "(Klems 88)", "from above, 70°", "BSDF [1/sr]", "= 0.25"]:
        assert part in words


def test_twenty_sets_fit(diffuser):
    sets = {f"laboratory {k}": diffuser for k in range(20)}
    figure = plot.hemisphere_grid(sets, pixels=11)
    boxes = [ax.get_position() for ax in figure.axes if ax.images]
    assert len(boxes) == 80
    assert min(b.x0 for b in boxes) >= 0
    assert max(b.x1 for b in boxes) <= 1
    assert min(b.y0 for b in boxes) > 0
    assert max(b.y1 for b in boxes) < 1
    corners = {(round(b.x0, 4), round(b.y0, 4)) for b in boxes}
    assert len(corners) == 80


def test_bars_stand_as_high_as_the_values():
    values = {
        "HSLU": {"T_h-h": 0.1, "T_d-h\n30°": 0.2},
        "FH-ISE": {"T_h-h": 0.15, "T_d-h\n30°": float("nan"), "T_d-d\n30°": 0.01},
    }
    figure = plot.transmittance_bars(values, title="ARB 80")
    ax = figure.axes[0]
    first, second = (c for c in ax.containers if c.get_label() in values)
    assert [bar.get_height() for bar in first] == [0.1, 0.2]
    assert [bar.get_height() for bar in second] == [0.15, 0.01]
    # One missing value of each set: a hatched stub, not a zero.
    assert sum(bar.get_hatch() == "////" and bar.get_facecolor()[0] > 0.85 for bar in ax.patches) == 2
    assert "ARB 80" in texts(figure)
    assert "HSLU" in texts(figure)


@pytest.mark.parametrize(("suffix", "magic"), [(".png", b"\x89PNG"), (".pdf", b"%PDF"), (".svg", b"<?xml")])
def test_files_are_valid_and_the_same_each_time(fabric, tmp_path, suffix, magic):
    for name in "ab":
        figure = plot.hemisphere(fabric, 41, regions=[Region.cone(direction(0, 0, side="interior"), 20)], pixels=60)
        plot.save(figure, tmp_path / (name + suffix))
    first, second = ((tmp_path / (name + suffix)).read_bytes() for name in "ab")
    assert first == second
    assert first.startswith(magic)
    assert b"20" + b"26-" not in first
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a" + suffix, "b" + suffix]


def test_unknown_suffixes_are_refused(fabric, tmp_path):
    figure = plot.hemisphere(fabric, 1, pixels=20)
    for name in ("a.gif", "a"):
        with pytest.raises(ClerestoryError, match=r"\.png, \.pdf or \.svg"):
            plot.save(figure, tmp_path / name)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ({"incident": 146}, "1 to 145"),
        ({"incident": [0.0, 0.0]}, "not an incident direction"),
        ({"incident": direction(30, 90), "side": "interior"}, "comes from the exterior"),
        ({"incident": 1, "scale": "square"}, "log or linear"),
        ({"incident": 1, "quantity": "flux"}, "bsdf or dsf"),
        ({"incident": 1, "projection": "fisheye"}, "polar or orthographic"),
        ({"incident": 1, "limits": (0.0, 1.0)}, "above 0"),
    ],
)
def test_bad_arguments_end_in_one_line(fabric, arguments, complaint):
    with pytest.raises(ClerestoryError, match=complaint) as caught:
        plot.hemisphere(fabric, **arguments, pixels=20)
    assert "\n" not in str(caught.value)


def test_the_disk_puts_directions_where_they_belong():
    for side in ("interior", "exterior"):
        assert disk.project(direction(90, 90, side=side), "polar") == pytest.approx([0, 1])
        assert disk.project(direction(45, 180, side=side), "polar") == pytest.approx([-0.5, 0])
        assert disk.project(direction(30, 0, side=side), "orthographic") == pytest.approx([0.5, 0])
        assert disk.project(direction(0, 0, side=side), "polar") == pytest.approx([0, 0])


def test_zero_on_a_logarithmic_scale_is_dark_and_not_missing(diffuser):
    values = np.zeros((len(KLEMS), len(KLEMS)))
    values[0] = 2.0
    bsdf = Bsdf.from_models({("exterior", "transmission"): Model.matrix(values, KLEMS)})
    figure = plot.hemisphere(bsdf, 1, pixels=60)
    image = figure.axes[0].images[0]
    colours = image.to_rgba(image.get_array())
    assert colours[10, 30] == pytest.approx(style.colours().get_under())
    assert colours[30, 30] == pytest.approx(style.colours()(1.0))
    assert colours[0, 0, 3] == 0.0
    dark = plot.hemisphere(Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.0)}), 1, pixels=20)
    assert "= 0" in texts(dark)


def written(axes):
    """Numbers written into patches, by place."""
    return {t.get_text(): np.array(t.get_position()) for t in axes.texts}


def test_patches_hold_means_and_numbers_stand_in_them(redirecting):
    figure = plot.patches(redirecting, 88, show="number")
    shown = np.asarray(figure.axes[0].collections[0].get_array())
    model, _ = redirecting.model("exterior", "transmission")
    assert shown == pytest.approx(model.values[:, 87])
    assert np.sum(shown * KLEMS.projected_solid_angles) == pytest.approx(
        float(redirecting.integrate(direction(50, 90), "transmission"))
    )
    places = written(figure.axes[0])
    for number in range(1, 146):
        x, y = places[f"{number}"]
        theta, phi = np.hypot(x, y) * 90, np.degrees(np.arctan2(y, x))
        assert KLEMS.index_of_outgoing(direction(theta, phi, side="interior")) == number - 1
        path = figure.axes[0].collections[0].get_paths()[number - 1]
        assert path.contains_point((x, y))


def test_peaks_count_in_patches(fabric):
    shown = np.asarray(plot.patches(fabric, 41).axes[0].collections[0].get_array())
    expected = np.full(len(KLEMS), 0.2 / np.pi)
    expected[40] += 0.05 / KLEMS.projected_solid_angles[40]
    assert shown == pytest.approx(expected, rel=1e-6)
    flux = plot.patches(fabric, 41, quantity="dsf").axes[0].collections[0].get_array() * KLEMS.solid_angles
    assert flux.sum() == pytest.approx(0.25, rel=1e-6)


@pytest.mark.parametrize("name", ["klems-full", "klems-half", "klems-quarter", "tregenza"])
@pytest.mark.parametrize("show", ["number", "both"])
def test_words_in_patches_do_not_leave_them(redirecting, name, show):
    basis = Basis.named(name)
    figure = plot.patches(redirecting, 41, basis=basis, show=show)
    figure.draw_without_rendering()
    ax = figure.axes[0]
    paths = ax.collections[0].get_paths()
    words = [t for t in ax.texts if t.get_text().split("\n")[0].isdigit()]
    assert len(words) == len(basis)
    for t in words:
        box = t.get_window_extent().transformed(ax.transData.inverted())
        corners = [(x, y) for x in (box.x0, box.x1) for y in (box.y0, box.y1)]
        inside = sum(paths[int(t.get_text().split("\n")[0]) - 1].contains_point(c) for c in corners)
        assert inside >= 3, t.get_text()
        assert t.get_fontsize() >= 4


def test_bare_bases_show_where_light_comes_from_or_goes():
    for of, sign in (("outgoing", -1), ("incident", 1)):
        figure = plot.basis_patches(KLEMS, of=of, marked=[41, 88])
        places = written(figure.axes[0])
        # Patch 41 is a sun 30° above, whose light goes down.
        assert places["41"] == pytest.approx([0, sign / 3], abs=0.01)
        colours = figure.axes[0].collections[0].get_facecolor()
        assert {i for i, c in enumerate(colours) if c[0] < 0.95} == {40, 87}
    with pytest.raises(ClerestoryError, match="1 to 145"):
        plot.basis_patches(KLEMS, marked=[146])


def test_slices_are_cuts_along_the_light_s_way(redirecting, diffuser):
    figure = plot.slices({"A": redirecting, "B": diffuser}, 88)
    first, second = figure.axes[0].lines[:2]
    alpha, values = first.get_data()
    assert (alpha[0], alpha[-1]) == (-90, 90)
    # A sun above: positive angles go down.
    off = np.abs(np.abs(alpha) % 10 - 5) > 0.2
    phi = np.where(alpha > 0, 270, 90)
    expected = redirecting.evaluate(direction(50, 90), direction(np.abs(alpha), phi, side="interior"))
    assert values[off][1:-1] == pytest.approx(expected[off][1:-1])
    assert second.get_ydata() == pytest.approx(0.5 / np.pi)
    assert alpha[np.argmax(values)] < -40
    words = texts(figure)
    for part in [
        "A",
        "B",
        "90\ndownward",
        "−90\nupward",
        "BSDF [1/sr]",
        "from above, 50° (Klems 88)",
        "to the interior",
    ]:
        assert part in words


def test_slices_show_peaks_as_stems_and_say_what_is_missing(fabric, redirecting):
    figure = plot.slices({"fabric": fabric, "other": redirecting}, direction(40, 0))
    words = texts(figure)
    assert "fabric: peak 0.05 at 40°" in words
    assert "transmittance of a peak" in words
    stem = figure.axes[1].collections[0].get_segments()[0]
    assert stem == pytest.approx(np.array([[40, 0], [40, 0.05]]))
    assert "left" in words
    figure = plot.slices({"fabric": fabric, "other": redirecting}, [1, 41], scatter="reflection")
    assert "fabric (no data)" in texts(figure)


def test_lines_are_distinct_for_twenty_sets():
    looks = [str(sorted(style.line(n).items())) for n in range(20)]
    assert len(set(looks)) == 20
    assert all(style.line(n)["linestyle"] != style.line(n + 1)["linestyle"] for n in range(20))


@pytest.mark.parametrize(("theta", "phi"), [(0, 0), (30, 90), (50, 200), (80, 270)])
@pytest.mark.parametrize("scatter", ["transmission", "reflection"])
def test_a_close_up_keeps_angles_and_directions(redirecting, theta, phi, scatter):
    incident = direction(theta, phi)
    figure = plot.close_up(redirecting, incident, half_width_deg=8, step_arcmin=30, scatter=scatter)
    shown = picture(figure)
    assert shown.shape == (32, 32)
    side = "interior" if scatter == "transmission" else "exterior"
    middle = direction(theta, phi + 180, side=side)
    # By the book: great circles from the centre, found by rotating it about axes across the way.
    offsets = (np.arange(32) - 15.5) * 0.5
    for row, column in [(0, 0), (3, 29), (20, 11), (31, 16)]:
        u, v = np.radians(offsets[column]), np.radians(offsets[row])
        up = np.array([0, 1, 0]) - middle[1] * middle
        up /= np.linalg.norm(up)
        right = np.cross(up, middle)
        right *= np.sign(right @ [1, 0, 0])
        angle = np.hypot(u, v)
        target = np.cos(angle) * middle + np.sin(angle) / angle * (u * right + v * up)
        beyond = (target[2] > 0) != (side == "interior")
        expected = np.nan if beyond else float(redirecting.evaluate(incident, target))
        assert shown[row, column] == pytest.approx(expected, nan_ok=True)
    assert "cells of 30'" in texts(figure)
    assert "linear" in texts(figure)
    assert "logarithmic" in texts(figure)


def test_a_close_up_finds_the_peak(fabric):
    figure = plot.close_up(fabric, direction(40, 0), scale="log")
    assert "peak 0.05: to the left, 40°" in texts(figure)
    rings = [m for m in figure.axes[0].lines if m.get_marker() == "o"]
    assert rings[0].get_xydata() == pytest.approx(np.zeros((1, 2)), abs=1e-9)
    with pytest.raises(ClerestoryError, match="not on the interior"):
        plot.close_up(fabric, 1, centre=direction(0, 0))
    with pytest.raises(ClerestoryError, match="steps that make 2 to 2000"):
        plot.close_up(fabric, 1, half_width_deg=0)


@pytest.fixture
def meshes(monkeypatch):
    """Corners (n, m, 3) of the surfaces that are drawn, in matplotlib's axes."""
    drawn = []
    draw = Axes3D.plot_surface

    def record(self, x, y, z, **kwargs):
        drawn.append(np.stack([x, y, z], axis=-1))
        return draw(self, x, y, z, **kwargs)

    monkeypatch.setattr(Axes3D, "plot_surface", record)
    return drawn


def test_solids_are_long_where_the_light_goes(redirecting, meshes):
    plot.photometric_solid(redirecting, 88, step_deg=3.6)
    (corners,) = meshes
    # Matplotlib's third axis is up, its second one points out of the room.
    ours = np.stack([corners[..., 0], corners[..., 2], -corners[..., 1]], axis=-1)
    radius = np.linalg.norm(ours, axis=-1)
    farthest = ours[np.unravel_index(np.argmax(radius), radius.shape)]
    assert np.max(radius) == pytest.approx(1.0)
    assert farthest[1] > 0.3
    assert farthest[2] > 0.3
    some = radius > 0.05
    way = ours[some] / radius[some][:, None]
    expected = redirecting.evaluate(direction(50, 90), way) * way[:, 2]
    assert radius[some] == pytest.approx(expected / np.max(expected), rel=1e-6)
    # Closed all around.
    assert corners[:, 0] == pytest.approx(corners[:, -1], abs=0)


def test_solids_point_outdoors_for_reflection(redirecting, meshes):
    figure = plot.photometric_solid(redirecting, 88, scatter="reflection", step_deg=5)
    corners = meshes[0].reshape(-1, 3)
    farthest = corners[np.argmax(np.linalg.norm(corners, axis=-1))]
    assert farthest[0] > 0.3
    assert farthest[1] > 0.3
    assert "seen from outdoors" in texts(figure)


@pytest.mark.parametrize("scale", ["log", "linear"])
def test_mountains_are_as_high_as_the_bsdf(redirecting, scale, meshes):
    plot.mountain(redirecting, 88, scale=scale, step_deg=5)
    x, y, height = meshes[0].reshape(-1, 3).T
    assert y[np.argmax(height)] > 0.5
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 1e-12))
    expected = redirecting.evaluate(direction(50, 90), np.stack([x, y, z], axis=-1))
    shown = 10**height if scale == "log" else height
    assert shown == pytest.approx(expected, rel=1e-6)


def test_solids_and_mountains_name_peaks(fabric):
    for kind in (plot.photometric_solid, plot.mountain):
        words = texts(kind(fabric, direction(40, 0), step_deg=10))
        assert "peak 0.05: to the left, 40°" in words
        assert "straight through: to the left, 40°" in words


@pytest.mark.parametrize("side", ["exterior", "interior"])
def test_maps_of_transmittance_stand_where_light_comes_from(side):
    # Only light from above passes: it travels downward.
    bsdf = Bsdf.from_models(
        {(side, "transmission"): table(lambda o, t: np.where(t[..., 1] < -0.2, 0.3, 0.0) + 0 * o[..., 0])}
    )
    figure = plot.transmittance_map(bsdf, side=side, pixels=81)
    shown = picture(figure)
    theta, phi, _ = pixel_angles(81, "polar")
    inside = np.isfinite(theta)
    expected = bsdf.integrate(direction(theta[inside], phi[inside], side=side), "transmission")
    assert np.mean(np.isclose(shown[inside], expected)) > 0.999
    assert np.nanmean(shown[60:]) > 0.5
    assert np.nanmean(shown[:20]) == 0.0
    for part in ["from above", "incident directions, as seen from the room", f"light from the {side}"]:
        assert part in texts(figure)


def test_a_map_of_differences_is_even_about_zero(redirecting, diffuser):
    figure = plot.transmittance_map(diffuser, minus=redirecting, label="B", minus_label="A", pixels=41)
    theta, phi, _ = pixel_angles(41, "polar")
    inside = np.isfinite(theta)
    suns = direction(theta[inside], phi[inside])
    expected = 0.5 - redirecting.integrate(suns, "transmission")
    assert np.mean(np.isclose(picture(figure)[inside], expected)) > 0.999
    low, high = figure.axes[0].images[0].get_clim()
    assert low == -high
    assert "B − A" in texts(figure)


KINDS = {
    "patches": lambda b, ax: plot.patches(b, 41, ax=ax),
    "slices": lambda b, ax: plot.slices({"A": b, "B": b}, 41, ax=ax),
    "close_up": lambda b, ax: plot.close_up(b, 41, ax=ax),
    "photometric_solid": lambda b, ax: plot.photometric_solid(b, 41, step_deg=5, ax=ax),
    "mountain": lambda b, ax: plot.mountain(b, 41, step_deg=5, ax=ax),
    "transmittance_map": lambda b, ax: plot.transmittance_map(b, pixels=50, ax=ax),
    "hemisphere": lambda b, ax: plot.hemisphere(b, 41, pixels=50, ax=ax),
    "transmittance_bars": lambda b, ax: plot.transmittance_bars({"A": {"T_h-h": 0.1}}, ax=ax),
    "hemisphere_grid": lambda b, ax: plot.hemisphere_grid({"A": b}, pixels=30),
    "basis_patches": lambda b, ax: plot.basis_patches(KLEMS, ax=ax),
}


@pytest.mark.parametrize("kind", [k for k in KINDS if k != "hemisphere"])
def test_every_kind_gives_the_same_file_each_time(fabric, tmp_path, kind):
    for name in "ab":
        plot.save(KINDS[kind](fabric, None), tmp_path / f"{name}.svg", dpi=40)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


@pytest.mark.parametrize("kind", [k for k in KINDS if k != "hemisphere_grid"])
def test_every_kind_draws_on_axes_that_it_is_given(fabric, kind):
    solid = kind in ("photometric_solid", "mountain")
    figure = Figure(figsize=(12, 5))
    FigureCanvasAgg(figure)
    figure.add_subplot(1, 2, 1)
    ax = figure.add_subplot(1, 2, 2, projection="3d" if solid else None)
    assert KINDS[kind](fabric, ax) is figure
    assert ax.has_data() or ax.collections
    figure.canvas.draw()


def is_whole(figure):
    """Whether everything that is drawn lies within the figure."""
    figure.draw_without_rendering()
    width, height = figure.get_size_inches()
    box = figure.get_tightbbox()
    return min(box.x0, box.y0) > -0.01 and box.x1 < width + 0.01 and box.y1 < height + 0.01


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_that_is_drawn_is_cut_off(fabric, kind):
    assert is_whole(KINDS[kind](fabric, None))


def test_long_names_and_many_sets_have_room(redirecting, fabric):
    name = "a laboratory whose name is longer than the picture is wide, with the year of its second campaign"
    many = {f"laboratory for daylight {k}": fabric for k in range(20)}
    assert is_whole(plot.hemisphere(fabric, 41, label=name, pixels=40))
    assert is_whole(plot.transmittance_map(fabric, minus=redirecting, label=name, minus_label=name, pixels=40))
    assert is_whole(plot.slices(many, 41, step_deg=1))
    assert is_whole(plot.slices(many, [1, 41], step_deg=1))
    assert is_whole(plot.transmittance_bars({name: {"T_h-h": 0.2} for name in many}))
    assert is_whole(plot.hemisphere_grid({name: fabric}, 41, pixels=20))


def test_colour_bars_point_down_only_where_something_is_darker(fabric, redirecting):
    for sets, expected in (({"A": fabric}, "neither"), ({"A": redirecting}, "neither")):
        figure = plot.hemisphere_grid(sets, 41, pixels=20)
        assert [ax._colorbar.extend for ax in figure.axes if hasattr(ax, "_colorbar")] == [expected]
    dark = Bsdf.from_models({("exterior", "transmission"): Model.matrix(np.eye(len(KLEMS)), KLEMS)})
    figure = plot.hemisphere_grid({"A": dark}, 41, pixels=20)
    assert [ax._colorbar.extend for ax in figure.axes if hasattr(ax, "_colorbar")] == ["min"]


def test_transmittances_are_those_of_the_report(redirecting, fabric, diffuser):
    sets = {
        "matrix": redirecting,
        "fabric": fabric,
        "none": Bsdf.from_models({("exterior", "reflection"): table(lobe(lambda t: t))}),
    }
    rows = plot.transmittances(sets, [1, 88])
    model, _ = redirecting.model("exterior", "transmission")
    areas = KLEMS.projected_solid_angles
    matrix = rows["matrix"]
    assert list(matrix) == ["T_h-h", "T_d-h\n0° (1)", "T_d-h\n50° (88)", "T_d-d\n0° (1)", "T_d-d\n50° (88)"]
    assert matrix["T_h-h"] == pytest.approx(areas @ model.values @ areas / np.pi)
    assert matrix["T_d-h\n50° (88)"] == pytest.approx(areas @ model.values[:, 87])
    assert matrix["T_d-d\n50° (88)"] == pytest.approx(areas[87] * model.values[87, 87])
    # A peak stays in its patch; of the diffuse light the patch's share is there too.
    assert rows["fabric"]["T_d-d\n50° (88)"] == pytest.approx(0.05 + 0.2 * areas[87] / np.pi, rel=1e-6)
    assert rows["fabric"]["T_h-h"] == pytest.approx(0.25, rel=1e-6)
    assert all(np.isnan(v) for v in rows["none"].values())


def test_totals_are_patch_means_where_a_patch_is_named_and_the_labels_say_so():
    sets = tree(3, 4)
    for patch in (1, 88, 145):
        by_patch = View.of(sets, patch)
        spread = KLEMS.sample_incident(patch - 1, np.random.default_rng(1).random((2000, 2)), "exterior")
        values = sets.integrate(spread, "transmission")
        assert by_patch.total() == pytest.approx(values.mean(), abs=0.4 * np.std(values) + 1e-9)
        (bar,) = (v for k, v in plot.transmittances(sets, [patch])[""].items() if k.startswith("T_d-h"))
        assert by_patch.total() == pytest.approx(bar)
        assert "(patch mean)" in by_patch.title
        centre = KLEMS.incident_centres("exterior")[patch - 1]
        by_direction = View.of(sets, centre)
        assert by_direction.total() == float(sets.integrate(centre, "transmission"))
        assert "(this direction)" in by_direction.title
