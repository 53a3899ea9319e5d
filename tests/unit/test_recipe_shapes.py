"""Shapes that recipes make: right sizes, closed outlines, fronts outside."""

import math
from itertools import pairwise

import numpy as np
import pytest

from clerestory import trace
from clerestory.trace import RecipeError
from clerestory.trace.bands import Bands
from clerestory.trace.kinds.blind import Louvre, Slat, VenetianBlind
from clerestory.trace.kinds.film import PrismaticFilm, Profile
from clerestory.trace.kinds.panel import Honeycomb, LaserCutPanel, LightShelf, Pane
from clerestory.trace.kinds.scan import read_scan, simplified
from clerestory.trace.kinds.screen import ExpandedMetal, PerforatedScreen
from clerestory.trace.kinds.weave import _PATTERNS, WovenFabric
from clerestory.trace.materials import Spec
from clerestory.trace.workshop import SMOOTH, Workshop


@pytest.fixture
def shop(tmp_path):
    specs = {"m": Spec("black", {}), "n": Spec("black", {}), SMOOTH: Spec("interface", {}, opaque=False)}
    return Workshop(tmp_path, specs, {"air": {}, "acrylic": {}}, Bands())


def outlines(pieces):
    """Pieces that follow each other, as broken lines."""
    lines, end = [], None
    for piece in pieces:
        points = piece.points(math.radians(0.2))
        if piece.turn == 0.0:
            points = points[0] + np.linspace(0.0, 1.0, 401)[:, None] * (points[1] - points[0])
        if end is not None and math.dist(end, points[0]) < 1e-12:
            lines[-1] = np.vstack([lines[-1], points[1:]])
        else:
            lines.append(points)
        end = tuple(points[-1])
    return lines


def area(line):
    """Area within a closed line (z, y), positive if it runs counter-clockwise."""
    z, y = line.T
    return 0.5 * float(np.sum(z[:-1] * y[1:] - z[1:] * y[:-1]))


@pytest.mark.parametrize("crown", [0.0, 9.0, -9.0, 40.0])
@pytest.mark.parametrize("thickness", [0.0, 0.5])
@pytest.mark.parametrize("bead", [0.0, 4.0])
def test_slats_have_their_width_and_crown(crown, thickness, bead, shop):
    slat = Slat(width_mm=80, crown_mm=crown, thickness_mm=thickness, bead_mm=bead, upper="m", lower="n")
    lines = outlines(slat.pieces(shop, "slat"))
    points = np.concatenate(lines) * 1000.0
    if abs(crown) < 30:
        edge = 0.5 * thickness * math.sin(2 * math.atan(2 * abs(crown) / 80)) if bead == 0.0 else 0.0
        assert np.ptp(points[:, 0]) == pytest.approx(80.0 + 2 * edge, abs=2e-3)
    middle = points[np.abs(points[:, 0]) < 0.2, 1]
    assert middle.max() == pytest.approx(crown + 0.5 * thickness, abs=1e-3)
    assert middle.min() == pytest.approx(crown - 0.5 * thickness, abs=1e-3)
    closed = [line for line in lines if math.dist(line[0], line[-1]) < 1e-12]
    # Without thickness the inner bead continues the slat's line; the outer one stands alone.
    assert len(closed) == (1 if thickness or bead else 0)
    assert all(area(line) < 0.0 for line in closed), "fronts are outside"
    if thickness and not bead and crown == 9.0:
        half = 2 * math.atan(2 * crown / 80)
        arc = 80 / math.sin(half) * half
        assert -area(closed[0]) * 1e6 == pytest.approx(arc * thickness, rel=1e-4)


def test_a_positive_tilt_hangs_the_outer_edge_down(shop):
    slat = {"width_mm": 80, "upper": "m", "lower": "n"}
    blind = VenetianBlind(kind="venetian-blind", pitch_mm=72, tilt_deg=30, slat=slat)
    (section,) = blind.shapes(shop, "sample")
    (piece,) = section.pieces
    assert section.period == 0.072
    assert piece.start == pytest.approx((-0.04 * math.cos(math.pi / 6), -0.02))
    # The front, on the left of the way into the room, is the upper side.
    assert (piece.face.front, piece.face.back) == ("m", "n")


