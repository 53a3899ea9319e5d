"""What is known of a product, inside a BSDF XML file: one element that other readers pass over.

`<ProductData xmlns="urn:clerestory:product:1">` stands under `<WindowElement>`, before `<Optical>`. In it, all
optional:

- `<State parameter="tilt_deg">30</State>`: what changes in the product's family, and its value here.
- `<Heat winter="…" summer="…">` with `<U unit="W/(m2 K)">`, `<SHGC>` and `<SHGCDiffuse>`.
- `<Orientation mounting="roof">` (or `facade`) with `<Azimuth unit="Degree">` (by the compass: in a roof that of the up
  of the data, in a façade that of the outward normal), `<Within unit="Degree">` and
  `<Tilt unit="Degree">low high</Tilt>`.
- `<ControlCurve unit="Degree">` with `<Slats unit="Millimeter">width distance crown</Slats>`, `<Safety>`, `<Step>`, and
  a `<Point profile="20">37.7</Point>` an angle: the tilt that keeps the sun out at this profile angle, empty where none
  does.
- `<Component number="1" kind="glass">` a layer or gap, with an element a property, named as in its manifest; shares of
  gases are `<Gas name="argon">0.9</Gas>`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

from clerestory._core import FileFormatError
from clerestory.bsdf import Bsdf
from clerestory.system.product.data import Curve, Heat, Orientation, ProductData

if TYPE_CHECKING:
    from clerestory._core import _Element

NAMESPACE = "urn:clerestory:product:1"
_ELEMENT = "ProductData"
_PARENT = "WindowElement"
_NUMBERS = frozenset(
    ("thickness_m", "width_m", "conductivity", "emissivity_exterior", "emissivity_interior", "tir", "openness")
)


def with_product(bsdf: Bsdf, data: ProductData) -> Bsdf:
    """The data set with what is known of its product, in place of what it said before."""
    element_type, material, geometry, comments, other = bsdf._core.metadata_parts()
    kept = [(parent, element) for parent, element in other if (parent, element[0]) != (_PARENT, _ELEMENT)]
    kept.append((_PARENT, (_ELEMENT, [("xmlns", NAMESPACE)], "", _written(data))))
    return Bsdf(bsdf._core.with_metadata_parts((element_type, material, geometry, comments, kept)))


def product_of(bsdf: Bsdf) -> ProductData | None:
    """What a data set says of its product; None where it says nothing.

    Raises
    ------
    FileFormatError
        Its element is damaged; the text names the part.
    """
    *_, other = bsdf._core.metadata_parts()
    for parent, (name, attributes, _, children) in other:
        if (parent, name) == (_PARENT, _ELEMENT) and dict(attributes).get("xmlns", NAMESPACE) == NAMESPACE:
            return _read(children)
    return None


def _leaf(name: str, text: object, /, **attributes: object) -> _Element:
    return (name, [(key, str(value)) for key, value in attributes.items()], _text(text), [])


def _text(value: object) -> str:
    return repr(value) if isinstance(value, float) else str(value)


def _written(data: ProductData) -> list[_Element]:
    made: list[_Element] = []
    if data.parameter is not None and data.value is not None:
        made.append(_leaf("State", data.value, parameter=data.parameter))
    if data.heat is not None:
        heat = data.heat
        values = [
            _leaf("U", heat.u, unit="W/(m2 K)"),
            _leaf("SHGC", heat.shgc),
            _leaf("SHGCDiffuse", heat.shgc_diffuse),
        ]
        made.append(("Heat", [("winter", heat.winter), ("summer", heat.summer)], "", values))
    if data.orientation is not None:
        place = data.orientation
        values = [_leaf("Within", place.within_deg, unit="Degree")]
        if place.azimuth_deg is not None:
            values.insert(0, _leaf("Azimuth", place.azimuth_deg, unit="Degree"))
        if place.tilt_deg is not None:
            values.append(_leaf("Tilt", " ".join(map(repr, place.tilt_deg)), unit="Degree"))
        made.append(("Orientation", [("mounting", place.mounting)], "", values))
    if data.curve is not None:
        curve = data.curve
        values = [
            _leaf("Slats", " ".join(map(repr, curve.slats_mm)), unit="Millimeter"),
            _leaf("Safety", curve.safety_deg),
            _leaf("Step", curve.step_deg),
        ]
        values += [
            _leaf("Point", "" if tilt is None else tilt, profile=repr(profile))
            for profile, tilt in zip(curve.profile_deg, curve.tilt_deg, strict=True)
        ]
        made.append(("ControlCurve", [("unit", "Degree")], "", values))
    made += [_component(entry) for entry in data.components]
    return made


def _component(entry: dict[str, Any]) -> _Element:
    values: list[_Element] = []
    for key, value in entry.items():
        if key in ("number", "kind"):
            continue
        if key == "gas":
            values += [_leaf("Gas", share, name=gas) for gas, share in value.items()]
        else:
            values.append(_leaf(key, value))
    return ("Component", [("number", str(entry["number"])), ("kind", str(entry["kind"]))], "", values)


def _read(children: list[_Element]) -> ProductData:
    found: dict[str, Any] = {}
    components = []
    for name, attributes, text, inner in children:
        held = dict(attributes)
        if name == "State":
            found |= {"parameter": held.get("parameter"), "value": _number(text, name)}
        elif name == "Heat":
            values = {key: _number(t, f"Heat/{key}") for key, _, t, _ in inner}
            u, shgc, diffuse = (_needed(values, key, name) for key in ("U", "SHGC", "SHGCDiffuse"))
            found["heat"] = Heat(u, shgc, diffuse, held.get("winter", ""), held.get("summer", ""))
        elif name == "Orientation":
            found["orientation"] = _orientation(held, inner)
        elif name == "ControlCurve":
            found["curve"] = _curve(inner)
        elif name == "Component":
            components.append(_entry(held, inner))
    return ProductData(components=tuple(components), **found)


def _orientation(held: dict[str, str], inner: list[_Element]) -> Orientation:
    known: dict[str, Literal["facade", "roof"]] = {"facade": "facade", "roof": "roof"}
    mounting = known.get(held.get("mounting", ""))
    if mounting is None:
        raise _damaged("Orientation", f"mounting {held.get('mounting')!r} is not known (give facade or roof)")
    texts = {key: text for key, _, text, _ in inner}
    tilt = _numbers(texts["Tilt"], 2, "Orientation/Tilt") if "Tilt" in texts else None
    return Orientation(
        mounting,
        _number(texts["Azimuth"], "Orientation/Azimuth") if "Azimuth" in texts else None,
        _number(texts.get("Within", "0"), "Orientation/Within"),
        None if tilt is None else (tilt[0], tilt[1]),
    )


def _curve(inner: list[_Element]) -> Curve:
    texts = {key: text for key, _, text, _ in inner if key != "Point"}
    points = [(dict(attributes), text) for key, attributes, text, _ in inner if key == "Point"]
    width, distance, crown = _numbers(texts.get("Slats", ""), 3, "ControlCurve/Slats")
    return Curve(
        tuple(_number(held.get("profile", ""), "ControlCurve/Point profile") for held, _ in points),
        tuple(None if text == "" else _number(text, "ControlCurve/Point") for _, text in points),
        (width, distance, crown),
        _number(texts.get("Safety", "0"), "ControlCurve/Safety"),
        _number(texts.get("Step", "0"), "ControlCurve/Step"),
    )


def _entry(held: dict[str, str], inner: list[_Element]) -> dict[str, Any]:
    number = held.get("number", "")
    if not number.isdecimal():
        raise _damaged("Component", f"number {number!r} is none (count from 1)")
    entry: dict[str, Any] = {"number": int(number), "kind": held.get("kind", "")}
    for key, attributes, text, _ in inner:
        if key == "Gas":
            entry.setdefault("gas", {})[dict(attributes).get("name", "")] = _number(text, f"Component {number}/Gas")
        elif key == "flipped":
            entry[key] = text == "True"
        else:
            entry[key] = _number(text, f"Component {number}/{key}") if key in _NUMBERS else text
    return entry


def _number(text: str, place: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise _damaged(place, f"{text[:40]!r} is no number (correct it)")
    return value


def _numbers(text: str, count: int, place: str) -> tuple[float, ...]:
    words = text.split()
    if len(words) != count:
        raise _damaged(place, f"{len(words)} numbers where {count} belong (correct it)")
    return tuple(_number(word, place) for word in words)


def _needed(values: dict[str, float], key: str, place: str) -> float:
    if key not in values:
        raise _damaged(place, f"<{key}> is missing (add it)")
    return values[key]


def _damaged(place: str, what: str) -> FileFormatError:
    return FileFormatError(f"<{_ELEMENT}>, {place}: {what}")
