"""The glare year of one view by five phases, beside Radiance's chain of pictures."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

import phases_radiance as phases
from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.exchange import write as write_matrix
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.year import RoomYear, Sampling
from clerestory.room import Room
from clerestory.sky import SkyPatches
from clerestory.weather import SkyYear
from room_radiance import panes, run, surfaces
from timing import seconds, table
from years import BLIND, WEATHER, lit_room, passing, weather_of

#: Pixels along a side of the chain's pictures, and of those by which the work a pixel is measured.
SIZE, SMALL = 400, 32
#: Divisions of rfluxmtx a pixel, hours that are timed.
DIVISIONS, HOURS = 1000, 5
#: Suns by which the work a sun is measured.
SUNS = 40
GLAZING = "void BSDF window 6 0 blind.xml 0 0 1 . 0 0"
EYE = ("-vta", "-vv", "180", "-vh", "180", "-vp", "1.8", "3", "1.2", "-vd", "0", "-1", "0", "-vu", "0", "0", "1")


def _a_pixel(job: Callable[[int], float]) -> float:
    """Time of a pixel [s], without that of starting, of a job that tells its time for a picture of a size."""
    half = SMALL // 2
    less, more = job(half), job(SMALL)
    return (more - less) / (SMALL**2 - half**2)


def _set_up(folder: Path, name: str, bounces: int, pixels: int) -> float:
    """Makes pictures of the windows' patches, `NAME%03d.hdr`, by so many pixels along a side; its time [s]."""
    size = ["-x", str(pixels), "-y", str(pixels)]
    rays = run("vwrays", "-ff", *EYE, *size, folder=folder)
    options = f"-ffc -ab {bounces} -ad {DIVISIONS} -lw {0.2 / DIVISIONS:g} -o small{name}%03d.hdr"
    command = ["rfluxmtx", *phases.THREADS, *options.split(), *size, "-", "window.rad", "-i", "empty.oct"]
    for path in folder.glob(f"small{name}*.hdr"):
        path.unlink()
    taken = seconds(lambda: run(*command, folder=folder, data=rays))
    for path in sorted(folder.glob(f"small{name}*.hdr")):
        large = run("pfilt", "-1", "-x", str(SIZE), "-y", str(SIZE), path.name, folder=folder)
        (folder / path.name.removeprefix("small")).write_bytes(large)
    return taken


def _hour(folder: Path, step: int) -> None:
    """One hour's picture and its glare: the sun's picture is one of those of C_ds, and is added."""
    for name, sky in (("full", "sky"), ("direct", "sun")):
        picture = run("dctimestep", f"{name}%03d.hdr", "blind.xml", "daylight.mtx", f"{sky}{step}.mtx", folder=folder)
        (folder / f"{name}.hdr").write_bytes(picture)
    added = run("pcomb", "-s", "1", "full.hdr", "-s", "-1", "direct.hdr", "-s", "1", "direct.hdr", folder=folder)
    (folder / "hour.hdr").write_bytes(added)
    run("evalglare", *EYE, "hour.hdr", folder=folder)


def _suns(folder: Path, room: Room, directions: np.ndarray, pixels: int) -> float:
    """Time of pictures of the direct light of some suns through the data set, by pixels along a side [s]."""
    lines = []
    for k, (x, y, z) in enumerate(directions):
        lines.append(f"void light solar{k} 0 0 3 1e6 1e6 1e6\nsolar{k} source sun{k} 0 0 4 {x} {y} {z} 0.533")
    (folder / "suns.rad").write_text("\n".join(lines) + "\n")
    (folder / "glazed.rad").write_text("\n".join([GLAZING, *surfaces(room), *panes(room)]) + "\n")
    (folder / "suns.oct").write_bytes(run("oconv", "suns.rad", "glazed.rad", folder=folder))
    rays = run("vwrays", "-ff", *EYE, "-x", str(pixels), "-y", str(pixels), folder=folder)
    names = [word for k in range(len(directions)) for word in ("-m", f"solar{k}")]
    options = "-h -fo+ -ffc -ab 1 -ad 256 -lw 1e-3 -dc 1 -dt 0 -dj 0 -st 0 -o sun_%s.hdr"
    size = ["-x", str(pixels), "-y", str(pixels)]
    command = ["rcontrib", *phases.THREADS, *options.split(), *size, *names, "suns.oct"]
    return seconds(lambda: run(*command, folder=folder, data=rays))


