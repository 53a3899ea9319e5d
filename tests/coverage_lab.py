"""Repetitions of a synthetic laboratory: how often stated intervals hold the truth.

A repetition is a laboratory that measures a few neighbouring incident directions of a sample, with noise and a level of
its own, makes a model by the package's own functions, and says how far it is to be believed. Asked are directions
that were measured and others between them; the truth has no cone.
"""

from dataclasses import dataclass, replace

import numpy as np

import pg2
from clerestory.directions import direction
from clerestory.measure import Measurement
from clerestory.measure.interpolant import fit
from clerestory.measure.uncertainty import COVERAGE_FACTOR, Settings, uncertainties
from clerestory.measure.uncertainty.patches import Patches

LEVEL = 0.005
CONE_DEG = 1.5
FINE = Patches.of("interior", across=16)


@dataclass(frozen=True)
class Repetition:
    """Errors over standard uncertainties of one laboratory."""

    sample: str
    measured: np.ndarray
    """Whether each direction was measured (directions,)."""
    totals: np.ndarray
    """Of direct-hemispherical values (directions,)."""
    patches: np.ndarray
    """Of fluxes into Klems patches (directions, patches)."""


def truth(sample, theta_deg, phi_deg):
    """Direct-hemispherical value and fluxes into patches, without the instrument's cone."""
    at, cone = pg2.travel(theta_deg, phi_deg), pg2.CONE
    try:
        pg2.CONE = 0.0
        return pg2.total(sample, at), FINE.fluxes(pg2.bsdf(sample, at, FINE.directions))
    finally:
        pg2.CONE = cone


def repetition(sample, seed):
    """One laboratory."""
    rng = np.random.default_rng([7, seed, list(pg2.SAMPLES).index(sample)])
    isotropic = pg2.SYMMETRY[sample] == "isotropic"
    first = 10.0 * rng.integers(0, 4) if isotropic else 10.0 * rng.integers(1, 5)
    thetas = first + 10.0 * np.arange(5 if isotropic else 3)
    phis = [0.0] if isotropic else 15.0 * rng.integers(0, 12) + np.array([0.0, 15.0, 30.0])
    level = 1.0 + LEVEL * rng.standard_normal()
    scans = []
    for theta in thetas:
        for phi in phis:
            one = pg2.scan(sample, float(theta), float(phi), seed=seed, spacing_deg=5.0, fine=28 if isotropic else 20)
            scans.append(replace(one, values=level * one.values))
    made = fit(Measurement(sample, tuple(scans)), symmetry="isotropic" if isotropic else "none", hold_out=False)
    ((_, one),) = uncertainties(scans, made, Settings(CONE_DEG, LEVEL)).items()
    known = [(float(rng.choice(thetas)), float(rng.choice(phis))) for _ in range(2)]
    between = [
        (float(rng.uniform(thetas[0], thetas[-1])), float(rng.uniform(phis[0], phis[-1] + 1e-9 + 90.0 * isotropic)))
        for _ in range(3)
    ]
    totals, patches = [], []
    for theta, phi in known + between:
        toward = direction(theta, phi, side="exterior")
        budget = one.at(toward)
        total, fluxes = truth(sample, theta, phi)
        totals.append((budget.total - total) / budget.total_error)
        found = FINE.fluxes(FINE.values(one.bsdf, toward))
        patches.append((found - fluxes) / budget.flux_errors)
    return Repetition(sample, np.arange(5) < len(known), np.array(totals), np.array(patches))


def held(errors):
    """Share of errors within the stated intervals of 95 %."""
    return float(np.mean(np.abs(errors) <= COVERAGE_FACTOR))
