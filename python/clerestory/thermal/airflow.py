"""Air that moves through gaps beside shading layers, by buoyancy or by a fan (ISO 15099:2003, section 7).

A gap exchanges air with the space on the other side of a layer that has openings: the other gap, the outdoors or the
room. The speed is where the driving pressure of warm air is used up by acceleration, by friction and at the openings.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from clerestory.thermal.conditions import KELVIN
from clerestory.thermal.convection import GRAVITY
from clerestory.thermal.gas import GAS_CONSTANT, GASES, PRESSURE

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from clerestory.thermal.layer import Gap, Openings, ThermalLayer

_ROUNDS = 200
_DISCHARGE = 0.6
"""Share of an opening that a stream fills."""


@dataclass(frozen=True)
class Flow:
    """Air in a gap."""

    speed: float
    """[m/s]; upward is positive."""
    temperature: float
    """Mean of the air in the gap [K]."""
    coefficient: float
    """From either face to this air [W/(m² K)]."""
    to_room: float
    """Heat that leaves with the air into the room [W/m²]."""


def through_gaps(
    layers: Sequence[ThermalLayer],
    gaps: Sequence[Gap],
    faces: NDArray[np.float64],
    closed: NDArray[np.float64],
    air: tuple[float, float],
    size_m: tuple[float, float],
    tilt_deg: float,
) -> dict[int, Flow]:
    """Ventilated gaps by their number.

    Parameters
    ----------
    layers, gaps
        From the exterior.
    faces
        Temperatures of the faces of each gap (gaps, 2) [K].
    closed
        Coefficient of each gap without ventilation (gaps,) [W/(m² K)].
    air
        Temperatures outdoors and indoors [K].
    size_m
        Height and width of the window.
    tilt_deg
        Of the window [°].
    """
    found: dict[int, Flow] = {}
    means = [float(pair.mean()) for pair in faces]
    last = len(layers) - 1
    for number, gap in enumerate(gaps):
        if gap.forced_speed_m_s > 0.0:
            found[number] = _Stream(gap, means[number], float(closed[number]), size_m).at(
                gap.forced_speed_m_s, gap.forced_temperature_c + KELVIN
            )
    for number, layer in enumerate(layers):
        if not layer.openings.any:
            continue
        before, after = number - 1, number
        if 0 < number < last:
            if before in found or after in found:
                continue
            first, second = (_Stream(gaps[k], means[k], float(closed[k]), size_m) for k in (before, after))
            found[before], found[after] = _exchanged(first, second, layer.openings, tilt_deg)
        elif last > 0:
            inside, space = (after, air[0]) if number == 0 else (before, air[1])
            if inside in found:
                continue
            stream = _Stream(gaps[inside], means[inside], float(closed[inside]), size_m)
            found[inside] = _vented(stream, space, layer.openings, tilt_deg, to_room=number == last)
    return found


@dataclass(frozen=True)
class _Stream:
    """A gap in which air moves."""

    gap: Gap
    mean: float
    """Of its faces [K]."""
    closed: float
    size_m: tuple[float, float]

    def coefficient(self, speed: float) -> float:
        """From either face to the air [W/(m² K)] (equation 106)."""
        return 2.0 * self.closed + 4.0 * abs(speed)

    def heat_per_kelvin(self, speed: float, temperature: float) -> float:
        """That the stream carries, a metre of width [W/(m K)]."""
        gas = self.gap.gas.at(temperature)
        return gas.density * gas.heat_capacity * self.gap.thickness_m * abs(speed)

    def fade(self, speed: float, heat: float) -> float:
        """Share of its difference from the faces that a stream which carries `heat` keeps to its end (equation 107)."""
        return math.exp(-2.0 * self.coefficient(speed) * self.size_m[0] / heat) if heat > 0.0 else 0.0

    def means(self, speed: float, heat: float, inlet: float) -> tuple[float, float]:
        """Temperature of the air in the gap and where it leaves [K] (equations 107 to 109)."""
        outlet = self.mean - (self.mean - inlet) * self.fade(speed, heat)
        length = heat / (2.0 * self.coefficient(speed))
        return self.mean - length / self.size_m[0] * (outlet - inlet), outlet

    def at(self, speed: float, inlet: float, *, to_room: bool = False) -> Flow:
        """With air of an inlet temperature [K] at a speed."""
        temperature = self.mean
        for _ in range(_ROUNDS):
            heat = self.heat_per_kelvin(speed, temperature)
            found, outlet = self.means(speed, heat, inlet)
            if abs(found - temperature) < 1e-10:
                break
            temperature = found
        carried = heat * (outlet - inlet) / self.size_m[0] if to_room else 0.0
        return Flow(speed, found, self.coefficient(speed), carried)

    def losses(self, openings: Openings, temperature: float, *, upward: bool) -> tuple[float, float]:
        """Pressure that is lost by a speed v: a v² + b v (equations 93 to 101)."""
        height, width = self.size_m
        gas = self.gap.gas.at(temperature)
        top, bottom = openings.top_m * width, openings.bottom_m * width
        sides = (openings.left_m + openings.right_m) * height + openings.front * width * height
        ends = top + bottom
        low = bottom + (top / (2.0 * ends) if ends > 0.0 else 0.25) * sides
        high = top + (bottom / (2.0 * ends) if ends > 0.0 else 0.25) * sides
        section = width * self.gap.thickness_m
        inlet, outlet = (low, high) if upward else (high, low)
        turns = sum((section / (_DISCHARGE * area) - 1.0) ** 2 for area in (inlet, outlet))
        friction = 12.0 * gas.viscosity * height / self.gap.thickness_m**2
        return gas.density / 2.0 * (1.0 + turns), friction


def _driving(first: float, second: float, height: float, tilt_deg: float) -> float:
    """Pressure [Pa] between two columns of air by their temperatures [K] (equation 92)."""
    reference = PRESSURE * GASES["air"].molar_mass / GAS_CONSTANT
    sine = abs(math.sin(math.radians(tilt_deg)))
    return reference * GRAVITY * height * sine * abs(first - second) / (first * second)


def _speed(squared: float, linear: float, pressure: float) -> float:
    """Where losses use a pressure up."""
    return (math.sqrt(linear**2 + 4.0 * squared * pressure) - linear) / (2.0 * squared)


def _vented(stream: _Stream, space: float, openings: Openings, tilt_deg: float, *, to_room: bool) -> Flow:
    """A gap that exchanges air with a space of some temperature [K]."""
    upward = stream.mean > space
    low, high = sorted((space, stream.mean))
    # The speed rises with the difference of temperatures, which falls with the speed: one crossing.
    for _ in range(_ROUNDS):
        temperature = (low + high) / 2.0
        squared, linear = stream.losses(openings, temperature, upward=upward)
        speed = _speed(squared, linear, _driving(temperature, space, stream.size_m[0], tilt_deg))
        reached = stream.means(speed, stream.heat_per_kelvin(speed, temperature), space)[0]
        if high - low < 1e-10:
            break
        if reached > temperature:
            low = temperature
        else:
            high = temperature
    made = stream.at(speed, space, to_room=to_room)
    return Flow(speed if upward else -speed, made.temperature, made.coefficient, made.to_room)


def _exchanged(first: _Stream, second: _Stream, openings: Openings, tilt_deg: float) -> tuple[Flow, Flow]:
    """Two gaps that exchange air with each other: the warmer one's rises."""
    warm, cold = (first, second) if first.mean >= second.mean else (second, first)
    gas = [stream.gap.gas.at(stream.mean) for stream in (warm, cold)]
    # Neither air nor heat is lost between the gaps: one mass of air, and one heat capacity.
    capacity = (gas[0].heat_capacity + gas[1].heat_capacity) / 2.0

    def speeds(mass: float) -> tuple[float, float]:
        """Of a flow of air [kg/(m s)]."""
        return mass / (gas[0].density * warm.gap.thickness_m), mass / (gas[1].density * cold.gap.thickness_m)

    def temperatures(mass: float) -> tuple[float, float]:
        """Of the air in both, where the outlet of one is the inlet of the other."""
        up, down = speeds(mass)
        heat = mass * capacity
        kept, kept_below = warm.fade(up, heat), cold.fade(down, heat)
        top = warm.mean * (1.0 - kept) + kept * cold.mean * (1.0 - kept_below)
        top /= 1.0 - kept * kept_below
        bottom = cold.mean - (cold.mean - top) * kept_below
        return warm.means(up, heat, bottom)[0], cold.means(down, heat, top)[0]

    def excess(mass: float) -> float:
        """Driving pressure that is left over at a flow."""
        reached = temperatures(mass)
        left = _driving(*reached, warm.size_m[0], tilt_deg) if reached[0] > reached[1] else 0.0
        for stream, temperature, speed, upward in zip((warm, cold), reached, speeds(mass), (True, False), strict=True):
            squared, linear = stream.losses(openings, temperature, upward=upward)
            left -= squared * speed**2 + linear * speed
        return left

    low, high = 0.0, 1e-3
    while excess(high) > 0.0:
        low, high = high, 2.0 * high
    for _ in range(_ROUNDS):
        middle = (low + high) / 2.0
        if excess(middle) > 0.0:
            low = middle
        else:
            high = middle
        if high - low < 1e-14:
            break
    mass = (low + high) / 2.0
    flows = [
        Flow(sign * speed, temperature, stream.coefficient(speed), 0.0)
        for stream, sign, speed, temperature in zip(
            (warm, cold), (1.0, -1.0), speeds(mass), temperatures(mass), strict=True
        )
    ]
    return (flows[0], flows[1]) if warm is first else (flows[1], flows[0])
