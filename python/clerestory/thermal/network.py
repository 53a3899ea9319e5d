"""Temperatures of layers between two climates (ISO 15099:2003, section 5).

Every face balances conduction through its layer, convection to its gap, long-wave radiation and half of what the layer
absorbs of the sun. Radiosities are linear in the fourth powers of the temperatures and are solved for exactly; the
temperatures are found by Newton's method.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.thermal.airflow import through_gaps
from clerestory.thermal.conditions import KELVIN
from clerestory.thermal.convection import gap_coefficient, indoor_coefficient

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from clerestory.thermal.conditions import Conditions
    from clerestory.thermal.layer import Gap, ThermalLayer

    Floats = NDArray[np.float64]

SIGMA = 5.6697e-8
"""Stefan and Boltzmann's constant [W/(m² K⁴)], as ISO 15099 has it."""
_STEPS = 100
_TOLERANCE = 1e-7
"""Of the balance of a face [W/m²]."""


@dataclass(frozen=True)
class Balance:
    """A window in balance."""

    temperatures_c: Floats
    """Of the faces, from the exterior (layers, 2) [°C]."""
    heat_in: float
    """To the room by convection and radiation of the interior face, and by air of ventilated gaps [W/m²]."""
    gap_coefficients: Floats
    """Conduction and convection of closed gaps (gaps) [W/(m² K)]."""
    speeds_m_s: Floats
    """Of air in ventilated gaps (gaps); upward is positive."""
    outdoor_coefficient: float
    """Convection and radiation [W/(m² K)]."""
    indoor_coefficient: float


def balance(
    layers: Sequence[ThermalLayer],
    gaps: Sequence[Gap],
    conditions: Conditions,
    absorbed: ArrayLike | None = None,
    *,
    height_m: float = 1.0,
    width_m: float = 1.0,
    tilt_deg: float = 90.0,
    dark: bool = False,
) -> Balance:
    """A window between two climates, with or without the sun.

    Parameters
    ----------
    layers, gaps
        From the exterior to the interior; gaps are one fewer.
    conditions
        Climates, and irradiance of the sun.
    absorbed
        Share of the irradiance that each layer absorbs (layers,); none by default.
    height_m, width_m
        Of the window [m].
    tilt_deg
        90 is upright, 0 level with the exterior above [°].
    dark
        Without the sun.

    Raises
    ------
    ClerestoryError
        There is no layer, numbers do not fit, or the balance is not found.
    """
    if not layers or len(gaps) != len(layers) - 1:
        raise ClerestoryError(
            f"{counted(len(gaps), 'gap')} for {counted(len(layers), 'layer')} (give a gap between any two layers)"
        )
    shares = np.zeros(len(layers)) if absorbed is None else np.asarray(absorbed, dtype=np.float64)
    if shares.shape != (len(layers),):
        raise ClerestoryError(f"{shares.size} absorptances for {counted(len(layers), 'layer')} (give one each)")
    sun = np.zeros(len(layers)) if dark else shares * conditions.irradiance
    window = _Window(layers, gaps, conditions, sun, height_m, width_m, tilt_deg)
    outdoor, indoor = conditions.outdoor_c + KELVIN, conditions.indoor_c + KELVIN
    # A small difference where there is none: without one nothing convects, and derivatives vanish.
    start = np.linspace(outdoor, indoor + (0.1 if outdoor == indoor else 0.0), 2 * len(layers) + 2)[1:-1]
    return window.described(_root(window, start))


