"""Operations that make a data set of another one: `Bsdf` has them as methods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.basis import Basis

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterable, Mapping
    from typing import Self

    from numpy.typing import ArrayLike

    from clerestory import _core
    from clerestory.bsdf import Part
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
    rms_error: float | None
    """RMS error of the values over their mean, weighted by projected solid angle. For a matrix it is the estimated
    sampling error; for a tree the difference to the source at pseudo-random directions, None for one with beams."""
    worst_direct_hemispherical: float
    """Largest difference between a direct-hemispherical value and the source's mean over the same directions."""


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

        Matrices, tensor trees, Lambertian components and ideal beams of one value are converted exactly, by overlaps of
        patches and cells (isotropic trees in steps of a quarter degree of azimuth). Everything else is sampled by
        low-discrepancy directions, cosine-weighted in both patches. Ideal beams become the mean BSDF of the patch that
        they fall into; peaks that were separated go back into their table. Nothing is scaled afterwards; `conversion`
        of the result tells the errors. Standard errors of matrices are carried along.

        Parameters
        ----------
        basis
            Patches, or their name (see `Basis.named`).
        outgoing
            Patches of the outgoing directions, where they differ from the incident ones.
        samples
            Pairs of directions a patch pair, where any are needed; 256 to 512 are usual.
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
        _check_sampling(samples, seed)
        core, rows = self._chosen(bands).to_matrix(
            incident._core,
            incident._core if outgoing is None else _basis(outgoing)._core,
            samples,
            seed,
            progress,
        )
        return type(self)(core, [ConversionReport(*row) for row in rows])

    def to_tree(
        self,
        rank: Literal["tensor3", "tensor4"] = "tensor4",
        *,
        resolution: int = 6,
        samples: int = 16,
        reduce: float | None = 90.0,
        bands: Iterable[str] | None = None,
        seed: int = 0,
        progress: Callable[[float], object] | None = None,
    ) -> Self:
        """All components as tensor trees: the mean BSDF over cells, fine where it changes and coarse where it does not.

        Ideal beams become the mean BSDF of the finest cell that they fall into; peaks that were separated go back into
        their table. `conversion` of the result tells the errors.

        Parameters
        ----------
        rank
            tensor3 for samples that scatter alike from all azimuths, tensor4 for all others.
        resolution
            2^resolution cells an axis at the finest, at most 10. Every step takes 16 times as long for tensor4, 8 times
            for tensor3.
        samples
            Pairs of directions a finest cell.
        reduce
            Percentage of the finest blocks to merge, the smoothest first, as Radiance's converters do; None merges
            equal values only.
        bands, seed, progress
            As in `to_matrix`.

        Raises
        ------
        UnsupportedError
            tensor3 is asked for, and a turn of the sample would move more than 5 % of the light (see
            `Model.anisotropy`).
        ClerestoryError
            A number is not sensible.
        """
        if rank not in ("tensor3", "tensor4"):
            raise ClerestoryError(f"{rank!r} is not a kind of tensor tree (give tensor3 or tensor4)")
        if not 0 <= resolution <= 10:
            raise ClerestoryError(f"resolution {resolution} is not one of a tensor tree (give 0 to 10)")
        _check_sampling(samples, seed)
        core, rows = self._chosen(bands).to_tree(rank == "tensor3", resolution, samples, reduce, seed, progress)
        return type(self)(core, [ConversionReport(*row) for row in rows])

    def scaled(self, factor: float) -> Self:
        """All values multiplied by a factor of 0 or more."""
        return type(self)(self._core.scaled(factor))

    def normalised(
        self,
        values: ArrayLike,
        side: Side,
        scatter: Scatter,
        *,
        basis: Basis | str = "klems-full",
        band: str | None = None,
        part: Part = "all",
    ) -> Self:
        """One component scaled to known direct-hemispherical values, such as those of an integrating sphere.

        Parameters
        ----------
        values
            Direct-hemispherical transmittance or reflectance of all light, 0 to 1: one a patch (n,), or one
            for all.
        side, scatter
            The component: side of incidence, transmission or reflection.
        basis
            Incident patches of the values; those of the matrix, if it is one.
        band
            Name of a band; visible, or the first, by default.
        part
            The light that is scaled: all, or only the scattered or only the direct part, while the rest is kept.

        Raises
        ------
        ClerestoryError
            A patch has no light to scale, or more than asked for in the part that is kept.
        UnsupportedError
            The model cannot be scaled by these patches; the text says what to convert it to.
        """
        patches = _basis(basis)
        array = np.asarray(values, dtype=np.float64)
        if array.ndim == 0:
            array = np.full(len(patches), float(array))
        array = np.ascontiguousarray(array.reshape(-1))
        return type(self)(self._core.normalised(band, side, scatter, patches._core, array, part))

    def reciprocal_average(self) -> Self:
        """Forced reciprocity: each component averaged with its own reverse.

        Transmission of the two sides is averaged with each other, reflection with itself, along reversed paths. The
        hemispherical values of the two sides' transmission become equal.

        Raises
        ------
        UnsupportedError
            A model has no table of its reversed paths; the text says what to convert it to.
        """
        return type(self)(self._core.reciprocal_average())

    def separate_peaks(self) -> Self:
        """The through-beam of every transmission table as an explicit peak; totals stay as they are.

        The criterion is that of Ward et al. 2021 (Building and Environment 196, 107774), which Radiance's material
        aBSDF applies while rendering. Reflection is left as it is.
        """
        return type(self)(self._core.separate_peaks())

    def with_band(self, name: str, mixture: Mapping[str, float]) -> Self:
        """With a band that is a weighted sum of others, as in ``with_band("solar", {"visible": 0.499, "nir": 0.501})``.

        Matrices on one basis, tensor trees of one rank and analytic models stay what they are; anything else becomes a
        sum of models at their own resolutions. A band of that name is replaced. Negative weights need matrices.

        Raises
        ------
        MissingDataError
            A band, or a component that another one has, is missing.
        """
        return type(self)(self._core.with_mixture(name, list(mixture.items())))

    def with_near_infrared(self, visible_share: float = 0.499) -> Self:
        """With the band nir, (solar − r·visible) / (1 − r), for matrices.

        Parameters
        ----------
        visible_share
            Share r of visible light in the solar spectrum.

        Notes
        -----
        Where solar and visible data do not fit together values become negative. They are kept, named in `warnings` and
        count as zero in every result.
        """
        return type(self)(self._core.with_near_infrared(visible_share))

    def only_band(self, name: str) -> Self:
        """With one of its bands alone.

        Raises
        ------
        MissingDataError
            There is no such band.
        """
        return type(self)(self._core.with_bands([name]))

    def renamed_band(self, old: str, new: str) -> Self:
        """With a band under another name, in lower case."""
        return type(self)(self._core.with_renamed_band(old, new))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write Clerestory's own file (`.bsdf.npz`), which holds all of the data set; `clerestory.read` reads it.

        It is written whole or not at all.

        Raises
        ------
        OSError
            The file cannot be written.
        """
        from clerestory.npz import save

        save(self, path)

    def _chosen(self, bands: Iterable[str] | None) -> _core.Bsdf:
        if bands is None:
            return self._core
        return self._core.with_bands([bands] if isinstance(bands, str) else list(bands))


def _check_sampling(samples: int, seed: int) -> None:
    if not 1 <= samples < 2**32:
        raise ClerestoryError(f"{samples} samples cannot be taken (give 1 or more; 256 are usual)")
    if not 0 <= seed < 2**64:
        raise ClerestoryError(f"seed {seed} is not possible (give a number from 0 to 2^64 - 1)")


def _basis(basis: Basis | str) -> Basis:
    return Basis.named(basis) if isinstance(basis, str) else basis