def report(data: Path) -> str:
    """Text of the section."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made, weather, bsdf = lit_room(), weather_of(data, folder), passing(data / BLIND)
        bsdf.write(folder / "blind.xml")
        phases.prepare_room(folder, made, sky="r4")
        skies = SkyYear(weather, "reinhart:4")
        lit = np.flatnonzero(skies.is_lit & (skies.suns.irradiance > 0.0))
        pixels = SIZE**2
        each = [_a_pixel(lambda size, n=n, b=b: _set_up(folder, n, b, size)) for n, b in (("full", 5), ("direct", 1))]
        matrices = pixels * sum(each)
        daylight = seconds(lambda: phases.daylight(folder, samples=5000))
        some = lit[:: len(lit) // SUNS][:SUNS]
        directions = skies.suns.directions[some]
        few, many = (_a_pixel(lambda size, n=n: _suns(folder, made, directions[:n], size)) for n in (SUNS // 4, SUNS))
        # The rays are traced once for all suns, and each sun has its share of the rest.
        suns = np.unique(SkyPatches.named("reinhart:6").index_of(skies.suns.directions[lit]))
        by_suns = pixels * (few + (many - few) / (SUNS - SUNS // 4) * max(len(suns) - SUNS // 4, 0))

        hours = lit[:: len(lit) // HOURS][:HOURS]
        for step in hours.tolist():
            for sky, part in (("sky", "all"), ("sun", "sun")):
                column = skies.columns(slice(step, step + 1), part=part)
                write_matrix(folder / f"{sky}{step}.mtx", np.asarray(column))
        times = [seconds(lambda step=step: _hour(folder, step)) for step in hours.tolist()]
        daylit = int(skies.is_lit.sum())
        theirs = matrices + daylight + by_suns + float(np.median(times)) * daylit

        eyes = {"eye": ([1.8, 3.0, 1.2], [0.0, -1.0, 0.0])}

        def ours(cache: Path, chunk: int) -> None:
            arrivals = Arrivals(RoomMatrices(made, cache=Cache(cache)), skies)
            for _ in RoomYear(arrivals, eyes=eyes, sampling=Sampling(chunk=chunk)).of({"blind": [bsdf]}):
                pass

        cold = [seconds(lambda k=k: ours(folder / f"cold{k}", 256)) for k in range(3)]
        # The matrices of the room are there, and no part of the year: other parts are asked for.
        warm = [seconds(lambda k=k: ours(folder / "cold0", 250 + k)) for k in range(3)]
        again = [seconds(lambda: ours(folder / "cold0", 256)) for _ in range(3)]
    rows = [
        ["Radiance: pictures of V and V_d (145 each)", f"{matrices:.0f}"],
        ["Radiance: D, 5,000 rays a patch", f"{daylight:.1f}"],
        [f"Radiance: pictures of C_ds, {len(suns)} suns of MF:6 that occur", f"{by_suns:.0f}"],
        ["Radiance: an hour (two dctimestep, pcomb, evalglare)", f"{np.median(times):.2f}"],
        [f"Radiance: the year, {daylit} hours", f"{theirs:.0f}"],
        ["Clerestory: the year, empty cache", f"{np.median(cold):.1f}"],
        ["Clerestory: the year, matrices of the room in the cache", f"{np.median(warm):.1f}"],
        ["Clerestory: the year again", f"{np.median(again):.2f}"],
    ]
    return f"""### The glare year of one view

An eye in a room, {len(weather)} hours of {WEATHER.stem}, {BLIND.name}, five phases, MF:4.
Radiance's chain: pictures of {SIZE} × {SIZE} pixels by rfluxmtx ({DIVISIONS} divisions, 5 bounces) and rcontrib, two
processes each, then dctimestep, pcomb and evalglare. Its matrices are measured by what {SMALL} × {SMALL} pixels take
longer than a quarter of them, its hours on {HOURS} of them, and both are scaled by the numbers of pixels, suns and
hours: the year itself was not run. Clerestory has two threads and no pictures (docs/annual.md); its DGP agrees with
that of pictures of the same moments (tests/physics/test_year_at_eyes.py). Medians of three runs.

{table(["what", "time [s]"], rows)}

Ratio: **{theirs / np.median(cold):.0f}** with an empty cache, **{theirs / np.median(warm):.0f}** with the
room's matrices in it; of the hours alone **{np.median(times) * daylit / np.median(warm):.0f}**. Aim: 100.
"""
