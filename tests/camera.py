"""A camera with a fisheye that tests make: a known scene, lens, response, noise, and files with EXIF."""

from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

import numpy as np
import tifffile
from PIL import Image
from PIL.TiffImagePlugin import IFDRational

from clerestory.photo import Lens, Vignetting

TIMES = [Fraction(1, n) for n in (15, 30, 60, 125, 250, 500, 1000, 2000, 4000)]
"""The series of the report, section 2.8."""
SRGB = np.array([0.2126, 0.7152, 0.0722])


def scene(d: np.ndarray, source: float = 9000.0) -> np.ndarray:
    """Red, green and blue (..., 3) [cd/m², each a share of the luminance] in directions of the camera's frame.

    A room with walls of a gentle gradient, panels of other colours, a window and a bright small source in it.
    """
    x, y, z = np.moveaxis(d, -1, 0)
    azimuth, elevation = np.degrees(np.arctan2(x, z)), np.degrees(np.arcsin(np.clip(y, -1, 1)))
    grey = 60.0 + 50.0 * (y + 1.0) + 15.0 * x
    colour = np.ones((*grey.shape, 3))
    rgb = grey[..., None] * colour
    for k, (a, e, value, tint) in enumerate(
        [
            (-60, -30, 20.0, (1.0, 0.9, 0.7)),
            (-35, -30, 45.0, (1.0, 1.0, 1.0)),
            (-10, -35, 150.0, (1.0, 1.0, 1.0)),
            (20, -35, 320.0, (1.2, 0.95, 0.8)),
            (45, -30, 800.0, (1.0, 1.0, 1.0)),
            (-50, 30, 6.0, (1.0, 1.0, 1.0)),
            (60, 35, 12.0, (0.8, 1.05, 1.2)),
        ]
    ):
        inside = (np.abs(azimuth - a) < 9) & (np.abs(elevation - e) < 9)
        rgb[inside] = value * (1.0 + 0.02 * k) * np.array(tint)
    window = (np.abs(azimuth) < 26) & (elevation > -5) & (elevation < 30)
    rgb[window] = (2500.0 + 60.0 * elevation[window])[..., None] * np.array([0.9, 1.0, 1.15])
    axis = np.array([np.sin(np.radians(8)), np.sin(np.radians(15)), 1.0])
    axis[2] = np.sqrt(1.0 - axis[0] ** 2 - axis[1] ** 2)
    rgb[d @ axis >= np.cos(np.radians(1.5))] = source
    return rgb


def curve(light: np.ndarray) -> np.ndarray:
    """Level from 0 to 1 of light from 0 to 1: a gamma and an S on it."""
    v = np.clip(light, 0.0, 1.0) ** (1.0 / 2.2)
    return v + 0.35 * v * (1.0 - v) * (v - 0.4)


@dataclass
class Maker:
    """A camera on a tripod before the scene."""

    lens: Lens
    shape: tuple[int, int] = (480, 720)
    vignetting: Vignetting = field(default_factory=lambda: Vignetting(coefficients=(-0.12, 0.01)))
    f_number: float = 5.0
    iso: int = 100
    saturation: float = 13.0
    """Luminance times exposure value [cd s/m²] that gives the highest level."""
    noise: float = 0.4
    """Standard deviation [levels of 255]."""
    source: float = 9000.0
    """Of the bright source [cd/m²]."""

    def luminances(self) -> np.ndarray:
        """The scene as the lens lays it out, without vignetting; 0 beyond the lens."""
        height, width = self.shape
        # Three by three rays a pixel.
        offsets = (np.arange(3) + 0.5) / 3
        total = np.zeros((height, width, 3))
        for dx in offsets:
            for dy in offsets:
                x, y = np.meshgrid(np.arange(width) + dx, np.arange(height) + dy)
                d = self.lens.directions(np.stack([x, y], axis=-1))
                behind = ~(d[..., 2] >= 0.0)
                rgb = scene(np.nan_to_num(d), self.source)
                rgb[behind] = 0.0
                total += rgb
        return total / 9.0

    def light(self) -> np.ndarray:
        """What reaches the sensor."""
        v = self.vignetting.at(np.nan_to_num(self.lens.thetas(self.shape)))
        return self.luminances() * v[..., None]

    def exif(self, time: Fraction, **more) -> Image.Exif:
        exif = Image.Exif()
        exif[271], exif[272] = "Canon", "Canon EOS 5D Mark II"
        inner = exif.get_ifd(34665)
        inner[33434] = IFDRational(time.numerator, time.denominator)
        inner[33437] = IFDRational(round(10 * self.f_number), 10)
        inner[34855] = self.iso
        inner[37386] = IFDRational(8, 1)
        inner[41987] = 1
        inner[42036] = "EF8-15mm f/4L FISHEYE USM"
        for tag, value in more.items():
            if value is None:
                del inner[int(tag[1:])]
            else:
                inner[int(tag[1:])] = value
        return exif

    def jpegs(self, folder: Path, times=TIMES, seed: int = 3, quality: int = 97) -> list[Path]:
        """The series as JPEGs."""
        rng = np.random.default_rng(seed)
        light = self.light()
        paths = []
        for k, time in enumerate(times):
            exposed = light * (float(time) * self.iso / self.f_number**2) / self.saturation
            level = 255.0 * curve(exposed) + rng.normal(0.0, self.noise, exposed.shape)
            image = Image.fromarray(np.clip(np.round(level), 0, 255).astype(np.uint8))
            path = folder / f"IMG_{4000 + k}.JPG"
            image.save(path, quality=quality, subsampling=0, exif=self.exif(time))
            paths.append(path)
        return paths

    def tiffs(self, folder: Path, times=TIMES, seed: int = 4) -> list[Path]:
        """The series as linear TIFFs of 16 bits, with photon noise; without EXIF."""
        rng = np.random.default_rng(seed)
        light = self.light()
        paths = []
        for k, time in enumerate(times):
            exposed = light * (float(time) * self.iso / self.f_number**2) / self.saturation
            noisy = exposed + rng.normal(0.0, 1.0, exposed.shape) * np.sqrt(exposed / 40000.0 + 2.0**-24)
            path = folder / f"raw_{k}.tif"
            tifffile.imwrite(path, np.clip(np.round(65535.0 * noisy), 0, 65535).astype(np.uint16), photometric="rgb")
            paths.append(path)
        return paths
