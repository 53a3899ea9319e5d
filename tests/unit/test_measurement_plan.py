"""Plans follow the laboratories' rules: what fits, what a spot covers, which directions, how long."""

import csv
import json

import numpy as np
import pytest

from clerestory import Basis, ClerestoryError
from clerestory.cli import main
from clerestory.directions import direction
from clerestory.measure.plan import INSTRUMENTS, Job, find_instrument, make_plan, read_job
from clerestory.measure.plan.extent import covers_periods, extent_of, largest_theta, lit_width_mm
from clerestory.measure.plan.incidence import azimuths, images, polar_angles, subset
from clerestory.measure.plan.job import Piece
from clerestory.measure.plan.paths import circle_path, hemisphere_path, in_band_path, square_path, without_source


def job(purpose="high-resolution", directions="steps", scatter=("transmission",), **sample):
    given = {"width_mm": 210, "height_mm": 297} | sample
    return Job.of({"sample": given, "purpose": purpose, "directions": directions, "scatter": list(scatter)})


def plan(instrument="pg2", **options):
    return make_plan(job(**options), find_instrument(instrument))


def test_a_spot_of_70_mm_covers_periods_of_15_mm_but_not_of_20():
    assert covers_periods(15.0, 70.0)
    assert not covers_periods(20.0, 70.0)
    covered = plan(period_mm=15, width_mm=400, height_mm=400)
    assert (covered.extent.spot_mm, covered.route.way) == (70.0, "measure")
    assert plan(period_mm=20, width_mm=400, height_mm=400).route.way == "positions"
    traced = plan(period_mm=20, width_mm=400, height_mm=400, geometry_known=True)
    assert traced.route.way == "material"
    assert traced.job.sample.period_mm == 20  # the job stays what it was


def test_fine_structures_are_measured_with_the_smallest_spot_that_covers_them():
    assert plan(period_mm=1).extent.spot_mm == 25.0
    assert plan().extent.periods == np.inf


@pytest.mark.parametrize(
    ("width", "height", "holder", "turns"),
    [
        (500, 500, "automatic holder", True),
        (501, 400, "large holder", False),
        (900, 1000, "large holder", False),
        (1000, 900, "large holder", False),
        (1001, 900, None, False),
        (901, 901, None, False),
        (20, 20, "automatic holder", True),
        (19, 20, None, False),
    ],
)
def test_which_samples_fit(width, height, holder, turns):
    extent = extent_of(Piece(width_mm=width, height_mm=height), find_instrument("pg2"))
    assert (extent.holder, extent.turns_in_its_plane) == (holder, turns)


def test_what_does_not_fit_is_traced_or_cut():
    assert plan(height_mm=1400, geometry_known=True).route.way == "material"
    assert plan(height_mm=1400).route.way == "cut"
    assert plan(period_mm=1, states=5, geometry_known=True).route.way == "material"


def test_the_aperture_grows_with_incidence_and_ends_at_the_sample():
    assert lit_width_mm(70.0, 60.0) == pytest.approx(140.0)
    assert largest_theta(50.0, 100.0) == pytest.approx(60.0)
    small = plan(width_mm=50, height_mm=60)
    assert small.extent.largest_theta_deg == pytest.approx(60.0)
    assert small.extent.limited_by == "sample"
    assert max(theta for _, theta, _ in small.incident) == 60.0
    assert any("1/cos θ" in text for text in small.advice)
    assert plan().extent.largest_theta_deg == 82.5
    # An aperture on the sample does not grow.
    image = plan("image-epfl", width_mm=100, height_mm=100)
    assert image.extent.lit_mm(60.0) == image.extent.spot_mm
    assert image.extent.limited_by == "instrument"


def test_angles_are_every_10_degrees_with_8_and_every_degree_near_a_cut_off():
    assert polar_angles(85.0) == [0, 8, 10, 20, 30, 40, 50, 60, 70, 80]
    assert polar_angles(75.0)[-1] == 70
    assert [a for a in polar_angles(85.0, 42.0) if 36 < a < 48] == list(range(37, 48))
    assert 36 not in polar_angles(85.0, 42.0)


