"""Skies in Python: what they give, what they refuse, and that their forms agree."""

import math

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.sky import Place, Sky, SkyPatches, SunPosition
from clerestory.sky.picture import place as on_picture
from clerestory.sky.picture import solid_angles

SUN = SunPosition(35.9, 125.0, 80)
UP = [0.0, 0.0, 1.0]


@pytest.fixture(scope="module")
def clear():
    return Sky.perez(SUN, direct=700, diffuse=120)


def skies():
    lit = {"direct_illuminance": 60000, "diffuse_illuminance": 12000}
    yield "perez", Sky.perez(SUN, direct=700, diffuse=120)
    yield "solar", Sky.perez(SUN, direct=700, diffuse=120, quantity="solar")
    yield "coloured", Sky.perez(SUN, direct=700, diffuse=120, colour="radiance")
    for kind in (1, 4, 8, 12, 15):
        yield f"cie{kind}", Sky.cie(kind, SUN, **lit)
    for name in ("overcast", "clear", "intermediate", "uniform"):
        yield name, getattr(Sky, name)(SUN)
    yield "preetham", Sky.preetham(SUN)
    yield "grey", Sky.preetham(SUN, coloured=False)


SKIES = dict(skies())


@pytest.mark.parametrize("name", SKIES)
def test_irradiance_is_the_integral_of_radiance(name):
    """By an independent sum over a million directions, 0.02 %; the disc and its glow are steep."""
    sky = SKIES[name]
    rows, columns = 500, 1000
    sine2 = (np.arange(rows) + 0.5) / rows  # equal projected solid angles
    azimuth = 2 * np.pi * (np.arange(columns) + 0.5) / columns
    s, a = np.meshgrid(np.sqrt(sine2), azimuth, indexing="ij")
    directions = np.stack([s * np.sin(a), s * np.cos(a), np.sqrt(1 - s**2)], axis=-1)
    found = np.pi * sky.radiance(directions).mean(axis=(0, 1))
    assert found == pytest.approx(sky.irradiance(part="sky"), rel=2e-4)
    weights = [0.265074126, 0.670114631, 0.064811243]
    assert found @ weights == pytest.approx(sky.diffuse_horizontal, rel=2e-4)


@pytest.mark.parametrize("name", SKIES)
def test_a_turned_world_sees_a_turned_sky(name):
    sky = SKIES[name]
    options = {"preset": sky.settings.preset, "quantity": sky.settings.quantity}
    if name == "perez":
        turned = Sky.perez(SUN, direct=700, diffuse=120, north_deg=30, **options)
        # The world's y axis points to azimuth 30: its own azimuth 100 is the compass's 130.
        world, compass = np.radians(100.0), np.radians(130.0)
        ours = turned.radiance([math.sin(world) * 0.8, math.cos(world) * 0.8, 0.6])
        theirs = sky.radiance([math.sin(compass) * 0.8, math.cos(compass) * 0.8, 0.6])
        assert ours == pytest.approx(theirs, rel=1e-12)
    assert np.all(sky.radiance([0.3, -0.4, -math.sqrt(0.75)]) == sky.ground)
    reflected = 0.2 * sky.irradiance() / np.pi
    assert sky.ground == pytest.approx(reflected, rel=1e-6)


