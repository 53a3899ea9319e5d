"""Glare of known sources, classes, presets, check pictures."""

import numpy as np
import pytest

from clerestory import ClerestoryError, MissingDataError
from clerestory.glare import PRESETS, Settings, dgi_class, dgp_class, evaluate, rate
from clerestory.glare.check import check_hdr, check_picture
from clerestory.picture import View
from glare_pictures import FISHEYES, disks, scattered

VIEW = View(FISHEYES["angular"])


def test_classes_include_their_limits():
    assert [dgp_class(v) for v in (0.2, 0.35, 0.3501, 0.40, 0.45, 0.46, 1.0)] == [
        "imperceptible", "imperceptible", "perceptible", "perceptible", "disturbing", "intolerable", "intolerable",
    ]  # fmt: skip
    assert [dgi_class(v) for v in (18, 18.1, 24.1, 28, 28.1)] == [
        "imperceptible", "perceptible", "disturbing", "disturbing", "intolerable",
    ]  # fmt: skip


def test_the_defaults_are_those_of_the_core():
    assert Settings.preset("evalglare-3.06") == Settings()
    assert Settings.preset("evalglare-2.10").changed() == {"low_light": True}
    assert set(Settings.preset("evalglare-1.x").changed()) == {"threshold", "threshold_of", "background", "low_light"}
    assert all(Settings.preset(name).words() for name in PRESETS)
    with pytest.raises(ClerestoryError, match=r"3\.06"):
        Settings.preset("evalglare-9")


def test_known_sources_rate_as_their_picture():
    picture = disks(800, VIEW, 500.0, (20000.0, 0, 20, 5), (10000.0, 30, -15, 4))
    seen = evaluate(picture)
    given = [(s.direction, s.luminance, s.solid_angle) for s in seen.sources]
    known = rate(given, VIEW, seen.vertical_illuminance, mean_luminance=seen.mean_luminance)
    for name in ("dgp", "dgi", "ugr", "cgi", "vcp", "dgr", "ugp2", "background_luminance", "veiling_luminance"):
        assert getattr(known, name) == pytest.approx(getattr(seen, name), rel=5e-3), name


def test_analytic_source():
    """One source on the line of sight: P = 1, and the formulas by hand."""
    omega, luminance, illuminance = 1e-3, 1e5, 2000.0
    found = rate([([0.0, 1.0, 0.0], luminance, omega)], VIEW, illuminance)
    background = (illuminance - luminance * omega) / np.pi
    assert found.ugr == pytest.approx(8 * np.log10(0.25 / background * luminance**2 * omega))
    term = luminance**2 * omega / illuminance**1.87
    assert found.dgp == pytest.approx(5.87e-5 * illuminance + 0.092 * np.log10(1 + term) + 0.159)
    assert np.isnan(found.vcp)
    with pytest.raises(MissingDataError, match="background"):
        rate([], VIEW, illuminance, settings=Settings(background="mean"))
    with pytest.raises(ClerestoryError, match="nothing to rate"):
        rate([], VIEW, 0.0)


def test_settings_that_make_no_sense():
    picture = disks(60, VIEW, 500.0)
    for settings in (
        Settings(threshold=-1.0),
        Settings(search_radius=0.0),
        Settings(threshold=4.0, threshold_of="task"),
        Settings(background="sky"),  # type: ignore[arg-type]
        Settings(task=(1e9, 0.0, 0.5)),
    ):
        with pytest.raises(ClerestoryError, match=r"\("):
            evaluate(picture, settings)


def test_check_picture_colours_the_sources():
    from clerestory.plot import render

    picture = scattered(150, VIEW, 2, 12)
    found = evaluate(picture)
    assert render(check_picture(picture, found), ".png", dpi=40).startswith(b"\x89PNG")
    check = check_hdr(picture, found)
    coloured = np.ptp(check.pixels, axis=2) > 0.05 * check.pixels.max(axis=2)
    assert np.array_equal(coloured, (found.labels > 0) & (picture.luminance > 0))
    with pytest.raises(ClerestoryError, match="no pixels"):
        check_picture(picture, rate([], VIEW, 100.0))
