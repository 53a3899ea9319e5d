"""Small files of optics programs and instruments, made by hand for the tests.

Birth certificate: all were typed for these tests in 2026 after the public descriptions of the formats (Zemax knowledge
base, libbsdf's SSDD specification, RGL's tensor files) and after the layout of real exports; every value was chosen so
that its place can be told from it, none was measured. Zemax and LightTools: value = 100 * incidence + 10 * azimuth
index + radial index, in thousandths. No code or data of others is in them.
"""

import struct

import numpy as np


def zemax(symmetry="PlaneSymmetrical", scatter="BRDF", content="Monochrome", rotations=(0,), end="\n"):
    """Two angles of incidence, azimuths of half a circle or a whole one, radial angles up to beyond the horizon."""
    azimuths = (0, 90, 180) if symmetry == "PlaneSymmetrical" else (0, 90, 180, 270)
    radials, incidences = (0, 10, 70), (0, 30)
    lines = ["# Sample: paint", "# Light source: laser (650 nm)", "Source\tMeasured", f"Symmetry\t{symmetry}"]
    lines += [f"SpectralContent\t{content}", f"ScatterType\t{scatter}"]
    for key, angles in (
        ("SampleRotation", rotations),
        ("AngleOfIncidence", incidences),
        ("ScatterAzimuth", azimuths),
        ("ScatterRadial", radials),
    ):
        lines += [f"{key}\t{len(angles)}", "\t".join(map(str, angles))]
    lines.append("")
    blocks = ["Monochrome"] if content == "Monochrome" else ["TristimulusX", "TristimulusY", "TristimulusZ"]
    for channel, block in enumerate(blocks):
        lines += [block, "DataBegin"]
        for turn, _ in enumerate(rotations):
            for incidence in incidences:
                lines.append(f"TIS {0.1 * (channel + 1):g}")
                for a, _ in enumerate(azimuths):
                    row = [zemax_value(incidence, a, r, channel, turn) for r, _ in enumerate(radials)]
                    lines.append("\t".join(f"{value:.6f}" for value in row))
        lines.append("DataEnd")
    return end.join([*lines, ""]).encode()


def zemax_value(incidence, azimuth, radial, channel=0, turn=0):
    """The value at an azimuth's and a radial angle's index; the same for all azimuths at the specular direction."""
    return (100 * incidence + 10 * (azimuth if radial else 0) + radial) / 1000 + channel + 10 * turn


def lighttools(content="Monochrome", front_azimuth=0.0, end="\n", back=False):
    """Light from one direction on the front, reflected and transmitted; on the back too if asked for."""
    lines = ["# Sample: film", "Symmetry Asymmetric", f"SpectralContent {content}"]
    lines += ["ScatterAzimuth 4", "0 90 180 270", "ScatterRadial 3", "0 40 90", "DataBegin"]
    names = ["TrisX", "TrisY", "TrisZ"] if content == "XYZ" else [None]
    for side in ("Front", "Back") if back else ("Front",):
        for scatter in ("BRDF", "BTDF"):
            for k, name in enumerate(names):
                lines += [
                    "AOI 40",
                    f"POI {front_azimuth:g}",
                    f"Side {side}",
                    "Wavelength 550",
                    f"ScatterType {scatter}",
                ]
                lines += [f"TristimulusValue {name}"] if name else []
                lines.append(f"TIS {0.25 + 0.5 * (scatter == 'BTDF') + 0.01 * k:g}")
                base = (scatter == "BTDF") * 100 + k * 10 + (side == "Back") * 1000
                lines += [f"{base + 0.5} {base + a + 1} 0" for a in range(4)]
    return end.join([*lines, "DataEnd", ""]).encode()


# A mesh of Reflet's: polar angles -30 to 30°, azimuths -90 and 0°, two tables, ended by CR as RT-300S instruments do.
REFLET = "\r".join(
    [
        "Name / Comment :\tpaper\t",
        "Date:\t7/12/2025 11:51:11 PM\t",
        "Data file type :\tBRDF\t",
        "Phi measure beginning :\t-90\t",
        "Phi measure end :\t0\t",
        "Phi measure step :\t90\t",
        "Theta Lighting\t30\t",
        "-30\t1\t2",
        "0\t3\t3",
        "30\t4\t5",
        "\t\t",
        "Name / Comment :\tpaper\t",
        "Data file type :\tIntensity BTDF\t",
        "Phi measure beginning :\t-90\t",
        "Phi measure end :\t0\t",
        "Phi measure step :\t90\t",
        "Theta Lighting\t60\t",
        "-30\t1\t2",
        "30\t4\t5",
        "",
    ]
).encode()