class _Window:
    """The balance of all faces as a function of their temperatures."""

    def __init__(
        self,
        layers: Sequence[ThermalLayer],
        gaps: Sequence[Gap],
        conditions: Conditions,
        sun: Floats,
        height_m: float,
        width_m: float,
        tilt_deg: float,
    ) -> None:
        self.layers, self.gaps, self.conditions, self.sun = layers, gaps, conditions, sun
        self.size, self.tilt_deg = (height_m, width_m), tilt_deg
        self.outdoor, self.indoor = conditions.outdoor_c + KELVIN, conditions.indoor_c + KELVIN
        self.emissivity = np.array([[layer.emissivity_exterior, layer.emissivity_interior] for layer in layers])
        self.transmittance = np.array([layer.ir_transmittance for layer in layers])
        self.conductance = np.array([layer.conductivity / layer.thickness_m for layer in layers])
        self._radiosities = np.linalg.inv(self._exchange())

    def _exchange(self) -> Floats:
        """Matrix of the radiosities of all faces, exterior and interior of each layer in turn."""
        count = len(self.layers)
        matrix = np.eye(2 * count)
        for k in range(count):
            reflected = 1.0 - self.emissivity[k] - self.transmittance[k]
            before, after = 2 * k - 1, 2 * k + 2
            for row, near, far, share in (
                (2 * k, before, after, reflected[0]),
                (2 * k + 1, after, before, reflected[1]),
            ):
                for column, part in ((near, share), (far, self.transmittance[k])):
                    if 0 <= column < 2 * count:
                        matrix[row, column] -= part
        return matrix

    def incoming(self, temperatures: Floats) -> tuple[Floats, Floats]:
        """Long-wave irradiance and radiosity of every face (layers, 2) [W/m²]."""
        sky, room = SIGMA * self.outdoor**4, SIGMA * self.indoor**4
        sources = (self.emissivity * SIGMA * temperatures**4).ravel()
        reflected = 1.0 - self.emissivity - self.transmittance[:, None]
        sources[0] += reflected[0, 0] * sky
        sources[1] += self.transmittance[0] * sky
        sources[-1] += reflected[-1, 1] * room
        sources[-2] += self.transmittance[-1] * room
        radiosity = (self._radiosities @ sources).reshape(-1, 2)
        incoming = np.empty_like(radiosity)
        incoming[:, 0] = np.concatenate([[sky], radiosity[:-1, 1]])
        incoming[:, 1] = np.concatenate([radiosity[1:, 0], [room]])
        return incoming, radiosity

    def convection(self, temperatures: Floats) -> tuple[Floats, Floats, Floats, float]:
        """Heat that every face takes up from its gap (layers, 2), coefficients, speeds, and what air brings indoors."""
        height = self.size[0]
        between = np.stack([temperatures[:-1, 1], temperatures[1:, 0]], axis=1)
        closed = np.array(
            [
                gap_coefficient(gap.gas, gap.thickness_m, height, (float(pair[0]), float(pair[1])), self.tilt_deg)
                for gap, pair in zip(self.gaps, between, strict=True)
            ]
        )
        taken = np.empty_like(temperatures)
        taken[0, 0] = self.conditions.outdoor_convection * (self.outdoor - temperatures[0, 0])
        taken[-1, 1] = self.indoor_convection(temperatures[-1, 1]) * (self.indoor - temperatures[-1, 1])
        across = closed * (between[:, 1] - between[:, 0])
        taken[:-1, 1], taken[1:, 0] = across, -across
        flows = through_gaps(
            self.layers, self.gaps, between, closed, (self.outdoor, self.indoor), self.size, self.tilt_deg
        )
        for number, flow in flows.items():
            taken[number, 1] = flow.coefficient * (flow.temperature - between[number, 0])
            taken[number + 1, 0] = flow.coefficient * (flow.temperature - between[number, 1])
        speeds = np.array([flows[k].speed if k in flows else 0.0 for k in range(len(self.gaps))])
        return taken, closed, speeds, sum(flow.to_room for flow in flows.values())

    def indoor_convection(self, surface: float) -> float:
        """[W/(m² K)] of the innermost face [K]."""
        given = self.conditions.indoor_convection
        if given is not None:
            return given
        return indoor_coefficient(float(surface), self.indoor, self.size[0], self.tilt_deg)

    def residual(self, flat: Floats) -> Floats:
        """What the faces gain (2 · layers) [W/m²]; 0 in balance."""
        temperatures = flat.reshape(-1, 2)
        incoming, _ = self.incoming(temperatures)
        gained = self.convection(temperatures)[0] + self.emissivity * (incoming - SIGMA * temperatures**4)
        through = self.conductance * (temperatures[:, 1] - temperatures[:, 0])
        gained[:, 0] += through + self.sun / 2.0
        gained[:, 1] += self.sun / 2.0 - through
        return gained.ravel()

    def described(self, flat: Floats) -> Balance:
        """What is worth knowing of the balance at these temperatures."""
        temperatures = flat.reshape(-1, 2)
        incoming, radiosity = self.incoming(temperatures)
        taken, closed, speeds, by_air = self.convection(temperatures)
        at_room = float(radiosity[-1, 1] - incoming[-1, 1] - taken[-1, 1])
        outside = float(radiosity[0, 0] - incoming[0, 0] - taken[0, 0])
        return Balance(
            temperatures - KELVIN,
            at_room + by_air,
            closed,
            speeds,
            _per_kelvin(outside, temperatures[0, 0] - self.outdoor),
            _per_kelvin(at_room, temperatures[-1, 1] - self.indoor),
        )


def _per_kelvin(heat: float, difference: float) -> float:
    return heat / difference if abs(difference) > 1e-9 else float("nan")


def _root(window: _Window, start: Floats) -> Floats:
    """Temperatures [K] in balance."""
    at, value = start, window.residual(start)
    for _ in range(_STEPS):
        worst = np.abs(value).max()
        if worst < _TOLERANCE:
            return at
        step = np.linalg.solve(_jacobian(window, at, value), -value)
        step *= min(1.0, 50.0 / float(np.abs(step).max()))
        share = 1.0
        while True:
            tried = at + share * step
            found = window.residual(tried)
            if np.abs(found).max() < worst or share < 1e-3:
                break
            share /= 2.0
        at, value = tried, found
    raise ClerestoryError(
        f"the temperatures of the layers were not found: {np.abs(value).max():.2g} W/m² are left over"
        " (check thicknesses, openings and climates)"
    )


def _jacobian(window: _Window, at: Floats, value: Floats) -> Floats:
    step = 1e-4
    return np.stack(
        [(window.residual(at + step * unit) - value) / step for unit in np.eye(len(at))],
        axis=1,
    )
