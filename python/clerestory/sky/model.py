"""Skies: radiance from every direction, made from weather or by a standard."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.photometry import EFFICACY, LUMINANCE
from clerestory.sky.patches import SkyPatches
from clerestory.sky.position import SunPosition
from clerestory.sky.settings import (
    LEVELS,
    SOLAR_DIAMETER_DEG,
    Part,
    SkySettings,
    choices_of,
    light_of,
    moment_of,
    settings_of,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class SunDisc:
    """The disc of the sun."""

    direction: NDArray[np.float64]
    """Unit vector (3,) toward its centre, in the world."""
    radiance: NDArray[np.float64]
    """Of R, G and B (3,) [W/(m² sr)]."""
    half_angle_deg: float
    """Half of its diameter [°]."""

    @property
    def luminance(self) -> float:
        """Luminance of the disc [cd/m²]."""
        return float(EFFICACY * self.radiance @ LUMINANCE)


@dataclass(frozen=True)
class SkyTable:
    """Luminances on a grid of altitude and azimuth, as other programs read them."""

    altitudes_deg: NDArray[np.float64]
    """From -90 to 90 (n,)."""
    azimuths_deg: NDArray[np.float64]
    """In the world, clockwise from its y axis (m,)."""
    luminance: NDArray[np.float64]
    """Without the sun's disc (n, m) [cd/m²]."""

    def to_csv(self) -> str:
        """Luminances [cd/m²]: a row an altitude [°], a column an azimuth [°], which the first row has."""
        head = "altitude\\azimuth," + ",".join(f"{a:g}" for a in self.azimuths_deg)
        rows = (
            f"{altitude:g}," + ",".join(f"{value:.6g}" for value in row)
            for altitude, row in zip(self.altitudes_deg, self.luminance, strict=True)
        )
        return "\n".join([head, *rows]) + "\n"