@pytest.mark.parametrize("shape", ["plate", "lens"])
def test_louvres_are_closed(shape, shop):
    louvre = Louvre(kind="louvre", pitch_mm=150, depth_mm=180, thickness_mm=30, shape=shape, tilt_deg=45, upper="m")
    (section,) = louvre.shapes(shop, "sample")
    (line,) = outlines(section.pieces)
    assert line[0] == pytest.approx(line[-1], abs=1e-12)
    whole = 180 * 30 if shape == "plate" else None
    if whole:
        assert -area(line) * 1e6 == pytest.approx(whole)
    else:
        assert 2 / 3 * 180 * 30 < -area(line) * 1e6 < 0.7 * 180 * 30


def crossings(section, y, z):
    """Medium at a place, by the borders that a level line from the exterior crosses."""
    found = []
    for k in range(-3, 4):
        for piece in section.pieces:
            (z0, y0), (z1, y1) = piece.start, piece.end
            y0, y1 = y0 + k * section.period, y1 + k * section.period
            if (y0 <= y) != (y1 <= y) and z0 + (y - y0) / (y1 - y0) * (z1 - z0) < z:
                at = z0 + (y - y0) / (y1 - y0) * (z1 - z0)
                found.append((at, piece.face.behind if y1 > y0 else piece.face.before))
    media = ["air", *(medium for _, medium in sorted(found))]
    assert all(a != b for a, b in pairwise(media)), "a border that is crossed twice the same way"
    return media[-1]


@pytest.mark.parametrize(
    ("model", "inside", "outside"),
    [
        (
            PrismaticFilm(
                kind="prismatic-film",
                pitch_um=50,
                lower_facet_deg=45,
                upper_facet_deg=45,
                base_um=100,
                medium="acrylic",
            ),
            [(1e-6, 1e-6), (120e-6, 25e-6)],
            [(-1e-6, 0), (120e-6, 1e-6), (126e-6, 25e-6)],
        ),
        (
            PrismaticFilm(
                kind="prismatic-film",
                pitch_um=50,
                points_um=[[0, 0], [40, 20], [50, 0]],
                base_um=100,
                grooves="exterior",
                medium="acrylic",
            ),
            [(-1e-6, 1e-6), (-119e-6, 40e-6)],
            [(1e-6, 0), (-119e-6, 10e-6)],
        ),
        (
            LaserCutPanel(kind="laser-cut-panel", thickness_mm=6, pitch_mm=4, cut_mm=0.4, medium="acrylic"),
            [(3e-3, 1e-3), (3e-3, 2e-3)],
            [(3e-3, 1e-4), (7e-3, 2e-3), (-1e-3, 2e-3)],
        ),
        (
            LaserCutPanel(
                kind="laser-cut-panel",
                thickness_mm=6,
                pitch_mm=4,
                cut_mm=0.4,
                cut_depth_mm=3,
                tilt_deg=10,
                medium="acrylic",
            ),
            [(5e-3, 1e-4), (1e-3, 2e-3)],
            [(1e-3, 1e-3 * math.tan(math.radians(10)))],
        ),
        (Pane(kind="pane", thickness_mm=4, medium="acrylic"), [(1e-3, 0.3)], [(-1e-3, 0.3), (5e-3, 0.3)]),
    ],
)
def test_bodies_are_where_they_belong(model, inside, outside, shop):
    (section,) = model.shapes(shop, "sample")
    assert [crossings(section, y, z) for z, y in inside] == ["acrylic"] * len(inside)
    assert [crossings(section, y, z) for z, y in outside] == ["air"] * len(outside)
    assert crossings(section, 1e-7, 1.0) == "air"


def test_a_honeycomb_encloses_its_cells(shop):
    cell = {"kind": "honeycomb", "pitch_mm": 20, "depth_mm": 30, "joint_mm": 8, "exterior": "m", "interior": "n"}
    for sag in (0, 20):
        (section,) = Honeycomb(**cell, sag_deg=sag).shapes(shop, "sample")
        low, high = section.depth()
        assert (low, high) == pytest.approx((-0.015, 0.015), abs=1e-3 if sag else 1e-12)
        outer = [p for p in section.pieces if p.face.front == "m" and p.start[1] != p.end[1]]
        assert len(outer) == 2
        assert all(p.start[0] < 0 for p in outer)


