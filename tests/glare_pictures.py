"""Pictures with glare sources that tests and benchmarks make, and evalglare on them."""

import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clerestory.picture import Picture, View

FISHEYES = {
    "angular": "-vta -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 180 -vv 180",
    "hemispherical": "-vth -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 180 -vv 180",
}
KEYS = (
    *(
        "dgp",
        "av_lum",
        "E_v",
        "lum_backg",
        "E_v_dir",
        "dgi",
        "ugr",
        "vcp",
        "cgi",
        "lum_sources",
        "omega_sources",
        "Lveil",
    ),
    *("Lveil_cie", "dgr", "ugp", "ugr_exp", "dgi_mod", "av_lum_pos", "av_lum_pos2", "med_lum", "med_lum_pos"),
    *("med_lum_pos2", "ugp2"),
)
NAMES = {
    "dgp": "dgp",
    "av_lum": "mean_luminance",
    "E_v": "vertical_illuminance",
    "lum_backg": "background_luminance",
    "E_v_dir": "direct_illuminance",
    "dgi": "dgi",
    "dgi_mod": "dgi_mod",
    "ugr": "ugr",
    "ugr_exp": "ugr_exp",
    "ugp": "ugp",
    "ugp2": "ugp2",
    "cgi": "cgi",
    "vcp": "vcp",
    "dgr": "dgr",
    "Lveil_cie": "veiling_luminance",
}


def directions(size: int, view: View) -> np.ndarray:
    """Directions (size, size, 3) of pixels; zero where there are none or they are behind the eye."""
    d = np.nan_to_num(view.pixel_directions(size, size))
    d[d @ view.frame[2] <= 0.0] = 0.0
    return d


def disk(d: np.ndarray, view: View, azimuth_deg: float, elevation_deg: float, radius_deg: float) -> np.ndarray:
    """Pixels within a radius about a direction to the right and above the line of sight."""
    a, e = np.radians([azimuth_deg, elevation_deg])
    axis = np.array([np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)]) @ view.frame
    return d @ axis >= np.cos(np.radians(radius_deg))


def grey(luminance: np.ndarray, view: View) -> Picture:
    """A grey picture of luminances [cd/m²]."""
    return Picture(np.repeat((luminance / 179.0)[..., None], 3, axis=2), view)


def disks(size: int, view: View, background: float, *sources: tuple[float, float, float, float]) -> Picture:
    """Disks of (luminance, azimuth, elevation, radius) before an even background."""
    d = directions(size, view)
    luminance = np.where((d != 0).any(axis=-1), background, 0.0)
    for value, azimuth, elevation, radius in sources:
        luminance[disk(d, view, azimuth, elevation, radius)] = value
    return grey(luminance, view)


def window(size: int, view: View, seed: int) -> Picture:
    """A window with mullions, the sun in it, and light slats below."""
    rng = np.random.default_rng(seed)
    d = directions(size, view)
    x, y, z = np.moveaxis(d @ view.frame.T, -1, 0)
    luminance = np.where(z > 0.0, 80.0 + 60.0 * (y + 1.0), 0.0)
    flat_x, flat_y = (np.divide(v, z, out=np.full_like(z, 99.0), where=z > 0.05) for v in (x, y))
    left, low = rng.uniform(-1.2, -0.4), rng.uniform(-0.3, 0.0)
    inside = (flat_x > left) & (flat_x < left + 1.3) & (flat_y > low) & (flat_y < low + 0.9)
    bars = (np.mod(flat_x - left, 0.45) < 0.06) | (np.mod(flat_y - low, 0.4) < 0.05)
    luminance[inside & ~bars] = rng.uniform(2500.0, 9000.0)
    luminance[inside & bars] = 400.0
    luminance[disk(d, view, rng.uniform(-30, 30), rng.uniform(10, 35), 1.2)] = rng.uniform(2e5, 5e7)
    colour = rng.uniform(0.6, 1.0, 3)
    return Picture((luminance / 179.0)[..., None] * colour, view)


def scattered(size: int, view: View, seed: int, count: int) -> Picture:
    """Many small sources of all luminances before a noisy background."""
    rng = np.random.default_rng(seed)
    d = directions(size, view)
    luminance = np.where((d != 0).any(axis=-1), rng.uniform(50.0, 400.0, (size, size)), 0.0)
    for _ in range(count):
        place = rng.uniform(-80, 80), rng.uniform(-60, 75), rng.uniform(0.8, 5.0)
        luminance[disk(d, view, *place)] = 10.0 ** rng.uniform(3.2, 6.0)
    return grey(luminance, view)


@dataclass
class Printed:
    """What evalglare printed."""

    values: dict[str, float]
    sources: list[dict[str, float]]


def evalglare(program: Path, path: Path, *options: str) -> Printed:
    """Runs evalglare on a picture."""
    run = subprocess.run([str(program), "-d", *options, str(path)], capture_output=True, text=True, check=False)
    lines = run.stdout.splitlines()
    values = [line for line in lines if line.startswith("dgp,")]
    if not values:
        raise AssertionError(run.stdout + run.stderr)
    names, _, numbers = values[0].partition(":")
    assert tuple(names.split(",")) == KEYS
    sources = []
    for line in lines:
        words = line.split()
        if words and words[0].isdigit() and words[0] != "0" and words[1] != "No":
            numbers_of = [float(word) for word in words]
            sources.append(
                {"pixels": numbers_of[1], "luminance": numbers_of[4], "omega": numbers_of[5], "P": numbers_of[6]}
            )
    return Printed(dict(zip(KEYS, map(float, numbers.split()), strict=True)), sources)