class Sky:
    """A sky with its sun and ground, from every direction of the world (x east, y north, z up).

    Radiances are W/(m² sr) of Radiance's R, G and B: visible watts of 179 lm, or solar ones. The disc of the sun is not
    in `radiance`; it is `sun`. A sky does not change.

    All constructors share these parameters:

    sun
        Where the sun is: a `SunPosition`, or altitude and compass azimuth [°].
    preset
        `clerestory`: the diffuse horizontal irradiance is that which was given (by quadrature to 1e-9), the ground's
        radiance is its reflectance × E/π, the horizon is sharp. `radiance`: as `gendaylit` and `gensky`.
        `radiance-matrix`: as `gendaymtx`, for `patches` of a `perez` sky.
    quantity
        `visible` or `solar` watts.
    colour
        `grey`, `radiance` (that of `gendaymtx`: 0.960, 1.004, 1.118), or factors of R, G and B.
    ground_reflectance
        0 to 1.
    north_deg
        Compass azimuth of the world's y axis, for a building that is turned.
    dew_point
        For water vapour in the luminous efficacy [°C]; 2 cm of water by default.
    """

    def __init__(self, core: _core.Sky, settings: SkySettings, traditional: str | None = None) -> None:
        self._core = core
        self.settings = settings
        self.traditional = traditional
        """Which of gensky's skies it is."""

    @classmethod
    def perez(
        cls,
        sun: SunPosition | tuple[float, float],
        *,
        direct: float | None = None,
        diffuse: float | None = None,
        direct_illuminance: float | None = None,
        diffuse_illuminance: float | None = None,
        global_horizontal: float | None = None,
        **common: Any,  # noqa: ANN401 (see the class)
    ) -> Sky:
        """Perez's all-weather sky.

        Parameters
        ----------
        sun, **common
            See the class.
        direct, diffuse
            Direct normal and diffuse horizontal irradiance [W/m²].
        direct_illuminance, diffuse_illuminance
            The same as illuminances [lx].
        global_horizontal
            Global horizontal irradiance [W/m²]; divided by Erbs' correlation, a rough estimate.

        Raises
        ------
        ClerestoryError
            It is night, or the light is not possible.
        """
        given = light_of(direct, diffuse, direct_illuminance, diffuse_illuminance, global_horizontal)
        if given is None:
            raise ClerestoryError(f"Perez's sky is made from irradiances or illuminances (give one of {LEVELS})")
        settings = settings_of("Perez all-weather", sun, given[1], **common)
        return cls(_core.Sky.perez(moment_of(settings), given[0], choices_of(settings)), settings)

    @classmethod
    def cie(
        cls,
        kind: int,
        sun: SunPosition | tuple[float, float],
        *,
        direct: float | None = None,
        diffuse: float | None = None,
        direct_illuminance: float | None = None,
        diffuse_illuminance: float | None = None,
        global_horizontal: float | None = None,
        zenith_luminance: float | None = None,
        **common: Any,  # noqa: ANN401 (see the class)
    ) -> Sky:
        """A general sky of CIE (S 011/E:2003, ISO 15469:2004), type 1 (overcast) to 15.

        Its level is the diffuse part of what `perez` takes, or the luminance of the zenith [cd/m²]; the sun shines with
        the direct part.
        """
        names = _core.cie_names()
        given = light_of(direct, diffuse, direct_illuminance, diffuse_illuminance, global_horizontal, zenith_luminance)
        if given is None:
            raise ClerestoryError(
                f"CIE sky {kind} says how light is distributed, not how much there is (give one of {LEVELS}, or the "
                "luminance of the zenith)"
            )
        words = f"CIE {kind}: {names[kind - 1]}" if 1 <= kind <= len(names) else f"CIE {kind}"
        settings = settings_of(words, sun, given[1], **common)
        if kind < 0:
            raise ClerestoryError(f"CIE sky {kind} is not one of the general skies (give a type from 1 to 15)")
        return cls(_core.Sky.cie(kind, moment_of(settings), given[0], choices_of(settings)), settings)

    @classmethod
    def overcast(cls, sun: SunPosition | tuple[float, float] = (90.0, 180.0), **options: Any) -> Sky:  # noqa: ANN401
        """CIE's traditional overcast sky, (1 + 2 sin altitude)/3 of the zenith.

        Parameters
        ----------
        sun
            Gives its level if nothing else does; its position is not seen.
        **options
            What `cie` takes; without any level that of Radiance's `gensky` for the sun's altitude.
        """
        return cls._traditional("overcast", sun, **options)

    @classmethod
    def uniform(cls, sun: SunPosition | tuple[float, float] = (90.0, 180.0), **options: Any) -> Sky:  # noqa: ANN401
        """A sky of one luminance; parameters as those of `overcast`."""
        return cls._traditional("uniform", sun, **options)

    @classmethod
    def clear(cls, sun: SunPosition | tuple[float, float], **options: Any) -> Sky:  # noqa: ANN401
        """CIE's traditional clear sky.

        Parameters
        ----------
        sun
            See the class.
        **options
            What `cie` takes; without any level the zenith's luminance is that of `turbidity` (2.45 by default) after
            `gensky`. `sunny=False` leaves the sun out of it.
        """
        return cls._traditional("clear", sun, **options)

    @classmethod
    def intermediate(cls, sun: SunPosition | tuple[float, float], **options: Any) -> Sky:  # noqa: ANN401
        """The intermediate sky of `gensky`; parameters as those of `clear`."""
        return cls._traditional("intermediate", sun, **options)

    @classmethod
    def _traditional(
        cls,
        kind: str,
        sun: SunPosition | tuple[float, float],
        *,
        direct: float | None = None,
        diffuse: float | None = None,
        direct_illuminance: float | None = None,
        diffuse_illuminance: float | None = None,
        global_horizontal: float | None = None,
        zenith_luminance: float | None = None,
        turbidity: float | None = None,
        sunny: bool = True,
        **common: Any,  # noqa: ANN401 (see the class)
    ) -> Sky:
        given = light_of(
            direct, diffuse, direct_illuminance, diffuse_illuminance, global_horizontal, zenith_luminance, turbidity
        ) or (("turbidity", 2.45, 0.0), {"turbidity": 2.45} if kind in ("clear", "intermediate") else {})
        settings = settings_of(f"CIE {kind}" if kind != "uniform" else kind, sun, given[1], **common)
        core = _core.Sky.traditional(kind, sunny, moment_of(settings), given[0], choices_of(settings))
        return cls(core, settings, kind)

    @classmethod
    def preetham(
        cls,
        sun: SunPosition | tuple[float, float],
        *,
        turbidity: float = 3.0,
        direct: float | None = None,
        diffuse: float | None = None,
        direct_illuminance: float | None = None,
        diffuse_illuminance: float | None = None,
        coloured: bool = True,
        **common: Any,  # noqa: ANN401 (see the class)
    ) -> Sky:
        """Preetham's clear sky with its colours ("Utah" sky).

        Parameters
        ----------
        sun, **common
            See the class; the preset `radiance` has no counterpart.
        turbidity
            2 (very clear) to 10 (haze). Without irradiances or illuminances it gives the level of sky and sun.
        direct, diffuse, direct_illuminance, diffuse_illuminance
            Level, as for `perez`.
        coloured
            False for a grey sky of the same luminance. The sun is always white.
        """
        given = light_of(direct, diffuse, direct_illuminance, diffuse_illuminance)
        light = {"turbidity": turbidity, **(given[1] if given else {})}
        settings = settings_of("Preetham" if coloured else "Preetham, grey", sun, light, **common)
        core = _core.Sky.preetham(
            turbidity, not coloured, moment_of(settings), given[0] if given else None, choices_of(settings)
        )
        return cls(core, settings)

    def __repr__(self) -> str:
        return f"<Sky {self.settings.kind!r}, sun {self.settings.sun.words}>"

    # Radiance and luminance

    def radiance(self, directions: ArrayLike) -> NDArray[np.float64]:
        """Radiance (..., 3) [W/(m² sr)] from directions (..., 3), without the sun's disc.

        Below the horizon it is the ground's.
        """
        vectors = np.asarray(directions, dtype=np.float64)
        if vectors.shape[-1:] != (3,):
            raise ClerestoryError("directions are triples x, y, z (give an array of 3 columns)")
        return self._core.radiance(np.ascontiguousarray(vectors.reshape(-1, 3))).reshape(vectors.shape)

    def luminance(self, directions: ArrayLike) -> NDArray[np.float64]:
        """Luminance (...) [cd/m²] from directions (..., 3), without the sun's disc."""
        self._visible("luminance")
        luminance: NDArray[np.float64] = EFFICACY * (self.radiance(directions) @ LUMINANCE)
        return luminance

    @property
    def sun(self) -> SunDisc | None:
        """Disc of the sun, if it is above the horizon and shines."""
        found = self._core.sun
        if found is None:
            return None
        direction, radiance, half_angle = found
        return SunDisc(np.array(direction), np.array(radiance), math.degrees(half_angle))

    @property
    def sun_direction(self) -> NDArray[np.float64]:
        """Unit vector (3,) of the world toward the sun that the sky is built about."""
        return np.array(SunPosition(*self._core.position).direction)

    @property
    def ground(self) -> NDArray[np.float64]:
        """Radiance (3,) of the ground."""
        return np.array(self._core.ground)

    @property
    def zenith_luminance(self) -> float:
        """Luminance of the zenith [cd/m²]."""
        return float(self.luminance([0.0, 0.0, 1.0]))

    # Irradiance and illuminance

    def irradiance(self, tilt_deg: float = 0.0, azimuth_deg: float = 180.0, part: Part = "all") -> NDArray[np.float64]:
        """Irradiance (3,) [W/m² of R, G and B] on a plane.

        Parameters
        ----------
        tilt_deg
            Angle between its normal and the zenith: 0 looks up, 90 is a façade.
        azimuth_deg
            Where its normal points to, clockwise from the world's y axis.
        part
            `all`; `sky` is the sky with the ground; `sun` is the disc alone.
        """
        tilt, azimuth = math.radians(tilt_deg), math.radians(azimuth_deg)
        normal = np.array([[math.sin(azimuth) * math.sin(tilt), math.cos(azimuth) * math.sin(tilt), math.cos(tilt)]])
        if not np.all(np.isfinite(normal)):
            raise ClerestoryError(f"a plane of tilt {tilt_deg}° and azimuth {azimuth_deg}° is not possible")
        total = np.zeros(3)
        if part != "sun":
            total += self._core.diffuse_on(normal)[0]
        if part != "sky":
            total += self._core.direct_on(normal)[0]
        return total

    def illuminance(self, tilt_deg: float = 0.0, azimuth_deg: float = 180.0, part: Part = "all") -> float:
        """Illuminance [lx] on a plane; parameters as those of `irradiance`."""
        self._visible("illuminance")
        return float(EFFICACY * self.irradiance(tilt_deg, azimuth_deg, part) @ LUMINANCE)

    @property
    def diffuse_horizontal(self) -> float:
        """Irradiance of the sky on a horizontal plane [W/m²]: R, G and B by their share of luminance."""
        return float(np.array(self._core.diffuse_horizontal()) @ LUMINANCE)

    @property
    def direct_normal(self) -> float:
        """Irradiance of the sun's disc on a plane that faces it [W/m²]."""
        return float(np.array(self._core.direct_normal()) @ LUMINANCE)

    @property
    def global_horizontal(self) -> float:
        """Irradiance of sky and sun on a horizontal plane [W/m²]."""
        sun = self.sun
        return self.diffuse_horizontal + (0.0 if sun is None else self.direct_normal * float(sun.direction[2]))

    @property
    def horizontal_illuminance(self) -> float:
        """Illuminance of sky and sun on a horizontal plane [lx]."""
        self._visible("illuminance")
        return EFFICACY * self.global_horizontal

    @property
    def diffuse_horizontal_illuminance(self) -> float:
        """Illuminance of the sky on a horizontal plane [lx]."""
        self._visible("illuminance")
        return EFFICACY * self.diffuse_horizontal

    @property
    def clearness(self) -> float | None:
        """Perez's ε, if the sky was made from irradiances or illuminances."""
        found = self._core.daylight
        return None if found is None else found[4]

    @property
    def brightness(self) -> float | None:
        """Perez's Δ, if the sky was made from irradiances or illuminances."""
        found = self._core.daylight
        return None if found is None else found[5]

    # Patches, tables, pictures

    def patches(
        self,
        basis: str | SkyPatches = "tregenza",
        *,
        part: Part = "all",
        sun: Literal["spread", "nearest"] = "spread",
        disc_deg: float = SOLAR_DIAMETER_DEG,
        value: Literal["mean", "centre"] | None = None,
    ) -> NDArray[np.float64]:
        """Radiance (n, 3) [W/(m² sr)] of the ground and the patches of the sky: a column of a sky matrix.

        Parameters
        ----------
        basis
            tregenza, reinhart:4, or patches.
        part
            `all`, `sky` (with the ground), or `sun` alone.
        sun
            `spread` over the four nearest patches, or into the `nearest` as a disc of `disc_deg`, as the direct part of
            the five-phase method has it.
        disc_deg
            Full angle of that disc.
        value
            `mean` over a patch, or at its `centre`, which is the default of the preset `radiance-matrix`. Both are
            scaled by one factor, so that the sky's horizontal irradiance stays.
        """
        patches = basis if isinstance(basis, SkyPatches) else SkyPatches.named(basis)
        if value is None:
            value = "centre" if self.settings.preset == "radiance-matrix" else "mean"
        disc = disc_deg if sun == "nearest" else None
        return self._core.patches(patches._core, part, disc, value == "mean")

    def table(self, altitude_step_deg: float = 5.0, azimuth_step_deg: float = 10.0) -> SkyTable:
        """Luminances on a grid of altitudes, the ground's below 0, and azimuths."""
        for step, whole in ((altitude_step_deg, 90.0), (azimuth_step_deg, 360.0)):
            if not 0.1 <= step <= whole or abs(whole / step - round(whole / step)) > 1e-9:
                raise ClerestoryError(f"a step of {step}° does not divide {whole:g}° (give 5 or 10)")
        altitudes = np.linspace(-90.0, 90.0, 2 * round(90.0 / altitude_step_deg) + 1)
        azimuths = np.arange(round(360.0 / azimuth_step_deg), dtype=np.float64) * azimuth_step_deg
        a, z = np.meshgrid(np.radians(altitudes), np.radians(azimuths), indexing="ij")
        directions = np.stack([np.cos(a) * np.sin(z), np.cos(a) * np.cos(z), np.sin(a)], axis=-1)
        return SkyTable(altitudes, azimuths, self.luminance(directions))

    def picture(self, size: int = 512, *, with_sun: bool = False) -> NDArray[np.float64]:
        """Radiance (size, size, 3) of an angular fisheye that looks up: y (north) at the top, x (east) at the left.

        Outside of the circle it is 0. The sun keeps its irradiance, however large a pixel is.
        """
        from clerestory.sky.picture import fisheye

        return fisheye(self, size, with_sun=with_sun)

    def radiance_description(self, functions: str = "sky.cal") -> str:
        """A scene of Radiance with this sky, ground and sun; `radiance_functions` is the file that it names.

        Parameters
        ----------
        functions
            Name of that file. Skies of the preset `radiance` name Radiance's own and need none.
        """
        from clerestory.sky.radiance import description

        return description(self, functions)

    def radiance_functions(self) -> str | None:
        """The function file of `radiance_description`; None if it needs none of its own."""
        from clerestory.sky.radiance import function_file

        return function_file(self)

    def _visible(self, what: str) -> None:
        if self.settings.quantity != "visible":
            raise ClerestoryError(f"a sky in solar watts has no {what} (make it with quantity visible)")
