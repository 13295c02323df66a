"""Colour tables of the field, and palettes made in OKLCh. All sRGB, 8 bits a channel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.style.elements import NUMBER_OF

# The element colours that Jmol, Mol*, NGL, Avogadro and others share, by atomic number from 1.
_JMOL = """FFFFFF D9FFFF CC80FF C2FF00 FFB5B5 909090 3050F8 FF0D0D 90E050 B3E3F5 AB5CF2 8AFF00
BFA6A6 F0C8A0 FF8000 FFFF30 1FF01F 80D1E3 8F40D4 3DFF00 E6E6E6 BFC2C7 A6A6AB 8A99C7 9C7AC7 E06633
F090A0 50D050 C88033 7D80B0 C28F8F 668F8F BD80E3 FFA100 A62929 5CB8D1 702EB0 00FF00 94FFFF 94E0E0
73C2C9 54B5B5 3B9E9E 248F8F 0A7D8C 006985 C0C0C0 FFD98F A67573 668080 9E63B5 D47A00 940094 429EB0
57178F 00C900 70D4FF FFFFC7 D9FFC7 C7FFC7 A3FFC7 8FFFC7 61FFC7 45FFC7 30FFC7 1FFFC7 00FF9C 00E675
00D452 00BF38 00AB24 4DC2FF 4DA6FF 2194D6 267DAB 266696 175487 D0D0E0 FFD123 B8B8D0 A6544D 575961
9E4FB5 AB5C00 754F45 428296 420066 007D00 70ABFA 00BAFF 00A1FF 008FFF 0080FF 006BFF 545CF2 785CE3
8A4FE3 A136D4 B31FD4 B31FBA B30DA6 BD0D87 C70066 CC0059 D1004F D90045 E00038 E6002E EB0026"""

# Corey and Pauling's (1953) and Koltun's (1965) model kits, as RasMol put them on screens.
_CPK = """H FFFFFF He FFC0CB Li B22222 B 00FF00 C C8C8C8 N 8F8FFF O F00000 F DAA520 Na 0000FF
Mg 228B22 Al 808090 Si DAA520 P FFA500 S FFC832 Cl 00FF00 Ca 808090 Ti 808090 Cr 808090 Mn 808090
Fe FFA500 Ni A52A2A Cu A52A2A Zn A52A2A Br A52A2A Ag 808090 I A020F0 Ba FFA500 Au DAA520"""
_UNLISTED = "FF1493"

# RasMol's "amino" colours; bases as in its "shapely" scheme.
_RESIDUES = """ALA C8C8C8 ARG 145AFF ASN 00DCDC ASP E60A0A CYS E6E600 GLN 00DCDC GLU E60A0A
GLY EBEBEB HIS 8282D2 ILE 0F820F LEU 0F820F LYS 145AFF MET E6E600 PHE 3232AA PRO DC9682 SER FA9600
THR FA9600 TRP B45AB4 TYR 3232AA VAL 0F820F MSE E6E600 SEC E6E600 ASX FF69B4 GLX FF69B4
A A0A0FF DA A0A0FF C FF8C4B DC FF8C4B G FF7070 DG FF7070 I 80FFFF DI 80FFFF T A0FFA0 DT A0FFA0
U FF8080 DU FF8080"""
OTHER_RESIDUE = (190, 160, 110)

# Kyte and Doolittle, J. Mol. Biol. 157 (1982) 105: -4.5 hydrophilic to 4.5 hydrophobic.
HYDROPATHY = dict(
    ILE=4.5, VAL=4.2, LEU=3.8, PHE=2.8, CYS=2.5, MET=1.9, MSE=1.9, ALA=1.8, GLY=-0.4, THR=-0.7,
    SER=-0.8, TRP=-0.9, TYR=-1.3, PRO=-1.6, HIS=-3.2, GLU=-3.5, GLN=-3.5, ASP=-3.5, ASN=-3.5,
    LYS=-3.9, ARG=-4.5,
)  # fmt: skip

SECONDARY = np.array([[222, 222, 222], [208, 62, 108], [240, 184, 52]], np.uint8)
"""(3, 3): COIL, HELIX, STRAND: Jmol's grey, magenta and gold, softened for print."""
NUCLEIC = (126, 148, 196)
"""Nucleic acids where the scheme is secondary structure."""
PLDDT = np.array([[255, 125, 69], [255, 219, 19], [101, 203, 243], [0, 83, 214]], np.uint8)
"""(4, 3) AlphaFold's bands: below 50, 50 to 70, 70 to 90, above 90."""


