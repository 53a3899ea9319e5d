"""U-value of glazing by EN 673:2011: a calculation by hand, for upright, sloping and level windows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

SIGMA = 5.67e-8
"""[W/(m² K⁴)], as the standard rounds it."""
UNCOATED = 0.837
"""Corrected emissivity of uncoated glass."""
_MEAN = 283.0
"""Temperature of the gaps [K]."""
_DIFFERENCE = 15.0
"""Between the outermost panes [K]."""
_GASES = {
    "air": (1.232, 1.761e-5, 2.496e-2, 1008.0),
    "argon": (1.699, 2.164e-5, 1.684e-2, 519.0),
    "krypton": (3.560, 2.400e-5, 0.900e-2, 245.0),
    "xenon": (5.689, 2.226e-5, 0.529e-2, 161.0),
}
"""Density [kg/m³], viscosity [Pa s], conductivity [W/(m K)] and heat capacity [J/(kg K)] at 10 °C (table 1)."""
_CONVECTION = {"vertical": (0.035, 0.38), "sloping": (0.10, 0.31), "horizontal": (0.16, 0.28)}
"""Of the Nusselt number A (Gr Pr)^n: upright, at 45°, and level, where heat flows upward."""
_ROUNDS = 100


def gap_conductances(
    thicknesses_m: Sequence[float],
    gases: Sequence[Mapping[str, float]],
    emissivities: Sequence[tuple[float, float]],
    *,
    position: str = "vertical",
) -> NDArray[np.float64]:
    """Of each gap [W/(m² K)], by radiation and by the gas (5.1 to 5.3).

    Parameters
    ----------
    thicknesses_m
        Of the gaps.
    gases
        Shares of the volume by name: air, argon, krypton, xenon.
    emissivities
        Of both faces of each gap, corrected.
    position
        vertical, sloping (45°) or horizontal.

    Raises
    ------
    ClerestoryError
        A gas or a position is not known, or numbers do not fit.
    """
    if position not in _CONVECTION:
        raise ClerestoryError(f"a position {position!r} is not known (known: {', '.join(_CONVECTION)})")
    if not len(thicknesses_m) == len(gases) == len(emissivities):
        raise ClerestoryError(
            f"{counted(len(thicknesses_m), 'gap')}, {len(gases)} gases and {len(emissivities)} pairs of emissivities"
        )
    properties = [_mixture(shares) for shares in gases]
    first = np.array([pair[0] for pair in emissivities], dtype=np.float64)
    second = np.array([pair[1] for pair in emissivities], dtype=np.float64)
    radiation = 4.0 * SIGMA * _MEAN**3 / (1.0 / first + 1.0 / second - 1.0)
    differences = np.full(len(properties), _DIFFERENCE / max(len(properties), 1))
    for _ in range(_ROUNDS):
        gas = np.array(
            [
                _gas_conductance(thickness, difference, known, position)
                for thickness, difference, known in zip(thicknesses_m, differences, properties, strict=True)
            ]
        )
        found = radiation + gas
        shared = _DIFFERENCE / found / (1.0 / found).sum() if len(found) else found
        if np.allclose(shared, differences, rtol=1e-10):
            break
        differences = shared
    return np.asarray(radiation + gas, dtype=np.float64)


def u_value(
    panes_m: Sequence[float],
    gaps: NDArray[np.float64],
    *,
    conductivity: float = 1.0,
    emissivity_interior: float = UNCOATED,
    outdoor: float = 25.0,
) -> float:
    """U-value [W/(m² K)] (equation 1).

    Parameters
    ----------
    panes_m
        Thicknesses.
    gaps
        What `gap_conductances` gave; one fewer.
    conductivity
        Of glass [W/(m K)].
    emissivity_interior
        Of the face toward the room, corrected.
    outdoor
        Coefficient outdoors [W/(m² K)].
    """
    if len(gaps) != len(panes_m) - 1:
        raise ClerestoryError(f"{counted(len(gaps), 'gap')} for {counted(len(panes_m), 'pane')} (give one fewer)")
    indoor = 3.6 + 4.1 * emissivity_interior / UNCOATED
    resistance = 1.0 / outdoor + 1.0 / indoor + sum(panes_m) / conductivity + float((1.0 / gaps).sum())
    return 1.0 / resistance


def _mixture(shares: Mapping[str, float]) -> tuple[float, float, float, float]:
    """Each property as the mean by volume."""
    for name in shares:
        if name not in _GASES:
            raise ClerestoryError(f"EN 673 has no gas {name!r} (it has {', '.join(_GASES)})")
    density, viscosity, conductivity, capacity = (
        sum(share * _GASES[name][k] for name, share in shares.items()) for k in range(4)
    )
    return density, viscosity, conductivity, capacity


def _gas_conductance(
    thickness: float, difference: float, gas: tuple[float, float, float, float], position: str
) -> float:
    density, viscosity, conductivity, capacity = gas
    grashof = 9.81 * thickness**3 * difference * density**2 / (_MEAN * viscosity**2)
    prandtl = viscosity * capacity / conductivity
    factor, power = _CONVECTION[position]
    return float(max(1.0, factor * (grashof * prandtl) ** power) * conductivity / thickness)
