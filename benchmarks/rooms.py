"""A fisheye with a tensor-tree blind: ours beside Radiance with its ambient cache, at equal error over 48 regions."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np

import room_radiance
from clerestory import room
from clerestory.picture import Picture, View
from clerestory.room import Room
from timing import table

SIZE = 400
RINGS, SECTORS = 4, 12
#: Paths a pixel of ours, and of the reference.
OURS, REFERENCE = (2, 8, 32), 192
#: Radiance's ambient divisions and accuracy: coarse and usual.
THEIRS = ((256, 0.25), (1024, 0.15))


def _regions(view: View) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Region of each pixel (-1 outside of the hemisphere), solid angle [sr], and cosine to the line of sight."""
    solid_angles = view.solid_angles(SIZE, SIZE)
    at = (np.arange(SIZE) + 0.5) / SIZE
    x, y = np.meshgrid(at - 0.5, 0.5 - at)
    theta, phi = np.pi * np.hypot(x, y), np.arctan2(y, x) % (2 * np.pi)
    ring = np.minimum((RINGS * (1.0 - np.cos(theta))).astype(int), RINGS - 1)
    sector = np.minimum((SECTORS * phi / (2 * np.pi)).astype(int), SECTORS - 1)
    inside = theta < np.pi / 2
    return np.where(inside, SECTORS * ring + sector, -1), solid_angles, np.where(inside, np.cos(theta), 0.0)


class _Measure:
    """Means over regions and illuminance at the eye of pictures of one view."""

    def __init__(self, view: View) -> None:
        self.region, self.solid_angle, self.cos = _regions(view)

    def __call__(self, luminance: np.ndarray) -> tuple[np.ndarray, float]:
        inside = self.region >= 0
        flux = np.bincount(self.region[inside], (luminance * self.solid_angle)[inside], RINGS * SECTORS)
        area = np.bincount(self.region[inside], self.solid_angle[inside], RINGS * SECTORS)
        return flux / area, float((luminance * self.solid_angle * self.cos).sum())


def _radiance(folder: Path, view: str, divisions: int, accuracy: float) -> tuple[np.ndarray, float]:
    """Luminance of Radiance's picture, and its time [s]: rpict's job by vwrays and rtrace, whose two processes share
    the ambient cache.
    """
    options = (
        f"-ab 6 -ad {divisions} -as {divisions // 2} -aa {accuracy} -ar 64 -lw {0.1 / divisions:.2g} -lr -10 -ds .05 "
        "-dj .8 -dt 0 -dc 1 -st 0.01 -ss 1 -af ambient -n 2"
    )
    (folder / "ambient").unlink(missing_ok=True)
    size = f"-x {SIZE} -y {SIZE}"
    started = time.perf_counter()
    rays = room_radiance.run("vwrays", "-ff", "-pj", "1", *size.split(), *view.split(), folder=folder)
    command = ["rtrace", "-ffc", *size.split(), *options.split(), "scene.oct"]
    found = room_radiance.run(*command, folder=folder, data=rays)
    seconds = time.perf_counter() - started
    path = folder / "radiance.hdr"
    path.write_bytes(found)
    return Picture.read(path).luminance.astype(float), seconds


def _made(data: Path, folder: Path) -> Room:
    (folder / "window.xml").write_bytes((data / "tensortree" / "b30.xml").read_bytes())
    system = {"file": str(folder / "window.xml"), "treatment": "high"}
    made = room.load(room_radiance.tables(system, sun=True, sky=True))
    room_radiance.octree(made, "void BSDF window 6 0 window.xml 0 0 1 . 0 0", folder, sun=True, sky=True)
    return made


def report(data: Path) -> str:
    """Text of the section."""
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made = _made(data, folder)
        view = made.view("eye").model_copy(update={"size_px": [SIZE, SIZE]})
        started = time.perf_counter()
        made = _made(data, folder)
        preparing = time.perf_counter() - started
        reference = made.picture(view, samples=REFERENCE, seed=99)
        options = reference.view
        measure = _Measure(View(options))
        means, eye = measure(reference.luminance)

        def error(luminance: np.ndarray) -> tuple[float, float]:
            found, found_eye = measure(luminance)
            return float(np.sqrt(np.mean((found - means) ** 2)) / means.mean()), found_eye / eye - 1.0

        costs = []
        for divisions, accuracy in THEIRS:
            luminance, seconds = _radiance(folder, options, divisions, accuracy)
            rms, at_eye = error(luminance)
            costs.append(seconds * rms**2)
            words = f"Radiance, -ad {divisions} -aa {accuracy:g}"
            rows.append([words, f"{seconds:.1f}", f"{100 * rms:.2f} %", f"{100 * at_eye:+.2f} %", ""])
        for samples in OURS:
            started = time.perf_counter()
            found = made.picture(view, samples=samples, seed=samples)
            seconds = time.perf_counter() - started + preparing
            rms, at_eye = error(found.luminance)
            ratio = f"{min(costs) / (seconds * rms**2):.0f}"
            words = f"Clerestory, {samples} paths a pixel"
            rows.append([words, f"{seconds:.1f}", f"{100 * rms:.2f} %", f"{100 * at_eye:+.2f} %", ratio])
    return f"""### A fisheye in a room

A room with a tensor-tree blind (b30.xml) under gensky's clear sky with its sun, {SIZE} × {SIZE} pixels. The error
is the RMS difference of the mean luminances of {RINGS * SECTORS} regions of equal solid angle to the reference,
over their mean; the reference is Clerestory's picture of {REFERENCE} paths a pixel, whose illuminances agree with
rtrace's (tests/conformance). Radiance does rpict's job by vwrays and rtrace, with two processes that share the
ambient cache, one ray a pixel; Clerestory has two threads, and reading and preparing the data set counts. The last
column is the least time × error² of Radiance over the row's. Aim: 20.

{table(["program", "time [s]", "error of regions", "E_v, relative", "speed to equal error"], rows)}
"""
