"""Makes the small faulty files of this folder and their index.

Run `python make.py` here to make them again; `tests/xml_faults.rs` reads them.
"""

import gzip
from pathlib import Path

HERE = Path(__file__).parent
HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
NAMESPACE = ' xmlns="http://windows.lbl.gov"'
VALUES = " ".join(f"0.{k + 10}" for k in range(25))
LISTING = """<AngleBasis><AngleBasisName>small</AngleBasisName>
<AngleBasisBlock><Theta>0</Theta><nPhis>1</nPhis>
<ThetaBounds><LowerTheta>0</LowerTheta><UpperTheta>30</UpperTheta></ThetaBounds></AngleBasisBlock>
<AngleBasisBlock><Theta>60</Theta><nPhis>4</nPhis>
<ThetaBounds><LowerTheta>30</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>
"""
TREE_LEAVES = " ".join(f"{{0.{k + 10}}}" for k in range(16))
KINDS = ("error", "warning", "clean")


def block(
    values: str = VALUES, *, direction: str = "Transmission Front", kind: str = "BTDF", basis: str = "small"
) -> str:
    """A WavelengthDataBlock."""
    return f"""<WavelengthDataBlock><WavelengthDataDirection>{direction}</WavelengthDataDirection>
<ColumnAngleBasis>{basis}</ColumnAngleBasis><RowAngleBasis>{basis}</RowAngleBasis>
<ScatteringDataType>{kind}</ScatteringDataType>
<ScatteringData>
{values}
</ScatteringData></WavelengthDataBlock>
"""


def tree_block(text: str, *, basis: str = "LBNL/Shirley-Chiu") -> str:
    """A WavelengthDataBlock with a tensor tree."""
    return f"""<WavelengthDataBlock><WavelengthDataDirection>Reflection Back</WavelengthDataDirection>
<AngleBasis>{basis}</AngleBasis><ScatteringDataType>BRDF</ScatteringDataType>
<ScatteringData>
{text}
</ScatteringData></WavelengthDataBlock>
"""


def data(
    *blocks: str, wavelength: str = '<Wavelength unit="Integral">Visible</Wavelength>', layer: str = "System"
) -> str:
    """A WavelengthData element."""
    return f"<WavelengthData><LayerNumber>{layer}</LayerNumber>{wavelength}\n{''.join(blocks)}</WavelengthData>\n"


def definition(structure: str = "Columns", listing: str = LISTING) -> str:
    """A DataDefinition element."""
    return f"<DataDefinition><IncidentDataStructure>{structure}</IncidentDataStructure>{listing}</DataDefinition>\n"


def layer(body: str, *, material: str = "<Name>test</Name>", defined: str | None = None) -> str:
    """A Layer element."""
    return f"<Layer><Material>{material}</Material>\n{definition() if defined is None else defined}{body}</Layer>\n"


def window(body: str, *, head: str = HEAD, namespace: str = NAMESPACE) -> str:
    """A whole file about a Layer."""
    return f"""{head}<WindowElement{namespace}><WindowElementType>System</WindowElementType>
<FileType>BSDF</FileType><Optical>
{body}</Optical></WindowElement>
"""


def with_block(*blocks: str, **options: str) -> str:
    """A whole file about blocks of one band."""
    return window(layer(data(*blocks, **options)))


def with_values(values: str) -> str:
    """A whole file about the values of one block."""
    return with_block(block(values))


def with_rings(old: str, new: str) -> str:
    """A whole file with a changed listing."""
    return window(layer(data(block()), defined=definition(listing=LISTING.replace(old, new))))


def with_tree(text: str, *, structure: str = "TensorTree4", **options: str) -> str:
    """A whole file about a tensor tree."""
    return window(layer(data(tree_block(text, **options)), defined=definition(structure, "")))


def with_material(material: str) -> str:
    """A whole file with a changed Material."""
    return window(layer(data(block()), material=material))


GOOD = with_values(VALUES)
REFLECTION = block(direction="Reflection Back", kind="BRDF")
OTHER = VALUES.replace("0.1", "0.2")

