"""Text of instruments and optics programs: its lines whatever ends them, and its words with the lines they stand in."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.counts import counted
from clerestory.measure.formats import header

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

LARGEST = 1e30
"""Numbers beyond this are no measured values."""

_HEAD = 4096


def lines_of(data: bytes) -> list[str]:
    """Lines of a text that ends them with LF, CR LF or CR.

    Raises
    ------
    FileFormatError
        There is nothing in it, or it is no text.
    """
    if not data.strip():
        raise FileFormatError("the file is empty (export it again)")
    if b"\0" in data:
        place = data.index(b"\0")
        raise FileFormatError(f"byte {place} is 0, which no text has (export it as text)")
    return header.lines_of(data)


def head_of(data: bytes) -> list[str]:
    """The first lines of what may be a text, in small letters; none where it is not."""
    try:
        return [line.strip() for line in "\n".join(lines_of(data[:_HEAD])).lower().split("\n")]
    except FileFormatError:
        return []


def number(word: str, what: str, line: int) -> float:
    """A word as a number.

    Raises
    ------
    FileFormatError
        It is none, or not finite.
    """
    try:
        value = float(word) if "_" not in word else np.nan
    except ValueError:
        value = np.nan
    if not abs(value) <= LARGEST:
        comma = ", with a point for decimals" if "," in word else ""
        raise FileFormatError(f"line {line}: {what} is {word[:40]!r}, not a number (correct it{comma})")
    return value


class Words:
    """The words of lines, one after the other, without comments.

    Parameters
    ----------
    lines
        The text's lines.
    comments
        What a line's remainder is ignored from.
    first
        Number of the first line.
    """

    def __init__(self, lines: Sequence[str], comments: tuple[str, ...] = ("#",), first: int = 1) -> None:
        split = [_before(line, comments).split() for line in lines]
        self._words = [word for words in split for word in words]
        self._ends = np.fromiter(accumulate(len(words) for words in split), dtype=np.int64, count=len(split))
        self._first = first
        self._at = 0

    def __len__(self) -> int:
        """Words that are left."""
        return len(self._words) - self._at

    @property
    def line(self) -> int:
        """Number of the line of the next word, or of the last line."""
        return self._line(self._at)

    def _line(self, index: int) -> int:
        return self._first + min(int(np.searchsorted(self._ends, index, side="right")), max(len(self._ends) - 1, 0))

    def peek(self) -> str:
        """The next word in small letters, or nothing at the end."""
        return self._words[self._at].lower() if len(self) else ""

    def take(self, what: str) -> str:
        """The next word.

        Raises
        ------
        FileFormatError
            The text ends.
        """
        if not len(self):
            raise FileFormatError(f"line {self.line}: the file ends where {what} should be (is it whole?)")
        self._at += 1
        return self._words[self._at - 1]

    def rest_of_line(self) -> str:
        """The remaining words of the line of the word before."""
        line, start = self._line(self._at - 1), self._at
        while len(self) and self.line == line:
            self._at += 1
        return " ".join(self._words[start : self._at])

    def number(self, what: str) -> float:
        """The next word as a number."""
        line = self.line
        return number(self.take(what), what, line)

    def count(self, what: str) -> int:
        """The next word as a count of things of which each takes a word at least.

        Raises
        ------
        FileFormatError
            It is no whole number from 1, or the file is too short for so many.
        """
        line = self.line
        value = self.number(f"the count of {what}")
        if value != int(value) or value < 1:
            raise FileFormatError(
                f"line {line}: the count of {what} is {value:g}, not a whole number from 1 (correct it)"
            )
        if value > len(self):
            raise FileFormatError(
                f"line {line}: {value:.0f} {what} are declared, but the file ends before (is it whole?)"
            )
        return int(value)

    def numbers(self, count: int, what: str) -> NDArray[np.float64]:
        """The next words as numbers (count,).

        Raises
        ------
        FileFormatError
            There are fewer, or one is not a finite number.
        """
        if count > len(self):
            raise FileFormatError(
                f"line {self._line(len(self._words))}: {counted(len(self), 'word')} left where {count} {what} should be"
                " (is the file whole?)"
            )
        words = self._words[self._at : self._at + count]
        try:
            values = np.array(words, dtype=np.float64)
        except ValueError:
            values = None
        if values is None or not (np.abs(values) <= LARGEST).all() or any("_" in word for word in words):
            for k, word in enumerate(words):
                number(word, f"number {k + 1} of {count} {what}", self._line(self._at + k))
            raise AssertionError("a word that numpy refuses is a number")
        self._at += count
        return values

    def angles(self, what: str, low: float, high: float) -> NDArray[np.float64]:
        """A count and as many angles within limits [°]."""
        count = self.count(what)
        line = self.line
        values = self.numbers(count, what)
        within(values, what, low, high, line)
        return values


def within(values: NDArray[np.float64], what: str, low: float, high: float, line: int) -> None:
    """Refuse angles beyond limits [°].

    Raises
    ------
    FileFormatError
        One is beyond.
    """
    beyond = values[(values < low) | (values > high)]
    if beyond.size:
        raise FileFormatError(f"line {line}: {beyond[0]:g}° of {what} is not within {low:g} to {high:g}° (correct it)")


def _before(line: str, comments: tuple[str, ...]) -> str:
    for mark in comments:
        if mark in line:
            line = line.split(mark, 1)[0]
    return line
