"""How a data set shows itself."""

import re

import numpy as np

from clerestory import Basis, Bsdf, Model

KLEMS = Basis.named("klems-full")


def two_bands():
    matrix = Model.matrix(np.full((145, 145), 0.4 / np.pi), KLEMS)
    return Bsdf.from_models(
        {
            "visible": {("exterior", "transmission"): matrix, ("interior", "reflection"): Model.lambertian(0.25)},
            "<solar>": {("exterior", "transmission"): Model.specular(0.5)},
        }
    )


def test_text():
    assert repr(two_bands()).splitlines() == [
        "Bsdf",
        "  visible: exterior transmission, matrix 145 × 145, LBNL/Klems Full, T_hh 0.4000",
        "  visible: interior reflection, Lambertian, R_hh 0.2500",
        "  <solar>: exterior transmission, specular, T_hh 0.5000",
    ]


def test_bases_that_differ_are_both_named():
    half = Basis.named("klems-half")
    bsdf = Bsdf.from_models({("exterior", "transmission"): Model.matrix(np.zeros((145, 77)), half, KLEMS)})
    assert "matrix 145 × 77, LBNL/Klems Half to LBNL/Klems Full" in repr(bsdf)


def test_html_is_escaped_and_balanced():
    html = two_bands()._repr_html_()
    assert "&lt;solar&gt;" in html
    assert "<solar>" not in html
    for tag in ("table", "tr", "td", "th", "tbody"):
        assert len(re.findall(rf"<{tag}>", html)) == len(re.findall(rf"</{tag}>", html)) > 0
    assert html.count("<tr>") == 4