@pytest.mark.parametrize(("tilt", "azimuth"), [(0, 0), (90, 180), (90, 45), (35, 200), (120, 90), (180, 0)])
def test_planes_of_any_tilt(clear, tilt, azimuth):
    rng = np.random.default_rng(3)
    z = 2 * (np.arange(400) + rng.random(400)) / 400 - 1
    a = 2 * np.pi * (np.arange(800) + rng.random(800)) / 800
    z, a = np.meshgrid(z, a)
    directions = np.stack([np.sqrt(1 - z**2) * np.sin(a), np.sqrt(1 - z**2) * np.cos(a), z], axis=-1)
    t, n = np.radians([tilt, azimuth])
    normal = np.array([np.sin(n) * np.sin(t), np.cos(n) * np.sin(t), np.cos(t)])
    cosine = np.clip(directions @ normal, 0, None)
    found = 4 * np.pi * (clear.radiance(directions)[..., 0] * cosine).mean()
    assert found == pytest.approx(clear.irradiance(tilt, azimuth, "sky")[0], rel=3e-3)
    disc = clear.sun
    expected = clear.direct_normal * max(0.0, float(disc.direction @ normal))
    assert clear.irradiance(tilt, azimuth, "sun")[0] == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_closed_forms():
    overcast = Sky.overcast(zenith_luminance=9000)
    assert overcast.horizontal_illuminance == pytest.approx(7 * math.pi / 9 * 9000, rel=1e-9)
    assert overcast.luminance([1.0, 0.0, 1e-12]) == pytest.approx(3000, rel=1e-6)
    uniform = Sky.uniform(zenith_luminance=5000, ground_reflectance=0.0)
    assert uniform.horizontal_illuminance == pytest.approx(math.pi * 5000, rel=1e-9)
    assert uniform.illuminance(90) == pytest.approx(math.pi * 2500, rel=1e-8)


#: Gradation (a, b) and indicatrix (c, d, e) of CIE S 011, table 1, type by type.
STANDARD = {
    1: (4.0, -0.70, 0, -1.0, 0),
    2: (4.0, -0.70, 2, -1.5, 0.15),
    3: (1.1, -0.8, 0, -1.0, 0),
    4: (1.1, -0.8, 2, -1.5, 0.15),
    5: (0, -1.0, 0, -1.0, 0),
    6: (0, -1.0, 2, -1.5, 0.15),
    7: (0, -1.0, 5, -2.5, 0.30),
    8: (0, -1.0, 10, -3.0, 0.45),
    9: (-1.0, -0.55, 2, -1.5, 0.15),
    10: (-1.0, -0.55, 5, -2.5, 0.30),
    11: (-1.0, -0.55, 10, -3.0, 0.45),
    12: (-1.0, -0.32, 10, -3.0, 0.45),
    13: (-1.0, -0.32, 16, -3.0, 0.30),
    14: (-1.0, -0.15, 16, -3.0, 0.30),
    15: (-1.0, -0.15, 24, -2.8, 0.15),
}


@pytest.mark.parametrize("kind", STANDARD)
def test_general_skies_follow_the_standard(kind):
    """L/Lz = f(χ) φ(Z) / (f(Zs) φ(0)) at a hundred directions, the level a zenith luminance."""
    a, b, c, d, e = STANDARD[kind]
    sky = Sky.cie(kind, SUN, zenith_luminance=4000)
    rng = np.random.default_rng(kind)
    z, azimuth = rng.uniform(0.02, 1.0, 100), rng.uniform(0, 2 * np.pi, 100)
    s = np.sqrt(1 - z**2)
    directions = np.column_stack([s * np.sin(azimuth), s * np.cos(azimuth), z])
    chi = np.arccos(np.clip(directions @ SUN.direction, -1, 1))

    def phi(cosine):
        return 1 + a * np.exp(b / cosine)

    def f(angle):
        return 1 + c * (np.exp(d * angle) - math.exp(d * math.pi / 2)) + e * np.cos(angle) ** 2

    expected = 4000 * f(chi) * phi(z) / (f(math.radians(90 - 35.9)) * phi(1.0))
    assert sky.luminance(directions) == pytest.approx(expected, rel=1e-9)
    lit = Sky.cie(kind, SUN, diffuse_illuminance=15000)
    assert lit.illuminance(part="sky") == pytest.approx(15000, rel=1e-6)


@pytest.mark.parametrize("basis", ["tregenza", "reinhart:2", "reinhart:4"])
@pytest.mark.parametrize("value", ["mean", "centre"])
def test_patches_conserve_the_horizontal_irradiance(clear, basis, value):
    patches = SkyPatches.named(basis)
    vector = clear.patches(basis, part="sky", value=value)
    assert vector.shape == (len(patches), 3)
    found = vector[1:, 0] @ patches.projected_solid_angles[1:]
    assert found == pytest.approx(clear.diffuse_horizontal, rel=1e-9)
    assert vector[0] == pytest.approx(clear.ground)
    sun = clear.patches(basis, part="sun")
    assert np.count_nonzero(sun[:, 0]) == 4
    assert sun[:, 0] @ patches.solid_angles == pytest.approx(clear.direct_normal, rel=1e-9)
    assert clear.patches(basis, value=value) == pytest.approx(vector + sun)
    one = clear.patches(basis, part="sun", sun="nearest")
    assert np.flatnonzero(one[:, 0]) == [np.argmax(patches.centres @ clear.sun.direction)]
    assert one.max() == pytest.approx(clear.sun.radiance[0], rel=1e-4)


