"""Conditions that people write: arithmetic, comparisons, and/or/not, names and a few functions.

The text is read as Python reads an expression and worked out on series; nothing else of Python is in reach.
"""

from __future__ import annotations

import ast
import operator
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.trace.keys import suggestion

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    Value = Any
    """A number, a text, or a series of one."""

_ARITHMETIC: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: np.true_divide,
    ast.Mod: np.mod,
}
_COMPARISONS: dict[type, Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: np.equal,
    ast.NotEq: np.not_equal,
}
_FUNCTIONS: dict[str, tuple[Callable[..., Any], int]] = {
    "abs": (np.abs, 1),
    "min": (np.minimum, 2),
    "max": (np.maximum, 2),
}
_MOST = 1000
"""Parts of an expression; more are more than anybody reads, and than is safe to walk through."""


class Expression:
    """A condition, read and checked.

    Parameters
    ----------
    text
        As it is written.
    names
        Names that it may hold.
    calls
        Functions that it may call, beside abs, min and max, with texts in quotes.

    Raises
    ------
    ClerestoryError
        It is no condition; the text says what in it is not.
    """

    def __init__(self, text: str, names: frozenset[str], calls: frozenset[str] = frozenset()) -> None:
        self.text = text
        self.names: set[str] = set()
        """Names that it holds."""
        self.calls: set[tuple[str, tuple[str, ...]]] = set()
        """Functions that it calls, with their texts."""
        self._known, self._callable = names, calls
        try:
            # Long chains of signs are read by recursion.
            self._body = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            what = error.msg if isinstance(error, SyntaxError) else "it cannot be read"
            raise ClerestoryError(f"{text!r} is no condition: {what} (write such as 'hour > 12')") from None
        if sum(1 for _ in ast.walk(self._body)) > _MOST:
            raise ClerestoryError(f"a condition of {len(text)} characters is too long (divide it among rules)")
        self._check(self._body)

    def __repr__(self) -> str:
        return f"<Expression {self.text!r}>"

    def value(self, values: Mapping[str, Value], calls: Mapping[tuple[str, tuple[str, ...]], Value]) -> Value:
        """What it comes to, a number or a series.

        Parameters
        ----------
        values
            Of its names.
        calls
            Of its calls.
        """
        return _value(self._body, values, calls)

    def _wrong(self, node: ast.AST, what: str) -> ClerestoryError:
        part = ast.get_source_segment(self.text.strip(), node) or self.text
        return ClerestoryError(f"{part!r} in {self.text!r}: {what}")

    def _check(self, node: ast.expr) -> None:
        match node:
            case ast.BoolOp(values=parts):
                for part in parts:
                    self._check(part)
            case ast.UnaryOp(op=ast.Not() | ast.USub() | ast.UAdd(), operand=part):
                self._check(part)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _ARITHMETIC:
                self._check(left)
                self._check(right)
            case ast.Compare(left=left, ops=ops, comparators=others) if all(type(op) in _COMPARISONS for op in ops):
                for part in (left, *others):
                    self._check_side(part, ops)
            case ast.Constant(value=bool() | int() | float()):
                pass
            case ast.Constant(value=str()):
                raise self._wrong(node, "a text stands only beside == and != or in a call (compare it with a name)")
            case ast.Name(id=name):
                if name not in self._known:
                    raise self._wrong(node, f"no such name ({suggestion(name, sorted(self._known))})")
                self.names.add(name)
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
                self._check_call(node, name, args)
            case _:
                raise self._wrong(
                    node, "is not understood (use + - * / %, comparisons, and, or, not, names and functions)"
                )

    def _check_side(self, part: ast.expr, ops: list[ast.cmpop]) -> None:
        is_text = isinstance(part, ast.Constant) and isinstance(part.value, str)
        if not (is_text and all(isinstance(op, (ast.Eq, ast.NotEq)) for op in ops)):
            self._check(part)

    def _check_call(self, node: ast.Call, name: str, args: list[ast.expr]) -> None:
        if name in _FUNCTIONS:
            count = _FUNCTIONS[name][1]
            if len(args) != count:
                raise self._wrong(node, f"{name} takes {count} numbers, not {len(args)} (give {count})")
            for part in args:
                self._check(part)
            return
        if name not in self._callable:
            known = sorted({*self._callable, *_FUNCTIONS})
            raise self._wrong(node, f"there is no function {name} ({suggestion(name, known)})")
        texts = []
        for part in args:
            if not (isinstance(part, ast.Constant) and isinstance(part.value, str)):
                raise self._wrong(node, f'{name} takes names in quotes (write such as {name}("plane"))')
            texts.append(part.value)
        if not 1 <= len(texts) <= 2:
            raise self._wrong(node, f'{name} takes a name, and a state if you like (write such as {name}("plane"))')
        self.calls.add((name, tuple(texts)))


def _value(node: ast.expr, values: Mapping[str, Value], calls: Mapping[tuple[str, tuple[str, ...]], Value]) -> Value:
    """What a checked part comes to."""

    def of(part: ast.expr) -> Value:
        return _value(part, values, calls)

    match node:
        case ast.BoolOp(op=op, values=parts):
            join = np.logical_and if isinstance(op, ast.And) else np.logical_or
            found = of(parts[0])
            for part in parts[1:]:
                found = join(found, of(part))
            return found
        case ast.UnaryOp(op=op, operand=part):
            if isinstance(op, ast.Not):
                return np.logical_not(of(part))
            return -of(part) if isinstance(op, ast.USub) else of(part)
        case ast.BinOp(left=left, op=op, right=right):
            with np.errstate(divide="ignore", invalid="ignore"):
                return _ARITHMETIC[type(op)](of(left), of(right))
        case ast.Compare(left=left, ops=ops, comparators=others):
            sides = [of(left), *(of(part) for part in others)]
            found = _COMPARISONS[type(ops[0])](sides[0], sides[1])
            for comparison, low, high in zip(ops[1:], sides[1:], sides[2:], strict=False):
                found = np.logical_and(found, _COMPARISONS[type(comparison)](low, high))
            return found
        case ast.Constant(value=value):
            return value
        case ast.Name(id=name):
            return values[name]
        case ast.Call(func=ast.Name(id=name), args=args):
            if name in _FUNCTIONS:
                return _FUNCTIONS[name][0](*(of(part) for part in args))
            return calls[name, tuple(str(part.value) for part in args if isinstance(part, ast.Constant))]
    raise AssertionError(ast.dump(node))