def test_a_light_shelf_reaches_to_both_sides(shop):
    shelf = LightShelf(kind="light-shelf", pitch_mm=2800, exterior_mm=600, interior_mm=400, thickness_mm=40, upper="m")
    (section,) = shelf.shapes(shop, "sample")
    assert section.depth() == pytest.approx((-0.6, 0.4))
    (line,) = outlines(section.pieces)
    assert -area(line) == pytest.approx(1.0 * 0.04)


def test_a_section_of_ones_own_has_exact_arcs(shop):
    profile = Profile(
        kind="profile",
        pitch_mm=10,
        outlines=[{"points_mm": [[0, 0], [4, 0, 180]], "closed": True, "front": "m"}],
    )
    (section,) = profile.shapes(shop, "sample")
    points = np.concatenate([p.points() for p in section.pieces])
    # Turning left on the way to the right goes below.
    assert points[:, 1].min() == pytest.approx(-0.002, abs=1e-5)
    assert np.hypot(points[:, 0] - 0.002, points[:, 1]).max() == pytest.approx(0.002, abs=1e-9)


def volume(mesh):
    a, b, c = (mesh.corners[mesh.triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def is_closed(mesh):
    """Every edge but those at the ends of a period has two triangles, which run along it in opposite ways."""
    cells = 10**7
    scaled = mesh.corners / np.array([*mesh.periods, mesh.periods[0]])
    wrapped = np.round(scaled * cells).astype(int) % np.array([cells, cells, 10**12])
    _, corner = np.unique(wrapped, axis=0, return_inverse=True)
    triangles = corner.reshape(-1)[mesh.triangles]
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    there, back = (np.sort(e[:, 0] * len(wrapped) + e[:, 1]) for e in (edges, edges[:, ::-1]))
    return np.array_equal(there, back)


YARN = {"per_cm": 20, "thickness_mm": 0.3, "material": "m"}


@pytest.mark.parametrize("weave", sorted(_PATTERNS))
@pytest.mark.parametrize("crimp", ["sine", "arc"])
def test_yarns_are_closed_tubes_of_the_right_thickness(weave, crimp, shop):
    fabric = WovenFabric(kind="woven-fabric", weave=weave, warp=YARN, weft=YARN, openness=0.1, crimp=crimp)
    (mesh,) = fabric.shapes(shop, "sample")
    assert is_closed(mesh)
    assert mesh.depth() == pytest.approx((-0.3e-3, 0.3e-3), rel=1e-9)
    counts = np.array([[c == "1" for c in row] for row in _PATTERNS[weave]])
    assert mesh.periods == pytest.approx((0.5e-3 * counts.shape[0], 0.5e-3 * counts.shape[1]))
    # Fronts are outside: the tubes, open at the ends of the period, have a volume above 0.
    assert volume(mesh) > 0.0
    # Each yarn of a weave passes over and under.
    assert (counts.any(axis=0) & ~counts.all(axis=0)).all()
    assert (counts.any(axis=1) & ~counts.all(axis=1)).all()


def test_openness_is_solved_for():
    both = WovenFabric(kind="woven-fabric", weave="plain", warp=YARN, weft={**YARN, "per_cm": 10}, openness=0.04)
    assert both.widths_mm == pytest.approx((0.4, 0.8))
    one = WovenFabric(kind="woven-fabric", weave="plain", warp={**YARN, "width_mm": 0.4}, weft=YARN, openness=0.04)
    assert one.widths_mm == pytest.approx((0.4, 0.4))
    assert one.open_fraction == pytest.approx(0.04)


def test_perforated_screens_have_their_openness(shop):
    for pattern, hole in (("square", "round"), ("triangular", "round"), ("square", "square"), ("triangular", "square")):
        screen = PerforatedScreen(
            kind="perforated-screen",
            pitch_mm=4,
            openness=0.3,
            thickness_mm=1,
            pattern=pattern,
            hole=hole,
            exterior="m",
            interior="n",
        )
        (mesh,) = screen.shapes(shop, "sample")
        assert is_closed(mesh)
        a, b, c = (mesh.corners[mesh.triangles[:, k]] for k in range(3))
        normals = 0.5 * np.cross(b - a, c - a)
        for name, sign in (("m", -1.0), ("n", 1.0)):
            chosen = np.array([mesh.faces[f].front == name for f in mesh.face]) & (normals[:, 2] * sign > 1e-15)
            assert normals[chosen, 2].sum() * sign == pytest.approx(0.7 * math.prod(mesh.periods), rel=1e-9)
        assert screen.open_fraction == pytest.approx(0.3)


def test_expanded_metal_is_closed(shop):
    metal = ExpandedMetal(
        kind="expanded-metal", long_mm=20, short_mm=8, strand_mm=1.5, thickness_mm=1, tilt_deg=40, material="m"
    )
    (mesh,) = metal.shapes(shop, "sample")
    assert is_closed(mesh)
    assert volume(mesh) > 0.0
    assert mesh.periods == (0.02, 0.008)
    # It stays within a period, so that strands do not meet the next ones.
    assert mesh.corners[:, 1].min() >= -1e-12
    assert mesh.corners[:, 1].max() <= 0.008 + 1e-12


def test_a_scan_is_smoothed_within_the_tolerance(tmp_path):
    x = np.linspace(0.0, 100.0, 401)
    clean = 20.0 * np.abs(x / 50.0 - 1.0)
    noisy = clean + np.random.default_rng(3).normal(0.0, 0.1, x.size)
    noisy[-1] = noisy[0]
    path = tmp_path / "scan.csv"
    path.write_text("x_um,z_um\n" + "\n".join(f"{a},{b}" for a, b in zip(x, noisy, strict=True)))
    found = read_scan(path, "sample.file")
    corners = simplified(*found, 100.0, 0.6, "sample", closes=True)
    assert len(corners) < 12
    assert np.abs(np.interp(x, *corners.T) - noisy).max() <= 0.6
    assert np.abs(np.interp(x, *corners.T) - clean).max() < 0.15
    assert corners[0, 1] == corners[-1, 1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b\n1,2\n2,3\n3,4", "has the columns a, b (x_um and z_um are asked for, in µm)"),
        ("1,2,3\n2,3,4\n3,4,5", "has 3 columns without names"),
        ("x_um,z_um\n1,2\n2,x\n3,4", "line 3: not two numbers"),
        ("x_um,z_um\n1,2\n1,3\n3,4", "has two heights at one x_um"),
        ("x_um,z_um\n1,2\n2,3", "holds 2 points"),
        ("", "holds no rows"),
    ],
)
def test_faulty_scans_are_named(text, message, tmp_path):
    path = tmp_path / "scan.csv"
    path.write_text(text)
    with pytest.raises(RecipeError) as caught:
        read_scan(path, "sample.file")
    assert str(caught.value).startswith(f"sample.file: {path}")
    assert message in str(caught.value)


def test_ends_of_a_scan_that_do_not_fit_are_named():
    x = np.linspace(0.0, 10.0, 11)
    with pytest.raises(RecipeError, match=r"sample\.period_um: the ends of the scan differ by 10 µm"):
        simplified(x, x, 10.0, 0.1, "sample", closes=True)
    assert len(simplified(x, x, 10.0, 0.1, "sample", closes=False)) == 2


@pytest.mark.parametrize("incident", [(0.0, 0.0, -1.0), (-0.0, -0.0, -1.0), (0.0, 0.6, -0.8), (0.6, 0.0, -0.8)])
def test_light_along_an_axis_meets_triangles(incident):
    """Zeros of either sign in a direction; a black cloth leaves the gaps between its yarns."""
    yarn = {"per_cm": 10.0, "width_mm": 0.5, "thickness_mm": 0.02, "material": "yarn"}
    cloth = {
        "sample": {"kind": "woven-fabric", "weave": "plain", "warp": yarn, "weft": yarn},
        "materials": {"yarn": {"kind": "lambertian", "reflectance": 0.0}},
    }
    seen, _ = trace.scan(cloth, np.array([incident]), trace.Settings(samples=4096, seed=1))
    (passed,) = [s.total[0] for s in seen if s.scatter == "transmission"]
    assert passed == pytest.approx(0.25, abs=0.02)