def test_a_picture_holds_the_sky_and_the_sun(clear):
    image = clear.picture(400, with_sun=True)
    weights = solid_angles(400)
    assert weights.sum() == pytest.approx(2 * math.pi, rel=1e-3)
    column, row = on_picture(clear.sun.direction, 400)
    peak = np.unravel_index(image[..., 0].argmax(), image.shape[:2])
    assert abs(peak[0] + 0.5 - row) < 2
    assert abs(peak[1] + 0.5 - column) < 2
    # South-east: below the middle, and left of it, since east is at the left.
    assert row > 200 > column
    sun = (image - clear.picture(400))[..., 0]
    assert (sun * weights).sum() == pytest.approx(clear.direct_normal, rel=1e-6)
    assert np.all(image[0, 0] == 0)
    assert Sky.uniform(zenith_luminance=1790).picture(64)[32, 32] == pytest.approx([10.0] * 3)


def test_a_table_has_sky_and_ground(clear):
    table = clear.table()
    assert table.luminance.shape == (37, 36)
    assert table.luminance[-1] == pytest.approx(clear.zenith_luminance)
    assert table.luminance[:18] == pytest.approx(float(clear.luminance([0, 0, -1])))
    # Brightest near to the sun: altitude 35, azimuth 120 or 130.
    row, column = np.unravel_index(table.luminance.argmax(), table.luminance.shape)
    assert table.altitudes_deg[row] == 35
    assert table.azimuths_deg[column] in (120, 130)
    lines = table.to_csv().splitlines()
    assert len(lines) == 38
    assert {len(line.split(",")) for line in lines} == {37}
    with pytest.raises(ClerestoryError, match="does not divide"):
        clear.table(7)


def test_solar_watts_have_no_luminance():
    sky = Sky.perez(SUN, direct=700, diffuse=120, quantity="solar")
    assert sky.diffuse_horizontal == pytest.approx(120, rel=1e-9)
    assert sky.direct_normal == pytest.approx(700, rel=1e-9)
    assert sky.global_horizontal == pytest.approx(120 + 700 * math.sin(math.radians(35.9)), rel=1e-9)
    with pytest.raises(ClerestoryError, match="no luminance"):
        sky.luminance(UP)
    with pytest.raises(ClerestoryError, match="unknown"):
        Sky.clear(SUN, quantity="solar")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Sky.perez((-10, 0), direct=0, diffuse=10), "night"),
        (lambda: Sky.clear((-10, 0)), "night"),
        (lambda: Sky.overcast((-10, 0)), "no light"),
        (lambda: Sky.preetham((-1, 0)), "above the horizon"),
        (lambda: Sky.preetham((30, 0), turbidity=1), "turbidity 1"),
        (lambda: Sky.preetham((30, 0), preset="radiance"), "no counterpart"),
        (lambda: Sky.perez(SUN, direct=700), "alone says nothing"),
        (lambda: Sky.perez(SUN), "give one of"),
        (lambda: Sky.perez(SUN, direct=700, diffuse=120, global_horizontal=500), "contradict"),
        (lambda: Sky.perez(SUN, direct=-1, diffuse=120), "not possible"),
        (lambda: Sky.perez(SUN, direct=1, diffuse=0), "no diffuse light"),
        (lambda: Sky.perez(SUN, direct=700, diffuse=120, ground_reflectance=1.2), "0 to 1"),
        (lambda: Sky.perez(SUN, direct=700, diffuse=120, preset="other"), "not known"),
        (lambda: Sky.perez(SUN, direct=700, diffuse=120, colour="pink"), "not known"),
        (lambda: Sky.perez((95, 0), direct=700, diffuse=120), "nowhere"),
        (lambda: Sky.cie(12, SUN), "not how much"),
        (lambda: Sky.cie(16, SUN, zenith_luminance=1), "type from 1"),
        (lambda: Sky.cie(-1, SUN, zenith_luminance=1), "type from 1"),
        (lambda: Sky.cie(12, SUN, zenith_luminance=1, preset="radiance-matrix"), "Perez's sky only"),
        (lambda: Sky.clear(SUN, turbidity=0.5), "turbidity"),
    ],
)
def test_what_makes_no_sense_is_refused(make, words):
    with pytest.raises(ClerestoryError, match=words):
        make()