@pytest.mark.parametrize(
    ("weave", "symmetry", "expected"),
    [
        ("square", "quadrilateral", [0, 45, 90]),
        ("rectangular", "quadrilateral", [0, 45, 90, 135]),
        ("square", "rotational", [0, 45, 90, 135]),
        ("square", "left-right", [-90, -45, 0, 45, 90]),
        ("square", "unknown", [0, 45, 90, 135, 180, 225, 270, 315]),
        ("none", "quadrilateral", [0, 15, 30, 45, 60, 75, 90]),
        ("none", "left-right", list(range(-90, 91, 15))),
        ("square", "up-down", [0, 45, 90, 135, 180]),
        ("none", "up-down", list(range(0, 181, 15))),
        ("none", "rotational", list(range(0, 180, 15))),
        ("none", "none", list(range(0, 360, 15))),
        ("none", "unknown", list(range(0, 360, 15))),
        ("none", "isotropic", [90]),
    ],
)
def test_azimuths_follow_symmetry_and_weave(weave, symmetry, expected):
    piece = Piece(width_mm=100, height_mm=100, weave=weave, symmetry=symmetry)
    assert azimuths(piece) == expected


def test_isotropic_and_anisotropic_counts():
    assert len(plan(symmetry="isotropic").incident) == 10
    # The normal once, nine other angles at 24 azimuths.
    assert len(plan(symmetry="none").incident) == 1 + 9 * 24


@pytest.mark.parametrize("name", ["klems-full", "klems-half", "klems-quarter", "tregenza"])
@pytest.mark.parametrize("symmetry", ["quadrilateral", "left-right", "up-down", "rotational", "none", "unknown"])
@pytest.mark.parametrize("side", ["exterior", "interior"])
def test_subsets_reach_every_patch_when_symmetry_completes_them(name, symmetry, side):
    basis = Basis.named(name)
    chosen = subset(name, symmetry, 90.0, side)
    reached = [
        int(basis.index_of_incident(direction(t, p, side=side)))
        for theta, phi in chosen
        for t, p in images(theta, phi, symmetry)
    ]
    assert set(reached) == set(range(len(basis)))
    if symmetry in ("none", "unknown"):
        assert len(chosen) == len(basis)
    else:
        assert len(chosen) < 0.65 * len(basis)


def test_an_isotropic_subset_has_one_patch_a_ring():
    assert len(subset("klems-full", "isotropic", 90.0)) == 9
    assert len(subset("tregenza", "isotropic", 90.0)) == 8
    assert max(theta for theta, _ in subset("klems-full", "none", 80.0)) < 80.0


def test_145_directions_of_a_camera_take_12_hours_and_symmetry_shortens_them():
    whole = plan("image-epfl", directions="tregenza", width_mm=400, height_mm=400)
    assert len(whole.incident) == 145
    assert whole.hours == pytest.approx(12.0, abs=0.1)
    assert plan("image-ibp", directions="tregenza", width_mm=400, height_mm=400).hours == pytest.approx(3.0, abs=0.05)
    half = plan("image-epfl", directions="tregenza", width_mm=400, height_mm=400, symmetry="left-right")
    assert half.hours < 0.65 * whole.hours
    assert whole.paths == ()


def test_a_scanning_instrument_takes_20_minutes_an_incidence_at_least():
    assert plan(symmetry="isotropic").hours == pytest.approx(10 / 3)
    positions = plan(symmetry="isotropic", period_mm=20, width_mm=450, height_mm=450)
    assert positions.route.positions == 4
    assert positions.hours == pytest.approx(40 / 3)


def test_what_the_instrument_does_not_see_is_said():
    words = plan("image-epfl", scatter=("transmission", "reflection"), width_mm=400, height_mm=400).advice
    assert words[0].startswith("reflection is not seen")


def neighbours(path):
    d = direction(path.theta_deg, path.phi_deg, side=path.side)
    cosines = d @ d.T
    np.fill_diagonal(cosines, -1.0)
    return np.degrees(np.arccos(np.clip(cosines.max(axis=1), -1.0, 1.0)))


def test_paths_reach_what_they_should_in_even_steps():
    whole = hemisphere_path("interior", step_deg=5.0, largest_theta_deg=85.0)
    assert whole.theta_deg.max() == 85.0
    assert neighbours(whole).max() < 5.5
    centre = direction(40.0, 270.0, side="interior")
    circle = circle_path(centre, radius_deg=3.0, step_deg=0.25)
    away = np.degrees(np.arccos(np.clip(direction(circle.theta_deg, circle.phi_deg, side="interior") @ centre, -1, 1)))
    assert away.max() == pytest.approx(3.0, abs=1e-6)
    assert len(circle) == pytest.approx(np.pi * 3.0**2 / 0.25**2, rel=0.1)
    square = square_path(centre, half_width_deg=2.0, step_deg=0.5)
    assert len(square) == 81
    assert neighbours(square) == pytest.approx(0.5, rel=0.01)
    incident = direction(40.0, 60.0)
    band = in_band_path(incident, "interior", half_width_deg=3.0, step_deg=1.0)
    across = np.array([-np.sin(np.radians(60.0)), np.cos(np.radians(60.0)), 0.0])
    away = np.degrees(np.arcsin(direction(band.theta_deg, band.phi_deg, side="interior") @ across))
    assert np.abs(away).max() == pytest.approx(3.0)
    assert len(np.unique(np.round(away, 6))) == 7
    # Straight on is among them.
    straight = direction(40.0, 240.0, side="interior")
    assert (direction(band.theta_deg, band.phi_deg, side="interior") @ straight).max() == pytest.approx(1.0)


