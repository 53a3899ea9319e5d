"""Pictures of sunny hours by five phases beside Radiance's chain: rfluxmtx, dctimestep and rtrace by picture."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import binary_erosion

from clerestory import Bsdf, read, room
from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.pictures import YearPictures
from clerestory.photometry import EFFICACY, LUMINANCE
from clerestory.picture import Picture, View
from clerestory.weather import SkyYear, read_weather
from samples import ABSENT, sample_root

phases = pytest.importorskip("phases_radiance", reason="pyradiance is not installed")
room_radiance = pytest.importorskip("room_radiance", reason="pyradiance is not installed")

EYE = np.array([1.8, 4.2, 1.3])
VIEW = View("-vtv -vp 1.8 4.2 1.3 -vd 0 -1 0 -vu 0 0 1 -vh 90 -vv 75")
SIZE = (40, 32)
BOUNCES = 8
#: Divisions of two runs, from which noise is known.
DIVISIONS = (500, 650)
HEAD = "place Innsbruck\nlatitude 47.3\nlongitude -11.4\ntime_zone -15\nsite_elevation 600\nweather_data_file_units 1\n"
SUNNY = "1 17 10.5 700 80\n3 17 13.5 600 120\n10 17 15.5 500 90\n"


def rays():
    """Origins and directions (pixels, 6) through the middles of the pixels, from the top left."""
    width, height = SIZE
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, 1.0 - (np.arange(height) + 0.5) / height)
    return np.concatenate(VIEW.rays(np.stack([x, y], axis=-1).reshape(-1, 2)), axis=-1)


def regions():
    """Pixels that show a part of the room, by its name; those at its edge are in none.

    The sun's disc is nowhere at the edge of one of the data set's patches.
    """
    towards = rays()[:, 3:]
    size = np.array([room_radiance.SIZE[key] for key in ("width_m", "depth_m", "height_m")])
    with np.errstate(divide="ignore"):
        ways = np.where(towards > 0.0, (size - EYE) / towards, -EYE / towards)
    axis = ways.argmin(axis=1)
    x, _, z = (EYE + ways.min(axis=1)[:, None] * towards).T
    inside = np.minimum.reduce([x - 0.2, 3.4 - x, z - 0.9, 2.6 - z])
    wall = axis == 1
    found = {
        "window": wall & (inside > 0.0),
        "wall of the window": wall & (inside < 0.0),
        "left": (axis == 0) & (x > 1.8),
        "right": (axis == 0) & (x < 1.8),
        "floor": (axis == 2) & (z < 1.0),
        "ceiling": (axis == 2) & (z > 1.0),
    }
    around = np.ones((3, 3))
    return {name: binary_erosion(seen.reshape(SIZE[::-1]), around).ravel() for name, seen in found.items()}


def means(values):
    """Of the regions (regions) of a picture's luminances (pixels)."""
    return np.array([values[inside].mean() for inside in regions().values()])


def theirs(folder, made, steps, divisions):
    """Luminances of the regions (steps, regions) by V T D s - V_d T D_d s_d + C_ds s_sun."""
    for name, bounces in (("full", BOUNCES), ("near", 1)):
        phases.view_pictures(folder, name, rays(), SIZE, divisions=divisions, bounces=bounces)

    def multiplied(name, sky):
        out = ("-o", f"{name}_step%03d.hdr")
        room_radiance.run("dctimestep", *out, f"{name}%03d.hdr", "system.xml", "daylight.mtx", sky, folder=folder)
        # Steps are numbered from 1 in some versions and from 0 in others.
        files = sorted(folder.glob(f"{name}_step*.hdr"))
        assert len(files) == steps
        found = [EFFICACY * (Picture.read(path).pixels @ np.asarray(LUMINANCE)).ravel() for path in files]
        for path in files:
            path.unlink()
        return np.array(found)

    values = multiplied("full", "sky.mtx") - multiplied("near", "sun.mtx")
    window = ["void BSDF window 6 0 system.xml 0 0 1 . 0 0", *room_radiance.panes(made)]
    (folder / "glazed.rad").write_text("\n".join([*room_radiance.surfaces(made), *window]) + "\n")
    origins, directions = np.split(rays(), 2, axis=1)
    for step, light in enumerate(phases.lights_of(folder / "suns.rad")):
        (folder / "sun.rad").write_text(light + "\n")
        (folder / "scene.oct").write_bytes(room_radiance.run("oconv", "sun.rad", "glazed.rad", folder=folder))
        # What the sun sends through the window to what is seen, and to the eye.
        values[step] += room_radiance.luminance(
            folder, origins[0], directions, *phases.EXACT, divisions=2 * divisions, bounces=1
        )
    return np.array([means(step) for step in values])


@pytest.mark.slow
def test_regions_of_pictures_are_those_of_the_chain(tmp_path):
    """Mean luminances of a room's parts within 5 % besides three standard errors of both."""
    root = sample_root()
    if root is None:
        pytest.skip(ABSENT)
    models = read(root / "klems" / "blinds30.xml").models["visible"]
    bsdf = Bsdf.from_models({key: model for key, model in models.items() if key[1] == "transmission"})
    made = room.load(room_radiance.tables({"glass": 0.8}, sun=False, sky=True))
    bsdf.write(tmp_path / "system.xml")
    phases.prepare_room(tmp_path, made)
    (tmp_path / "sunny.wea").write_text(HEAD + SUNNY)
    phases.daylight(tmp_path, samples=3000)
    phases.skies(tmp_path, "sunny.wea")
    phases_sky = (tmp_path / "sky.mtx").read_bytes()
    phases.skies(tmp_path, "sunny.wea", more=("-d", "-D", "suns.rad"))
    (tmp_path / "sun.mtx").write_bytes((tmp_path / "sky.mtx").read_bytes())
    (tmp_path / "sky.mtx").write_bytes(phases_sky)
    steps = SUNNY.count("\n")
    chain = np.array([theirs(tmp_path, made, steps, divisions) for divisions in DIVISIONS])

    sky = SkyYear(read_weather(tmp_path / "sunny.wea"), "tregenza", preset="radiance-matrix")
    ours = []
    for seed in (1, 2):
        matrices = RoomMatrices(made, cache=Cache(tmp_path / "cache"), seed=seed)
        year = YearPictures(Arrivals(matrices, sky, value="centre"), VIEW, SIZE, samples=512)
        pictures = [picture.pixels[..., 0].ravel() for _, picture in year.of([bsdf]).at(range(steps))]
        ours.append([means(EFFICACY * values) for values in pictures])
    found, expected = np.mean(ours, axis=0), chain.mean(axis=0)

    # Two runs of each tell little of one value's noise, but enough of that of all values of a region.
    spreads = [np.ptp(runs, axis=0) / 2.0 / expected for runs in (chain, np.array(ours))]
    error = np.sqrt(sum(np.mean(spread**2, axis=0) for spread in spreads))
    # That of the chain where light comes by way of other walls only; what differs shall not hide in it.
    assert (error < 0.05).all(), dict(zip(regions(), error, strict=True))
    assert (np.abs(found / expected - 1.0) < 0.05 + 3.0 * error).all(), found / expected
