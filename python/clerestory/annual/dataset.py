"""Labelled results of a year, and their files: netCDF, Zarr, CSV.

Variables have their unit and what they are; coordinates are `point` with x, y, z [m], `threshold` [lx], `time` (middle
of the interval, standard time), `view`, `data_set`.
"""

from __future__ import annotations

import csv
import errno
import io
import math
import os
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError, __version__
from clerestory.annual import en17037, lm83
from clerestory.annual.metrics import UDI_NAMES
from clerestory.whole import whole_file, write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    import xarray
    from numpy.typing import ArrayLike, NDArray

    from clerestory.annual.metrics import PointMetrics
    from clerestory.weather import Weather

    Place = tuple[int | slice | NDArray[np.int64], ...]
    """Of values in an array; numbers rise."""

VARIABLES: dict[str, tuple[str, str]] = {
    "daylight_autonomy": ("share of the hours with at least the threshold", "1"),
    "continuous_daylight_autonomy": ("mean of min(1, illuminance/threshold)", "1"),
    "useful_daylight_illuminance": ("share of the hours in the band", "1"),
    "light_exposure": ("light exposure", "lx h"),
    "mean_illuminance": ("mean illuminance", "lx"),
    "highest_illuminance": ("highest illuminance", "lx"),
    "hours_in_sun": (f"hours with more than {lm83.SUNLIT:g} lx of direct sun", "h"),
    "illuminance": ("illuminance", "lx"),
    "eye_illuminance": ("vertical illuminance at the eye", "lx"),
    "dgp": ("daylight glare probability", "1"),
    "dgi": ("daylight glare index", "1"),
    "state": ("state of the windows", "1"),
}
"""Long name and unit of every variable."""
SUFFIXES = (".nc", ".zarr", ".csv")


def of_points(
    metrics: PointMetrics,
    points: ArrayLike,
    hours: str,
    *,
    hours_in_sun: ArrayLike | None = None,
    area: ArrayLike | None = None,
    **about: str | float,
) -> xarray.Dataset:
    """Metrics of a room by point, with those of the whole room as attributes.

    Parameters
    ----------
    metrics
        Of the points (n).
    points
        Where they are (n, 3) [m].
    hours
        Which hours count, in words: `Hours.words`.
    hours_in_sun
        Of the points (n,) [h], for annual sunlight exposure.
    area
        That each point stands for (n,) [m²]; all the same by default.
    **about
        Further attributes, such as the weather's source.

    Returns
    -------
    A data set with variables of `VARIABLES`.
    """
    import xarray

    where = np.asarray(points, dtype=np.float64)
    if where.shape != (metrics.exposure.size, 3):
        raise ClerestoryError(f"points {where.shape} do not go with {metrics.exposure.size} (give x, y, z of each)")
    variables: dict[str, tuple[tuple[str, ...], NDArray[Any]]] = {
        "daylight_autonomy": (("threshold", "point"), metrics.autonomy),
        "continuous_daylight_autonomy": (("threshold", "point"), metrics.continuous_autonomy),
        "useful_daylight_illuminance": (("band", "point"), metrics.useful),
        "light_exposure": (("point",), metrics.exposure),
        "mean_illuminance": (("point",), metrics.mean),
        "highest_illuminance": (("point",), metrics.highest),
    }
    whole: dict[str, str | float] = {"hours": hours, "hours_counted": metrics.hours}
    if hours_in_sun is not None:
        variables["hours_in_sun"] = (("point",), np.asarray(hours_in_sun, dtype=np.float64))
        whole["ase_1000_250"] = lm83.sunlight_exposure(hours_in_sun, area)
    if 300.0 in metrics.thresholds:
        whole["sda_300_50"] = lm83.spatial_autonomy(metrics.autonomy_at(300.0), area)
    made = xarray.Dataset(
        {name: (dims, values, _attributes(name)) for name, (dims, values) in variables.items()},
        coords={
            "point": np.arange(len(where)),
            "threshold": ("threshold", metrics.thresholds, {"units": "lx"}),
            "band": ("band", list(UDI_NAMES), {"long_name": "below 100, 100 to 300, 300 to 3000, above 3000 lx"}),
            **{axis: ("point", where[:, k], {"units": "m"}) for k, axis in enumerate("xyz")},
        },
        attrs={**whole, **about, "software": f"Clerestory {__version__}"},
    )
    if area is not None:
        made = made.assign_coords(area=("point", np.asarray(area, dtype=np.float64), {"units": "m2"}))
    return made


def add_provision(made: xarray.Dataset, levels: tuple[en17037.Provision, ...]) -> xarray.Dataset:
    """The same with daylight provision by EN 17037 among the attributes."""
    found: dict[str, str | float] = {"en17037_provision": en17037.provision_level(levels) or "none"}
    for level in levels:
        found[f"en17037_{level.level}_target_area"] = level.target_area
        found[f"en17037_{level.level}_minimum_area"] = level.minimum_area
    return made.assign_attrs(found)


def by_time(weather: Weather, variables: dict[str, tuple[tuple[str, ...], ArrayLike]], **coords: Any) -> xarray.Dataset:  # noqa: ANN401
    """Values by step of a year: illuminances of points, or illuminance and glare of views and data sets.

    Parameters
    ----------
    weather
        Its times are the coordinate `time`.
    variables
        Dimensions, `time` among them, and values of variables of `VARIABLES`.
    **coords
        Names along the other dimensions, such as `view=["desk"]`.
    """
    import xarray

    unknown = sorted(set(variables) - set(VARIABLES))
    if unknown:
        raise ClerestoryError(f"a variable {unknown[0]!r} is not known (give {', '.join(VARIABLES)})")
    return xarray.Dataset(
        {name: (dims, np.asarray(values), _attributes(name)) for name, (dims, values) in variables.items()},
        coords={
            "time": (
                "time",
                weather.times.astype("datetime64[ns]"),
                {"long_name": "standard time, middle of interval"},
            ),
            "interval": ("time", weather.interval, {"long_name": "length of the interval", "units": "h"}),
            **coords,
        },
        attrs={
            "weather": weather.source,
            "latitude": weather.place.latitude,
            "longitude": weather.place.longitude,
            "time_zone": weather.time_zone,
            "software": f"Clerestory {__version__}",
        },
    )