# A slice: one column, in the plane of incidence.
SLICE = b"Name / Comment : card\nData file type : BRDF\nScanning : 1 axis\nTheta Lighting 20\n-20 0.1\n0 0.2\n20 0.9\n"

JDV = (
    b"DataType:\tBRDF(RT-300S)\r\nSampleID:\tleft\r\nDate:\t7/12/2025\r\nIncidence:\t30\r\nPolar:\t-30,30,30\r\n"
    b"Azimuth:\t-90,0,90\r\n\r\nRaw data\r\n\t-30\t0\t30\r\n-90\t1\t3\t4\r\n0\t2\t3\t5\r\n\r\n\r\n"
    b"DataType:\tBRDF(RT-300S)\r\nSampleID:\tright\r\nIncidence:\t0\r\n\r\nRaw data\r\n\t-30\t0\r\n-90\t7\t8\r\n"
)

SPEOS = (
    b"OPTIS - Anisotropic BSDF surface file v1.0\nSampleID:\tSample 60\n0 1 0\n1\t0\n0\n1\n3\n0 45 90\n10 0\n"
    b"Reflection Spectrum\n2\n100 50\n1000 50\n\t-90\t0\n-30\t1\t2\n0\t3\t3\n30\t4\t5\n\n\n"
    b"\t0\t180\n0\t3\t3\n30\t9\t9\n"
)

# One luminance table of one channel, with a factor for each angle of incidence: BSDF = value * kbdf / pi.
DDR = (
    b";; by hand\nSource Measured\nTypeSym PlaneSymmetrical\nTypeColorModel BW\nTypeData Luminance Absolute\n"
    b"psi 1 0\nsigma 2 0 30\nphi 2 0 180\ntheta 2 0 20\nbw kbdf 2 3\ndef\n1 2\n1 3\n4 5\n4 6\n"
)
DDT = (
    b"Source Generated\nTypeSym ASymmetrical 4D\nTypeColorModel Spectral 2\nTypeData Intensity Absolute\n"
    b"psi 2 0 90\nsigma 1 40\nsigmaT 25\nphi 1 0\ntheta 2 0 10\nwl 500\n1 2\n3 4\nwl 600\n5 6\n7 8\n"
)
SDR = (
    b"Source Measured\nTypeColorModel RGB\nsigma 3 0 30 60\nred def 0.1 0.2 0.3\ngre def 0.4 0.5 0.6\nblu 0.7 0.8 0.9\n"
)

SSDD = (
    b"""VERSION 0.2
SOFTWARE by hand
# a table about the normal
DATA_TYPE brdf
COLOR_MODEL rgb
PARAM_TYPE spherical_coordinate_system
PARAM0_LIST 0 40
PARAM1_LIST 0 90
PARAM2_LIST 0 30 90
PARAM3_LIST 0 180
NAME two words
DATA ascii
"""
    + b"".join(b"%d %d %d\n" % (k, k + 100, k + 200) for k in range(24))
    + b"""
DATA_TYPE btdf
COLOR_MODEL monochrome
PARAM_TYPE specular_coordinate_system
REDUCTION_TYPE bilateral_symmetry
PARAM0_LIST 0 40
PARAM2_LIST 0 20
PARAM3_LIST 0 180
PARAM4_LIST 0 -10
DATA ascii
1
2
3
4
1
2
5
6
DATA_TYPE specular_transmittance
COLOR_MODEL spectrum
WAVELENGTH_LIST 400 500
PARAM0_LIST 0 60
DATA ascii
0.1 0.2
0.3 0.4
"""
)

# The same table of a Lambertian reflection of 0.5 on half and difference angles, as text and as float32.
HALF_HEAD = (
    b"VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE half_difference_coordinate_system\n"
    b"REDUCTION_TYPE bilateral_symmetry reciprocity\nPARAM0_LIST 0 90\nPARAM2_LIST 0 90\nPARAM3_LIST 0 90\n"
)
HALF = HALF_HEAD + b"DATA ascii\n" + b"0.15915494\n" * 8
HALF_BINARY = HALF_HEAD + b"DATA binary\n" + struct.pack("<8f", *[0.5 / np.pi] * 8)

