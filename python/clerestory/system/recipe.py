"""Specifications of windows: TOML files that read like a data sheet, layers from the exterior to the interior."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, model_validator

from clerestory.system.product.keys import ProductKeys
from clerestory.trace.keys import Fraction, Keys, NotNegative, Number, Positive, suggestion, wrong

if TYPE_CHECKING:
    from typing import Self

GASES = ("air", "argon", "krypton", "xenon")
THERMAL = ("emissivity_exterior", "emissivity_interior", "tir", "conductivity", "openness", "thickness_mm")


class SystemKeys(Keys):
    """The window as a whole."""

    name: str | None = None
    """Its name; the layers' names by default."""
    standard: Literal["en410", "iso9050", "nfrc300"] = "en410"
    """Spectra that weigh the wavelengths."""
    basis: str = "klems-full"
    """Patches: klems-full, klems-half, klems-quarter, tregenza, reinhart:N."""
    specular: Literal["centre", "mean"] = "centre"
    """A pane's value in a patch: at its nominal centre, as WINDOW does, or the mean over it."""
    resolution: Literal["patches", "layers"] = "patches"
    """`layers` keeps beams and the layers' own resolution; for files of Clerestory's own."""
    spectral: bool = True
    """Wavelength by wavelength where there are panes; otherwise in broad bands."""
    width_m: Positive | None = None
    """Width [m]."""
    height_m: Positive | None = None
    """Height [m]."""
    tilt_deg: Annotated[Number, Field(ge=0.0, le=180.0)] = 90.0
    """Tilt [°]: 90 is vertical, 0 a roof window."""


class SheetKeys(Keys):
    """A sheet of a clear material."""

    refractive_index: Annotated[Number, Field(ge=1.0, le=5.0)]
    """Real part n."""
    extinction: NotNegative = 0.0
    """Imaginary part κ."""
    thickness_mm: Positive
    """Thickness [mm]."""


class EdgeKeys(Keys):
    """Open gaps along the edges of a shading layer, which let air pass [mm]."""

    top: NotNegative = 0.0
    """Along its top."""
    bottom: NotNegative = 0.0
    """Along its bottom."""
    left: NotNegative = 0.0
    """Along its left edge."""
    right: NotNegative = 0.0
    """Along its right edge."""


class _Solid(Keys):
    """What all solid layers may say."""

    name: str | None = None
    """Its name; that of the file by default."""
    flipped: bool = False
    """Turned round: what the file calls front faces the room."""
    emissivity_exterior: Fraction | None = None
    """Long-wave emissivity of the exterior face, before it is flipped."""
    emissivity_interior: Fraction | None = None
    """Long-wave emissivity of the interior face, before it is flipped."""
    tir: Fraction | None = None
    """Long-wave transmittance."""
    conductivity: Positive | None = None
    """Thermal conductivity [W/(m K)]."""
    openness: Fraction | None = None
    """Open fraction of the area, for air."""
    edges_mm: EdgeKeys | None = None
    """Open gaps between its edges and the frame, for air."""


