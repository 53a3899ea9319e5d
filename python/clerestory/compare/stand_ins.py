"""Simple models that are often used in place of measured data, made of one data set.

They show what the measured distribution is worth: how far a result would be off without it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.bsdf import Bsdf
from clerestory.compare.quantities import klems
from clerestory.integrals import hemispherical
from clerestory.model import Model

if TYPE_CHECKING:
    from clerestory.compare.result import Settings

TURNS = 24
"""Turns of the isotropic mean."""
_SAMPLES = 32


def made_of(bsdf: Bsdf, label: str, settings: Settings) -> dict[str, tuple[Bsdf, str]]:
    """Stand-ins for a data set, and words for how each was made.

    Notes
    -----
    *Specular and Lambertian*: what leaves through the patch that continues the incident direction becomes an ideal
    beam, everything else an ideal diffuser, both by incident patch of Klems' full basis. *Isotropic*: the mean over
    turns of the sample in its plane. *Lambertian*: one value, the hemispherical-hemispherical.
    """
    return {
        "specular + Lambertian": (
            _specular(bsdf, settings),
            f"of {label}: light into the Klems full patch that continues the direction as an ideal beam, the rest as "
            "an ideal diffuser, by incident Klems full patch",
        ),
        "isotropic mean": (
            _isotropic(bsdf, settings),
            f"of {label}: mean over {TURNS} turns of the sample in its plane, on Klems full",
        ),
        "Lambertian": (
            _lambertian(bsdf, settings),
            f"of {label}: an ideal diffuser of its hemispherical-hemispherical value",
        ),
    }


def _alone(model: Model, settings: Settings) -> Bsdf:
    return Bsdf.from_models({settings.band: {(settings.side, settings.scatter): model}})


def _component(bsdf: Bsdf, settings: Settings) -> Bsdf:
    model, _ = bsdf.model(settings.side, settings.scatter, settings.band)
    return _alone(model, settings)


def _matrix(bsdf: Bsdf, settings: Settings) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """BSDF [1/sr] on Klems full, (outgoing, incident)."""
    table = bsdf.to_matrix(klems(), samples=_SAMPLES)
    return np.maximum(table.model(settings.side, settings.scatter, settings.band)[0].values, 0.0)


def _specular(bsdf: Bsdf, settings: Settings) -> Bsdf:
    basis = klems()
    areas = basis.projected_solid_angles
    values = _matrix(_component(bsdf, settings), settings)
    total = areas @ values
    direct = areas * np.diagonal(values)
    rest = np.broadcast_to(np.maximum(total - direct, 0.0) / np.pi, values.shape)
    parts = [(1.0, Model.specular(direct, basis=basis)), (1.0, Model.matrix(rest, basis))]
    return _alone(Model.sum(parts), settings)


def _isotropic(bsdf: Bsdf, settings: Settings) -> Bsdf:
    one = _component(bsdf, settings)
    if one.model(settings.side, settings.scatter, settings.band)[0].kind != "matrix":
        one = one.to_matrix(klems(), samples=_SAMPLES)
    turned = [one.rotated(360.0 * k / TURNS) for k in range(TURNS)]
    models = [t.model(settings.side, settings.scatter, settings.band)[0] for t in turned]
    mean = Model.sum([(1.0 / TURNS, model) for model in models])
    return _alone(mean, settings).to_matrix(klems(), samples=_SAMPLES)


def _lambertian(bsdf: Bsdf, settings: Settings) -> Bsdf:
    value = hemispherical(
        bsdf, settings.scatter, side=settings.side, band=settings.band, samples=settings.samples
    ).value
    return _alone(Model.lambertian(value), settings)