def _rgb(code: str) -> tuple[int, int, int]:
    return int(code[:2], 16), int(code[2:4], 16), int(code[4:], 16)


def _pairs(text: str) -> dict[str, tuple[int, int, int]]:
    words = text.split()
    return {name: _rgb(code) for name, code in zip(words[::2], words[1::2], strict=True)}


def jmol() -> NDArray[np.uint8]:
    """Jmol's element colours (256, 3) by atomic number; unknown elements pink."""
    table = np.full((256, 3), _rgb(_UNLISTED), np.uint8)
    colors = [_rgb(code) for code in _JMOL.split()]
    table[1 : len(colors) + 1] = colors
    return table


def cpk() -> NDArray[np.uint8]:
    """Corey-Pauling-Koltun element colours (256, 3) by atomic number; unlisted ones pink."""
    table = np.full((256, 3), _rgb(_UNLISTED), np.uint8)
    for symbol, color in _pairs(_CPK).items():
        table[NUMBER_OF[symbol.upper()]] = color
    return table


def residues() -> dict[str, tuple[int, int, int]]:
    """RasMol's colours by residue name."""
    return _pairs(_RESIDUES)


def distinct(count: int) -> NDArray[np.uint8]:
    """``count`` colours (count, 3) that stay apart on screen and in print, however many.

    Hues step by the golden angle, so that neighbours in the list differ most; lightness cycles
    through three levels, so that no two of a page's first dozen fall together in grey either. The
    first, which carbons of a single chain have, lies between those of nitrogen, oxygen, sulfur and
    phosphorus.
    """
    i = np.arange(count)
    return oklch(np.array([0.70, 0.60, 0.79])[i % 3], 0.125, 170.0 + 137.508 * i)


def pastel(count: int, lightness: float) -> NDArray[np.uint8]:
    """``count`` pale colours (count, 3) of equal lightness (0 to 1), after Goodsell's paintings."""
    return oklch(np.full(count, lightness), 0.075, 25.0 + 137.508 * np.arange(count))


_LMS_FROM_LAB = np.array(
    [
        [1.0, 1.0, 1.0],
        [0.3963377774, -0.1055613458, -0.0894841775],
        [0.2158037573, -0.0638541728, -1.2914855480],
    ]
)
_RGB_FROM_LMS = np.array(
    [
        [4.0767416621, -1.2684380046, -0.0041960863],
        [-3.3077115913, 2.6097574011, -0.7034186147],
        [0.2309699292, -0.3413193965, 1.7076147010],
    ]
)
"""Ottosson (2020), for rows."""


def oklch(lightness: NDArray, chroma: float | NDArray, hue_degrees: NDArray) -> NDArray[np.uint8]:
    """sRGB (n, 3) of OKLCh colours (Ottosson 2020), clipped to the gamut."""
    hue = np.radians(hue_degrees)
    lab = np.stack([lightness, chroma * np.cos(hue), chroma * np.sin(hue)], axis=-1)
    linear = ((lab @ _LMS_FROM_LAB) ** 3 @ _RGB_FROM_LMS).clip(0, 1)
    curve = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.round(255 * curve).astype(np.uint8)


def lch_of(rgb: NDArray[np.uint8]) -> NDArray[np.float64]:
    """(n, 3) lightness, chroma and hue in degrees of sRGB colours (n, 3): inverse of oklch."""
    c = np.asarray(rgb, np.float64) / 255
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    lab = np.cbrt(linear @ np.linalg.inv(_RGB_FROM_LMS)) @ np.linalg.inv(_LMS_FROM_LAB)
    hue = np.degrees(np.arctan2(lab[:, 2], lab[:, 1]))
    return np.stack([lab[:, 0], np.hypot(lab[:, 1], lab[:, 2]), hue], axis=-1)
