"""From scans to a model between their incident directions.

Each scan becomes lobes, radial basis functions on the sphere whose amplitudes are those of least squares; between
incident directions the lobes move along plans of optimal transport (after Ward, Kurt and Bonneel 2014, "Reducing
anisotropic BSDF measurement to common practice").
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.bsdf import Bsdf
from clerestory.directions import SCATTERS, SIDES
from clerestory.measure.delaunay import NoSurfaceError
from clerestory.measure.interpolant.fitted import Component, Fit, HeldOut
from clerestory.measure.interpolant.lines import is_line
from clerestory.measure.interpolant.residual import Residual
from clerestory.measure.prepare.noise import noise
from clerestory.measure.prepare.step import light_in_words, same_light
from clerestory.measure.prepare.symmetry import SYMMETRIES, chosen, scores
from clerestory.measure.scan import Measurement
from clerestory.model import Model

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.prepare.symmetry import Symmetry
    from clerestory.measure.scan import Scan

    Floats = NDArray[np.float64]

Method = Literal["transport", "linear", "nearest"]
"""Light moves from place to place; distributions fade into each other; the nearest one."""
METHODS: tuple[Method, ...] = ("transport", "linear", "nearest")

_LEAST_ERROR = 1e-5
"""Standard error [1/sr] that no point is better than."""
_MOST_LEFT_OUT = 24
"""Incident directions that are left out in turn; of more, so many spread over all."""
_SIGNIFICANT = 2.0
"""Standard errors beyond which light that lobes lack is given to them."""
_ONE_AZIMUTH_DEG = 1.0
"""Scans whose azimuths differ by less are in one plane of incidence."""


def fit(
    measurement: Measurement | Iterable[Scan],
    *,
    method: Method = "transport",
    symmetry: Symmetry | Literal["auto"] = "auto",
    channels: Sequence[str] | None = None,
    hold_out: bool = True,
    progress: Callable[[float], object] | None = None,
) -> Fit:
    """Make a model of every side, transmission or reflection, and channel that was measured.

    Parameters
    ----------
    measurement
        Scans of a sample, in BSDF or DSF; those of light from one direction are taken together.
    method
        What lies between measured incident directions: light moves (transport), distributions fade into each other
        (linear), or the nearest one holds (nearest).
    symmetry
        The sample's, by which measured directions stand for others. `auto` takes isotropic where all scans are in one
        plane of incidence, and otherwise the highest symmetry that was tested and holds.
    channels
        Channels that become bands of the data set; all of them by default.
    hold_out
        Whether incident directions are left out in turn to see how well the others foretell them.
    progress
        Called with the share that is done, 0 to 1.

    Raises
    ------
    ClerestoryError
        There are too few points or incident directions, they lie on lines (see `spread_lines`), or the values are a
        detector's signal.
    """
    if method not in METHODS:
        raise ClerestoryError(f"method {method!r} is not known (give {', '.join(METHODS)})")
    if symmetry not in (*SYMMETRIES, "auto"):
        raise ClerestoryError(f"symmetry {symmetry!r} is not known (give auto, {', '.join(SYMMETRIES)})")
    if not isinstance(measurement, Measurement):
        measurement = Measurement("", tuple(measurement))
    scans = [scan.as_bsdf() for scan in measurement.of()]
    if not scans:
        raise ClerestoryError("there is no scan of the sample to make a model of")
    names = list(dict.fromkeys(name for scan in scans for name in scan.channels))
    if channels is not None:
        for name in channels:
            if name not in names:
                raise ClerestoryError(f"no channel {name!r} (there are {', '.join(names)})")
        names = list(channels)
    warnings: list[str] = list(measurement.warnings)
    bands: dict[str, dict[tuple[Side, Scatter], Model]] = {}
    components = []
    for band in names:
        for side in SIDES:
            for scatter in SCATTERS:
                here = [s for s in scans if (s.incident_side, s.scatter) == (side, scatter) and band in s.channels]
                if not here:
                    continue
                model, component = _component(here, band, method, symmetry, warnings, progress, hold_out=hold_out)
                bands.setdefault(band, {})[side, scatter] = model
                components.append(component)
    return Fit(Bsdf.from_models(bands), measurement.sample, method, tuple(components), tuple(dict.fromkeys(warnings)))


def _component(
    scans: list[Scan],
    band: str,
    method: Method,
    wanted: Symmetry | Literal["auto"],
    warnings: list[str],
    progress: Callable[[float], object] | None,
    *,
    hold_out: bool,
) -> tuple[Model, Component]:
    side, scatter = scans[0].incident_side, scans[0].scatter
    symmetry, reason = _symmetry(scans, band, wanted, warnings)
    groups = same_light(scans)
    _refuse_lines(groups)
    distributions = distributions_of(groups, band, symmetry, progress)
    model = Model(distributions.model(symmetry, method, progress))
    count = len(groups)
    step = max(1, -(-count // _MOST_LEFT_OUT))
    rows = np.zeros((0, 4))
    lights = np.arange(0, count, step)
    if hold_out and count > (2 if symmetry == "isotropic" else 3):
        rows = distributions.held_out(symmetry, method, list(lights))
    else:
        lights = lights[:0]
    inside = ~np.isnan(rows[:, 1])
    first = [group[0] for group in groups]
    held = HeldOut(
        np.array([first[k].incident_theta_deg for k in lights[inside]]),
        np.array([first[k].incident_phi_deg for k in lights[inside]]),
        rows[inside, 0],
        rows[inside, 1],
        rows[inside, 2],
        np.degrees(rows[inside, 3]),
    )
    over = distributions.scattered()
    if (over > 1.0).any():
        worst = int(np.argmax(over))
        warnings.append(
            f"{band}, {scatter} from {side}: {over[worst]:.3f} of the light from {first[worst].incident_theta_deg:g}°"
            " leaves, more than arrives; the model keeps to 1 (calibrate it, or look at the reference beam)"
        )
    component = Component(
        band,
        side,
        scatter,
        symmetry,
        reason,
        count,
        sum(len(scan) for scan in scans),
        sum(distributions.lobe_counts()),
        max(scan.incident_theta_deg for scan in scans),
        max(float(scan.theta_deg.max()) for scan in scans if len(scan)),
        held,
    )
    return model, component


def distributions_of(
    groups: Sequence[Sequence[Scan]],
    band: str,
    symmetry: Symmetry,
    progress: Callable[[float], object] | None = None,
) -> _core.Distributions:
    """Lobes of the scans of each light, with as much light as their points have.

    What is left of the points when the lobes are taken off is integrated over triangles: where lobes follow the points
    badly, as along a narrow ring, that is light that they lack. Points that make no surface cannot tell.
    """
    mirrored = symmetry == "isotropic"
    made = _core.Distributions([_points(group, band, mirrored=mirrored) for group in groups], progress)
    first = groups[0][0]
    nearest = Model(made.model(symmetry, "nearest", None))
    each = Bsdf.from_models({band: {(first.incident_side, first.scatter): nearest}})
    factors = np.ones(len(groups))
    for k, (group, held) in enumerate(zip(groups, made.scattered(), strict=True)):
        try:
            error = Residual.of(group, each, band, mirrored=mirrored).total
        except NoSurfaceError:
            continue
        lacks = float(error.off[0])
        if held > 0.0 and abs(lacks) > _SIGNIFICANT * float(np.sqrt(error.scatter[0])):
            factors[k] = max(0.0, 1.0 + lacks / held)
    return made.scaled(factors, np.ones(len(groups)))


def _refuse_lines(groups: Sequence[Sequence[Scan]]) -> None:
    for group in groups:
        if is_line(group):
            raise ClerestoryError(
                f"{light_in_words(group[0])}: points along a line say nothing of what lies beside it (assume that it"
                " can be turned about the mirrored or straight direction: --lines; or fit a formula)"
            )


def _symmetry(
    scans: Sequence[Scan], band: str, wanted: Symmetry | Literal["auto"], warnings: list[str]
) -> tuple[Symmetry, str]:
    if wanted != "auto":
        return wanted, "as was said"
    slanted = [scan.incident_phi_deg for scan in scans if scan.incident_theta_deg > _ONE_AZIMUTH_DEG]
    turned = np.exp(1j * np.radians(slanted))
    if not slanted or np.ptp(np.angle(turned / turned[0], deg=True)) < _ONE_AZIMUTH_DEG:
        warnings.append(
            "all scans are in one plane of incidence: the sample is taken as isotropic, which is not tested"
        )
        return "isotropic", "one plane of incidence"
    return chosen(scores(scans, channel=band))


def _points(group: Sequence[Scan], band: str, *, mirrored: bool) -> tuple[Floats, Floats, Floats, Floats, float, float]:
    """Incident direction, outgoing directions, BSDF and standard errors of the scans of one light; no beam."""
    outgoing = np.concatenate([scan.outgoing for scan in group])
    values = np.concatenate([scan.channel(band) for scan in group])
    errors = np.concatenate([_errors(scan, band) for scan in group])
    kept = np.isfinite(values) & np.isfinite(errors)
    outgoing, values, errors = outgoing[kept], values[kept], errors[kept]
    incident = group[0].incident
    across = np.array([-incident[1], incident[0], 0.0])
    if mirrored and np.linalg.norm(across) > 1e-9:
        # An isotropic sample is alike on both sides of the plane of incidence.
        across /= np.linalg.norm(across)
        image = outgoing - 2.0 * (outgoing @ across)[:, None] * across
        outgoing, values, errors = np.concatenate([outgoing, image]), np.tile(values, 2), np.tile(errors, 2)
    return incident[None, :], outgoing, values, errors, 0.0, 0.0


def _errors(scan: Scan, band: str) -> Floats:
    """Standard errors of the BSDF [1/sr]: the scan's own, or noise that is alike in all directions of DSF."""
    if scan.standard_errors is not None:
        errors = scan.standard_errors[:, scan.channels.index(band)]
    else:
        errors = noise(scan, band) / np.maximum(np.cos(np.radians(scan.theta_deg)), 0.02)
    return np.maximum(errors, _LEAST_ERROR)
