"""A bracketed series: photographs of one view that differ in exposure."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from itertools import pairwise
from math import log2
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from clerestory._core import ClerestoryError
from clerestory.photo.exposure import Exposure, Given
from clerestory.photo.photograph import Photograph

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence

Times = Literal["written", "thirds"]
"""How exposure times are meant: as they are written, or as the thirds of a stop that cameras keep and round in EXIF."""

SAME = 0.02
"""Exposures nearer than this share are the same."""
WIDE = 16.0
"""A greater step between neighbours than this leaves levels that no picture holds well."""


@dataclass(frozen=True)
class Series:
    """Photographs from the shortest to the longest exposure, and what is doubtful about them."""

    photographs: tuple[Photograph, ...]
    warnings: tuple[str, ...]

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width [pixels]."""
        return self.photographs[0].shape

    @property
    def bits(self) -> int:
        """Bits a channel."""
        return self.photographs[0].bits

    @property
    def values(self) -> list[float]:
        """Time · ISO / f-number² of each [s]."""
        return [p.exposure.value for p in self.photographs]


def read_series(
    paths: Sequence[str | os.PathLike[str]],
    exposures: Mapping[str, Given] | None = None,
    *,
    given: Given | None = None,
    times: Times = "written",
) -> Series:
    """Read what the files of a series say, and check that they belong together. Their order does not matter.

    Parameters
    ----------
    paths
        Two or more photographs of one size.
    exposures
        Settings by the name of the file (with or without its folder), which win over EXIF; see `read_table`.
    given
        Settings of all pictures that EXIF does not hold, or wrongly.
    times
        Whether 1/60 s is meant as written, or is the 1/64 s (2⁻⁶ s) that cameras really keep.

    Raises
    ------
    ClerestoryError
        They do not make a series: one picture, two of one exposure, different sizes, apertures, cameras.
    """
    files = [Path(path) for path in paths]
    if len(files) < 2:
        raise ClerestoryError(
            f"{files[0] if files else 'the series'}: one picture holds no range of luminances "
            "(give two or more exposures of one view)"
        )
    taken = [_open(path, exposures, given or Given(), times) for path in files]
    taken.sort(key=lambda p: (p.exposure.value, str(p.path)))
    _check_same_picture(taken)
    for a, b in pairwise(taken):
        if b.exposure.value < (1.0 + SAME) * a.exposure.value:
            raise ClerestoryError(
                f"{b.path}: has the exposure of {a.path}, {a.exposure.words} (leave one of them out, or correct "
                "their exposures by --exposures)"
            )
    return Series(tuple(taken), tuple(_doubts(taken)))


def _open(path: Path, exposures: Mapping[str, Given] | None, given: Given, times: Times) -> Photograph:
    own = None
    if exposures is not None:
        own = exposures.get(str(path), exposures.get(path.name))
        if own is None:
            raise ClerestoryError(f"{path}: is not in the table of exposures (add a line for {path.name})")
    merged = Given(
        *(
            a if a is not None else b
            for a, b in zip(
                (own.time, own.f_number, own.iso) if own else (None, None, None),
                (given.time, given.f_number, given.iso),
                strict=True,
            )
        )
    )
    photograph = Photograph.open(path, merged)
    if times == "written":
        return photograph
    e = photograph.exposure
    return Photograph(
        path, Exposure(third_of_a_stop(e.time), e.f_number, e.iso), photograph.camera, photograph.shape, photograph.bits
    )


def third_of_a_stop(time: float) -> float:
    """The nearest power of 2^(1/3) s."""
    return float(2.0 ** (round(3.0 * log2(time)) / 3.0))


def _check_same_picture(taken: Sequence[Photograph]) -> None:
    """Fail on what no series may have; the odd picture out is named."""
    for name, values, remedy in (
        ("size", [f"{p.shape[1]} × {p.shape[0]} pixels" for p in taken], "give the pictures of one series"),
        ("depth", [f"{p.bits} bits" for p in taken], "give JPEGs or 16-bit TIFFs, not both"),
        ("camera", [p.camera.model for p in taken], "give the pictures of one camera"),
        ("lens", [p.camera.lens for p in taken], "give the pictures of one lens"),
        ("focal length", [f"{p.camera.focal_length} mm" for p in taken], "do not zoom within a series"),
        (
            "f-number",
            [f"f/{p.exposure.f_number:g}" for p in taken],
            "keep the aperture, since vignetting depends on it, and bracket by time",
        ),
        (
            "white balance",
            [_balance(p.camera.automatic_white_balance) for p in taken],
            "set a fixed one on the camera",
        ),
    ):
        counts = Counter(values)
        if len(counts) > 1:
            usual = counts.most_common(1)[0][0]
            odd, value = next((p, v) for p, v in zip(taken, values, strict=True) if v != usual)
            raise ClerestoryError(f"{odd.path}: its {name} is {value}, that of others {usual} ({remedy})")


def _balance(automatic: bool | None) -> str:  # noqa: FBT001 (a tag's value)
    return {None: "not said", True: "automatic", False: "fixed"}[automatic]


def _doubts(taken: Sequence[Photograph]) -> list[str]:
    found = []
    if taken[0].camera.automatic_white_balance and taken[0].bits == 8:
        found.append(
            "the white balance was automatic, so that the colours of the exposures may differ (set a fixed one)"
        )
    if len({p.exposure.iso for p in taken}) > 1:
        found.append("the ISO speed changes within the series, and its steps are less exact than times (keep ISO 100)")
    for a, b in pairwise(taken):
        step = b.exposure.value / a.exposure.value
        if step > WIDE:
            found.append(
                f"from {a.path.name} to {b.path.name} the exposure grows {step:.0f}-fold, so that some luminances "
                "are badly exposed in both (take steps of one or two stops)"
            )
    return found