def test_a_path_near_the_horizon_or_the_source_loses_what_cannot_be_seen():
    circle = circle_path(direction(89.0, 0.0, side="interior"), radius_deg=3.0, step_deg=0.5)
    assert 0 < len(circle) < 120
    assert circle.theta_deg.max() < 90.0
    source = direction(30.0, 90.0)
    whole = hemisphere_path("exterior", step_deg=2.5)
    free = without_source(whole, source, "exterior", 3.0)
    near = direction(free.theta_deg, free.phi_deg, side="exterior") @ source
    assert near.max() < np.cos(np.radians(3.0))
    assert 0 < len(whole) - len(free) < 10
    assert without_source(hemisphere_path("interior"), source, "exterior", 3.0).side == "interior"
    with pytest.raises(ClerestoryError, match="make no path"):
        circle_path(source, radius_deg=80.0, step_deg=1e-6)


def run(capsys, *words):
    code = main([str(w) for w in words])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_a_plan_becomes_files(tmp_path, capsys):
    (tmp_path / "twill.toml").write_text(
        'purpose = "glare"\ninstrument = "mine.toml"\n[sample]\nwidth_mm = 210\nheight_mm = 297\n'
        'period_mm = 0.6\nweave = "square"\nsymmetry = "rotational"\n'
    )
    mine = (
        (INSTRUMENTS.folder / "pg2.toml")
        .read_text()
        .replace("minutes_an_incidence = 20.0", "minutes_an_incidence = 60")
    )
    (tmp_path / "mine.toml").write_text(mine)
    code, out, _ = run(capsys, "measure", "plan", tmp_path / "twill.toml", "-o", tmp_path / "plan", "--json")
    assert code == 0
    said = json.loads(out)
    assert json.loads((tmp_path / "plan" / "plan.json").read_text()) == said
    assert said["hours"] == len(said["incident"]) == 1 + 9 * 4
    with (tmp_path / "plan" / "incident.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 37
    assert rows[-1]["theta_deg"] == "80"
    with (tmp_path / "plan" / "paths.csv").open() as file:
        points = sum(1 for _ in file) - 1
    assert points == sum(path["points"] for path in said["paths"])
    assert read_job(tmp_path / "twill.toml").purpose == "glare"


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        ([], "no sample is given"),
        (["--size", "210"], "2 numbers"),
        (["--size", "210,-3"], "sample.height_mm"),
        (["--size", "210,297", "--symmetry", "twill"], "sample.symmetry: 'twill' is not known"),
        (["--size", "210,297", "--for", "cut-off"], "sample.cut_off_deg: is missing"),
        (["--size", "210,297", "--weave", "square", "--symmetry", "isotropic"], "a weave is not isotropic"),
        (["--size", "210,297", "--instrument", "pg3"], "did you mean pg2"),
        (["--size", "210,297", "--incident", "1,2"], "--from-scan only"),
        (["--from-scan", "x.txt", "--size", "1,1"], "does not go with"),
        (["nowhere.toml"], "nowhere.toml"),
        (["faulty.toml"], "faulty.toml: sample.wide_mm: there is no such key"),
        (["faulty.toml", "--size", "1,1"], "--size: does not go with faulty.toml"),
        (["--size", "210,297", "--instrument", "faulty.toml"], "faulty.toml: sample: there is no such key"),
        (["--size", "210,297", "-o", "faulty.toml"], "is a file"),
    ],
)
def test_what_makes_no_sense_is_refused(tmp_path, capsys, monkeypatch, words, complaint):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "faulty.toml").write_text("[sample]\nwide_mm = 210\n")
    code, out, err = run(capsys, "measure", "plan", *words)
    assert code in (1, 2)
    assert out == ""
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert complaint in err
    assert [path.name for path in tmp_path.iterdir()] == ["faulty.toml"]


def test_every_instrument_that_ships_can_be_planned_for():
    assert INSTRUMENTS.names() == ["image-epfl", "image-ibp", "pg2", "reflet180"]
    for name in INSTRUMENTS.names():
        made = plan(name, symmetry="isotropic", width_mm=200, height_mm=200)
        assert made.route.way == "measure"
        assert made.incident
