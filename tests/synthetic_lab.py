"""Scans of samples whose BSDF is a formula, as a goniophotometer would give them."""

from dataclasses import replace

import numpy as np

from clerestory.directions import angles, direction, outgoing_side
from clerestory.integrals import continued
from clerestory.measure import Measurement, Scan


def hemisphere(step_deg=5.0, top_deg=85.0, first_deg=lambda _ring: 3.0):
    """Angles of an even scan: rings of about equal spacing, each from the azimuth of its first point on."""
    theta, phi = [0.0], [0.0]
    for ring in np.arange(step_deg, top_deg + 1e-9, step_deg):
        count = max(6, round(360.0 * np.sin(np.radians(ring)) / step_deg))
        theta += [ring] * count
        phi += list(np.arange(count) * 360.0 / count + first_deg(ring))
    return np.array(theta), np.array(phi)


def about(axis, side, radius_deg=6.0, step_deg=0.5):
    """Angles of a square scan about a direction."""
    line = np.arange(-radius_deg, radius_deg + 1e-9, step_deg)
    x, y = (np.radians(a.ravel()) for a in np.meshgrid(line, line))
    across = np.cross(axis, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    vectors = axis + x[:, None] * across + y[:, None] * np.cross(axis, across)
    vectors /= np.linalg.norm(vectors, axis=1)[:, None]
    vectors = vectors[vectors[:, 2] > 0.0 if side == "interior" else vectors[:, 2] < 0.0]
    return angles(vectors)


def lobe(outgoing, axis, width_deg):
    """1 along an axis, falling as a Gaussian of the chord."""
    return np.exp(-0.5 * np.sum((outgoing - axis) ** 2, axis=-1) / np.radians(width_deg) ** 2)


def diffuse_and_peak(incident, outgoing, scatter, *, diffuse=0.3, peak=2.0, width_deg=4.0):
    """An isotropic sample: a diffuser with a wide peak straight on."""
    return diffuse / np.pi + peak * lobe(outgoing, continued(incident, scatter), width_deg)


def twill(incident, outgoing, scatter):
    """Turned by 180° it is the same, mirrored it is not: a lobe drawn out along a slanting line."""
    slant = np.array([np.cos(0.6), np.sin(0.6)])
    off = (outgoing - continued(incident, scatter))[..., :2]
    along, across = off @ slant, off @ np.array([-slant[1], slant[0]])
    return 0.05 + 0.6 * np.exp(-0.5 * ((along / 0.5) ** 2 + (across / 0.15) ** 2))


def venetian(incident, outgoing, scatter):
    """Mirrored left to right it is the same, up to down it is not: light goes up."""
    return 0.05 + 0.3 * np.clip(outgoing[..., 1] + 0.3, 0.0, None) * (1.2 + incident[..., 1])


def prism(incident, outgoing, scatter):
    """Throws light up and to the right of straight on, like no mirror image of itself."""
    axis = continued(incident, scatter) + np.array([0.25, 0.4, 0.0])
    axis[:2] *= min(1.0, 0.95 / np.linalg.norm(axis[:2]))
    axis[2] = np.copysign(np.sqrt(1.0 - axis[0] ** 2 - axis[1] ** 2), axis[2])
    return 0.02 + 1.5 * lobe(outgoing, axis, 6.0)


def scan(
    sample,
    theta_deg,
    phi_deg,
    *,
    side="exterior",
    scatter="transmission",
    points=None,
    noise_dsf=0.0,
    relative=0.0,
    seed=0,
    **changes,
):
    """One scan of a sample, with noise that is the same in all directions in DSF, and a share of the value."""
    theta, phi = hemisphere() if points is None else points
    incident = direction(theta_deg, phi_deg, side=side)
    outgoing = direction(theta, phi, side=outgoing_side(side, scatter))
    values = sample(incident, outgoing, scatter)
    if noise_dsf or relative:
        cosine = np.maximum(np.cos(np.radians(theta)), 1e-3)
        error = np.hypot(noise_dsf / cosine, relative * values)
        values = values + error * np.random.default_rng(seed).standard_normal(len(theta))
    made = Scan(side, scatter, theta_deg, phi_deg, theta, phi, values[:, None])
    return replace(made, **changes) if changes else made


def series(sample, thetas_deg=(0.0, 8.0, 30.0, 60.0), phis_deg=(0.0, 45.0, 90.0), **options):
    """Scans of several incident directions."""
    found = []
    for theta in thetas_deg:
        for phi in phis_deg if theta > 0.0 else (0.0,):
            found.append(scan(sample, theta, phi, seed=len(found), **options))
    return Measurement("synthetic", tuple(found))
