"""Operations that make a data set of another one: `Bsdf` has them as methods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from clerestory.basis import Basis

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Self

    from clerestory import _core
    from clerestory.directions import Scatter, Side


@dataclass(frozen=True)
class ConversionReport:
    """How well a converted component stands for its source."""

    band: str
    side: Side
    """Side of incidence."""
    scatter: Scatter
    source: str
    """Kind of the source's model."""
    samples: int
    """Pairs of directions a cell; 0 where the conversion is exact."""
    rms_error: float
    """Estimated sampling error of the values: RMS over the mean, weighted by projected solid angle."""
    worst_direct_hemispherical: float | None
    """Largest difference between a direct-hemispherical value and the source's mean over the same directions; None
    where the source has only an estimate of its own."""


class Operations:
    """The methods of `Bsdf` that make another data set."""

    def __init__(self, core: _core.Bsdf, conversion: Iterable[ConversionReport] = ()) -> None:
        self._core = core
        self.conversion = list(conversion)
        """What `to_matrix` or `to_tree` did to each component; empty if it was not converted."""

    def to_matrix(
        self,
        basis: Basis | str = "klems-full",
        *,
        outgoing: Basis | str | None = None,
        samples: int = 256,
        bands: Iterable[str] | None = None,
        seed: int = 0,
        progress: Callable[[float], object] | None = None,
    ) -> Self:
        """All components as matrices: the mean BSDF over every pair of patches.

        Matrices, Lambertian components and ideal beams of one value are converted exactly, everything else by
        low-discrepancy directions, cosine-weighted in both patches. Peaks become the mean BSDF of the patch that they
        fall into. Nothing is scaled afterwards; `conversion` of the result tells the errors. Standard errors of
        matrices are carried along.

        Parameters
        ----------
        basis
            Patches, or their name (see `Basis.named`).
        outgoing
            Patches of the outgoing directions, where they differ from the incident ones.
        samples
            Pairs of directions a patch pair; 256 to 512 are usual.
        bands
            The bands that the result holds; all by default.
        seed
            Another seed gives an independent estimate.
        progress
            Called about ten times a second with the share that is done, 0 to 1.

        Raises
        ------
        ClerestoryError
            The basis is not known, or the number of samples is not sensible.
        MissingDataError
            A band is not there.
        KeyboardInterrupt
            Ctrl-C was pressed; nothing is left behind.
        """
        incident = _basis(basis)
        core, rows = self._chosen(bands).to_matrix(
            incident._core,
            incident._core if outgoing is None else _basis(outgoing)._core,
            samples,
            seed,
            progress,
        )
        return type(self)(core, [ConversionReport(*row) for row in rows])

    def _chosen(self, bands: Iterable[str] | None) -> _core.Bsdf:
        if bands is None:
            return self._core
        return self._core.with_bands([bands] if isinstance(bands, str) else list(bands))


def _basis(basis: Basis | str) -> Basis:
    return Basis.named(basis) if isinstance(basis, str) else basis