FRED = (
    b"type bsdf_data\nformat angles=deg bsdf=value scale=2\n"
    b"30\t0\n0\t0\t0.1\n30\t0\t0.5\n30\t90\t0.2\n150 0 0.4\n10 90\n5 0 1\n"
)
VIAVI = (
    b"!!EDS10 10-90     RPC Photonics     10/28/2014\n!!BSDF Data\n"
    b"10.000\t90.000\n0.0 0.0 0.6\n10.0 90.0 24.0\n90.0 0.0 9.0\n"
)
BRF = (
    b"BRF Values\nRSG tile, 2 inch\nsrc_z\tsrc_a\tview_z\tview_a\t450nm\t550.5nm\n"
    b"0 0 45 180 3.141592653589793 1\n45 0 0 0 1.5 1.25\n45 0 45 180 2 2\n"
)
DAT = (
    b"{ Units, Wavelength Units } SI Microns\r\n{ Thickness } 3.048\r\n{ Product Name: Clear }\r\n"
    b"0.300 0.002 0.047 0.048\r\n0.305 0.003 0.047 0.049\r\n"
)
PRODUCT_1 = (
    b'{"name": "Blind", "composition": [{"child_product": {"name": "Slat", "measured_data": {"thickness": 0.2},'
    b' "spectral_data": {"spectral_data": [{"wavelength": 0.31, "T": 0.0, "Rf": 0.5, "Rb": 0.4},'
    b' {"wavelength": 0.3, "T": 0.1, "Rf": 0.6, "Rb": null}], "dual_band_values": {"Rf_sol_diffuse": 0.55,'
    b' "Rf_vis_diffuse": 0.6, "Tf_vis_specular": 0.02}}}}]}'
)
PRODUCT_2 = (
    b'{"name": "Film", "physical_properties": {"thickness": 1.5, "optical_properties": {"optical_data":'
    b' {"angle_blocks": [{"incidence_angle": 8, "wavelength_data": ['
    b'{"w": "0.3", "specular": {"tf": "0.2", "tb": "0.21"}, "diffuse": {"tf": "0.3", "rb": "0.1"}},'
    b' {"w": "0.4", "specular": {"tf": "0.25"}, "pv": {"eqef": "0.5"}}]}]}}}}'
)
SPHERES = (
    b"# lamp: xenon\nangle,wavelength,side,scatter,collected,value,standard error\n"
    b"8,400,front,T,hemispherical,0.5,0.01\n8,500,front,T,hemispherical,0.6,0.01\n"
    b"8,400,front,T,diffuse,0.2,0.01\n8,500,front,T,diffuse,0.25,0.02\n60,400,back,reflectance,total,0.3,0.01\n"
)
WIDE = b"wavelength (um);tau_n-h [%];tau_n-dif [%];Rf;Rb\n0.4;50;20;0.1;0.2\n0.3;40;10;0.3;\n"
RT = b"# Incident side: interior\nAOI 0 0.5 0.25\nAOI: 30, 0.45, 0.3\n"


def tensor_file(fields):
    """A tensor file of arrays by name, float32 or uint8."""
    codes = {"uint8": 1, "float32": 10}
    head = b"tensor_file\0" + bytes([1, 0]) + struct.pack("<I", len(fields))
    place = len(head) + sum(13 + len(name) + 8 * values.ndim for name, values in fields.items())
    body = b""
    for name, values in fields.items():
        head += struct.pack("<H", len(name)) + name.encode()
        head += struct.pack("<HBQ", values.ndim, codes[str(values.dtype)], place + len(body))
        head += struct.pack(f"<{values.ndim}Q", *values.shape)
        body += values.tobytes()
    return head + body


def material(phi_i=(0.0,), theta_i=(0.0, 0.4, 0.8), size=4, rgb=False, jacobian=False):
    """Fields of a measured material whose density is even and whose values are all 0.5."""
    incident, channels = (len(phi_i), len(theta_i)), 3 if rgb else 2
    fields = {
        "description": np.frombuffer(b"made by hand", dtype=np.uint8),
        "jacobian": np.array([jacobian], dtype=np.uint8),
        "theta_i": np.array(theta_i, dtype=np.float32),
        "phi_i": np.array(phi_i, dtype=np.float32),
        "ndf": np.full((size, size), 2.0, dtype=np.float32),
        "sigma": np.full((size, size), 0.25, dtype=np.float32),
        "vndf": np.ones((*incident, size, size), dtype=np.float32),
        "rgb" if rgb else "spectra": np.full((*incident, channels, size, size), 0.5, dtype=np.float32),
    }
    if not rgb:
        fields["wavelengths"] = np.array([450.0, 550.0], dtype=np.float32)
    return fields


