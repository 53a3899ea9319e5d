"""Makes the BSDF files of this folder from formulas, without Clerestory.

Run `python make.py` here to make them again. The formulas are in README.md.
"""

from pathlib import Path

HERE = Path(__file__).parent
QUARTER = [(0, 0, 9, 1), (18, 9, 27, 8), (36, 27, 45, 12), (54, 45, 63, 12), (76.5, 63, 90, 8)]
USER = [(0, 0, 12.5, 1), (30, 12.5, 47.5, 6), (68.75, 47.5, 90, 10)]


def listing(name: str, rings: list[tuple[float, float, float, int]]) -> str:
    """An AngleBasis element."""
    blocks = "".join(
        f"<AngleBasisBlock><Theta>{theta}</Theta><ThetaBounds><LowerTheta>{low}</LowerTheta>"
        f"<UpperTheta>{high}</UpperTheta></ThetaBounds><nPhis>{count}</nPhis></AngleBasisBlock>\n"
        for theta, low, high, count in rings
    )
    return f"<AngleBasis><AngleBasisName>{name}</AngleBasisName>\n{blocks}</AngleBasis>\n"


def block(direction: str, values: list[float], *, column: str = "", row: str = "", band: str = "Visible") -> str:
    """A WavelengthData element with a matrix, or with a tree if no basis is named."""
    if column:
        basis = f"<ColumnAngleBasis>{column}</ColumnAngleBasis><RowAngleBasis>{row}</RowAngleBasis>"
        text = ", ".join(f"{v:.6g}" for v in values)
    else:
        basis = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>"
        text = "{" + " ".join(f"{v:.6g}" for v in values) + "}"
    return f"""<WavelengthData><LayerNumber>System</LayerNumber><Wavelength unit="Integral">{band}</Wavelength>
<WavelengthDataBlock><WavelengthDataDirection>{direction}</WavelengthDataDirection>{basis}
<ScatteringDataType>{"BTDF" if direction.startswith("T") else "BRDF"}</ScatteringDataType>
<ScatteringData>{text}</ScatteringData></WavelengthDataBlock></WavelengthData>
"""


def write(name: str, structure: str, bases: str, blocks: str, material: str = "<Name>golden</Name>") -> None:
    """Write a whole file."""
    text = f"""<?xml version="1.0" encoding="UTF-8"?>
<WindowElement xmlns="http://windows.lbl.gov"><WindowElementType>System</WindowElementType><FileType>BSDF</FileType>
<Optical><Layer><Material>{material}</Material><DataDefinition>
<IncidentDataStructure>{structure}</IncidentDataStructure>{bases}</DataDefinition>
{blocks}</Layer></Optical></WindowElement>
"""
    (HERE / name).write_text(text)


def main() -> None:
    """Write all files."""
    quarter, user = "LBNL/Klems Quarter", "golden user basis"
    square = [1e-5 * k for k in range(41 * 41)]
    write(
        "quarter.xml",
        "Columns",
        listing(quarter, QUARTER),
        block("Transmission Front", square, column=quarter, row=quarter)
        + block("Reflection Back", [2 * v for v in square], column=quarter, row=quarter)
        + block("Transmission Front", [3 * v for v in square], column=quarter, row=quarter, band="Solar"),
        "<Name>golden</Name><Thickness unit='Millimeter'>2</Thickness><EmissivityFront>0.8</EmissivityFront>"
        "<EmissivityBack>0.7</EmissivityBack><TIR>0.05</TIR>",
    )
    small = [1e-4 * k for k in range(17 * 17)]
    write("user_rows.xml", "Rows", listing(user, USER), block("Transmission Back", small, column=user, row=user))
    rectangular = [1e-5 * k for k in range(41 * 17)]
    write(
        "rectangular.xml",
        "Columns",
        listing(user, USER) + listing(quarter, QUARTER),
        block("Reflection Front", rectangular, column=quarter, row=user),
    )
    write("tree3.xml", "TensorTree3", "", block("Transmission Front", [0.002 * (k + 1) for k in range(64)]))
    write("tree4.xml", "TensorTree4", "", block("Reflection Back", [0.001 * (k + 1) for k in range(256)]))


if __name__ == "__main__":
    main()
