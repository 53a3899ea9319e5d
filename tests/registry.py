"""Every kind of model, by name. A model joins all batteries of physics and statistics by being listed here."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from clerestory import Basis, Bsdf, Model, read
from clerestory.directions import direction, outgoing_side
from clerestory.system import Layer, Window, pane, stack
from clerestory.system.shelf import glass
from partition import Polar, Sectors, Square, Turned

if TYPE_CHECKING:
    from collections.abc import Callable

    from clerestory.directions import Scatter, Side
    from partition import Partition

#: (θ, φ) of incident light [°]: the normal, ordinary ones, and near the horizon. None lies on a border of patches.
INCIDENT = ((0.0, 0.0), (41.0, 93.0), (66.0, 207.0), (23.0, 311.0), (87.5, 20.0))


@dataclass(frozen=True)
class Case:
    """A data set in the batteries."""

    name: str
    build: Callable[[], Bsdf]
    #: Partition in whose cells the model is constant, for an incident disk point; None if there is none.
    cells: Callable[[np.ndarray], Partition] | None = None
    #: Keeps or absorbs the light's energy, for every incident direction.
    conserving: bool = True
    #: How far beams may be from those of the reversed paths. An isotropic tree's cell is not as large backwards.
    beams: float = 1e-9
    #: Backwards it is itself, and not a table that stands for it.
    reversible: bool = True

    @property
    def bsdf(self) -> Bsdf:
        return _built(self.name)

    @property
    def components(self) -> list[tuple[str, Side, Scatter]]:
        """Band, side and scatter of every model in it."""
        return [(band, side, scatter) for band, models in self.bsdf.models.items() for side, scatter in models]

    @property
    def sides(self) -> list[Side]:
        """Sides from which light is looked at."""
        return sorted({side for _, side, _ in self.components})

    def scatters(self, side: Side) -> list[Scatter]:
        """What happens to light from a side."""
        return sorted({scatter for _, s, scatter in self.components if s == side}, reverse=True)

    def only(self, side: Side) -> Scatter | None:
        """The one thing that happens to light from a side; None if it is both transmitted and reflected."""
        scatters = self.scatters(side)
        return scatters[0] if len(scatters) == 1 else None

    def exact(self, incident: np.ndarray) -> Partition | None:
        """Cells in which the model is constant for an incident direction (3,)."""
        return self.cells(-np.asarray(incident)[:2]) if self.cells else None

    def partition(self, incident: np.ndarray) -> Partition:
        """The same, or else fine cells."""
        return self.exact(incident) or Square(160)

    @property
    def tolerance(self) -> float:
        """Relative error of a quadrature with one point a cell."""
        return 6e-3 if self.cells is None else 1e-9


def incident_directions(side: Side) -> np.ndarray:
    """The incident directions of the batteries (n, 3)."""
    theta, phi = np.array(INCIDENT).T
    return direction(theta, phi, side=side)


def outgoing(points: np.ndarray, side: Side, scatter: Scatter) -> np.ndarray:
    """Outgoing directions (..., 3) of disk points (..., 2)."""
    z = np.sqrt(np.clip(1 - np.sum(points**2, axis=-1), 0, None))
    sign = 1.0 if outgoing_side(side, scatter) == "interior" else -1.0
    return np.concatenate([points, sign * z[..., None]], axis=-1)


def transmission(model: Model, side: Side = "exterior") -> Bsdf:
    return Bsdf.from_models({(side, "transmission"): model})


def table(incident: Basis, out: Basis | None = None, *, seed: int = 1, empty: bool = False) -> Model:
    """A rough table with totals between 0.2 and 0.9; nothing smooth that could hide an exchange of patches."""
    out = out or incident
    rng = np.random.default_rng(seed)
    values = rng.lognormal(0.0, 1.0, (len(out), len(incident)))
    if empty:
        values[:, ::3] = 0.0
        values[::4, :] = 0.0
        values[1::4, :] *= -0.1
    totals = out.projected_solid_angles @ values.clip(0.0)
    wanted = rng.uniform(0.2, 0.9, len(incident))
    return Model.matrix(values * np.divide(wanted, totals, out=np.zeros_like(totals), where=totals > 0), incident, out)


def through(basis: Basis, beam: float = 0.7, floor: float = 0.1) -> Model:
    """A table of a beam that stays in its patch, over a diffuse floor."""
    n = len(basis)
    return Model.matrix(np.full((n, n), floor / np.pi) + np.diag(beam / basis.projected_solid_angles), basis)


def quarter(seed: int) -> Model:
    return table(Basis.named("klems-quarter"), seed=seed)


def tree(rank: int, depth: int, *, seed: int = 1) -> Bsdf:
    """An uneven random tree, transmission from outside, that keeps to the energy it gets."""
    rng = np.random.default_rng(seed)

    def node(level: int) -> str:
        # Near the root there are no leaves, so that there is detail everywhere.
        if level < depth and (level < 2 or rng.random() < 0.5):
            return "{" + " ".join(node(level + 1) for _ in range(2**rank)) + "}"
        return f"{{{rng.choice([0.0, 0.02, 0.1, 0.3]) * rng.lognormal():.6g}}}"

    bsdf = _read_tree(rank, node(0))
    theta, phi = np.meshgrid(np.linspace(0.2, 89.8, 90), np.linspace(0.5, 359.5, 90))
    highest = bsdf.integrate(direction(theta, phi), "transmission").max()
    return bsdf.scaled(0.9 / highest)


def _read_tree(rank: int, text: str) -> Bsdf:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "tree.xml"
        path.write_text(_TREE_FILE.format(rank=rank, tree=text))
        return read(path)


_TREE_FILE = """<?xml version="1.0" encoding="UTF-8"?>
<WindowElement xmlns="http://windows.lbl.gov"><WindowElementType>System</WindowElementType>
<Optical><Layer><Material><Name>test</Name></Material>
<DataDefinition><IncidentDataStructure>TensorTree{rank}</IncidentDataStructure></DataDefinition>
<WavelengthData><LayerNumber>System</LayerNumber><Wavelength unit="Integral">Visible</Wavelength>
<WavelengthDataBlock><WavelengthDataDirection>Transmission Front</WavelengthDataDirection>
<AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringData>{tree}</ScatteringData></WavelengthDataBlock>
</WavelengthData></Layer></Optical></WindowElement>
"""


def tree_model(rank: int, depth: int, *, seed: int = 1) -> Model:
    """The same as a model."""
    return tree(rank, depth, seed=seed).models["visible"]["exterior", "transmission"]


def isotropic(n: int) -> Callable[[np.ndarray], Partition]:
    """Cells of a tree of rank 3: a grid in the frame where the light travels toward +x."""
    return lambda incident: Turned(Square(n), float(np.arctan2(incident[1], incident[0])))


def backwards(n: int) -> Callable[[np.ndarray], Partition]:
    """Cells of the reverse of a tree of rank 3."""
    return lambda incident: Turned(
        Sectors.backwards(n, float(np.hypot(*incident))), float(np.arctan2(incident[1], incident[0]))
    )


def square(n: int) -> Callable[[np.ndarray], Partition]:
    """Cells of a tree of rank 4."""
    return lambda _: Square(n)


#: Five patches in a ring: azimuth + 180° is not a patch, so that its reversal cannot be a table.
ODD = Basis.from_rings("odd", [(0, 20, 0, 1), (20, 50, 35, 5), (50, 90, 70, 7)])


def of(*bases: Basis | str) -> Callable[[np.ndarray], Partition]:
    """Cells of bases, whatever the incident direction."""
    polar = Polar.of(*(Basis.named(b) if isinstance(b, str) else b for b in bases))
    return lambda _: polar


def backwards_of(basis: Basis) -> Callable[[np.ndarray], Partition]:
    """Cells of the reverse of a table: its incident patches, half a turn on."""
    return turned(of(basis), 180.0)


def turned(cells: Callable[[np.ndarray], Partition], angle_deg: float, *, mirror: bool = False):
    """Cells of a model that is mirrored or turned."""
    return lambda incident: Turned(cells(incident), np.radians(angle_deg), mirror)


def _cases() -> list[Case]:
    full, half, small = (Basis.named(f"klems-{n}") for n in ("full", "half", "quarter"))
    diffuse = of(Basis.from_rings("coarse", [(0, 30, 0, 1), (30, 60, 45, 4), (60, 90, 75, 4)]))
    angular = np.array([0.9, 0.89, 0.86, 0.7, 0.0])
    basis_names = ("klems-full", "klems-half", "klems-quarter", "tregenza", "reinhart:2", "iea21")
    mixture = [
        (0.3, Model.lambertian(0.8)),
        (0.5, table(full, seed=11)),
        (0.2, Model.specular(0.9)),
    ]
    return [
        Case("Lambertian", lambda: transmission(Model.lambertian(0.5)), diffuse),
        Case("specular", lambda: transmission(Model.specular(0.8)), diffuse),
        Case("specular by angle", lambda: transmission(Model.specular(angular)), diffuse),
        Case(
            "specular by patch",
            lambda: transmission(Model.specular(np.linspace(0.9, 0.1, len(full)), basis=full)),
            diffuse,
        ),
        *(
            Case(f"matrix on {name}", lambda name=name: transmission(table(Basis.named(name))), of(name))
            for name in basis_names
            if name != "iea21"
        ),
        Case("rectangular matrix", lambda: transmission(table(small, full)), of(full)),
        Case("matrix to the 5° exit grid", lambda: transmission(table(small, Basis.named("iea21"))), of("iea21")),
        Case("matrix with empty rows", lambda: transmission(table(half, empty=True)), of(half)),
        Case("matrix with a through-beam", lambda: transmission(through(full)), of(full)),
        Case("matrix of a user's basis", lambda: transmission(table(ODD)), of(ODD)),
        Case("reversed matrix", lambda: transmission(table(small, half).reciprocal()), of(small), conserving=False),
        Case("reversed view", lambda: transmission(table(ODD).reciprocal()), backwards_of(ODD), conserving=False),
        Case("sum", lambda: transmission(Model.sum(mixture)), of(full)),
        Case(
            "sum of two beams and tables",
            lambda: transmission(
                Model.sum(
                    [(0.2, Model.specular(1.0)), (0.3, Model.specular(angular)), (0.2, quarter(3)), (0.3, table(half))]
                )
            ),
            of(small, half),
        ),
        Case("turned by patches", lambda: transmission(table(small)).rotated(90.0), of(small)),
        Case("turned by any angle", lambda: transmission(table(full)).rotated(17.0), turned(of(full), 17.0)),
        Case("mirrored", lambda: transmission(table(half)).mirrored(), of(half)),
        Case(
            "mirrored after a turn",
            lambda: transmission(Model.sum([(0.5, table(ODD)), (0.5, Model.specular(0.4))])).rotated(31.0).mirrored(),
            turned(of(ODD), -31.0, mirror=True),
        ),
        Case("flipped", lambda: transmission(table(small), "interior").flipped(), of(small)),
        Case(
            "both sides, transmission and reflection",
            lambda: Bsdf.from_models(
                {
                    (side, scatter): Model.sum([(0.35, quarter(seed)), (0.1, Model.specular(0.5 + 0.1 * seed))])
                    for seed, (side, scatter) in enumerate(_COMPONENTS)
                }
            ),
            of(small),
        ),
        Case(
            "several bands",
            lambda: Bsdf.from_models(
                {
                    "visible": {
                        ("exterior", "transmission"): Model.sum([(0.4, quarter(5)), (0.5, Model.specular(0.6))]),
                        ("exterior", "reflection"): quarter(6).scaled(0.3),
                    },
                    "solar": {
                        ("exterior", "transmission"): Model.sum([(0.2, quarter(7)), (0.2, Model.specular(0.2))]),
                        ("exterior", "reflection"): Model.lambertian(0.4),
                    },
                    "nir": {
                        ("exterior", "transmission"): table(half, seed=8).scaled(0.7),
                        ("exterior", "reflection"): Model.specular(0.1),
                    },
                }
            ),
            of(small, half),
        ),
        Case("isotropic tree", lambda: tree(3, 4), isotropic(16)),
        Case("anisotropic tree", lambda: tree(4, 4), square(16)),
        Case("tree of one value", lambda: tree(4, 0), square(1)),
        Case("tree turned by a quarter", lambda: tree(4, 4).rotated(90.0), square(16)),
        Case("tree turned by any angle", lambda: tree(4, 3).rotated(-28.0), turned(square(8), -28.0)),
        Case("isotropic tree, mirrored", lambda: tree(3, 4, seed=4).mirrored(), isotropic(16)),
        Case(
            "anisotropic tree, reversed",
            lambda: transmission(tree_model(4, 4).reciprocal()),
            square(16),
            conserving=False,
        ),
        Case(
            "isotropic tree, reversed",
            lambda: transmission(tree_model(3, 3).reciprocal()),
            backwards(8),
            conserving=False,
        ),
        Case(
            "sum of a tree, a table and a reversed view",
            lambda: transmission(
                Model.sum(
                    [
                        (0.5, tree_model(4, 3)),
                        (0.2, quarter(4)),
                        (0.1, tree_model(3, 3).reciprocal()),
                        (0.1, Model.specular(0.5)),
                    ]
                )
            ),
        ),
        Case("separated matrix", lambda: transmission(through(full)).separate_peaks(), of(full)),
        Case("separated tree", lambda: _tree_with_beam().separate_peaks(), square(16)),
        Case(
            "separated reverse of an isotropic tree",
            lambda: transmission(isotropic_beam().reciprocal()).separate_peaks(),
            backwards(32),
            conserving=False,
            beams=0.2,
        ),
        Case(
            "separated matrix, turned",
            lambda: transmission(through(full)).separate_peaks().rotated(7.0),
            turned(of(full), 7.0),
        ),
        Case(
            "layered system",
            lambda: stack([pane(1.52, absorption_per_m=20.0, thickness_m=0.004), _diffuser(small)], small).bsdf,
            of(small),
        ),
        Case("pane", lambda: pane(1.52, absorption_per_m=20.0, thickness_m=0.004), diffuse),
        # At the end: batteries take directions by the number of the case.
        Case(
            "measured beam beside a table",
            lambda: transmission(
                Model.sum(
                    [
                        (0.4, table(full, seed=12)),
                        (
                            1.0,
                            Model.specular(
                                np.linspace(0.5, 0.1, len(full)), basis=full, standard_error=np.full(len(full), 0.01)
                            ),
                        ),
                    ]
                )
            ),
            of(full),
        ),
        Case(
            "specular by cosine",
            lambda: transmission(Model.specular(np.array([0.0, 0.7, 0.85, 0.9]), by="cosine")),
            diffuse,
        ),
        Case("diffuser seen through beams", lambda: transmission(Model.lambertian(0.8).filtered(_PASS, _PASS))),
        Case(
            "table seen through beams by patch",
            lambda: transmission(
                table(full, seed=13).filtered(_PASS, Model.specular(np.linspace(1, 0.2, 145), basis=full))
            ),
            of(full),
        ),
        Case("tree seen through beams", lambda: transmission(tree_model(4, 3).filtered(_PASS, _PASS)).rotated(12.0)),
        Case(
            "window at its layers' own resolution",
            lambda: Window([Layer("pane", pane=glass("clear", 0.006)), Layer("shade", bsdf=_SHADE)]).sharpened(
                basis=small
            ),
        ),
        # At the horizon the density of a lobe does not fall with the cosine, and the points of cells are coarse.
        *(
            Case(
                f"interpolant, {method}",
                lambda method=method: transmission(interpolant(method)),
                reversible=False,
            )
            for method in ("transport", "linear", "nearest")
        ),
    ]


def interpolant(method: str) -> Model:
    """A model of a few coarse scans of an isotropic sample whose lobe stays clear of the horizon."""
    from clerestory.integrals import continued
    from clerestory.measure.interpolant import fit
    from synthetic_lab import lobe, series

    def lagging(incident: np.ndarray, to: np.ndarray, scatter: Scatter) -> np.ndarray:
        axis = 0.7 * continued(incident, scatter)
        axis[2] = np.copysign(np.sqrt(1.0 - axis[0] ** 2 - axis[1] ** 2), to[0, 2])
        return 0.08 + 1.5 * lobe(to, axis, 7.0)

    scans = series(lagging, (0.0, 30.0, 60.0, 75.0), (0.0,))
    made = fit(scans, method=method, symmetry="isotropic", hold_out=False)  # type: ignore[arg-type]
    return made.bsdf.models["visible"]["exterior", "transmission"]


def _tree_with_beam() -> Bsdf:
    """A beam in the finest cells, over a diffuse floor."""
    n = 16

    def node(level: int, corner: tuple[int, ...]) -> str:
        width = n >> level
        if corner[:2] != corner[2:]:
            return "{0.02}"
        if width == 1:
            return f"{{{0.02 + 0.6 * n * n / np.pi:.6g}}}"
        half = width // 2
        children = ([c + half * (k >> axis & 1) for axis, c in enumerate(corner)] for k in range(16))
        return "{" + " ".join(node(level + 1, tuple(child)) for child in children) + "}"

    return _read_tree(4, node(0, (0, 0, 0, 0)))


def isotropic_beam() -> Model:
    """A beam in the finest cells about the straight direction, over a diffuse floor, as a tree of rank 3."""
    n = 32

    def node(level: int, corner: tuple[int, int, int]) -> str:
        width = n >> level
        low = np.array(corner) / n
        high = low + width / n
        # Straight on: (1 - x0, 1/2) on the outgoing square.
        outside = low[0] >= 0.5 or not (low[1] <= 1 - low[0] and high[1] >= 1 - high[0] and low[2] <= 0.5 <= high[2])
        if outside:
            return "{0.02}"
        if width == 1:
            return f"{{{0.02 + 0.15 * n * n / np.pi * (1 + 0.3 * corner[0] / n + 0.1 * (corner[2] * n > 0.5)):.6g}}}"
        half = width // 2
        children = (tuple(c + half * (k >> axis & 1) for axis, c in enumerate(corner)) for k in range(8))
        return "{" + " ".join(node(level + 1, child) for child in children) + "}"

    return _read_tree(3, node(0, (0, 0, 0))).models["visible"]["exterior", "transmission"]


#: What a pane leaves over, by cosine.
_PASS = Model.specular(np.array([0.0, 0.6, 0.8, 0.85, 0.9]), by="cosine")


def _diffuser(basis: Basis) -> Bsdf:
    """A reciprocal-looking layer that scatters to both sides."""
    return Bsdf.from_models(
        {(side, scatter): table(basis, seed=20 + k).scaled(0.45) for k, (side, scatter) in enumerate(_COMPONENTS)}
    )


_COMPONENTS: list[tuple[Side, Scatter]] = [
    (side, scatter) for side in ("exterior", "interior") for scatter in ("transmission", "reflection")
]


#: A diffuser with holes.
_SHADE = Bsdf.from_models(
    {
        key: Model.sum([(1.0, Model.lambertian(0.3)), (1.0, Model.specular(0.2 if key[1] == "transmission" else 0.05))])
        for key in _COMPONENTS
    }
)

CASES = {case.name: case for case in _cases()}


@cache
def _built(name: str) -> Bsdf:
    return CASES[name].build()