def speos(scatter="reflection", version="v8.0", kind=1, end="\n"):
    """SPEOS' anisotropic BSDF: two anisotropy angles, light from 0° and 40°; 0.5 of it at 350 nm, 0.25 at 850.

    BSDF is 1, and 3 where straight or mirrored light of 40° goes.
    """
    polars = [0.0, 20.0, 40.0, 60.0, 80.0, 90.0]
    azimuths = list(range(0, 361, 30))
    lines = [f"OPTIS - Anisotropic BSDF surface file {version}", "0", "a comment", "12", "paint, white", "1\t0\t0"]
    lines += ["1\t0" if scatter == "reflection" else "0\t1", str(kind), "2", "0\t90"]
    lines += ["2", "0\t40", "2", "0\t40", "0\t0", "", "2", "350\t50", "850\t25"]
    for _ in range(2):
        for theta in (0, 40):
            lines += [f"{len(polars)} {len(azimuths)}", "\t" + "\t".join(map(str, azimuths))]
            for polar in polars if scatter == "reflection" else polars[::-1]:
                shown = polar if scatter == "reflection" else 180.0 - polar
                cosine = 1.0 if kind == 1 else float(np.cos(np.radians(polar)))
                row = [cosine * (3.0 if polar == theta == 40 and a % 360 == 0 else 1.0) for a in azimuths]
                lines.append("\t".join([f"{shown:g}", *(f"{value:.6g}" for value in row)]))
    return end.join([*lines, "End of file", ""]).encode()


def speos_spectral(end="\n"):
    """SPEOS' spectral BRDF: light from 0° and 30°, two wavelengths, even; 0.4 and 0.8 of the light."""
    azimuths = list(range(0, 361, 45))
    lines = [
        "OPTIS - brdf surface file v9.0",
        "0",
        "Scattering surface",
        "0",
        "",
        "1\t0",
        "1",
        "2\t2",
        "0\t30",
        "450\t650",
    ]
    for _ in range(2):
        for percent in (40, 80):
            lines += [str(percent), f"4\t{len(azimuths)}", "\t" + "\t".join(map(str, azimuths))]
            lines += ["\t".join([str(polar), *["2"] * len(azimuths)]) for polar in (0, 30, 60, 90)]
    return end.join([*lines, ""]).encode()


GOLDEN = {
    "zemax": {
        "a.bsdf": zemax(),
        "b.bsdf": zemax("ASymmetrical", "BTDF", "XYZ", end="\r\n"),
        "c.bsdf": zemax("ASymmetrical4D", rotations=(0, 90), end="\r"),
    },
    "lighttools": {"l.bsdf": lighttools(), "m.bsdf": lighttools("XYZ", 45.0, "\r\n", back=True)},
    "reflet": {"mesh.txt": REFLET, "slice.txt": SLICE},
    "jdv": {"a.jdv": JDV},
    "speos": {"a.rtd": SPEOS},
    "speos_own": {
        "r.anisotropicbsdf": speos(),
        "t.anisotropicbsdf": speos("transmission", "v7.0", 0, "\r\n"),
        "s.brdf": speos_spectral(),
    },
    "integra": {"a.ddr": DDR, "b.ddt": DDT},
    "integra_specular": {"a.sdr": SDR},
    "ssdd": {"a.ssdd": SSDD, "half.ssdd": HALF, "binary.ssdd": HALF_BINARY},
    "rgl": {
        "a.bsdf": tensor_file(material()),
        "rgb.bsdf": tensor_file(material(rgb=True, jacobian=True)),
        "turned.bsdf": tensor_file(material(phi_i=(-3.0, -1.5, 0.0))),
    },
    "fred": {"a.txt": FRED},
    "viavi": {"EDS.txt": VIAVI},
    "brf": {"tile.txt": BRF},
    "product_json": {"v1.json": PRODUCT_1, "v2.json": PRODUCT_2},
    "igdb_dat": {"CLEAR.DAT": DAT},
    "sphere_csv": {"long.csv": SPHERES, "wide.csv": WIDE},
    "reflectances": {"RTfile.txt": RT},
}
"""Valid files by format and name."""
