"""Heat through a window: its layers and gaps as heat meets them, U, and solar heat gain from every direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.thermal import CONDITIONS, Gap, Gas, Openings, ThermalLayer, balance, solar_gain, u_value
from clerestory.thermal.layer import front_of_cloth, front_of_slats

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.basis import Basis
    from clerestory.system.layer import Layer
    from clerestory.system.window import Built, Window
    from clerestory.thermal import Conditions, SolarGain

    Floats = NDArray[np.float64]

UNCOATED = 0.84
"""Hemispherical emissivity of uncoated glass."""
GLASS_CONDUCTIVITY = 1.0
"""Of soda-lime glass [W/(m K)]."""


@dataclass(frozen=True)
class WindowHeat:
    """U and solar heat gain of a window, centre of glass."""

    u: float
    """[W/(m² K)], under `winter`."""
    gain: SolarGain
    """Under `summer`, from every patch; the first is along the normal."""
    basis: Basis
    """Patches that the sun may stand in."""
    winter: Conditions
    summer: Conditions
    assumed: tuple[str, ...]
    """What was not given and taken as usual."""

    @property
    def g(self) -> float:
        """Solar heat gain coefficient for light along the normal, g."""
        return float(self.gain.shgc[0])

    @property
    def diffuse(self) -> float:
        """Solar heat gain coefficient for evenly diffuse light."""
        area = self.basis.projected_solid_angles
        return float(area @ self.gain.shgc / area.sum())


def heat(
    window: Window,
    built: Built,
    *,
    winter: str | Conditions = "nfrc-winter",
    summer: str | Conditions = "nfrc-summer",
    each: bool = False,
    width_m: float = 1.0,
    height_m: float = 1.0,
    tilt_deg: float = 90.0,
) -> WindowHeat:
    """U, and solar heat gain coefficient from every direction, by ISO 15099.

    Parameters
    ----------
    window, built
        The window, and what `Window.solve` made of it.
    winter, summer
        Climates for U and for the gain, by their names in `clerestory.thermal.CONDITIONS`.
    each
        Balance the heat for each direction by itself, which takes seconds.
    width_m, height_m, tilt_deg
        Of the glazing; 90 is upright.

    Raises
    ------
    MissingDataError
        There is no band solar, or a layer lacks a thermal property; the text names its number and name.
    """
    if "solar" not in built.absorbed:
        raise MissingDataError(
            f"heat needs the band solar, and the window has {' and '.join(built.absorbed)} only (give its layers solar"
            " values)"
        )
    cold, hot = _climate(winter), _climate(summer)
    assumed: list[str] = []
    layers = [thermal_layer(layer, number, assumed) for number, layer in enumerate(window.layers, 1)]
    _need_gaps(window)
    gaps = [Gap(gap.width_m, Gas(gap.gas)) for gap in window.gaps]
    size = {"height_m": height_m, "width_m": width_m, "tilt_deg": tilt_deg}
    incident = built.basis.incident_centres("exterior")
    transmitted = np.asarray(built.bsdf.integrate(incident, "transmission", band="solar"))
    gain = solar_gain(layers, gaps, transmitted, built.absorptance("solar"), hot, each=each, **size)
    return WindowHeat(u_value(layers, gaps, cold, **size), gain, built.basis, cold, hot, tuple(assumed))


def as_one(window: Window) -> tuple[dict[str, float], list[str]]:
    """Thermal properties of the whole window as of one layer, as a file of it describes them, and what was assumed.

    Returns
    -------
    By the names of `Metadata`: thickness, emissivities of both faces, long-wave transmittance through all layers, and
    the conductivity that lets through as much heat between the faces as the window does in NFRC's winter; several
    layers have no openness.

    Raises
    ------
    MissingDataError
        A layer lacks a thermal property, or gaps are not given; the text names the layer's number and name.
    """
    assumed: list[str] = []
    layers = [thermal_layer(layer, number, assumed) for number, layer in enumerate(window.layers, 1)]
    _need_gaps(window)
    first, last = layers[0], layers[-1]
    found = {
        "thickness_m": sum(layer.thickness_m for layer in layers) + sum(gap.width_m for gap in window.gaps),
        "emissivity_exterior": first.emissivity_exterior,
        "emissivity_interior": last.emissivity_interior,
        "tir": _long_wave(layers),
        "thermal_conductivity": first.conductivity,
    }
    if len(layers) == 1:
        openness = window.layers[0].thermal.openness
        return (found if openness is None else {**found, "openness": openness}), assumed
    cold = CONDITIONS["nfrc-winter"]
    dark = balance(layers, [Gap(gap.width_m, Gas(gap.gas)) for gap in window.gaps], cold, dark=True)
    between = float(dark.temperatures_c[-1, 1] - dark.temperatures_c[0, 0])
    return {**found, "thermal_conductivity": -dark.heat_in * found["thickness_m"] / between}, assumed


def _long_wave(layers: Sequence[ThermalLayer]) -> float:
    """Long-wave transmittance through all layers, with what is thrown to and fro between them."""
    passed, thrown_back = 1.0, 0.0
    for layer in layers:
        t = layer.ir_transmittance
        outer, inner = (1.0 - t - e for e in (layer.emissivity_exterior, layer.emissivity_interior))
        again = 1.0 / (1.0 - thrown_back * outer)
        passed, thrown_back = passed * t * again, inner + t * t * thrown_back * again
    return passed


def _need_gaps(window: Window) -> None:
    if len(window.layers) > 1 and not window.gaps:
        raise MissingDataError("the gaps between the layers are not given (add them with their gas)")


def _climate(given: str | Conditions) -> Conditions:
    if not isinstance(given, str):
        return given
    if given not in CONDITIONS:
        raise ClerestoryError(f"conditions {given!r} are not known (known: {', '.join(CONDITIONS)})")
    return CONDITIONS[given]


def thermal_layer(layer: Layer, number: int, assumed: list[str]) -> ThermalLayer:
    """A layer as heat meets it; panes have what uncoated glass has where nothing else is known.

    Parameters
    ----------
    layer, number
        The layer, and its place from the exterior, where it has no number of its own.
    assumed
        What was not known and taken as usual is added to these.

    Raises
    ------
    MissingDataError
        The layer lacks a thermal property; the text names its number and name.
    """
    place, known = layer.called(number), layer.thermal
    values = {
        "emissivity_exterior": known.emissivity_exterior,
        "emissivity_interior": known.emissivity_interior,
        "conductivity": known.conductivity,
    }
    usual = {
        "emissivity_exterior": UNCOATED,
        "emissivity_interior": UNCOATED,
        "conductivity": GLASS_CONDUCTIVITY,
    }
    for key, value in values.items():
        if value is None and layer.pane is not None:
            values[key] = usual[key]
            assumed.append(f"{place}: {key} is not known, taken as {usual[key]:g}")
    missing = [key for key, value in values.items() if value is None]
    if known.thickness_m is None:
        missing.append("thickness_mm")
    if missing:
        raise MissingDataError(f"{place}: heat needs its {', '.join(missing)} (give them)")
    tir = known.tir
    if tir is None:
        tir = 0.0
        if layer.pane is None:
            assumed.append(f"{place}: tir is not known, taken as 0")
    return ThermalLayer(
        place,
        known.thickness_m or 0.0,
        values["conductivity"] or 0.0,
        values["emissivity_exterior"] or 0.0,
        values["emissivity_interior"] or 0.0,
        tir,
        _openings(layer),
    )


def _openings(layer: Layer) -> Openings:
    """What air passes: the open share of the layer, and the gaps at its edges."""
    known = layer.thermal
    front = 0.0
    if known.openness:
        front = (
            front_of_cloth(known.openness)
            if known.slat_tilt_deg is None
            else front_of_slats(known.openness, known.slat_tilt_deg)
        )
    top, bottom, left, right = known.edges_m
    return Openings(top, bottom, left, right, front)
