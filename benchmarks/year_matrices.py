"""The view matrix of a room beside rfluxmtx, and the product of a year beside dctimestep."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import phases_radiance as phases
from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.exchange import read as read_matrix
from clerestory.annual.exchange import write as write_matrix
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.phases import Transfer
from clerestory.annual.year import RoomYear, Sampling
from clerestory.weather import SkyYear
from timing import Pair, alternate, row, seconds, table
from years import BLIND, WEATHER, grid, lit_room, passing, weather_of

#: Paths of a point of ours, divisions of theirs, and those of the reference.
PATHS, THEIRS, LONG = (256, 1024, 4096), (4000, 16000, 64000), (1 << 17, 250_000)


@dataclass(frozen=True)
class _Errors:
    """Of a view matrix beside a reference, relative to its mean."""

    entries: float
    """Of single entries."""
    points: float
    """Of irradiance under an even sky behind an open window."""

    @classmethod
    def of(cls, view: np.ndarray, reference: np.ndarray) -> _Errors:
        entries = np.sqrt(np.mean((view - reference) ** 2)) / reference.mean()
        points = np.sqrt(np.mean((view.sum(axis=1) - reference.sum(axis=1)) ** 2)) / reference.sum(axis=1).mean()
        return cls(float(entries), float(points))


def view(data: Path) -> str:
    """Text of the section."""
    del data  # The room is its own.
    points, normals = grid(12)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made = lit_room()
        phases.prepare_room(folder, made)
        number = iter(range(1000))

        def ours(samples: int) -> np.ndarray:
            cache = Cache(folder / f"cache{next(number)}")
            return RoomMatrices(made, cache=cache, seed=next(number)).view(points, normals, samples=samples).all

        def theirs(divisions: int) -> np.ndarray:
            return phases.view(folder, points, normals, divisions=divisions)[0]

        long = [ours(LONG[0]).astype(float), theirs(LONG[1])]
        reference = np.mean(long, axis=0)
        apart = _Errors.of(long[0], long[1])
        rows = []
        found: dict[str, list[tuple[float, _Errors]]] = {"Radiance": [], "Clerestory": []}
        for program, job, sizes in (("Radiance", theirs, THEIRS), ("Clerestory", ours, PATHS)):
            for size in sizes:
                times, errors = [], []
                for _ in range(3):
                    times.append(seconds(lambda job=job, size=size, errors=errors: errors.append(job(size))))
                each = [_Errors.of(view, reference) for view in errors]
                mean = _Errors(*(float(np.mean([getattr(e, key) for e in each])) for key in ("entries", "points")))
                found[program].append((float(np.median(times)), mean))
                rows.append([program, str(size), times, mean])

        def cost(program: str, key: str) -> float:
            return min(time * getattr(error, key) ** 2 for time, error in found[program])

        lines = [
            [program, size, f"{np.median(times):.2f}", f"{100 * e.entries:.1f} %", f"{100 * e.points:.2f} %"]
            for program, size, times, e in rows
        ]
        ratios = {key: cost("Radiance", key) / cost("Clerestory", key) for key in ("entries", "points")}
    head = ["program", "paths or divisions of a point", "time [s]", "error of entries", "error of illuminance"]
    return f"""### The view matrix of a room

{len(points)} points × 145 patches; rfluxmtx with two processes and 12 bounces, Clerestory with two threads and
paths to their end, each without anything kept from before. The error of entries is their RMS difference to the
reference over its mean; that of illuminance is that of the rows' sums, a window that is evenly bright. The reference is
the mean of both programs' long runs ({LONG[0]} paths, {LONG[1]} divisions), which differ by
{100 * apart.entries:.1f} % and {100 * apart.points:.2f} %. Medians of three runs.

{table(head, lines)}

Speed to equal error, by the least time × error² of each: **{ratios["entries"]:.1f}** for entries,
**{ratios["points"]:.1f}** for illuminance. Aim: 20. rfluxmtx's rays end in one patch each; ours ask a point of each
part of the window wherever they meet a surface, without a ray where nothing can stand between.
"""


def product(data: Path) -> str:
    """Text of the section."""
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        weather, bsdf, made = weather_of(data, folder), passing(data / BLIND), lit_room()
        bsdf.write(folder / "blind.xml")
        phases.prepare_room(folder, made, sky="r4")
        phases.daylight(folder, samples=1000)
        phases.skies(folder, "year.wea", divisions=4)
        matrices = RoomMatrices(made, cache=Cache(folder / "cache"))
        for count in (100, 2000):
            points, normals = grid(count)
            view = matrices.view(points, normals, samples=256)
            write_matrix(folder / "view.mtx", view.all)
            factors = [read_matrix(folder / f"{name}.mtx")[:, :, 1] for name in ("view", "daylight", "sky")]
            in_memory = [np.asarray(factor, dtype=np.float32) for factor in factors]

            def theirs(_: int) -> None:
                phases.run("dctimestep", "-of", "view.mtx", "blind.xml", "daylight.mtx", "sky.mtx", folder=folder)

            def multiplied(_: int, factors: list[np.ndarray] = in_memory) -> None:
                _ = (factors[0] @ Transfer.of(bsdf, matrices.basis).transmission @ factors[1]) @ factors[2]

            def whole(number: int, points: np.ndarray = points, normals: np.ndarray = normals) -> None:
                # Another length of the year's parts, so that none is taken from the cache.
                arrivals = Arrivals(matrices, SkyYear(weather, "reinhart:4"), value="centre")
                year = RoomYear(
                    arrivals, points, normals, method="3-phase", sampling=Sampling(view=256, chunk=200 + number)
                )
                for _ in year.of({"blind": [bsdf]}):
                    pass

            pair = alternate(multiplied, theirs, 2)
            rows.append(row(f"{count} points, the product", pair, unit=1.0))
            anew = Pair([seconds(lambda k=k: whole(k)) for k in range(2)], pair.theirs)
            rows.append(row(f"{count} points, with new skies and kept parts", anew, unit=1.0))
    return f"""### The product of a year

V T D s of {len(weather)} hours under {WEATHER.stem}, MF:4. dctimestep reads V, D and a binary sky matrix that gendaymtx
has made, multiplies three channels and writes a binary result. The product of ours is of one channel (it is grey), of
matrices in memory, with the data set made a matrix; the other rows make the skies of the year anew, multiply, and keep
the parts of the year in the cache. The same runs of dctimestep stand beside both. Aim: 30.

{table(["points", "Clerestory [s]", "Radiance [s]", "ratio", "spread"], rows)}
"""
