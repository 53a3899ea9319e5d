"""U-values and solar heat gain, for the standard conditions and by direction (ISO 15099:2003, section 4; Klems 1996).

SHGC(i) = T(i) + Σ_k N_k A_k(i): what passes directly, and of what each layer absorbs the fraction that flows inward.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.thermal.conditions import CONDITIONS
from clerestory.thermal.network import balance

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from clerestory.thermal.conditions import Conditions
    from clerestory.thermal.layer import Gap, ThermalLayer
    from clerestory.thermal.network import Balance

    Floats = NDArray[np.float64]


def u_value(
    layers: Sequence[ThermalLayer],
    gaps: Sequence[Gap],
    conditions: Conditions = CONDITIONS["nfrc-winter"],
    **window: Any,  # noqa: ANN401  # as `balance` has them
) -> float:
    """Centre-of-glass U-value [W/(m² K)]: heat from the room without sun, by the difference of the air's temperatures.

    Parameters
    ----------
    layers, gaps, conditions
        As in `balance`.
    window
        Its size and tilt, as in `balance`.

    Raises
    ------
    ClerestoryError
        As in `balance`, or the temperatures on both sides are equal.
    """
    difference = conditions.indoor_c - conditions.outdoor_c
    if difference == 0.0:
        raise ClerestoryError(f"{conditions.name}: a U-value needs different temperatures on both sides")
    return -balance(layers, gaps, conditions, dark=True, **window).heat_in / difference


@dataclass(frozen=True)
class SolarGain:
    """What the sun brings into a room through a window, for each direction that it may come from."""

    transmitted: Floats
    """Solar direct-hemispherical transmittance (n,)."""
    absorbed: Floats
    """Of each layer (layers, n)."""
    inward: Floats
    """Fraction of what a layer absorbs that flows inward (layers,)."""
    shgc: Floats
    """Solar heat gain coefficient (n,)."""
    balance: Balance
    """Of the first direction, in the sun."""

    @property
    def secondary(self) -> Floats:
        """Share of the sun that is absorbed and comes in as heat (n,)."""
        return self.shgc - self.transmitted


def inward_fractions(
    layers: Sequence[ThermalLayer],
    gaps: Sequence[Gap],
    conditions: Conditions,
    absorbed: ArrayLike,
    **window: Any,  # noqa: ANN401
) -> Floats:
    """Fraction of what each layer absorbs that flows inward (layers,), near the balance in the sun.

    The heat of the sun is turned up by 1 % of it in one layer after another.
    """
    shares = np.asarray(absorbed, dtype=np.float64)
    return _fractions(layers, gaps, conditions, shares, balance(layers, gaps, conditions, shares, **window), window)


def _fractions(
    layers: Sequence[ThermalLayer],
    gaps: Sequence[Gap],
    conditions: Conditions,
    shares: Floats,
    at: Balance,
    window: dict[str, Any],
) -> Floats:
    """The same near a balance that was found."""
    more = 0.01
    found = [
        balance(layers, gaps, conditions, shares + more * unit, **window).heat_in - at.heat_in
        for unit in np.eye(len(layers))
    ]
    return np.array(found) / (more * conditions.irradiance)


def solar_gain(
    layers: Sequence[ThermalLayer],
    gaps: Sequence[Gap],
    transmitted: ArrayLike,
    absorbed: ArrayLike,
    conditions: Conditions = CONDITIONS["nfrc-summer"],
    *,
    each: bool = False,
    **window: Any,  # noqa: ANN401
) -> SolarGain:
    """Solar heat gain coefficient by direction: SHGC = (heat in with the sun − heat in without) / irradiance.

    Parameters
    ----------
    layers, gaps, conditions
        As in `balance`; conditions with a sun.
    transmitted
        Solar transmittance of the system for each direction (n,).
    absorbed
        Solar absorptance of each layer (layers, n), of light from the exterior.
    each
        Balance the heat for each direction by itself. By default the fractions of the first direction hold for all:
        they depend on temperatures only weakly.
    window
        Its size and tilt, as in `balance`.

    Raises
    ------
    ClerestoryError
        As in `balance`; numbers do not fit; there is no sun; or a direction has more than all of its light.
    """
    direct = np.atleast_1d(np.asarray(transmitted, dtype=np.float64))
    taken = np.asarray(absorbed, dtype=np.float64).reshape(len(layers), -1)
    if taken.shape != (len(layers), len(direct)):
        raise ClerestoryError(f"absorptances of shape {taken.shape} for {len(direct)} directions (layers, directions)")
    over = np.flatnonzero(direct + taken.sum(axis=0) > 1.0 + 1e-6)
    if len(over):
        raise ClerestoryError(
            f"direction {over[0] + 1}: transmittance and absorptances sum to "
            f"{direct[over[0]] + taken[:, over[0]].sum():.4f} (check the data sets)"
        )
    if not conditions.irradiance > 0.0:
        raise ClerestoryError(f"{conditions.name}: there is no sun (give an irradiance, or nfrc-summer)")
    dark = balance(layers, gaps, conditions, dark=True, **window).heat_in
    first = balance(layers, gaps, conditions, taken[:, 0], **window)
    inward = _fractions(layers, gaps, conditions, taken[:, 0], first, window)
    if each:
        heat = [balance(layers, gaps, conditions, column, **window).heat_in for column in taken.T]
        secondary = (np.array(heat) - dark) / conditions.irradiance
    else:
        # The fractions near the balance, scaled to what comes in between darkness and it.
        whole = (first.heat_in - dark) / conditions.irradiance
        linear = float(inward @ taken[:, 0])
        inward = inward * (whole / linear if linear > 0.0 else 1.0)
        secondary = inward @ taken
    return SolarGain(direct, taken, inward, direct + secondary, first)
