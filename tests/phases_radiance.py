"""Matrices and years of a room by Radiance's programs: rfluxmtx, gendaymtx and dctimestep.

A folder holds what they share: `empty.oct`, the room without its windows, `window.rad`, where the windows' patches
begin and end, and `sky.rad`, the ground and the patches of the sky.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import room_radiance
from clerestory.annual.exchange import read
from room_radiance import WEIGHTS, run

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from clerestory.room import Room

THREADS = ("-n", "2")
#: Directions as they are, without the jitter by which tables are smoothed; the sun as large as it is.
EXACT = ("-ss", "0", "-dj", "1")


def prepare(folder: Path, surfaces: Sequence[str], windows: Sequence[str], *, sky: str = "r1") -> None:
    """The room and its windows in one plane for the programs; `sky` is its division, r1 to r6."""
    (folder / "room.rad").write_text("\n".join(surfaces) + "\n")
    (folder / "empty.oct").write_bytes(run("oconv", "room.rad", folder=folder))
    head = ["void glow window 0 0 4 1 1 1 0", "#@rfluxmtx h=kf u=+Z"]
    (folder / "window.rad").write_text("\n".join([*head, *windows]) + "\n")
    (folder / "sky.rad").write_text(
        "void glow ground_glow 0 0 4 1 1 1 0\n#@rfluxmtx h=u u=+Y\nground_glow source ground 0 0 4 0 0 -1 180\n"
        f"void glow sky_glow 0 0 4 1 1 1 0\n#@rfluxmtx h={sky} u=+Y\nsky_glow source sky 0 0 4 0 0 1 180\n"
    )


def prepare_room(folder: Path, room: Room, *, sky: str = "r1") -> None:
    """The same for a room of `room_radiance`."""
    prepare(folder, room_radiance.surfaces(room), room_radiance.panes(room), sky=sky)


def view(
    folder: Path, points: np.ndarray, normals: np.ndarray, *, divisions: int, bounces: int = 12, runs: int = 1
) -> np.ndarray:
    """Irradiance by the radiance of patches (runs, points, patches) [sr]; `bounces` count the way from the window.

    Its random numbers are the same in each process, so runs are rows of one.
    """
    rows = "\n".join(" ".join(f"{v:.9g}" for v in (*p, *d)) for p, d in zip(points, normals, strict=True))
    options = f"-faf -I+ -ab {bounces} -ad {divisions} -lw {0.2 / divisions:.3g} -lr -{bounces + 4} -u+"
    command = ["rfluxmtx", *THREADS, *options.split(), "-y", str(runs * len(points)), "-", "window.rad"]
    data = "\n".join([rows] * runs) + "\n"
    (folder / "view.mtx").write_bytes(run(*command, "-i", "empty.oct", folder=folder, data=data))
    found = read(folder / "view.mtx") @ WEIGHTS
    return found.reshape(runs, len(points), -1)


def view_pictures(
    folder: Path, name: str, rays: np.ndarray, size: tuple[int, int], *, divisions: int, bounces: int
) -> None:
    """Pictures of the windows' patches, `NAME%03d.hdr` in the folder, by the rays (pixels, 6) from the top left."""
    width, height = size
    options = (
        f"-ffc -ab {bounces} -ad {divisions} -lw {0.2 / divisions:.3g} -lr -{bounces + 4} -u+ -x {width} -y {height}"
    )
    command = ["rfluxmtx", *THREADS, *options.split(), "-o", f"{name}%03d.hdr", "-", "window.rad", "-i", "empty.oct"]
    for path in folder.glob(f"{name}???.hdr"):
        path.unlink()
    run(*command, folder=folder, data=rays.astype(np.float32).tobytes())


def daylight(folder: Path, *, samples: int, bounces: int = 1, divisions: int = 64) -> np.ndarray:
    """Radiance of a window's patches by that of the ground and the sky's (patches, sky), in `daylight.mtx`, too.

    `bounces` and `divisions` are of what stands outside.
    """
    options = f"-ff -c {samples} -ab {bounces} -ad {divisions} -lw {0.2 / divisions / samples:.3g} -u+"
    command = ["rfluxmtx", *THREADS, *options.split(), "window.rad", "sky.rad", "-i", "empty.oct"]
    (folder / "daylight.mtx").write_bytes(run(*command, folder=folder))
    return read(folder / "daylight.mtx") @ WEIGHTS


def skies(folder: Path, weather: str, *, divisions: int = 1, more: Sequence[str] = ()) -> np.ndarray:
    """Radiance of the ground and the sky's patches (sky, steps) under a WEA file of the folder, in `sky.mtx`, too.

    Grey, as the years of ours.
    """
    colours = "-c 1 1 1 -g .2 .2 .2"
    command = ["gendaymtx", "-of", "-m", str(divisions), *colours.split(), *more, weather]
    (folder / "sky.mtx").write_bytes(run(*command, folder=folder))
    return read(folder / "sky.mtx") @ WEIGHTS


def product(folder: Path, *factors: str) -> np.ndarray:
    """The product of matrix files (rows, steps), of which the second may be a data set's."""
    (folder / "product.mtx").write_bytes(run("dctimestep", "-of", *factors, folder=folder))
    return read(folder / "product.mtx") @ WEIGHTS


def lights_of(suns: Path) -> list[str]:
    """The suns of a file of gendaymtx, as scenes."""
    text = suns.read_text().split("\n\n")
    return ["\n".join(text[k : k + 2]) for k in range(0, len(text) - 1, 2)]


def direct(
    folder: Path,
    room: Room,
    points: np.ndarray,
    normals: np.ndarray,
    *,
    system: str,
    suns: str,
    divisions: int,
) -> np.ndarray:
    """Illuminance by the suns of a file through a data set, where nothing else is lit (points, suns) [lx].

    The suns are gendaymtx's, in the folder as the data set's file is.
    """
    blacks = [line for line in room_radiance.surfaces(room) if " polygon " in line]
    names = {line.split()[0] for line in blacks}
    black = [f"void plastic {name} 0 0 5 0 0 0 0 0" for name in sorted(names)]
    window = [f"void BSDF window 6 0 {system} 0 0 1 . 0 0", *room_radiance.panes(room)]
    (folder / "black.rad").write_text("\n".join([*black, *blacks, *window]) + "\n")
    found = []
    for light in lights_of(folder / suns):
        (folder / "sun.rad").write_text(light + "\n")
        (folder / "scene.oct").write_bytes(run("oconv", "sun.rad", "black.rad", folder=folder))
        found.append(room_radiance.illuminance(folder, points, normals, *EXACT, divisions=divisions, bounces=1))
    return np.stack(found, axis=-1)
