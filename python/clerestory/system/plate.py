"""Fresnel's plates: what a smooth sheet does with light, in both polarisations, by angle and wavelength.

Sheets are thick against the coherence length of light, so fluxes add. Arrays carry the polarisation first: s, then p.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Optics:
    """Transmittance and reflectances of light without scattering, (2, n, m): polarisation, wavelength, angle.

    What passes is the same from both sides. `absorbed` is by pane, side of incidence (exterior, interior) and the same
    three axes, (k, 2, 2, n, m).
    """

    transmittance: Floats
    exterior: Floats
    """Reflectance for light from the exterior."""
    interior: Floats
    """Reflectance for light from the interior."""
    absorbed: Floats

    @classmethod
    def of_pane(cls, transmittance: Floats, exterior: Floats, interior: Floats) -> Optics:
        """A single pane, which absorbs what is left."""
        absorbed = 1.0 - transmittance - np.stack([exterior, interior])
        return cls(transmittance, exterior, interior, absorbed[None])

    def before(self, inner: Optics) -> Optics:
        """With another one behind it, towards the interior.

        All reflections between them are followed: the geometric series of EN 410 and ISO 9050, in each polarisation.
        """
        # Perfect mirrors that face each other let nothing in at grazing incidence.
        kept = 1.0 - self.interior * inner.exterior
        between = np.divide(1.0, kept, out=np.zeros_like(kept), where=kept > 1e-12)
        inward, outward = self.transmittance * between, inner.transmittance * between
        return Optics(
            inward * inner.transmittance,
            self.exterior + inward * inner.exterior * self.transmittance,
            inner.interior + outward * self.interior * inner.transmittance,
            np.concatenate(
                [
                    np.stack(
                        [
                            self.absorbed[:, 0] + self.absorbed[:, 1] * inward * inner.exterior,
                            self.absorbed[:, 1] * outward,
                        ],
                        axis=1,
                    ),
                    np.stack(
                        [
                            inner.absorbed[:, 0] * inward,
                            inner.absorbed[:, 1] + inner.absorbed[:, 0] * outward * self.interior,
                        ],
                        axis=1,
                    ),
                ]
            ),
        )

    def flipped(self) -> Optics:
        """Turned round."""
        return Optics(self.transmittance, self.interior, self.exterior, self.absorbed[::-1, ::-1])


def interface(outer: Floats, inner: Floats, sine: Floats) -> Floats:
    """Reflectance (2, ...) of the border of two media, for a sine of the angle in vacuum; 1 beyond the critical angle.

    Notes
    -----
    Fresnel's equations: rₛ = ((n₁ c₁ − n₂ c₂)/(n₁ c₁ + n₂ c₂))², rₚ = ((n₂ c₁ − n₁ c₂)/(n₂ c₁ + n₁ c₂))².
    """
    first = outer * np.sqrt(np.clip(1.0 - (sine / outer) ** 2, 0.0, None))
    second = inner * np.sqrt(np.clip(1.0 - (sine / inner) ** 2, 0.0, None))
    # n₂ c₁ / (n₁ n₂) and so on, so that both read alike.
    crossed = first / outer**2, second / inner**2
    return np.stack([_share(first, second), _share(*crossed)])


def _share(a: Floats, b: Floats) -> Floats:
    total = a + b
    # Both vanish where light grazes a border of equal indices.
    return np.divide(a - b, total, out=np.zeros_like(total), where=total > 0.0) ** 2


def sheets(indices: list[Floats], internal: list[Floats], theta_deg: ArrayLike) -> Optics:
    """Sheets in contact, such as a laminate, outermost first.

    Parameters
    ----------
    indices
        Refractive index of each sheet (n,).
    internal
        Share of light that one pass along the normal leaves over, of each sheet (n,).
    theta_deg
        Angles in air from the normal [°] (m,).

    Notes
    -----
    Light on its path through a sheet is weakened by internal^(1/cosθ'), cosθ' = √(1 − sin²θ/n²), and divided at each
    border by Fresnel's equations. The sheets' absorption is given as that of one pane.
    """
    theta = np.radians(np.atleast_1d(np.asarray(theta_deg, dtype=np.float64)))
    sine = np.sin(theta)[None, :]
    columns = [np.ones((1, 1)), *(np.asarray(n, dtype=np.float64)[:, None] for n in indices), np.ones((1, 1))]
    total: Optics | None = None
    for k in range(len(columns) - 1):
        reflected = interface(*np.broadcast_arrays(columns[k], columns[k + 1], sine))
        if k == 0 or k == len(columns) - 2:
            # The cosine of 90° is not quite 0 in floating point.
            reflected[..., np.cos(theta) < 1e-9] = 1.0
        border = Optics.of_pane(1.0 - reflected, reflected, reflected)
        total = border if total is None else total.before(border)
        if k < len(internal):
            cosine = np.sqrt(np.clip(1.0 - (sine / columns[k + 1]) ** 2, 0.0, None))
            inside = np.asarray(internal[k], dtype=np.float64)[:, None]
            with np.errstate(divide="ignore"):
                passed = inside ** np.divide(1.0, cosine)
            passed = np.broadcast_to(passed, reflected.shape)
            total = total.before(Optics.of_pane(passed, np.zeros(passed.shape), np.zeros(passed.shape)))
    assert total is not None
    return Optics.of_pane(total.transmittance, total.exterior, total.interior)


def uncoated(transmittance: Floats, reflectance: Floats) -> tuple[Floats, Floats]:
    """Refractive index and internal transmittance of the plate with these values at normal incidence (n,).

    References
    ----------
    Furler 1991, "Angular dependence of optical properties of homogeneous glasses", ASHRAE Transactions 97.
    """
    t, r = transmittance, reflectance
    if (t + r > 1.0 + 1e-9).any():
        worst = float((t + r).max())
        raise ClerestoryError(f"transmittance and reflectance sum to {worst:.4f}, more than 1 (check the data)")
    beta = t**2 - r**2 + 2.0 * r + 1.0
    root = np.sqrt(np.clip(beta**2 - 4.0 * (2.0 - r) * r, 0.0, None))
    face = (beta - root) / (2.0 * (2.0 - r))
    amplitude = np.sqrt(face)
    once = (1.0 - face) ** 2
    internal = 2.0 * t / (once + np.sqrt(once**2 + 4.0 * (t * face) ** 2))
    return (1.0 + amplitude) / np.clip(1.0 - amplitude, 1e-9, None), np.clip(internal, 0.0, 1.0)
