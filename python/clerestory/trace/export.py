"""Scans and rays as files for other programs."""

from __future__ import annotations

import csv
import io
import math
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory.directions import angles, outgoing_side
from clerestory.model import Model
from clerestory.trace.sample import Sample, load
from clerestory.whole import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

    from clerestory.basis import Basis
    from clerestory.bsdf import Bsdf
    from clerestory.directions import Side
    from clerestory.trace.instrument import Seen, Settings, Source, Tell

    Floats = NDArray[np.float64]


def culled(bsdf: Bsdf, percent: float) -> Bsdf:
    """A data set whose trees have so many per cent of their finest blocks merged; beams beside them stay."""
    return bsdf.with_models(
        {
            band: {key: _culled(model, percent) for key, model in members.items()}
            for band, members in bsdf.models.items()
        }
    )


def _culled(model: Model, percent: float) -> Model:
    if model.kind == "tensor tree":
        return model.reduced(percent=percent)[0]
    kind, _, _, arrays, models = model._core.to_parts()
    if kind != "sum":
        return model
    weights = dict(arrays)["weights"]
    return Model.sum([(float(w), _culled(Model(m), percent)) for w, m in zip(weights, models, strict=True)])


SCAN_COLUMNS = (
    "band",
    "side",
    "incident_theta_deg",
    "incident_phi_deg",
    "scatter",
    "quantity",
    "outgoing_theta_deg",
    "outgoing_phi_deg",
    "value",
    "standard_error",
)


def scan_table(seen: Iterable[Seen], basis: Basis) -> str:
    """A scan as CSV: a row for each outgoing patch (`bsdf` [1/sr]), one for the beam and one for all light (`total`).

    Parameters
    ----------
    seen
        What `scan` gave.
    basis
        The patches that it saw.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(SCAN_COLUMNS)
    for light in seen:
        side: Side = "interior" if light.incident[2] > 0.0 else "exterior"
        theta, phi = (float(a) for a in angles(light.incident))
        head = (light.band, side, f"{theta:.6g}", f"{phi:.6g}", light.scatter)
        centres = basis.outgoing_centres(outgoing_side(side, light.scatter))
        thetas, phis = angles(centres)
        for t, p, value, error in zip(thetas, phis, light.values, light.errors, strict=True):
            writer.writerow((*head, "bsdf", f"{t:.6g}", f"{p % 360.0:.6g}", f"{value:.8g}", f"{error:.3g}"))
        for quantity, (value, error) in (("beam", light.beam), ("total", light.total)):
            shown = "" if math.isnan(error) else f"{error:.3g}"
            writer.writerow((*head, quantity, "", "", f"{value:.8g}", shown))
    return text.getvalue()


def write_rays(
    sample: Source,
    path: Path,
    incident: ArrayLike | None,
    side: Side,
    paths: int,
    settings: Settings,
    *,
    progress: Tell | None = None,
) -> int:
    """Write the rays that leave a sample, whole or not at all.

    A `.csv` file has a row a ray: position [mm], unit vector of travel, flux of each band as a share of all that was
    sent in, and whether it was transmitted or reflected. A `.npz` file has the same as arrays, positions in metres.

    Parameters
    ----------
    sample
        As in `measure`.
    incident
        Direction (3,) to the source; evenly diffuse light from `side` where there is none.
    paths
        How many paths are sent in.
    settings
        Seed, threads and cones count.
    progress
        As in `measure`.

    Returns
    -------
    int
        Number of rays.
    """
    made = load(sample)
    if path.suffix.lower() == ".npz":
        return _arrays(made, path, incident, side, paths, settings, progress)
    head = ["x_mm", "y_mm", "z_mm", "dx", "dy", "dz", *(f"flux_{b.replace(' ', '_')}" for b in made.bands), "scatter"]
    count = 0
    with tempfile.NamedTemporaryFile("w", dir=path.parent, suffix=".part", encoding="utf-8") as file:
        file.write(",".join(head) + "\n")

        def take(positions: Floats, ways: Floats, flux: Floats, reflected: NDArray[np.bool_]) -> None:
            nonlocal count
            count += len(positions)
            for row, returns in zip(np.column_stack([1000.0 * positions, ways, flux]).tolist(), reflected, strict=True):
                numbers = ",".join(f"{x:.9g}" for x in row)
                file.write(f"{numbers},{'reflected' if returns else 'transmitted'}\n")

        _follow(made, incident, side, paths, settings, take, progress)
        file.flush()
        write_whole(path, Path(file.name).read_bytes())
    return count


def _arrays(
    made: Sample,
    path: Path,
    incident: ArrayLike | None,
    side: Side,
    paths: int,
    settings: Settings,
    progress: Tell | None,
) -> int:
    parts: list[tuple[Floats, Floats, Floats, NDArray[np.bool_]]] = []

    def take(*part: NDArray[np.float64]) -> None:
        parts.append(part)  # type: ignore[arg-type]  # three of floats, one of flags

    _follow(made, incident, side, paths, settings, take, progress)
    positions, ways, flux, reflected = (np.concatenate(column) for column in zip(*parts, strict=True))
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        position_m=positions,
        direction=ways,
        flux=flux,
        reflected=reflected,
        bands=np.array(made.bands),
        recipe=np.array(made.source),
    )
    write_whole(path, buffer.getvalue())
    return len(positions)


def _follow(
    made: Sample,
    incident: ArrayLike | None,
    side: Side,
    paths: int,
    settings: Settings,
    take: object,
    progress: Tell | None,
) -> None:
    towards = None if incident is None else np.atleast_2d(np.asarray(incident, dtype=np.float64))
    made.core().rays(settings.core(), towards, side, paths, take, progress)  # type: ignore[arg-type]
