"""What a coated pane does at other angles than it was measured at: two models from values along the normal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.system.plate import Optics

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

# Coefficients of 1, c, c², c³, c⁴ with c = cosθ: transmittance, and transmittance plus reflectance, of reference panes.
CLEAR = ((-0.0015, 3.355, -3.840, 1.460, 0.0288), (0.999, -0.563, 2.043, -2.532, 1.054))
BRONZE = ((-0.002, 2.813, -2.341, -0.05725, 0.599), (0.997, -1.868, 6.513, -7.862, 3.225))
CLEAR_ABOVE = 0.645
"""A pane that passes more than this along the normal goes by the clear curves."""
GRAZING_DEG = 75.0
"""From here on, the absorption of a Roos pane goes down to nothing at 90°."""


def clear_or_bronze(transmittance: Floats, exterior: Floats, interior: Floats, theta_deg: Floats) -> Optics:
    """A coated pane by the curves of clear or bronze glass.

    Parameters
    ----------
    transmittance, exterior, interior
        Along the normal (n,): what passes, and what is reflected on either side.
    theta_deg
        Angles from the normal [°] (m,).

    Notes
    -----
    T(θ) = T₀ τ̂(θ), R(θ) = R₀ (1 − ρ̂) + ρ̂. Along the normal the fits are 0.2 % off; there the values are the measured
    ones, and τ̂ does not exceed 1.

    References
    ----------
    Finlayson, Arasteh, Huizenga, Rubin, Reilly 1993, WINDOW 4.0: documentation of calculation procedures, LBL-33943.
    """
    cosine = np.cos(np.radians(theta_deg))
    powers = cosine[None, :] ** np.arange(5)[:, None]
    is_clear = (transmittance > CLEAR_ABOVE)[:, None]
    passes, both = (
        np.where(is_clear, np.array(clear) @ powers, np.array(bronze) @ powers)
        for clear, bronze in zip(CLEAR, BRONZE, strict=True)
    )
    more = both - passes
    passes = np.clip(passes, 0.0, 1.0)
    passes[:, cosine < 1e-9], more[:, cosine < 1e-9] = 0.0, 1.0
    passes[:, cosine > 1.0 - 1e-9], more[:, cosine > 1.0 - 1e-9] = 1.0, 0.0
    return _within(
        transmittance[:, None] * passes,
        *(np.clip(r[:, None] * (1.0 - more) + more, 0.0, 1.0) for r in (exterior, interior)),
    )


def roos(transmittance: Floats, exterior: Floats, interior: Floats, theta_deg: Floats, category: float = 4.0) -> Optics:
    """A coated pane by the model of Roos.

    Parameters
    ----------
    category
        q from 1 to 10; 4 is uncoated glass.

    Notes
    -----
    T(θ)/T₀ = 1 − a z^α − b z^β − c z^γ with z = θ/90° and one pane: a = 8, b = 0.25/q, c = 1 − a − b, α = 5.2 + 0.7
    q, β = 2, γ = 5.32 + 0.77 q. Absorption stays as it is along the normal up to 75°, and goes down to nothing at 90°
    (Kuhn 2006).

    References
    ----------
    Roos, Polato, van Nijnatten, Hutchins, Olive, Anderson 2001, "Angular-dependent optical properties of low-e and
    solar control windows", Solar Energy 69 (Supplement 6), 15–26.
    """
    if not 1.0 <= category <= 10.0:
        raise ClerestoryError(f"category {category:g} of a coating is not one of Roos' model (give 1 to 10)")
    z = np.asarray(theta_deg) / 90.0
    a, b = 8.0, 0.25 / category
    shape = 1.0 - a * z ** (5.2 + 0.7 * category) - b * z**2 - (1.0 - a - b) * z ** (5.32 + 0.77 * category)
    t = transmittance[:, None] * np.clip(shape, 0.0, 1.0)
    fade = np.clip((90.0 - np.asarray(theta_deg)) / (90.0 - GRAZING_DEG), 0.0, 1.0)
    kept = (np.clip(1.0 - transmittance - r, 0.0, None)[:, None] * fade for r in (exterior, interior))
    return _within(t, *(np.clip(1.0 - t - k, 0.0, 1.0) for k in kept))


def _within(transmittance: Floats, exterior: Floats, interior: Floats) -> Optics:
    """Scaled down where a fit gives more light than there is, and the same in both polarisations."""
    most = np.maximum(1.0, transmittance + np.maximum(exterior, interior))
    return Optics.of_pane(*(np.stack([part / most] * 2) for part in (transmittance, exterior, interior)))
