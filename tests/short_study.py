"""A small room, films and a few days of weather, for studies that are done in seconds."""

import numpy as np

from clerestory import Bsdf, Model

BOX = {
    "width_m": 3.0,
    "depth_m": 4.0,
    "height_m": 3.0,
    "openings": [{"wall": "south", "width_m": 2.0, "height_m": 1.6, "sill_m": 0.9, "system": "window"}],
}
"""A room, as the table of a recipe."""
ROOM = """
[place]
latitude = 47.3
longitude = 11.4
timezone = "Etc/GMT-1"
[sky]
kind = "overcast"
[room]
width_m = 3.0
depth_m = 4.0
height_m = 3.0
[[room.openings]]
wall = "south"
width_m = 2.0
height_m = 1.6
sill_m = 0.9
system = "pane"
[systems.pane]
glass = 0.7
[views.desk]
point_m = [1.5, 2.0, 1.2]
direction = [0, -1, 0]
[sensors.plane]
height_m = 0.8
spacing_m = 1.5
"""
HEAD = """place Innsbruck
latitude 47.3
longitude -11.4
time_zone -15
site_elevation 600
weather_data_file_units 1
"""


def film(folder, transmittance, reflectance=0.5):
    """Table of a system that scatters evenly, from a file that is written."""
    parts = {
        (side, scatter): Model.lambertian(value)
        for side in ("exterior", "interior")
        for scatter, value in (("transmission", transmittance), ("reflection", reflectance))
    }
    Bsdf.from_models(parts).save(folder / "film.bsdf.npz")
    return {"file": str(folder / "film.bsdf.npz")}


def days(numbers, *, months=(3,)):
    """Weather of some days of months, sunny and grey in turn."""
    lines = []
    for month in months:
        for day in numbers:
            for hour in range(24):
                high = max(0.0, np.sin(np.pi * (hour + 0.5 - 6.0) / 12.0))
                lines.append(f"{month} {day} {hour + 0.5} {800 * high * (day % 2 == 0):.0f} {150 * high:.0f}")
    return HEAD + "\n".join(lines) + "\n"
