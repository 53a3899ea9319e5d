"""What stands in windows: every way in which a person can name a data set, in a room and in a study."""

import json

import pytest

from blind_recipe import BLIND
from clerestory import Bsdf, Model, room, trace
from clerestory.annual.cache import Cache
from clerestory.annual.study import load
from clerestory.annual.traced import kept
from clerestory.cli import main
from clerestory.directions import direction
from clerestory.npz import mark
from clerestory.room.recipe import System
from clerestory.room.systems import system_of
from clerestory.system.build import load as specified
from clerestory.trace.keys import RecipeError
from short_study import ROOM, days

TILTED = BLIND.replace("pitch_mm = 72", "pitch_mm = 72\ntilt_deg = 30")
WINDOW = """
[[layers]]
kind = "glass"
glass = "clear"
thickness_mm = 4
"""
SHADED = """
[[layers]]
kind = "recipe"
recipe = "blind.toml"
samples = 16
"""
GLASS = "wavelength_nm,T,Rf,Rb\n" + "".join(f"{nm},0.6,0.07,0.07\n" for nm in range(300, 2501, 100))
NORMAL = direction(0.0, 0.0)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "blind.toml").write_text(TILTED)
    (tmp_path / "window.toml").write_text(WINDOW)
    (tmp_path / "shaded.toml").write_text(SHADED)
    (tmp_path / "pane.csv").write_text(GLASS)
    (tmp_path / "room.toml").write_text(ROOM)
    (tmp_path / "days.wea").write_text(days((20,)))
    return tmp_path


@pytest.fixture
def quick(tmp_path):
    """Traces with few paths, and keeps it; what was traced."""
    seen = []
    keep = kept(Cache(tmp_path / "cache"), seen.append)
    return (lambda sample, **settings: keep(sample, **{**settings, "samples": 16})), seen


def passed(bsdf, **options):
    return float(bsdf.integrate(NORMAL, "transmission", **options))


def test_a_recipe_is_traced_with_its_beams_apart(folder, quick):
    traced, seen = quick
    placed = system_of(System(file="blind.toml"), "systems.s", folder, traced)
    # Slats of 80 mm at 30° cover 40 mm of the 72 mm from slat to slat.
    assert passed(placed.bsdf, part="direct") == pytest.approx(32.0 / 72.0, abs=0.01)
    assert placed.file is None
    again = system_of(System(file="blind.toml"), "systems.s", folder, traced)
    assert mark(again.bsdf) == mark(placed.bsdf)
    assert seen == ["tracing venetian blind"]
    in_table = system_of(System(file="blind.toml", treatment="klems"), "systems.s", folder, traced)
    assert passed(in_table.bsdf, part="direct") == 0.0


def test_a_changed_recipe_is_another_data_set(folder, quick):
    traced, seen = quick
    first = mark(system_of(System(file="shaded.toml"), "s", folder, traced).bsdf)
    # The specification stays as it is; a file that it names does not.
    (folder / "blind.toml").write_text(TILTED.replace("0.5", "0.6"))
    assert mark(system_of(System(file="shaded.toml"), "s", folder, traced).bsdf) != first
    assert len(seen) == 2


def test_a_specification_is_what_system_build_makes_of_it(folder):
    placed = system_of(System(file="window.toml", treatment="high"), "s", folder)
    assert mark(placed.bsdf) == mark(specified(folder / "window.toml").solve().bsdf)


def test_glass_by_transmittance_by_name_and_by_file(folder):
    assert passed(system_of(System(glass=0.7), "s", folder).bsdf) == pytest.approx(0.7)
    clear = system_of(System(glass="clear", thickness_mm=4.0), "s", folder).bsdf
    assert passed(clear, band="visible", part="direct") == pytest.approx(0.893, abs=0.002)
    measured = system_of(System(glass="pane.csv", thickness_mm=4.0), "s", folder).bsdf
    assert passed(measured, band="visible", part="direct") == pytest.approx(0.6, abs=1e-6)


