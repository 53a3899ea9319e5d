"""The response of a camera by Debevec and Malik: a smooth curve through all levels.

P. Debevec and J. Malik (1997), "Recovering high dynamic range radiance maps from photographs", SIGGRAPH '97,
equation 3.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from clerestory.photo.response import HIGHEST, LEVELS, LOWEST

if TYPE_CHECKING:
    from numpy.typing import NDArray

SMOOTHNESS = 30.0
"""Weight λ of the second difference."""
GAMMA = 2.2
"""Power of level that light nearly follows. The curve is made smooth beside it: its own logarithm bends sharply in the
dark, where smoothing it would lift it."""


def hat(levels: NDArray[np.float64]) -> NDArray[np.float64]:
    """Trust in levels of 255: a hat over the reliable ones with 1 at its top, 0 beyond them."""
    middle = 0.5 * (LOWEST + HIGHEST)
    inside = (levels >= LOWEST) & (levels <= HIGHEST)
    # The lowest and the highest reliable level count a little, too.
    rise = (middle - LOWEST + 1.0 - np.abs(levels - middle)) / (middle - LOWEST + 1.0)
    return np.where(inside, rise, 0.0)


def logarithms(levels: NDArray[np.float64], exposures: NDArray[np.float64]) -> NDArray[np.float64]:
    """Logarithms of light (256,) by level, up to a constant.

    Parameters
    ----------
    levels
        Of spots in the pictures (spots, pictures), of 255; between two levels the curve is taken to be straight.
    exposures
        Exposure values of the pictures [s].

    Notes
    -----
    The least squares of w(Z)(g(Z_ij) − ln E_i − ln t_j) and of λ w(z) (g(z) − 2.2 ln z)″, where ln E_i, which are as
    many as there are spots, are eliminated exactly.
    """
    spots, pictures = levels.shape
    weights = hat(levels).ravel()
    kept = weights > 0.0
    z, w = levels.ravel()[kept], weights[kept]
    times = np.tile(np.log(exposures), spots)[kept]
    spot = np.repeat(np.arange(spots), pictures)[kept]
    row = np.arange(z.size)
    low = np.minimum(z.astype(int), LEVELS - 2)
    share = z - low
    curve = sparse.csr_matrix(
        (np.concatenate([1.0 - share, share]), (np.tile(row, 2), np.concatenate([low, low + 1]))), (z.size, LEVELS)
    )
    of_spot = sparse.csr_matrix((np.ones(z.size), (row, spot)), (z.size, spots))
    square = sparse.diags(w**2)
    both = curve.T @ square @ of_spot
    totals = np.maximum(of_spot.T @ w**2, 1e-300)
    normal = (curve.T @ square @ curve - both @ sparse.diags(1.0 / totals) @ both.T).toarray()
    right = curve.T @ (w**2 * times) - both @ ((of_spot.T @ (w**2 * times)) / totals)
    bend = sparse.diags([1.0, -2.0, 1.0], [0, 1, 2], (LEVELS - 2, LEVELS))
    # A floor keeps the ends, of which nothing is known, straight.
    stiff = SMOOTHNESS * np.maximum(hat(np.arange(1.0, LEVELS - 1.0)), 0.05)
    roughness = (bend.T @ sparse.diags(stiff**2) @ bend).toarray()
    normal += roughness
    right += roughness @ (GAMMA * np.log(np.arange(LEVELS) + 0.5))
    normal[LEVELS // 2, LEVELS // 2] += 1.0  # the constant: g(128) = 0
    return np.asarray(np.linalg.solve(normal, right))