def _attributes(name: str) -> dict[str, str]:
    long_name, units = VARIABLES[name]
    return {"long_name": long_name, "units": units}


def save(made: xarray.Dataset, path: str | os.PathLike[str]) -> None:
    """Writes results whole or not at all: .nc (netCDF 4), .zarr (a folder, which must not exist), .csv (spreadsheets).

    A CSV file has a row a point or a step, and a column a variable (and threshold, band, view, …). Attributes are
    remarks at its head.

    Raises
    ------
    ClerestoryError
        The name ends otherwise, or what writes Zarr is not installed.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix == ".nc":
        write_whole(path, bytes(made.to_netcdf(engine="h5netcdf", encoding=_encoding(made))))
    elif suffix == ".zarr":
        _save_zarr(made, path)
    elif suffix == ".csv":
        write_whole(path, to_csv(made).encode())
    else:
        what = f"ends in {suffix}, which is not known" if suffix else "has no suffix"
        raise ClerestoryError(f"{path}: the name of results {what} (give {', '.join(SUFFIXES)})")


def save_filled(
    made: xarray.Dataset,
    path: str | os.PathLike[str],
    name: str,
    dims: Sequence[str],
    parts: Iterable[tuple[Place, NDArray[np.float32]]],
) -> None:
    """Writes netCDF as `save`, with a variable of `VARIABLES` more that comes part by part.

    Parameters
    ----------
    made
        The rest; it has all the coordinates.
    name, dims
        Of the variable.
    parts
        Where in it some values are, and these.

    Raises
    ------
    OSError
        The disk has no room for it, as it would be without compression.
    """
    import h5netcdf

    # The library of these files crashes where a disk gets full while it writes.
    needed = made.nbytes + 4 * math.prod(made.sizes[dim] for dim in dims) + 2**20
    if shutil.disk_usage(Path(path).resolve().parent).free < needed:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
    with whole_file(path) as temporary:
        made.to_netcdf(temporary, engine="h5netcdf", encoding=_encoding(made))
        with h5netcdf.File(temporary, "a") as file:
            shape = tuple(made.sizes[dim] for dim in dims)
            pieces = tuple(min(length, 256) for length in shape)
            values = file.create_variable(
                name, tuple(dims), np.float32, chunks=pieces, compression="gzip", compression_opts=1, shuffle=True
            )
            values.attrs.update(_attributes(name))
            for where, some in parts:
                values[where] = some


def _encoding(made: xarray.Dataset) -> dict[str, dict[str, Any]]:
    numeric = [name for name, values in made.data_vars.items() if values.dtype.kind == "f" and values.ndim]
    return {str(name): {"zlib": True, "complevel": 4} for name in numeric}


def _save_zarr(made: xarray.Dataset, path: Path) -> None:
    try:
        import zarr  # noqa: F401 (xarray loads it)
    except ImportError as error:
        raise ClerestoryError(f"{path}: writing Zarr needs zarr (pip install zarr, or give a name in .nc)") from error
    if path.exists():
        raise ClerestoryError(f"{path}: is there already (choose another name, or remove it)")
    folder = Path(tempfile.mkdtemp(prefix=f".{path.name}.", dir=path.resolve().parent))
    try:
        made.to_zarr(folder / path.name, zarr_format=2, consolidated=True)
        (folder / path.name).rename(path)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def to_csv(made: xarray.Dataset) -> str:
    """The text of a CSV file, see `save`."""
    row = "time" if "time" in made.dims else "point"
    if row not in made.dims:
        raise ClerestoryError("results without points and times are not a table (write .nc)")
    columns: list[tuple[str, NDArray[Any]]] = [(row, _cells(made[row].values))]
    columns += [(str(name), made[name].values) for name in made.coords if made[name].dims == (row,) and name != row]
    for name, values in made.data_vars.items():
        if row not in values.dims:
            continue
        rest = [dim for dim in values.dims if dim != row]
        table = values.transpose(row, *rest).values
        for index in np.ndindex(*table.shape[1:]):
            labels = [str(_label(made, str(dim), k)) for dim, k in zip(rest, index, strict=True)]
            columns.append((" ".join([str(name), *labels]), table[(slice(None), *index)]))
    text = io.StringIO()
    for key, value in made.attrs.items():
        text.write(f"# {key}: {value}\n")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([name for name, _ in columns])
    cells = [[f"{v:.7g}" if isinstance(v, float) else str(v) for v in values.tolist()] for _, values in columns]
    writer.writerows(zip(*cells, strict=True))
    return text.getvalue()


def _cells(values: NDArray[Any]) -> NDArray[Any]:
    """Times as people and spreadsheets read them."""
    if values.dtype.kind != "M":
        return values
    return np.array([str(t).replace("T", " ") for t in values.astype("datetime64[s]")])


def _label(made: xarray.Dataset, dim: str, index: int) -> object:
    if dim not in made.coords:
        return index
    value = made[dim].values[index]
    return f"{value:g}" if isinstance(value, float) else value
