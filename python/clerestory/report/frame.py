"""What all HTML reports share: the templates' environment, pictures within the page, symbols with subscripts.

Whatever comes from files or labels is escaped by the template engine.
"""

from __future__ import annotations

import base64
import re
from typing import TYPE_CHECKING

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from clerestory.plot.style import render

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SYMBOL = r"[TR]_[dh]-[dh]|θ_co|E_v"


def environment(package: str | None = None) -> Environment:
    """Templates of a package, and those that all share: `frame.html.j2` is to be extended."""
    shared = PackageLoader("clerestory.report")
    made = Environment(
        loader=shared if package is None else ChoiceLoader([PackageLoader(package), shared]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["symbol"] = symbol
    made.filters["subscripts"] = subscripts
    return made


def png(figure: Figure, dpi: float) -> str:
    """A figure as the address of an image."""
    return address(render(figure, ".png", dpi=dpi))


def address(image: bytes) -> str:
    """A PNG file as the address of an image."""
    return "data:image/png;base64," + base64.b64encode(image).decode("ascii")


def symbol(name: str) -> Markup:
    """`T_d-h` with its subscript lowered."""
    head, mark, rest = name.partition("_")
    # A non-breaking hyphen, so that narrow columns do not part it.
    return Markup("{}<sub>{}</sub>").format(head, rest.replace("-", "\u2011")) if mark else escape(name)


def subscripts(text: str) -> Markup:
    """A sentence with its symbols' subscripts lowered, and numbers that stay beside their units."""
    text = re.sub(r"(?<=\d) (?=%|(?:lx|h|m)\b)", "\u00a0", text)
    parts = re.split(rf"\b({_SYMBOL})\b", text)
    return Markup("").join(symbol(p) if re.fullmatch(_SYMBOL, p) else escape(p) for p in parts if p)
