"""Gases between panes and their mixtures (ISO 15099:2003, annex B and equations 56 to 68)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from clerestory._core import ClerestoryError

PRESSURE = 101325.0
"""Of the air [Pa]."""
GAS_CONSTANT = 8314.462
"""[J/(kmol K)]."""


@dataclass(frozen=True)
class Pure:
    """A gas whose properties are linear in temperature: a + b T, with T in kelvin."""

    molar_mass: float
    """[kg/kmol]."""
    heat_capacity: tuple[float, float]
    """At constant pressure [J/(kg K)]."""
    conductivity: tuple[float, float]
    """[W/(m K)]."""
    viscosity: tuple[float, float]
    """[Pa s]."""


GASES: dict[str, Pure] = {
    "air": Pure(28.97, (1002.737, 1.2324e-2), (2.8733e-3, 7.76e-5), (3.7233e-6, 4.94e-8)),
    "argon": Pure(39.948, (521.9285, 0.0), (2.2848e-3, 5.1486e-5), (3.3786e-6, 6.4514e-8)),
    "krypton": Pure(83.8, (248.0907, 0.0), (9.443e-4, 2.8260e-5), (2.2130e-6, 7.7770e-8)),
    "xenon": Pure(131.3, (158.3397, 0.0), (4.538e-4, 1.723e-5), (1.0690e-6, 7.4140e-8)),
}
"""By name."""


@dataclass(frozen=True)
class Properties:
    """Of a gas at some temperature and the pressure of the air."""

    density: float
    """[kg/m³]."""
    heat_capacity: float
    """At constant pressure [J/(kg K)]."""
    conductivity: float
    """[W/(m K)]."""
    viscosity: float
    """[Pa s]."""


class Gas:
    """A gas, or a mixture of gases.

    Parameters
    ----------
    shares
        Name of a gas, or shares of the volume by the names of gases; they sum to 1.

    Raises
    ------
    ClerestoryError
        A gas is not known, or the shares do not sum to 1.
    """

    def __init__(self, shares: str | Mapping[str, float] = "air") -> None:
        given = {shares: 1.0} if isinstance(shares, str) else dict(shares)
        for name in given:
            if name not in GASES:
                raise ClerestoryError(f"a gas {name!r} is not known (known: {', '.join(GASES)})")
        if any(share < 0.0 for share in given.values()) or abs(sum(given.values()) - 1.0) > 1e-6:
            raise ClerestoryError(f"shares of a gas sum to {sum(given.values()):g} (give shares of 1, none negative)")
        self.shares = {name: share for name, share in given.items() if share > 0.0}
        """By name."""

    def __repr__(self) -> str:
        parts = (f"{100.0 * share:g} % {name}" for name, share in self.shares.items())
        return f"<Gas: {', '.join(parts)}>"

    def at(self, temperature: float) -> Properties:
        """At a temperature [K]."""
        gases = [(GASES[name], share) for name, share in self.shares.items()]
        mass = sum(share * gas.molar_mass for gas, share in gases)
        density = PRESSURE * mass / (GAS_CONSTANT * temperature)
        molar = sum(share * gas.molar_mass * _at(gas.heat_capacity, temperature) for gas, share in gases)
        if len(gases) == 1:
            gas = gases[0][0]
            return Properties(
                density, molar / mass, _at(gas.conductivity, temperature), _at(gas.viscosity, temperature)
            )
        return Properties(density, molar / mass, _conductivity(gases, temperature), _viscosity(gases, temperature))


def _at(coefficients: tuple[float, float], temperature: float) -> float:
    return coefficients[0] + coefficients[1] * temperature


def _phi(ratio: float, root: float, mass: float) -> float:
    """Wilke's interaction of two gases (equations 62 and 66).

    Parameters
    ----------
    ratio
        Of a property of theirs.
    root
        Ratio of masses under its fourth root: M_j / M_i for viscosities, M_i / M_j for conductivities.
    mass
        M_i / M_j.
    """
    fourth = math.sqrt(math.sqrt(root))
    return (1.0 + math.sqrt(ratio) * fourth) ** 2 / (2.0 * math.sqrt(2.0) * math.sqrt(1.0 + mass))


def _mixed(values: list[float], shares: list[float], interaction: list[list[float]]) -> float:
    """Σ v_i / (1 + Σ_{j≠i} φ_ij x_j / x_i)."""
    return sum(
        value / (1.0 + sum(interaction[i][j] * shares[j] / share for j in range(len(shares)) if j != i))
        for i, (value, share) in enumerate(zip(values, shares, strict=True))
    )


def _viscosity(gases: list[tuple[Pure, float]], temperature: float) -> float:
    values = [_at(gas.viscosity, temperature) for gas, _ in gases]
    masses = [gas.molar_mass for gas, _ in gases]
    interaction = [
        [_phi(vi / vj, mj / mi, mi / mj) for vj, mj in zip(values, masses, strict=True)]
        for vi, mi in zip(values, masses, strict=True)
    ]
    return _mixed(values, [share for _, share in gases], interaction)


def _conductivity(gases: list[tuple[Pure, float]], temperature: float) -> float:
    """Of the monatomic part and of the rest, each mixed with its own interaction (equations 63 to 68)."""
    masses = [gas.molar_mass for gas, _ in gases]
    shares = [share for _, share in gases]
    translation = [3.75 * GAS_CONSTANT / gas.molar_mass * _at(gas.viscosity, temperature) for gas, _ in gases]
    rest = [_at(gas.conductivity, temperature) - first for (gas, _), first in zip(gases, translation, strict=True)]
    phi = [
        [_phi(ki / kj, mi / mj, mi / mj) for kj, mj in zip(translation, masses, strict=True)]
        for ki, mi in zip(translation, masses, strict=True)
    ]
    psi = [
        [phi[i][j] * (1.0 + 2.41 * (mi - mj) * (mi - 0.142 * mj) / (mi + mj) ** 2) for j, mj in enumerate(masses)]
        for i, mi in enumerate(masses)
    ]
    return _mixed(translation, shares, psi) + _mixed(rest, shares, phi)
