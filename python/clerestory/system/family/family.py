"""A product whose parameter has values: data sets by value, and what lies between them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.bsdf import Bsdf
from clerestory.model import Model

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from clerestory.system.product import Orientation


@dataclass(frozen=True)
class State:
    """The product with one value of its parameter."""

    name: str
    """Such as `tilt_30`."""
    value: float
    """Of the parameter."""
    bsdf: Bsdf
    components: tuple[dict[str, Any], ...] = ()
    """What the product is made of in this state, as `clerestory.system.components` lists it."""
    file: Path | None = None
    """That it was read from."""


@dataclass(frozen=True)
class Family:
    """A product with a parameter."""

    name: str
    parameter: str
    """Its name with its unit, such as `tilt_deg`."""
    states: tuple[State, ...]
    """By rising or falling value, the most open one first."""
    slats_mm: dict[str, float] | None = None
    """Width, pitch and crown of the slats that tilt [mm]."""
    orientation: Orientation | None = None
    """How it is to be placed."""

    @property
    def values(self) -> list[float]:
        """Of the parameter, in the order of the states."""
        return [state.value for state in self.states]

    def nearest(self, value: float) -> State:
        """The state whose value is the nearest; of two the more open one."""
        return self.states[int(np.argmin(np.abs(np.array(self.values) - value)))]

    def at(self, value: float) -> State:
        """A state between those that there are: a mixture of both neighbours by their distance.

        Shares of a window's height mix exactly so. Between tilts it is an approximation, whose beams are those of both
        neighbours.

        Raises
        ------
        ClerestoryError
            The value lies beyond the states.
        """
        for state in self.states:
            if state.value == value:
                return state
        for one, other in zip(self.states, self.states[1:], strict=False):
            share = (value - one.value) / (other.value - one.value)
            if 0.0 < share < 1.0:
                return State(state_name(self.parameter, value), value, mixed([(1.0 - share, one), (share, other)]))
        low, high = min(self.values), max(self.values)
        raise ClerestoryError(f"{self.parameter} {value:g} lies beyond the states of {self.name} ({low:g} to {high:g})")

    def refined(self, step: float) -> Family:
        """The same with more states: also at the multiples of a step, mixed of their neighbours.

        Raises
        ------
        ClerestoryError
            The step is not above 0, or asks for more than 1000 states.
        """
        low, high = min(self.values), max(self.values)
        if not (step > 0.0 and (high - low) / step <= 1000.0):
            raise ClerestoryError(f"a step of {step:g} between {low:g} and {high:g} is not possible (give another)")
        first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
        between = {round(float(k * step), 9) for k in np.arange(first, last + 1.0)}
        values = sorted(between | set(self.values), reverse=self.values[0] > self.values[-1])
        return replace(self, states=tuple(self.at(value) for value in values))


def state_name(parameter: str, value: float) -> str:
    """Name of a state: the parameter without its unit, and the value."""
    word = parameter.split(".")[-1]
    for unit in ("_deg", "_mm", "_um", "_m"):
        word = word.removesuffix(unit)
    return f"{word}_{value:g}"


def mixed(parts: Sequence[tuple[float, State]]) -> Bsdf:
    """Data sets side by side in one window, by their shares of its area.

    Raises
    ------
    ClerestoryError
        They have not the same bands and components; the text names the state.
    """
    (_, first), *rest = parts
    held = [state.bsdf.models for _, state in parts]
    for (_, other), models in zip(rest, held[1:], strict=True):
        for band in sorted(set(held[0]) ^ set(models)):
            has, lacks = (first, other) if band in held[0] else (other, first)
            raise ClerestoryError(f"{has.name} has a band {band!r}, {lacks.name} has none (build both with the same)")
        for band, members in models.items():
            if set(members) != set(held[0][band]):
                raise ClerestoryError(f"{first.name} and {other.name} have not the same components in band {band!r}")
    return first.bsdf.with_models(
        {
            band: {
                key: Model.mixture(
                    [(weight, models[band][key]) for (weight, _), models in zip(parts, held, strict=True)]
                )
                for key in members
            }
            for band, members in held[0].items()
        }
    )
