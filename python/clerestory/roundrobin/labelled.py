"""The numbers of a round robin as labelled arrays, NaN where there is nothing.

Dimensions are `system`, `laboratory`, `treatment` and `seed`; `moment` (points in time), `time` (steps of the year),
`point` and `threshold` (daylight autonomy), classes of glare; `data_set` and `quantity` (transmittances); `measure` and
`source` (variance).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import __version__
from clerestory.annual.frequencies import DGI_CLASSES, DGP_CLASSES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import xarray
    from numpy.typing import DTypeLike, NDArray

    from clerestory.roundrobin.run import Found
    from clerestory.roundrobin.study import RoundRobin

Variables = dict[str, tuple[tuple[str, ...], "NDArray[Any]", dict[str, str]]]
_CASE = ("system", "laboratory", "treatment", "seed")
_AT_EYE = (
    ("illuminance", "vertical illuminance at the eye", "lx"),
    ("dgp", "daylight glare probability", "1"),
    ("dgi", "daylight glare index", "1"),
)
_SOURCES = ("laboratory", "method", "interaction", "repetition")


class _Axes:
    """Labels along dimensions, and arrays over them."""

    def __init__(self, study: RoundRobin) -> None:
        self.labels: dict[str, list[Any]] = {
            "system": [system.name for system in study.systems],
            "laboratory": study.laboratories,
            "treatment": list(study.recipe.treatments),
            "seed": list(study.recipe.seeds),
        }
        self._places: dict[str, dict[Any, int]] = {}

    def empty(self, *dims: str, dtype: DTypeLike = np.float64) -> NDArray[Any]:
        """NaN everywhere."""
        return np.full([len(self.labels[dim]) for dim in dims], np.nan, dtype=dtype)

    def place(self, **labels: object) -> tuple[int, ...]:
        """Where some labels are, in their order."""
        for dim in labels:
            self._places.setdefault(dim, {label: k for k, label in enumerate(self.labels[dim])})
        return tuple(self._places[dim][label] for dim, label in labels.items())


def labelled(study: RoundRobin, found: Sequence[Found]) -> xarray.Dataset:
    """All numbers."""
    import xarray

    axes = _Axes(study)
    variables: Variables = {}
    for add in (_transmittances, _moments, _years, _variances):
        variables |= add(axes, found)
    used = {dim for dims, _, _ in variables.values() for dim in dims}
    coords: dict[str, Any] = {dim: labels for dim, labels in axes.labels.items() if dim in used}
    years = found[0].years_of
    if years is not None and "point" in used:
        coords |= {axis: ("point", years.points[:, k], {"units": "m"}) for k, axis in enumerate("xyz")}
    attributes = {"title": study.recipe.name, "software": f"Clerestory {__version__}"}
    return xarray.Dataset(variables, coords=coords, attrs=attributes)


def _transmittances(axes: _Axes, found: Sequence[Found]) -> Variables:
    own = {one.system.name: one.transmittance for one in found if one.transmittance is not None}
    if not own:
        return {}
    labels = {"data_set": [t.labels for t in own.values()]}
    axes.labels["data_set"] = list(dict.fromkeys(label for each in labels["data_set"] for label in each))
    keys = [q["key"] for t in own.values() for q in t.numbers["quantities"]]
    axes.labels["quantity"] = list(dict.fromkeys(keys))
    dims = ("system", "data_set", "quantity")
    values = axes.empty(*dims)
    for system, each in own.items():
        for quantity in each.numbers["quantities"]:
            for label, value in zip(each.labels, quantity["values"], strict=True):
                if value is not None:
                    values[axes.place(system=system, data_set=label, quantity=quantity["key"])] = value
    words = "value of a quantity: fractions of the incident light, angles in degrees"
    return {"transmittance": (dims, values, {"long_name": words})}


def _moments(axes: _Axes, found: Sequence[Found]) -> Variables:
    if not any(one.moments for one in found):
        return {}
    room = found[0].moments_of
    assert room is not None
    axes.labels["moment"] = list(room.recipe.times)
    dims = (*_CASE, "moment")
    values = {key: axes.empty(*dims) for key, _, _ in _AT_EYE}
    for one in found:
        for case, moments in one.moments.items():
            for (time, seed), moment in moments.items():
                place = axes.place(**_case(one, case.laboratory, case.treatment, seed), moment=time)
                for key, array in values.items():
                    array[place] = getattr(moment, key)
    return {f"moment_{key}": (dims, values[key], {"long_name": words, "units": unit}) for key, words, unit in _AT_EYE}


def _case(found: Found, laboratory: str, treatment: str, seed: int) -> dict[str, object]:
    return {"system": found.system.name, "laboratory": laboratory, "treatment": treatment, "seed": seed}


def _years(axes: _Axes, found: Sequence[Found]) -> Variables:
    if not any(one.years for one in found):
        return {}
    years = found[0].years_of
    assert years is not None
    axes.labels |= {
        "time": list(years.weather.times),
        "point": list(range(len(years.points))),
        "threshold": list(years.recipe.thresholds_lx),
        "dgp_class": list(DGP_CLASSES.names),
        "dgi_class": list(DGI_CLASSES.names),
    }
    in_time = (*_CASE, "time")
    series = {key: axes.empty(*in_time, dtype=np.float32) for key, _, _ in _AT_EYE}
    autonomy = axes.empty(*_CASE, "threshold", "point")
    shares = {key: axes.empty(*_CASE, f"{key}_class") for key in ("dgp", "dgi")}
    for one, case, seed in _each_year(found):
        place = axes.place(**_case(one, case.laboratory, case.treatment, seed))
        year, annual = one.years[case][seed], one.annual(case, seed)
        series["illuminance"][place] = year.eye_illuminance
        series["dgp"][place], series["dgi"][place] = year.dgp, year.dgi
        autonomy[place] = np.stack([annual.autonomy[t] for t in axes.labels["threshold"]])
        shares["dgp"][place], shares["dgi"][place] = annual.dgp_classes, annual.dgi_classes
    made: Variables = {
        f"year_{key}": (in_time, series[key], {"long_name": words, "units": unit}) for key, words, unit in _AT_EYE
    }
    words = "share of the daylight hours with at least the threshold"
    made["daylight_autonomy"] = ((*_CASE, "threshold", "point"), autonomy, {"long_name": words, "units": "1"})
    for key, array in shares.items():
        about = {"long_name": f"share of the hours in a class of {key.upper()}", "units": "1"}
        made[f"{key}_share"] = ((*_CASE, f"{key}_class"), array, about)
    return made


def _each_year(found: Sequence[Found]) -> Iterator[tuple[Found, Any, int]]:
    for one in found:
        for case, years in one.years.items():
            for seed in years:
                yield one, case, seed


def _variances(axes: _Axes, found: Sequence[Found]) -> Variables:
    measures = [(one.system.name, measure) for one in found for measure in one.measures]
    if not measures:
        return {}
    axes.labels["measure"] = list(dict.fromkeys(measure.key for _, measure in measures))
    axes.labels["source"] = list(_SOURCES)
    dims = ("system", "measure", "source")
    fields = {
        "degrees": "degrees of freedom",
        "sum_of_squares": "sum of squares about the mean",
        "share": "share of the total sum of squares",
        "f": "F",
        "p": "probability of so large an F without an effect",
    }
    spreads = {
        "laboratory_spread": "standard deviation of the laboratories' means",
        "method_spread": "standard deviation of the methods' means",
        "repetition_spread": "standard deviation between seeds",
    }
    of_sources = {name: axes.empty(*dims) for name in fields}
    of_measures = {name: axes.empty("system", "measure") for name in spreads}
    for system, measure in measures:
        place = axes.place(system=system, measure=measure.key)
        for source in measure.variance.sources:
            (k,) = axes.place(source=source.name)
            for name, array in of_sources.items():
                array[(*place, k)] = np.nan if (value := getattr(source, name)) is None else value
        for name, array in of_measures.items():
            array[place] = np.nan if (value := getattr(measure.variance, name)) is None else value
    made: Variables = {
        f"variance_{name}": (dims, array, {"long_name": fields[name]}) for name, array in of_sources.items()
    }
    return made | {
        name: (("system", "measure"), array, {"long_name": spreads[name]}) for name, array in of_measures.items()
    }
