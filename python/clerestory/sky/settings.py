"""What a sky is made with: its light, whose practice it follows, colour, ground and orientation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from clerestory._core import ClerestoryError
from clerestory.sky.position import SunPosition

if TYPE_CHECKING:
    from collections.abc import Sequence

Preset = Literal["clerestory", "radiance", "radiance-matrix"]
Quantity = Literal["visible", "solar"]
Part = Literal["all", "sky", "sun"]
Colour = Literal["grey", "radiance"]
PRESETS: tuple[Preset, ...] = ("clerestory", "radiance", "radiance-matrix")
PARTS: tuple[Part, ...] = ("all", "sky", "sun")

COLOURS: dict[Colour, tuple[float, float, float]] = {"grey": (1.0, 1.0, 1.0), "radiance": (0.960, 1.004, 1.118)}
SOLAR_DIAMETER_DEG = 0.533

_DEW_POINTS: dict[Preset, float] = {"clerestory": 10.97353, "radiance": 10.97353, "radiance-matrix": 11.0}
_MEAN_DISTANCE = 94  # the day on which the sun's distance is its mean
LEVELS = "direct and diffuse irradiance, direct and diffuse illuminance, global irradiance"
"""Ways to say how much light there is."""


@dataclass(frozen=True)
class SkySettings:
    """Everything that a sky was made with."""

    kind: str
    """Its model in words."""
    sun: SunPosition
    """Where the sun is, by the compass."""
    light: dict[str, float]
    """What it was given of the light: irradiances [W/m²], illuminances [lx], luminance [cd/m²], turbidity."""
    preset: Preset
    """Whose practice it follows."""
    quantity: Quantity
    """What the watts of its radiances are."""
    colour: tuple[float, float, float]
    """Factors of the sky's R, G and B; coloured models have their own."""
    ground_reflectance: float
    """Of the ground, 0 to 1."""
    north_deg: float
    """Compass azimuth of the world's y axis."""
    dew_point: float
    """For water vapour in the luminous efficacy [°C]."""


def light_of(
    direct: float | None = None,
    diffuse: float | None = None,
    direct_illuminance: float | None = None,
    diffuse_illuminance: float | None = None,
    global_horizontal: float | None = None,
    zenith_luminance: float | None = None,
    turbidity: float | None = None,
) -> tuple[tuple[str, float, float], dict[str, float]] | None:
    """The one level that is given, for the core and by name; None without any."""
    ways: list[tuple[str, dict[str, float | None]]] = [
        ("irradiance", {"direct": direct, "diffuse": diffuse}),
        ("illuminance", {"direct_illuminance": direct_illuminance, "diffuse_illuminance": diffuse_illuminance}),
        ("global", {"global_horizontal": global_horizontal}),
        ("zenith", {"zenith_luminance": zenith_luminance}),
        ("turbidity", {"turbidity": turbidity}),
    ]
    given = [(name, values) for name, values in ways if any(v is not None for v in values.values())]
    if not given:
        return None
    if len(given) > 1:
        names = " and ".join(key for _, values in given for key, value in values.items() if value is not None)
        raise ClerestoryError(f"{names} contradict each other (give one of {LEVELS}, zenith luminance or turbidity)")
    name, values = given[0]
    if len(values) == 2:
        sun, sky = values
        if values[sky] is None:
            raise ClerestoryError(f"{sun} alone says nothing of the sky (give {sky}, too)")
        values[sun] = values[sun] or 0.0
    kept = {key: float(value) for key, value in values.items() if value is not None}
    first, second = [*kept.values(), 0.0][:2]
    return (name, first, second), kept


def settings_of(
    kind: str,
    sun: SunPosition | tuple[float, float],
    light: dict[str, float],
    *,
    preset: Preset = "clerestory",
    quantity: Quantity = "visible",
    colour: Colour | Sequence[float] = "grey",
    ground_reflectance: float = 0.2,
    north_deg: float = 0.0,
    dew_point: float | None = None,
) -> SkySettings:
    """From what a constructor was given.

    Raises
    ------
    ClerestoryError
        The colour or the preset is not known.
    """
    if isinstance(colour, str):
        if colour not in COLOURS:
            raise ClerestoryError(f"a colour {colour!r} is not known (known: {', '.join(COLOURS)}, or three factors)")
        factors = COLOURS[colour]
    else:
        r, g, b = (float(c) for c in colour)
        factors = (r, g, b)
    if preset not in PRESETS:
        raise ClerestoryError(f"a preset {preset!r} is not known (known: {', '.join(PRESETS)})")
    return SkySettings(
        kind=kind,
        sun=sun if isinstance(sun, SunPosition) else SunPosition(float(sun[0]), float(sun[1])),
        light=light,
        preset=preset,
        quantity=quantity,
        colour=factors,
        ground_reflectance=float(ground_reflectance),
        north_deg=float(north_deg),
        dew_point=default_dew_point(preset) if dew_point is None else float(dew_point),
    )


def default_dew_point(preset: Preset) -> float:
    """Dew point [°C] of a preset for weather that has none."""
    return _DEW_POINTS[preset]


def moment_of(settings: SkySettings) -> tuple[float, float, int, float]:
    """The sun's altitude and azimuth in the world [°], the day of the year and the dew point, for the core."""
    sun = settings.sun
    # Radiance's gendaylit takes day 0 for a sun that is given by its angles.
    unknown = 0 if settings.preset == "radiance" else _MEAN_DISTANCE
    day = unknown if sun.day is None else sun.day
    return sun.altitude_deg, sun.azimuth_deg - settings.north_deg, day, settings.dew_point


def choices_of(settings: SkySettings) -> tuple[Preset, Quantity, tuple[float, float, float], float]:
    """Preset, quantity, colour and ground, for the core."""
    return settings.preset, settings.quantity, settings.colour, settings.ground_reflectance
