"""Samples of lobes whose totals are known, in the synthetic laboratory, as a scanning goniophotometer sees them.

Incident directions every 10° of θ (to 80°) and 15° of φ; an even scan of the outgoing hemisphere to 80° and fine ones
about the peaks; a cone of 1.5°, which widens all that is narrow; noise that is alike in DSF, and 1 % of the value.
"""

from dataclasses import dataclass

import numpy as np

import synthetic_lab
from clerestory.directions import angles
from clerestory.measure import Measurement

#: One standard deviation an axis of the cone of 1.5° [rad].
CONE = np.radians(1.5) / 4.0
TOP_DEG = 80.0


@dataclass(frozen=True)
class Lobe:
    """Gaussian of the chord about a direction on the sphere."""

    axis: np.ndarray
    width: float
    flux: float

    def __call__(self, outgoing):
        """BSDF [1/sr] as the instrument sees it."""
        width = np.hypot(self.width, CONE)
        chord2 = np.sum((outgoing - self.axis) ** 2, axis=-1)
        return self.flux * np.exp(-0.5 * chord2 / width**2) / self.norm(width)

    def norm(self, width):
        """∫ of the Gaussian times cosine, where it does not reach the horizon."""
        area = 2.0 * np.pi * width**2
        return area * self.axis[2] * (1.0 - width**2)


def _up(x, y):
    r2 = np.minimum(x * x + y * y, 0.995)
    scale = np.sqrt(r2 / np.maximum(x * x + y * y, 1e-12))
    return np.array([x * scale, y * scale, np.sqrt(1.0 - r2)])


def _fall(travel, power=1.0):
    """A share that falls with the angle of incidence."""
    return np.sqrt(max(1.0 - travel @ travel, 0.0)) ** (0.5 * power)


# Each sample: floor and lobes for light that travels toward a point of the disk.
def peak(travel):
    """Diffuse, with a peak straight on."""
    return 0.25 * _fall(travel), [Lobe(_up(*travel), np.radians(1.0), 0.4 * _fall(travel))]


def off_specular(travel):
    """A wide lobe that lags behind the straight direction."""
    return 0.1, [Lobe(_up(*(0.75 * travel)), np.radians(9.0), 0.5 * _fall(travel))]


def ring(travel):
    """Light on a cone about the straight direction: 36 lobes that overlap."""
    turn = 2.0 * np.pi * np.arange(36) / 36
    places = 0.55 * travel[:, None] + 0.3 * np.array([np.cos(turn), np.sin(turn)])
    return 0.1, [Lobe(_up(*place), np.radians(2.5), 0.5 / 36 * _fall(travel)) for place in places.T]


def twill(travel):
    """Turned by half a turn it is the same, mirrored it is not: lobes along a slanting line through the peak."""
    along = np.array([np.cos(0.6), np.sin(0.6)])
    straight = Lobe(_up(*travel), np.radians(1.0), 0.15 * _fall(travel, 2.0))
    beside = [
        Lobe(_up(*(0.7 * travel + off * along)), np.radians(6.0), 0.08 * _fall(travel))
        for off in (-0.24, -0.12, 0.12, 0.24)
    ]
    return 0.1, [straight, *beside]


def prism(travel):
    """Two peaks beside the straight direction, one of which takes over from the other."""
    share = 0.5 + 0.35 * travel[1]
    places = [travel * 0.6 + [0.0, 0.25], travel * 0.6 - [0.0, 0.25]]
    weights = [share, 1.0 - share]
    lobes = [
        Lobe(_up(*place), np.radians(1.2), 0.6 * weight * _fall(travel))
        for place, weight in zip(places, weights, strict=True)
    ]
    return 0.05, lobes


SAMPLES = {"peak": peak, "off-specular": off_specular, "ring": ring, "twill": twill, "prism": prism}


def travel(theta_deg, phi_deg):
    """Point of the disk of travel of light from a direction."""
    return -np.sin(np.radians(theta_deg)) * np.array([np.cos(np.radians(phi_deg)), np.sin(np.radians(phi_deg))])


def brightest(sample, at):
    """Directions of the peaks (n, 3); of a ring, all along it."""
    if sample == "ring":
        turn = 2.0 * np.pi * np.arange(720) / 720
        places = 0.55 * at[:, None] + 0.3 * np.array([np.cos(turn), np.sin(turn)])
        return np.array([_up(*place) for place in places.T])
    return np.array([lobe.axis for lobe in SAMPLES[sample](at)[1]])