def test_twilight_has_a_sky_without_sun():
    sky = Sky.perez((-0.3, 270), direct=0, diffuse=25)
    assert sky.sun is None
    assert Sky.perez((-0.3, 270), direct=10, diffuse=25).sun is None
    assert Sky.overcast((-20, 0), diffuse_illuminance=10).horizontal_illuminance == pytest.approx(10)


# Aldrans, 14:00 CET (methods.md 8.6): month, day, altitude and azimuth, all ±0.1°.
ALDRANS = [
    (12, 15.2, 205.4),
    (1, 19.7, 203.5),
    (2, 28.8, 206.0),
    (3, 38.5, 212.2),
    (4, 48.2, 221.3),
    (5, 55.1, 228.7),
    (6, 58.4, 230.0),
]


@pytest.mark.parametrize(("month", "altitude", "azimuth"), ALDRANS)
def test_sun_of_aldrans(month, altitude, azimuth):
    place = Place(47.3, 11.4, 1.0)
    sun = SunPosition.at(place, f"{2021 if month != 12 else 2020}-{month:02d}-21 14:00")
    assert sun.altitude_deg == pytest.approx(altitude, abs=0.1)
    assert sun.azimuth_deg == pytest.approx(azimuth, abs=0.1)


def test_clocks():
    summer = SunPosition.at(Place(47.3, 11.4, "Europe/Vienna"), "2021-06-21 15:00")
    assert summer.altitude_deg == pytest.approx(58.4, abs=0.1)  # daylight saving: 14:00 CET
    utc = SunPosition.at(Place(47.3, 11.4), "2021-06-21 13:00")
    assert utc.azimuth_deg == pytest.approx(summer.azimuth_deg, abs=1e-9)
    for method in ("radiance", "almanac"):
        other = SunPosition.at(Place(47.3, 11.4, "Europe/Vienna"), "2021-06-21 15:00", method=method)
        assert other.altitude_deg == pytest.approx(summer.altitude_deg, abs=0.5), method
        assert other.azimuth_deg == pytest.approx(summer.azimuth_deg, abs=1.0), method
    almanac = SunPosition.at(Place(47.3, 11.4, "Europe/Vienna"), "2021-06-21 15:00", method="almanac")
    assert almanac.altitude_deg == pytest.approx(summer.altitude_deg, abs=0.02)
    assert Place(-33.9, 151.2, "Australia/Sydney").standard_hours(2021) == 10
    assert SunPosition.at(Place(0, 0), "2024-02-29 12:00").day == 60
    assert SunPosition.at(Place(0, 0), "2024-12-31 12:00").day == 365


def test_the_words_of_a_sun():
    assert SunPosition(28.84, 206.0).words == "28.8° above the horizon, azimuth 206.0° (SSW)"
    assert SunPosition(-3.0, 359.0).words == "3.0° below the horizon, azimuth 359.0° (N)"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Place(91, 0), "latitude"),
        (lambda: Place(0, 200), "longitude"),
        (lambda: Place(0, 0, "Mars/Olympus"), "time zone"),
        (lambda: Place(0, 0, 15.0), "time zone"),
        (lambda: SunPosition.at(Place(0, 0), "noon"), "not understood"),
    ],
)
def test_places_and_times_that_do_not_exist(make, words):
    with pytest.raises(ClerestoryError, match=words):
        make()