FILES = {
    # Nothing, or something else.
    "empty.xml": ("error", "the file is empty", ""),
    "blank.xml": ("error", "the file is empty", " \n\t\n"),
    "other-text.xml": ("error", "not a BSDF XML file", "1 2 3\n"),
    "html.xml": ("error", "not a BSDF XML file", "<html><body>404 <b>not found</b></body></html>"),
    "binary.xml": ("error", "not a BSDF XML file", bytes(range(1, 256))),
    "zeros.xml": ("error", "not a BSDF XML file", bytes(4096)),
    "no-optical.xml": ("error", "no <Optical>", GOOD.replace("Optical>", "Thermal>")),
    "no-layer.xml": ("error", "no <Layer>", window("")),
    "no-wavelength-data.xml": ("error", "no <WavelengthData>", window(layer(""))),
    "no-block.xml": ("error", "no block of it", with_block()),
    "no-scattering-data.xml": ("error", "no <ScatteringData>", GOOD.replace("ScatteringData>", "Data>")),
    # Cut off or out of order.
    "cut-in-data.xml": ("error", "line 16, <ScatteringData>: the file ends before", GOOD[: GOOD.index("0.20")]),
    "cut-in-tag.xml": ("error", "the tag has no end", GOOD[: GOOD.index(' xmlns="') + 12]),
    "cut-before-end.xml": ("error", "ends before </WindowElement>", GOOD.replace("</WindowElement>", "")),
    "cut-in-comment.xml": ("error", "ends inside of a comment", GOOD.replace("</Layer>", "<!-- </Layer>")),
    "tags-crossed.xml": (
        "error",
        "</Name> is due but </Material>",
        GOOD.replace("</Name></Material>", "</Material></Name>"),
    ),
    "tag-unclosed.xml": ("error", "</RowAngleBasis> is due", GOOD.replace("</RowAngleBasis>", "")),
    "attribute-unquoted.xml": ("error", "has no quoted value", GOOD.replace('unit="Integral"', "unit=Integral")),
    "attribute-nameless.xml": ("error", "has no name", GOOD.replace('unit="Integral"', '="Integral"')),
    "attribute-unclosed.xml": ("error", "the tag has no end", GOOD.replace('unit="Integral"', 'unit="Integral')),
    "less-than-in-text.xml": ("error", "'<' does not begin a tag", GOOD.replace("test", "a < b")),
    "nested-deep.xml": ("error", "nested more than", GOOD.replace("<Name>", "<Name>" * 60)),
    # Values.
    "values-missing.xml": ("error", "24 values where 5 × 5 = 25", with_values(VALUES.rsplit(" ", 1)[0])),
    "values-too-many.xml": ("error", "26 values where 5 × 5 = 25", with_values(VALUES + " 1")),
    "values-none.xml": ("error", "0 values where", with_values("")),
    "value-nan.xml": ("error", 'line 16, <ScatteringData>: "nan"', with_values(VALUES.replace("0.15", "nan"))),
    "value-inf.xml": ("error", '"-inf" is not a finite', with_values(VALUES.replace("0.15", "-inf"))),
    "value-overflow.xml": ("error", '"1e999" is not a finite', with_values(VALUES.replace("0.15", "1e999"))),
    "value-word.xml": ("error", '"abc" is not a finite', with_values(VALUES.replace("0.15", "abc"))),
    "value-hexadecimal.xml": ("error", '"0x1f" is not a finite', with_values(VALUES.replace("0.15", "0x1f"))),
    "value-joined.xml": ("error", '"0.150.16" is not a finite', with_values(VALUES.replace("0.15 ", "0.15"))),
    "value-null-byte.xml": ("error", "is not a finite", with_values(VALUES.replace("0.15", "0\0"))),
    "values-in-elements.xml": ("error", "0 values where", with_values(f"<v>{VALUES}</v>")),
    "decimal-commas.xml": ("error", "decimal commas", with_values(VALUES.replace(".", ","))),
    "decimal-commas-semicolons.xml": (
        "error",
        "decimal commas",
        with_values(VALUES.replace(".", ",").replace(" ", "; ")),
    ),
    "commas-doubled.xml": ("error", "is not a finite", with_values(VALUES.replace(" ", ",,"))),
    # Angle bases.
    "basis-unknown.xml": ("error", '"other" is neither listed nor known', with_block(block(basis="other"))),
    "basis-unnamed.xml": (
        "error",
        "the angle basis has no name",
        window(layer(data(block(basis="")), defined=definition(listing=""))),
    ),
    "basis-too-small.xml": (
        "error",
        "25 values where 41 × 41",
        window(layer(data(block(basis="LBNL/Klems Quarter")), defined=definition(listing=""))),
    ),
    "basis-listed-twice.xml": (
        "error",
        "listed twice",
        window(layer(data(block()), defined=definition(listing=LISTING * 2))),
    ),
    "ring-without-nphis.xml": ("error", "ring 2 has no <nPhis>", with_rings("<nPhis>4</nPhis>", "")),
    "ring-nphis-negative.xml": ("error", "nPhis is -4", with_rings("<nPhis>4<", "<nPhis>-4<")),
    "ring-nphis-zero.xml": ("error", "nPhis is 0", with_rings("<nPhis>4<", "<nPhis>0<")),
    "ring-nphis-fraction.xml": ("error", "nPhis is 4.5", with_rings("<nPhis>4<", "<nPhis>4.5<")),
    "ring-nphis-huge.xml": ("error", "nPhis is 1000000000000", with_rings("<nPhis>4<", "<nPhis>1e12<")),
    "ring-nphis-large.xml": ("error", "25 values where 1000001 × 1000001", with_rings("<nPhis>4<", "<nPhis>1e6<")),
    "ring-nphis-word.xml": ("error", '"four" is not a number', with_rings("<nPhis>4<", "<nPhis>four<")),
    "ring-without-bounds.xml": ("error", "has no <ThetaBounds>", with_rings("ThetaBounds", "Bounds")),
    "ring-gap.xml": ("error", "ring 2 begins at 40", with_rings("<LowerTheta>30<", "<LowerTheta>40<")),
    "ring-reversed.xml": ("error", "rings reach from", with_rings("<LowerTheta>0<", "<LowerTheta>90<")),
    "ring-short.xml": ("error", "reach from 0° to 80°", with_rings("<UpperTheta>90<", "<UpperTheta>80<")),
    "ring-nan.xml": ("error", '"nan" is not a number', with_rings("<UpperTheta>30<", "<UpperTheta>nan<")),
    # What is ambiguous.
    "structure-unknown.xml": ("error", '"Diagonals" is not known', GOOD.replace("Columns", "Diagonals")),
    "definition-twice.xml": (
        "error",
        "second <DataDefinition>",
        GOOD.replace("<WavelengthData>", definition() + "<WavelengthData>"),
    ),
    "direction-unknown.xml": ("error", 'direction "sideways" is not known', with_block(block(direction="sideways"))),
    "direction-without-side.xml": ("error", "from which side", with_block(block(direction="Transmission"))),
    "direction-with-both.xml": ("error", "is not known", with_block(block(direction="Transmission Reflection Front"))),
    "direction-missing.xml": (
        "error",
        'direction "" is not known',
        GOOD.replace("WavelengthDataDirection>", "Direction>"),
    ),
    "band-missing.xml": ("error", "no <Wavelength>", with_block(block(), wavelength="")),
    "band-empty.xml": ("error", "no <Wavelength>", with_block(block(), wavelength="<Wavelength/>")),
    "wavelength-unit.xml": (
        "error",
        'wavelength "550" in "furlong"',
        with_block(block(), wavelength='<Wavelength unit="furlong">550</Wavelength>'),
    ),
    "layers-differ.xml": (
        "error",
        'layers "1" and "2", none of the system',
        window(layer(data(block(), layer="1") + data(block(), layer="2"))),
    ),
    "thickness-negative.xml": ("error", "-1 cannot be a size", with_material('<Thickness unit="Meter">-1</Thickness>')),
    "thickness-infinite.xml": ("error", "inf cannot be a size", with_material("<Thickness>inf</Thickness>")),
    # Attacks and wrong encodings.
    "entity-bomb.xml": (
        "error",
        "document type",
        GOOD.replace(HEAD, HEAD + '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;">]>\n').replace(
            "test", "&b;"
        ),
    ),
    "entity-external.xml": (
        "error",
        "document type",
        GOOD.replace(HEAD, HEAD + '<!DOCTYPE a [<!ENTITY a SYSTEM "file:///etc/passwd">]>\n').replace("test", "&a;"),
    ),
    "doctype-external.xml": (
        "error",
        "document type",
        GOOD.replace(HEAD, HEAD + '<!DOCTYPE WindowElement SYSTEM "http://example.org/a.dtd">\n'),
    ),
    "utf-16.xml": ("error", "UTF-16", GOOD.encode("utf-16")),
    "utf-16-without-mark.xml": ("error", "UTF-16", GOOD.encode("utf-16-be")),
    "utf-32.xml": ("error", "UTF-16 or UTF-32", GOOD.encode("utf-32")),
    "gzip-cut.xml.gz": ("error", "gzip data end too early", gzip.compress(GOOD.encode(), mtime=0)[:-30]),
    "gzip-damaged.xml.gz": ("error", "gzip", gzip.compress(GOOD.encode(), mtime=0)[:60] + b"\xff" * 40),
    "gzip-of-nothing.xml.gz": ("error", "no <WindowElement>", gzip.compress(b"", mtime=0)),
    "gzip-bomb-of-zeros.xml.gz": ("error", "no <WindowElement>", gzip.compress(bytes(4 << 20), mtime=0)),
    # Tensor trees.
    "tree-brace-missing.xml": ("error", "before all of its braces are closed", with_tree("{" + TREE_LEAVES)),
    "tree-brace-too-many.xml": (
        "error",
        "after the tensor tree's last closing brace",
        with_tree("{" + TREE_LEAVES + "}}"),
    ),
    "tree-children-missing.xml": ("error", "instead of 16 children", with_tree("{{1} {2}}")),
    "tree-of-other-rank.xml": (
        "error",
        "more than 8 children",
        with_tree("{" + TREE_LEAVES + "}", structure="TensorTree3"),
    ),
    "tree-grid-count.xml": ("error", "line 10, <ScatteringData>", with_tree("{1 2 3}")),
    "tree-nan.xml": ("error", '"nan" is not a finite', with_tree("{nan}")),
    "tree-empty.xml": ("error", "line 9, <ScatteringData>", with_tree("")),
    "tree-deep.xml": ("error", "line 10, <ScatteringData>", with_tree("{" * 400)),
    "tree-of-numbers.xml": ("error", "begins with an opening brace", with_tree(VALUES)),
    "tree-in-columns.xml": ("error", "a tensor tree stands where a matrix", with_values("{" + TREE_LEAVES + "}")),
    "tree-basis.xml": ("error", '"LBNL/Klems Full" for a tensor tree', with_tree("{1}", basis="LBNL/Klems Full")),
    "tree-without-structure.xml": (
        "error",
        "write TensorTree3 (isotropic) or TensorTree4",
        window(layer(data(tree_block("{1}")), defined="")),
    ),
    # Faults that a person would still understand.
    "log-before.xml": ("warning", "line 1: text stands before the XML", "rtrace: warning - no light\n" + GOOD),
    "log-with-tags-before.xml": ("warning", "text stands before the XML", "<command> -n 4 > out\n" + GOOD),
    "text-behind.xml": ("warning", "behind </WindowElement>", GOOD + "done in 3 s\n"),
    "solar-in-lower-case.xml": ("warning", '"solar" instead of "Solar"', GOOD.replace("Visible", "solar")),
    "band-unusual.xml": ("warning", "not one of the usual ones", GOOD.replace("Visible", "Photopic")),
    "reflection-labelled-btdf.xml": (
        "warning",
        "1 block with the label of the wrong direction",
        with_block(block(OTHER, direction="Reflection Front")),
    ),
    "direction-in-other-words.xml": (
        "warning",
        "taken as Transmission Back",
        with_block(block(direction="Back transmittance")),
    ),
    "block-twice.xml": ("warning", "is there twice; the later one is used", with_block(block(), block(OTHER))),
    "negative-values.xml": (
        "warning",
        "2 negative values, the least -1e-1",
        with_values(VALUES.replace("0.10", "-0.1").replace("0.11", "-0.01")),
    ),
    "tree-negative.xml": ("warning", "1 negative value, -5e-1; it counts as 0", with_tree("{-0.5}")),
    "reflection-is-transmission.xml": (
        "warning",
        "value for value, as Transmission Front",
        with_block(block(), REFLECTION),
    ),
    "listing-not-standard.xml": (
        "warning",
        "not the standard basis of that name; the listing is used",
        GOOD.replace(">small<", ">LBNL/Klems Quarter<"),
    ),
    "structure-missing.xml": (
        "warning",
        "Columns, the usual one, is assumed",
        GOOD.replace("IncidentDataStructure>", "Structure>"),
    ),
    "listing-missing.xml": (
        "warning",
        'the listing of angle basis "LBNL/Klems Quarter" (<AngleBasis>) is missing',
        window(
            layer(data(block(" ".join(["0.1"] * 41**2), basis="LBNL/Klems Quarter")), defined=definition(listing=""))
        ),
    ),
    "tree-without-basis.xml": ("warning", "LBNL/Shirley-Chiu is assumed", with_tree("{1}", basis="")),
    "latin-1.xml": (
        "warning",
        "not UTF-8; they were read as Latin-1",
        GOOD.replace("test", "Möller").encode("latin-1"),
    ),
    "says-utf-16.xml": ("warning", "says that it is UTF-16", GOOD.replace("UTF-8", "UTF-16")),
    "ampersand.xml": ("warning", "no reference that XML knows", GOOD.replace("test", "A & B")),
    "entity-unknown.xml": ("warning", "no reference that XML knows", GOOD.replace("test", "&eacute;")),
    "control-character.xml": ("warning", "control characters", GOOD.replace("test", "te\x07st")),
    "second-layer.xml": ("warning", "a second <Layer>", window(layer(data(block())) * 2)),
    "absorbed.xml": (
        "warning",
        '"Absorbed Front" is not read',
        with_block(block(), block("0.1 0.2", direction="Absorbed Front")),
    ),
    "fractional.xml": (
        "warning",
        '"fractional diffuse" is not read',
        with_block(block(), block("0.1", kind="Fractional Diffuse")),
    ),
    "layer-beside-system.xml": (
        "warning",
        'data of layer "1" beside those of the system',
        window(layer(data(block()) + data(block(OTHER), layer="1"))),
    ),
    "emissivity-word.xml": (
        "warning",
        '"unknown" is not a number',
        with_material("<EmissivityFront>unknown</EmissivityFront>"),
    ),
    "thickness-unit.xml": (
        "warning",
        'unit "league" is not known',
        with_material('<Thickness unit="league">1</Thickness>'),
    ),
    "wavelength-data-empty.xml": ("warning", "no <WavelengthDataBlock>", window(layer(data(block()) + data()))),
    # Oddities that are no faults.
    "byte-order-mark.xml": ("clean", "", b"\xef\xbb\xbf" + GOOD.encode()),
    "windows-line-ends.xml": ("clean", "", GOOD.replace("\n", "\r\n")),
    "no-declaration.xml": ("clean", "", GOOD.removeprefix(HEAD)),
    "no-namespace.xml": ("clean", "", GOOD.replace(NAMESPACE, "")),
    "namespace-prefix.xml": (
        "clean",
        "",
        GOOD.replace("</", "</b:")
        .replace("<", "<b:")
        .replace("<b:/b:", "</b:")
        .replace("<b:?", "<?")
        .replace(" xmlns=", " xmlns:b="),
    ),
    "latin-1-declared.xml": (
        "clean",
        "",
        GOOD.replace("UTF-8", "ISO-8859-1").replace("test", "Möller").encode("latin-1"),
    ),
    "comments-and-cdata.xml": (
        "clean",
        "",
        GOOD.replace("0.20 ", "0.20 <!-- 1 2 --> ").replace("test", "<![CDATA[a < b & c]]>"),
    ),
    "text-in-lines.xml": ("clean", "", GOOD.replace(">Visible<", ">\n\tVisible\n<").replace(">small<", ">\n small <")),
    "separators-mixed.xml": (
        "clean",
        "",
        with_values(VALUES.replace(" ", ",\t", 5).replace(" ", "\n", 5).replace(" ", " ,", 5)),
    ),
    "rows.xml": ("clean", "", GOOD.replace("Columns", "Rows")),
    "wavelength.xml": ("clean", "", with_block(block(), wavelength='<Wavelength unit="Nanometers">550</Wavelength>')),
    "basis-from-definition.xml": (
        "clean",
        "",
        GOOD.replace("<ColumnAngleBasis>small</ColumnAngleBasis><RowAngleBasis>small</RowAngleBasis>", ""),
    ),
    "good.xml.gz": ("clean", "", gzip.compress(GOOD.encode(), mtime=0)),
}


def main() -> None:
    """Write all files and the index."""
    lines = ["# Made by make.py: file, what reading it gives, and part of the message."]
    for name, (kind, message, content) in FILES.items():
        assert kind in KINDS, name
        (HERE / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        lines.append(f"{name}\t{kind}\t{message}")
    (HERE / "index.txt").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