def bsdf(sample, at, outgoing):
    """As the instrument sees it, without noise [1/sr]."""
    floor, lobes = SAMPLES[sample](at)
    outgoing = np.asarray(outgoing) * [1.0, 1.0, np.sign(np.asarray(outgoing)[..., 2:]).flat[0]]
    return floor / np.pi + sum(lobe(outgoing) for lobe in lobes)


def square(count):
    """Directions of equal projected solid angle (n, 3)."""
    u, v = np.meshgrid((np.arange(count) + 0.5) / count, (np.arange(2 * count) + 0.5) / (2 * count))
    r, turn = np.sqrt(u.ravel()), 2.0 * np.pi * v.ravel()
    return np.stack([r * np.cos(turn), r * np.sin(turn), np.sqrt(1.0 - r**2)], axis=-1)


EVEN = square(300)


def total(sample, at):
    """Direct-hemispherical value."""
    floor, lobes = SAMPLES[sample](at)
    sum_ = floor
    for lobe in lobes:
        width = np.hypot(lobe.width, CONE)
        if lobe.axis[2] > 5.0 * width:
            sum_ += lobe.flux
        else:
            near = _cap(lobe.axis, 6.0 * width, 300)
            inside = near[0][:, 2] > 0.0
            sum_ += float(np.sum((lobe(near[0]) * near[0][:, 2] * near[1])[inside]))
    return sum_


def _cap(axis, radius, count):
    """Directions of a cap and their solid angles."""
    grid = (np.arange(count) + 0.5) / count
    u, v = (a.ravel() for a in np.meshgrid(grid, grid))
    chord2 = u * radius**2
    cos = 1.0 - 0.5 * chord2
    sin = np.sqrt(np.maximum(1.0 - cos**2, 0.0))
    across = np.cross(axis, [0.3, 0.5, 0.8])
    across /= np.linalg.norm(across)
    other = np.cross(axis, across)
    turn = 2.0 * np.pi * v
    points = cos[:, None] * axis + (sin * np.cos(turn))[:, None] * across + (sin * np.sin(turn))[:, None] * other
    return points, np.full(len(u), np.pi * radius**2 / count**2)


def scan(sample, theta_deg, phi_deg, *, noise=2e-4, relative=0.01, seed=0, spacing_deg=3.0, fine=28):
    """One scan: transmission from the exterior, even and fine about narrow peaks."""
    at = travel(theta_deg, phi_deg)
    places = [synthetic_lab.hemisphere(spacing_deg, TOP_DEG, lambda ring: 7.0 * ring)]
    for lobe in SAMPLES[sample](at)[1]:
        if lobe.width < np.radians(2.0):
            near, _ = _cap(lobe.axis, np.radians(5.0), fine)
            places.append(angles(near[near[:, 2] > np.cos(np.radians(TOP_DEG))]))
    return synthetic_lab.scan(
        lambda _incident, outgoing, _scatter: bsdf(sample, at, outgoing),
        theta_deg,
        phi_deg,
        points=np.concatenate(places, axis=1),
        noise_dsf=noise,
        relative=relative,
        seed=[seed, round(10 * theta_deg), round(10 * phi_deg)],
    )


def measured(sample, *, isotropic=False, seed=0, phis_deg=None, **options):
    """All scans: every 10° to 80°, every 15° of azimuth from the symmetry's share of a turn."""
    if phis_deg is None:
        last = {"twill": 180.0, "peak": 90.0, "ring": 90.0, "off-specular": 90.0}.get(sample, 180.0)
        whole = {"twill": 165.0, "prism": 90.0}.get(sample, last)
        phis_deg = [0.0] if isotropic else list(np.arange(0.0, whole + 1e-9, 15.0))
    scans = [scan(sample, 0.0, 0.0, seed=seed, **options)]
    scans += [
        scan(sample, float(theta), float(phi), seed=seed, **options) for theta in range(10, 81, 10) for phi in phis_deg
    ]
    return Measurement(sample, tuple(scans))


SYMMETRY = {
    "peak": "isotropic",
    "off-specular": "isotropic",
    "ring": "isotropic",
    "twill": "rotational",
    "prism": "quadrilateral",
}
