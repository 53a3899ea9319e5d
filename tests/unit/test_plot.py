"""Pictures show the numbers that the data set gives, where someone in the room would see them."""

import subprocess
import sys

import matplotlib
import numpy as np
import pytest

from clerestory import Basis, Bsdf, ClerestoryError, MissingDataError, Model, plot
from clerestory.bsdf import Region
from clerestory.directions import direction
from clerestory.plot import disk

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
    (mark,) = (m for m in ax.lines if m.get_marker() == "x")
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
