"""Models of one component: light from one side, transmitted or reflected."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.basis import Basis
from clerestory.tree import TreeOperations

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray


class Model(TreeOperations):
    """How light from one side is transmitted or reflected.

    Models are put together to a data set by `Bsdf.from_models`.
    """

    @classmethod
    def matrix(
        cls,
        values: ArrayLike,
        incident: Basis,
        outgoing: Basis | None = None,
        *,
        standard_errors: ArrayLike | None = None,
    ) -> Model:
        """Table of BSDF values.

        Parameters
        ----------
        values
            BSDF [1/sr], rows of outgoing and columns of incident patches.
        incident, outgoing
            Bases of the columns and the rows; one serves for both.
        standard_errors
            One a value [1/sr].
        """
        core = _core.Model.matrix(
            incident._core,
            (outgoing or incident)._core,
            np.ascontiguousarray(values, dtype=np.float64),
            None if standard_errors is None else np.ascontiguousarray(standard_errors, dtype=np.float64),
        )
        return cls(core)

    def with_standard_errors(self, standard_errors: ArrayLike, totals: ArrayLike | None = None) -> Model:
        """The same matrix with other standard errors.

        Parameters
        ----------
        standard_errors
            One a value [1/sr], rows of outgoing and columns of incident patches.
        totals
            Standard errors of the direct-hemispherical values (incident patches,), where they are known by
            themselves: errors of one measurement's values are not independent.

        Raises
        ------
        ClerestoryError
            The model is no matrix, numbers do not fit, or an error is negative.
        """
        if self.kind != "matrix":
            raise ClerestoryError(f"standard errors go with a matrix, not with a {self.kind} (convert it first)")
        kind, numbers, bases, arrays, models = self._core.to_parts()
        errors = np.asarray(standard_errors, dtype=np.float64)
        if errors.shape != self.values.shape:
            raise ClerestoryError(f"standard errors of shape {errors.shape} do not go with {self.values.shape}")
        kept = [(name, array) for name, array in arrays if name == "values"]
        kept.append(("standard_errors", np.ascontiguousarray(errors.T).ravel()))
        if totals is not None:
            kept.append(("total_standard_errors", np.ascontiguousarray(totals, dtype=np.float64)))
        return Model(_core.Model.from_parts(kind, numbers, bases, kept, models))

    @property
    def total_standard_errors(self) -> NDArray[np.float64] | None:
        """Standard errors of a matrix's direct-hemispherical values (incident patches,), if it has any of its own."""
        arrays = dict(self._core.to_parts()[3])
        found = arrays.get("total_standard_errors")
        return None if found is None else np.asarray(found, dtype=np.float64)

    @classmethod
    def lambertian(cls, value: float) -> Model:
        """Ideal diffuser of a given direct-hemispherical transmittance or reflectance."""
        return cls(_core.Model.lambertian(value))

    @classmethod
    def specular(
        cls,
        value: float | ArrayLike,
        *,
        basis: Basis | None = None,
        standard_error: ArrayLike | None = None,
        by: Literal["sine", "cosine"] = "sine",
    ) -> Model:
        """Ideal straight or mirrored beam.

        Parameters
        ----------
        value
            Transmittance or reflectance: a number, one a patch if `basis` is given, or else values at equal steps of
            sin²θ from 0 to 1, or of cosθ.
        basis
            Incident patches of the values.
        standard_error
            One a patch, for a measured beam.
        by
            What values at equal steps go by: `sine`, sin²θ from 0 along the normal to 1, or `cosine`, cosθ from 0 at
            grazing incidence to 1, as suits glass.

        Raises
        ------
        ClerestoryError
            Standard errors are given without a basis, or numbers do not fit.
        """
        values = np.asarray(value, dtype=np.float64)
        if standard_error is not None:
            if basis is None or values.ndim == 0:
                raise ClerestoryError("standard errors of a beam go with values by patch (give basis and values)")
            return cls(_core.Model.beam(basis._core, values, np.asarray(standard_error, dtype=np.float64)))
        if values.ndim == 0:
            return cls(_core.Model.specular(float(values)))
        if basis is None:
            make = _core.Model.specular_cosine if by == "cosine" else _core.Model.specular_angular
            return cls(make(values))
        return cls(_core.Model.specular_patches(basis._core, values))

    @classmethod
    def sum(cls, parts: Iterable[tuple[float, Model]]) -> Model:
        """Weighted sum of models, each at its own resolution; weights are 0 or more."""
        return cls(_core.Model.sum([(weight, model._core) for weight, model in parts]))

    @classmethod
    def mixture(cls, parts: Iterable[tuple[float, Model]]) -> Model:
        """Weighted sum that stays a matrix, a tensor tree, Lambertian or specular where all parts are alike.

        Weights may be negative where all parts are matrices on the same bases. Standard errors add as those of
        independent values.
        """
        return cls(_core.Model.mixture([(weight, model._core) for weight, model in parts]))

    @property
    def kind(self) -> str:
        """matrix, tensor tree, Lambertian, specular, beam, sum, turned, reversed, separated or filtered."""
        return self._core.kind

    def __repr__(self) -> str:
        return f"<Model: {self.kind}>"

    @property
    def incident_basis(self) -> Basis:
        """Incident patches of a matrix."""
        return Basis(self._core.matrix_parts()[0])

    @property
    def outgoing_basis(self) -> Basis:
        """Outgoing patches of a matrix."""
        return Basis(self._core.matrix_parts()[1])

    @property
    def values(self) -> NDArray[np.float64]:
        """BSDF of a matrix [1/sr], rows of outgoing and columns of incident patches."""
        return self._core.matrix_parts()[2]

    @property
    def standard_errors(self) -> NDArray[np.float64] | None:
        """Standard errors [1/sr] of a matrix, if it has any."""
        return self._core.matrix_parts()[3]

    def filtered(self, before: Model, after: Model) -> Model:
        """The scattered light of this model, with incident and outgoing light weakened by beams.

        Parameters
        ----------
        before, after
            Specular models: what incident light is multiplied by, and what outgoing light is.

        Notes
        -----
        a(vᵢ) f(vᵢ, vₒ) b(vₒ), at the model's own resolution; its peaks are not in it. Totals of a matrix are exact,
        others are found with 4096 samples.
        """
        return Model(self._core.filtered(before._core, after._core))

    def extrapolated(self, incident: ArrayLike, outgoing: ArrayLike) -> NDArray[np.bool_]:
        """Whether values of an interpolant lie beyond what was measured.

        Parameters
        ----------
        incident, outgoing
            Unit vectors toward the source and along the light (n, 3) each.

        Raises
        ------
        ClerestoryError
            The model is no interpolant.
        """
        rows = [np.ascontiguousarray(np.atleast_2d(a), dtype=np.float64) for a in (incident, outgoing)]
        found = self._core.extrapolated(*rows)
        if found is None:
            raise ClerestoryError(f"a {self.kind} model does not know what was measured (only an interpolant does)")
        return np.array(found, dtype=np.bool_)

    def scaled(self, factor: float) -> Model:
        """All values multiplied by a factor of 0 or more."""
        return Model(self._core.scaled(factor))

    def reciprocal(self) -> Model:
        """The model of the reversed paths: the other side's transmission, or the same side's reflection."""
        return Model(self._core.reciprocal())

    def anisotropy(self) -> float:
        """Share of the light that a turn of the sample in its plane would move: 0 for an isotropic one.

        Seen at 60° of azimuth and about 25° of polar angle, so that a table's own patches do not count.
        """
        return self._core.anisotropy()

    def reciprocity_error(self, back: Model) -> float:
        """How far two models are from reciprocity: ∫∫|f − reverse of `back`| / ∫∫f, 0 if they are reciprocal.

        Parameters
        ----------
        back
            The other side's transmission; for reflection the model itself.

        Returns
        -------
        NaN where this model is dark.
        """
        error = self._core.reciprocity_error(back._core)
        return float("nan") if error is None else error
