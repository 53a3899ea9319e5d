"""Skies as scenes of Radiance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.photometry import LUMINANCE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from clerestory.sky.model import Sky

_TYPES = {"clear": 1, "overcast": 2, "uniform": 3, "intermediate": 4}

_SKY = """
skyfunc glow sky_glow
0
0
4 1 1 1 0

sky_glow source sky
0
0
4 0 0 1 180
"""

_GROUND = """
skyfunc glow ground_glow
0
0
4 1 1 1 0

ground_glow source ground
0
0
4 0 0 -1 180
"""


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{value:.8g}" for value in values)


def description(sky: Sky, functions: str) -> str:
    """A scene with sky, ground and sun; see `Sky.radiance_description`."""
    settings = sky.settings
    parts = [
        f"# {settings.kind} sky by Clerestory, preset {settings.preset}, {settings.quantity} watts\n"
        f"# sun {settings.sun.words}; {settings.sun.source}\n"
        + "".join(f"# {name.replace('_', ' ')}: {value:g}\n" for name, value in settings.light.items())
        + f"# ground reflectance {settings.ground_reflectance:g}; the y axis points to azimuth {settings.north_deg:g}\n"
    ]
    sun = sky.sun
    if sun is not None:
        parts.append(
            f"\nvoid light solar\n0\n0\n3 {_numbers(sun.radiance)}\n"
            f"\nsolar source sun\n0\n0\n4 {_numbers(sun.direction)} {2 * sun.half_angle_deg:.6g}\n"
        )
    if function_file(sky) is None:
        parts += [_with_radiances_functions(sky), _SKY, _GROUND]
        return "".join(parts)
    parts.append(f"\nvoid colorfunc skyfunc\n4 sky_r sky_g sky_b {functions}\n0\n0\n")
    parts.append(_SKY)
    if settings.preset == "radiance":
        return "".join([*parts, _GROUND])
    parts.append(
        f"\nvoid glow ground_glow\n0\n0\n4 {_numbers(sky.ground)} 0\n\nground_glow source ground\n0\n0\n4 0 0 -1 180\n"
    )
    return "".join(parts)


def _with_radiances_functions(sky: Sky) -> str:
    """The brightness by skybright.cal or perezlum.cal, which Radiance has."""
    toward = sky.sun_direction
    ground = sky.ground[0]
    found = sky._core.distribution
    assert found is not None, "a sky of this preset is grey"
    scale, lobed = found
    if sky.traditional is not None:
        at_zenith = _core.gensky_factor(sky.traditional, float(np.degrees(np.arcsin(toward[2]))))
        values = [_TYPES[sky.traditional], scale * at_zenith, ground]
        if sky.traditional in ("clear", "intermediate"):
            values += [at_zenith, *toward]
        name, file = "skybr", "skybright.cal"
    else:
        assert lobed is not None, "Perez's and the general skies are lobed"
        a, b, base, c, d, e = lobed
        # The file has a constant of 1 in the indicatrix.
        values = [scale * base, ground, a, b, c / base, d, e / base, *toward]
        name, file = "skybright", "perezlum.cal"
    return f"\nvoid brightfunc skyfunc\n2 {name} {file}\n0\n{len(values)} {_numbers(values)}\n"


def function_file(sky: Sky) -> str | None:
    """A function file with everything of the sky in it; see `Sky.radiance_functions`."""
    blends = sky.settings.preset == "radiance"
    if blends and sky.settings.colour == (1.0, 1.0, 1.0):
        return None  # Radiance has the functions
    x, y, z = sky.sun_direction
    lines = [
        f"{{ {sky.settings.kind} sky by Clerestory: radiance of R, G and B, without sun and ground }}",
        f"cosg = Dx*({x:.12g}) + Dy*({y:.12g}) + Dz*({z:.12g});",
        "g = Acos(cosg);",
        "cosz = if(Dz - .01, Dz, .01);",
        "positive(v) = if(v, v, 0);",
    ]
    found = sky._core.distribution
    if found is None:
        lines += _coloured(sky)
        return "\n".join(lines) + "\n"
    scale, lobed = found
    if lobed is not None:
        lines.append(f"grey = {scale:.12g} * positive({_lobe(lobed)});")
    elif sky.traditional == "overcast":
        lines.append(f"grey = {scale:.12g} * (1 + 2*Dz)/3;")
    else:
        lines += [
            "eta = Acos(Dz);",
            f"zt = Acos({z:.12g});",
            f"grey = {scale:.12g} * positive(((1.35*sin(5.631-3.59*eta)+3.12)*sin(4.396-2.6*zt) + 6.37 - eta)/2.326"
            " * exp(-.563*g*((2.629-eta)*(1.562-zt)+.812)));",
        ]
    # The colour as the core has it: of luminance 1.
    colour = np.array(sky.settings.colour)
    if sky.settings.preset == "clerestory":
        colour = colour / float(colour @ LUMINANCE)
    if blends:
        lines.append("blend(sky, ground) = ((Dz+1.01)^10*sky + (Dz+1.01)^-10*ground) / ((Dz+1.01)^10 + (Dz+1.01)^-10);")
        values = [f"blend({factor:.12g} * grey, {g:.12g})" for factor, g in zip(colour, sky.ground, strict=True)]
    else:
        values = [f"{factor:.12g} * grey" for factor in colour]
    lines += [f"sky_{name} = {value};" for name, value in zip("rgb", values, strict=True)]
    return "\n".join(lines) + "\n"


def _lobe(lobed: tuple[float, ...] | list[float]) -> str:
    a, b, base, c, d, e = lobed
    return (
        f"(1 + ({a:.12g})*exp(({b:.12g})/cosz)) * (({base:.12g}) + ({c:.12g})*exp(({d:.12g})*g) + ({e:.12g})*cosg*cosg)"
    )


def _coloured(sky: Sky) -> list[str]:
    found = sky._core.coloured
    assert found is not None, "a sky is grey or coloured"
    factor, lobes, scales, rgb = found
    lines = [f"Y = positive({factor * scales[0]:.12g} * {_lobe(lobes[0])});"]
    lines += [f"{name} = {scales[k]:.12g} * {_lobe(lobes[k])};" for k, name in ((1, "xc"), (2, "yc"))]
    lines += ["X = xc/yc*Y;", "Z = (1-xc-yc)/yc*Y;"]
    lines += [
        f"sky_{name} = positive(({row[0]:.12g})*X + ({row[1]:.12g})*Y + ({row[2]:.12g})*Z);"
        for name, row in zip("rgb", rgb, strict=True)
    ]
    return lines