def test_what_comes_with_clerestory(folder, quick):
    traced, seen = quick
    blind = system_of(System(file="flat-blind"), "s", folder, traced).bsdf
    assert mark(blind) == mark(trace.measure("flat-blind", samples=16))
    assert seen


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"file": "flat-blnd"}, "s.file: flat-blnd: neither a file nor a name that comes with Clerestory"),
        ({"file": "none.toml"}, "none.toml does not exist"),
        ({"file": "room.toml"}, "room.toml: neither a window nor a sample"),
        ({"file": "broken.toml"}, "broken.toml: not TOML"),
        ({"file": "gap.toml"}, "gap.toml: layer 1 (none.toml): "),
        ({"glass": "amber", "thickness_mm": 4}, "s.glass: layer 1 (amber): no glass 'amber' comes with Clerestory"),
        ({"glass": "clear"}, "s.glass: layer 1 (clear): thickness_mm: the thickness of the glass 'clear' is not given"),
        ({"glass": "none.csv"}, "none.csv"),
    ],
)
def test_what_cannot_be_is_told_with_its_key(folder, given, words):
    (folder / "broken.toml").write_text("layers = [")
    (folder / "gap.toml").write_text('[[layers]]\nkind = "recipe"\nrecipe = "none.toml"\n')
    with pytest.raises(RecipeError) as told:
        system_of(System.of(given), "s", folder)
    assert words in str(told.value)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"glass": 1.2}, "glass: 1.2 does not fit (give a transmittance above 0"),
        ({"glass": True}, "glass: True does not fit"),
        ({"glass": 0.7, "thickness_mm": 4}, "thickness_mm: goes with a glass by its name"),
        ({"glass": "clear", "glass_reflectance": 0.1}, "glass_reflectance: goes with a transmittance"),
    ],
)
def test_keys_that_do_not_go_together(given, words):
    with pytest.raises(RecipeError) as told:
        System.of(given)
    assert str(told.value).startswith(words)


def test_a_study_with_states_of_all_kinds(folder, capsys):
    study = folder / "study.toml"
    study.write_text(
        """
room = "room.toml"
weather = "days.wea"
method = "3-phase"
patches = "reinhart:1"
paths = 64
[data_sets.law.states.up]
glass = "clear"
thickness_mm = 4
[data_sets.law.states.half]
file = "window.toml"
[data_sets.law.states.down]
file = "shaded.toml"
[data_sets.law.control]
kind = "schedule"
times = [ { state = "up", end = 11 }, { state = "half", end = 13 }, { state = "down" } ]
"""
    )
    assert main(["annual", str(study), "--cache", str(folder / "cache"), "--json"]) == 0
    told = capsys.readouterr()
    assert told.err == "tracing venetian blind\n"
    (record,) = json.loads(told.out)["data_sets"]
    assert list(record["states"]["pane"]) == ["up", "half", "down"]
    assert all(share > 0.0 for share in record["states"]["pane"].values())


def test_a_data_set_in_a_band_of_its_own(folder):
    grey = Bsdf.from_models(
        {("exterior", "transmission"): Model.lambertian(0.2), ("exterior", "reflection"): Model.lambertian(0.1)}
    )
    both = grey.with_band("photopic", {"visible": 2.0})
    both.save(folder / "both.bsdf.npz")
    text = """
room = "room.toml"
weather = "days.wea"
method = "3-phase"
[data_sets.own]
file = "both.bsdf.npz"
treatment = "high"
band = "photopic"
"""
    (folder / "study.toml").write_text(text)
    (one,) = load(folder / "study.toml", cache=folder / "cache").data_sets["own"]
    assert passed(one) == pytest.approx(0.4)
    (folder / "study.toml").write_text(text.replace('"photopic"', '"solar"'))
    with pytest.raises(RecipeError, match=r"data_sets\.own\.band: .*solar"):
        load(folder / "study.toml", cache=folder / "cache")


def test_a_room_is_known_by_what_its_windows_hold(folder, quick):
    traced, _ = quick
    (folder / "room.toml").write_text(ROOM.replace("glass = 0.7", 'file = "shaded.toml"\ntreatment = "klems"'))
    first = room.load(folder / "room.toml", traced=traced).content()
    (folder / "blind.toml").write_text(TILTED.replace("0.5", "0.6"))
    assert room.load(folder / "room.toml", traced=traced).content() != first