def test_settings_are_kept(clear):
    settings = clear.settings
    assert settings.light == {"direct": 700.0, "diffuse": 120.0}
    assert settings.sun == SUN
    assert settings.preset == "clerestory"
    assert clear.clearness == pytest.approx(4.1, abs=0.1)
    assert Sky.overcast((30, 0)).clearness is None


def test_preetham_is_as_published():
    """Y, x and y at a direction, with the paper's tables written out for T = 3 and a sun 50° from the zenith."""
    t, zs = 3.0, math.radians(50.0)
    sky = Sky.preetham((40.0, 180.0), turbidity=t)
    zenith, azimuth = math.radians(65.0), math.radians(110.0)
    toward = [math.sin(zenith) * math.sin(azimuth), math.sin(zenith) * math.cos(azimuth), math.cos(zenith)]
    gamma = math.acos(np.dot(toward, SunPosition(40.0, 180.0).direction))

    def f(a, b, c, d, e, theta, angle):
        return (1 + a * math.exp(b / math.cos(theta))) * (1 + c * math.exp(d * angle) + e * math.cos(angle) ** 2)

    luminous = (
        0.1787 * t - 1.4630,
        -0.3554 * t + 0.4275,
        -0.0227 * t + 5.3251,
        0.1206 * t - 2.5771,
        -0.0670 * t + 0.3703,
    )
    red = (-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989, -0.0033 * t + 0.0452)
    green = (
        -0.0167 * t - 0.2608,
        -0.0950 * t + 0.0092,
        -0.0079 * t + 0.2102,
        -0.0441 * t - 1.6537,
        -0.0109 * t + 0.0529,
    )
    chi = (4 / 9 - t / 120) * (math.pi - 2 * zs)
    at_zenith = 1000 * ((4.0453 * t - 4.9710) * math.tan(chi) - 0.2155 * t + 2.4192)
    powers = np.array([zs**3, zs**2, zs, 1.0])
    turbid = np.array([t**2, t, 1.0])
    x_rows = [
        [0.00166, -0.00375, 0.00209, 0],
        [-0.02903, 0.06377, -0.03202, 0.00394],
        [0.11693, -0.21196, 0.06052, 0.25886],
    ]
    y_rows = [
        [0.00275, -0.00610, 0.00317, 0],
        [-0.04214, 0.08970, -0.04153, 0.00516],
        [0.15346, -0.26756, 0.06670, 0.26688],
    ]
    zeniths = (at_zenith, turbid @ x_rows @ powers, turbid @ y_rows @ powers)
    tables = (luminous, red, green)
    lum, x, y = (z * f(*c, zenith, gamma) / f(*c, 0.0, zs) for z, c in zip(zeniths, tables, strict=True))
    assert sky.luminance(toward) == pytest.approx(lum, rel=1e-6)
    # Back from Radiance's R, G and B: their X, Y and Z by its primaries, white 0.3333.
    primaries = np.array([[0.640, 0.330, 0.030], [0.290, 0.600, 0.110], [0.150, 0.060, 0.790]]).T
    scale = np.linalg.solve(primaries, np.array([0.3333, 0.3333, 0.3334]) / 0.3333)
    xyz = primaries * scale @ sky.radiance(toward)
    assert xyz[:2] / xyz.sum() == pytest.approx([x, y], abs=1e-6)


@pytest.mark.parametrize("altitude", [0.5, 2, 20, 60, 85, 89.9])
@pytest.mark.parametrize(("direct", "diffuse"), [(60, 30), (900, 60), (5, 3), (1000, 5), (0, 1), (0, 600), (1300, 300)])
def test_any_light_has_a_sky(altitude, direct, diffuse):
    """Also where Perez's coefficients are not sound."""
    sky = Sky.perez((altitude, 77.0), direct=direct, diffuse=diffuse, quantity="solar")
    assert sky.irradiance(part="sky")[0] == pytest.approx(diffuse, rel=1e-6)
    directions = np.random.default_rng(1).normal(size=(2000, 3))
    assert np.all(np.isfinite(sky.radiance(directions)))
    assert np.all(sky.radiance(directions) >= 0)
