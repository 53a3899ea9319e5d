"""Analysis of variance: hand-worked tables, designs with holes, and what cannot be told apart."""

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.roundrobin.variance import analyse


def flat(table):
    """Values, laboratories and methods of a table of lists of repetitions; None where there is nothing."""
    rows = [
        (value, f"lab {i}", f"method {j}")
        for i, row in enumerate(table)
        for j, cell in enumerate(row)
        for value in (cell or [])
    ]
    return tuple(zip(*rows, strict=True))


def test_a_table_worked_by_hand():
    # Means of rows 5 and 8, of columns 4, 6.5 and 9, all 6.5; cells 2, 5, 8 and 6, 8, 10.
    found = analyse(*flat([[[1, 3], [4, 6], [7, 9]], [[5, 7], [7, 9], [9, 11]]]))
    assert found.mean == pytest.approx(6.5)
    squares = {s.name: (s.sum_of_squares, s.degrees) for s in found.sources}
    assert squares["laboratory"] == (pytest.approx(6 * 2 * 1.5**2), 1)
    assert squares["method"] == (pytest.approx(4 * (2.5**2 + 0 + 2.5**2)), 2)
    assert squares["interaction"] == (pytest.approx(2 * 4 * 0.5**2), 2)
    assert squares["repetition"] == (pytest.approx(12.0), 6)
    assert found.total == pytest.approx(27 + 50 + 2 + 12)
    assert found.source("laboratory").f == pytest.approx(27 / 1.0)
    assert found.source("method").f == pytest.approx(25 / 1.0)
    assert found.source("interaction").f == pytest.approx(1.0 / 2.0)
    assert found.source("laboratory").against == "interaction"
    # With two degrees below, F of one above has p = 1 - sqrt(F / (F + 2)); of two above, p = 1 / (1 + F).
    assert found.source("laboratory").p == pytest.approx(1.0 - np.sqrt(27.0 / 29.0))
    assert found.source("method").p == pytest.approx(1.0 / 26.0)
    assert found.complete
    assert found.laboratory_means == pytest.approx({"lab 0": 5.0, "lab 1": 8.0})
    assert found.method_means == pytest.approx({"method 0": 4.0, "method 1": 6.5, "method 2": 9.0})
    assert found.laboratory_spread == pytest.approx(np.sqrt(4.5))
    assert found.repetition_spread == pytest.approx(np.sqrt(2.0))
    assert sum(s.share for s in found.sources) == pytest.approx(1.0)


def test_a_hole_worked_by_hand():
    # One of four cells is empty. Additive fit: laboratory 1 is 3 above laboratory 0 (7 - 4), method 1 is 6 above.
    found = analyse([4.0, 10.0, 7.0], ["a", "a", "b"], ["x", "y", "x"])
    assert found.connected
    assert not found.complete
    assert found.laboratory_means == pytest.approx({"a": 7.0, "b": 10.0})
    assert found.method_means == pytest.approx({"x": 5.5, "y": 11.5})
    # Without the laboratory, x and y have means 5.5 and 10: what is left is 2 * 1.5²; without the method 2 * 3².
    assert found.source("laboratory").sum_of_squares == pytest.approx(4.5)
    assert found.source("method").sum_of_squares == pytest.approx(18.0)
    assert found.total == pytest.approx(18.0)
    # Nothing is left to judge by.
    assert found.source("laboratory").f is None
    assert found.source("interaction").degrees == 0


def test_unbalanced_squares_are_those_of_fits():
    rng = np.random.default_rng(3)
    table = [[[1.0, 2.0], [2.5], None], [[4.0], [3.0, 5.0, 4.5], [7.0]], [None, [1.0], [2.0, 3.5]]]
    y, labs, methods = flat(table)
    y = np.array(y) + rng.normal(0.0, 0.3, len(y))
    found = analyse(y, labs, methods)

    def left(*factors):
        columns = [np.ones(len(y))]
        for factor in factors:
            columns += [np.array([float(name == level) for name in factor]) for level in sorted(set(factor))[1:]]
        design = np.column_stack(columns)
        return float(np.sum((y - design @ np.linalg.pinv(design) @ y) ** 2))

    cells = [f"{a}{b}" for a, b in zip(labs, methods, strict=True)]
    assert found.source("laboratory").sum_of_squares == pytest.approx(left(methods) - left(labs, methods))
    assert found.source("method").sum_of_squares == pytest.approx(left(labs) - left(labs, methods))
    assert found.source("interaction").sum_of_squares == pytest.approx(left(labs, methods) - left(cells))
    assert found.source("repetition").sum_of_squares == pytest.approx(left(cells))
    assert [s.degrees for s in found.sources] == [2, 2, 2, len(y) - 7]


def test_designs_in_two_parts_cannot_be_told_apart():
    found = analyse([1.0, 2.0, 3.0], ["a", "b", "c"], ["x", "y", "y"])
    assert not found.connected
    assert found.laboratory_spread is None
    assert found.source("method").degrees == 0


def test_equal_values_have_no_variance():
    found = analyse([0.1] * 4, ["a", "a", "b", "b"], ["x", "y", "x", "y"])
    assert found.total == 0.0
    assert all(s.sum_of_squares == 0.0 and s.share is None and s.f is None for s in found.sources)
    assert found.method_spread == pytest.approx(0.0, abs=1e-15)


def test_one_laboratory_or_method_alone():
    found = analyse([1.0, 2.0, 4.0, 5.0], ["a", "a", "b", "b"], ["x"] * 4)
    assert found.method_spread is None
    assert found.source("laboratory").against == "repetition"
    assert found.source("laboratory").f == pytest.approx(9.0 / 0.5)


def test_p_is_even_where_there_is_no_effect():
    rng = np.random.default_rng(1)
    names = [(f"{i}", f"{j}") for i in range(4) for j in range(3) for _ in range(2)]
    labs, methods = zip(*names, strict=True)
    found = [analyse(rng.normal(size=len(names)), labs, methods) for _ in range(400)]
    for name in ("laboratory", "method", "interaction"):
        p = np.array([f.source(name).p for f in found])
        # 40 expected, standard deviation 6.
        assert 20 <= np.sum(p < 0.1) <= 60
        assert 160 <= np.sum(p < 0.5) <= 240


def test_what_is_no_design_is_refused():
    with pytest.raises(ClerestoryError, match="2 values of 1 laboratories"):
        analyse([1.0, 2.0], ["a"], ["x", "y"])
    with pytest.raises(ClerestoryError, match="not finite"):
        analyse([1.0, np.nan], ["a", "b"], ["x", "x"])
    with pytest.raises(ClerestoryError, match="0 values"):
        analyse([], [], [])