class GlassKeys(_Solid):
    """A pane of glass: a file of spectra, glass that comes with Clerestory, or sheets by their refractive index."""

    kind: Literal["glass"]
    file: str | None = None
    """Its spectra (.dat, .json, .csv), relative to the specification."""
    glass: str | None = None
    """Glass that comes with Clerestory: clear."""
    sheets: Annotated[list[SheetKeys], Field(min_length=1)] | None = None
    """Sheets in contact, outermost first: one for a plate, several for a laminate."""
    thickness_mm: Positive | None = None
    """Thickness [mm] of glass that comes with Clerestory; for a file, instead of its own."""
    angles: Literal["fresnel", "clear-bronze", "roos"] | None = None
    """How values of a file at other angles are found; by default by its coating."""
    roos_category: Annotated[Number, Field(ge=1.0, le=10.0)] = 4.0
    """q of Roos' model."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        given = [key for key in ("file", "glass", "sheets") if getattr(self, key) is not None]
        if len(given) != 1:
            raise wrong("file", "a file, a glass or sheets are asked for (give one of them)")
        if self.glass is not None and self.thickness_mm is None:
            raise wrong("thickness_mm", f"the thickness of the glass {self.glass!r} is not given (add it)")
        if self.sheets is not None and self.thickness_mm is not None:
            raise wrong("thickness_mm", "each sheet has its own thickness (leave it out)")
        if self.file is None and (self.angles is not None or self.roos_category != 4.0):
            raise wrong("angles", "goes with a file; what has a refractive index follows Fresnel (leave it out)")
        return self


class FileKeys(_Solid):
    """A layer from a BSDF file."""

    kind: Literal["file"]
    file: str
    """BSDF file (.xml, .xml.gz, .bsdf.npz), relative to the specification."""
    rotated_deg: Number = 0.0
    """Turned in its plane, counter-clockwise as seen from the room [°]."""
    separate_peaks: bool = False
    """Whether its through-beam is taken out of its table."""
    thickness_mm: Positive | None = None
    """Thickness [mm]."""


class TracedKeys(Keys):
    """How a recipe is measured."""

    basis: str | None = None
    """Patches that it is measured on, or tensor4 or tensor3 for a tree; those of the window by default."""
    resolution: Annotated[int, Field(ge=1, le=8)] = 5
    """2^resolution cells an axis of a tree."""
    samples: Annotated[int, Field(ge=16)] | None = None
    """Paths an incident patch."""
    error: Annotated[Number, Field(gt=0.0, lt=1.0)] | None = None
    """Relative standard error to reach instead."""
    seed: Annotated[int, Field(ge=0)] = 1
    """Another seed gives an independent result."""


class RecipeKeys(_Solid, TracedKeys):
    """A layer from a recipe of the virtual goniophotometer."""

    kind: Literal["recipe"]
    recipe: str | dict[str, Any]
    """A recipe (.toml), the name of one that comes with Clerestory, or its tables."""
    changed: dict[str, Any] = Field(default_factory=dict)
    """Tables with those keys of the recipe that are other here, such as { sample = { tilt_deg = 30 } }."""
    thickness_mm: Positive | None = None
    """Thickness [mm]; the recipe's depth by default."""


class GapKeys(Keys):
    """Gas between two layers."""

    kind: Literal["gap"]
    name: str | None = None
    """Its name; its gas by default."""
    gas: str | dict[str, Fraction] | None = None
    """air, argon, krypton or xenon, or shares by volume such as { argon = 0.9, air = 0.1 }."""
    width_mm: Positive
    """Width [mm]."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        if self.gas is None or self.gas == {}:
            raise wrong("gas", f"what the gap is filled with is not given ({suggestion('', GASES)})")
        shares = {self.gas: 1.0} if isinstance(self.gas, str) else self.gas
        for gas in shares:
            if gas not in GASES:
                raise wrong("gas", f"{gas!r} is not known ({suggestion(gas, GASES)})")
        if abs(sum(shares.values()) - 1.0) > 1e-6:
            raise wrong("gas", f"the shares sum to {sum(shares.values()):g} (make them sum to 1)")
        return self

    @property
    def shares(self) -> dict[str, float]:
        """Shares by volume."""
        assert self.gas is not None
        return {self.gas: 1.0} if isinstance(self.gas, str) else dict(self.gas)


AnyLayer = Annotated[GlassKeys | FileKeys | RecipeKeys | GapKeys, Field(discriminator="kind")]


class Specification(Keys):
    """A window: what it is made of, from the exterior to the interior."""

    system: SystemKeys = Field(default_factory=SystemKeys)
    """The window as a whole."""
    product: ProductKeys = Field(default_factory=ProductKeys)
    """Who makes it, and how it is to be placed."""
    layers: Annotated[list[AnyLayer], Field(min_length=1)]
    """Solid layers and the gaps between them, from the exterior to the interior."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        """Solid layers and gaps take turns, and the first and the last are solid."""
        count = len(self.layers)
        for number, layer in enumerate(self.layers, 1):
            is_gap = isinstance(layer, GapKeys)
            if is_gap and number in (1, count):
                place = "first" if number == 1 else "last"
                raise wrong("layers", f"layer {number} is a gap, but comes {place} (gaps lie between solid layers)")
            if number > 1 and is_gap == isinstance(self.layers[number - 2], GapKeys):
                if is_gap:
                    raise wrong("layers", f"layers {number - 1} and {number} are both gaps (make them one)")
                raise wrong(
                    "layers",
                    f"between layers {number - 1} and {number} there is no gap (add one of kind gap, with its gas)",
                )
        return self
