"""Which format is it? By content, for standard input and for files with an odd ending."""

from __future__ import annotations

import re

_PDB_RECORD = re.compile(
    rb"^(HEADER|TITLE |COMPND|REMARK|CRYST1|MODEL |ATOM  |HETATM|OBSLTE|SPLIT |AUTHOR|EXPDTA)", re.M
)
_COUNTS = re.compile(rb"^[ 0-9]{6}.*V[23]000\s*$", re.M)
_GRO_ATOM = re.compile(rb"^[ 0-9]{5}.{10}[ 0-9]{5} *-?\d+\.\d+ *-?\d+\.\d+ *-?\d+\.\d+")
_XYZ_ATOM = re.compile(rb"^\s*[A-Za-z0-9]+(\s+[-+]?\d*\.?\d+(?:[eE][-+]?\d+)?){3}")


def sniff(data: bytes) -> str | None:
    """The usual ending of the structure format that ``data`` is in, or None.

    Args:
        data: The file's content, unzipped.
    """
    head = data[:20000].lstrip(b"\xef\xbb\xbf")
    if head[:1] in b"\x80\x81\x82\x83\x84\x85\x86\x87\x88\x89\x8a\x8b\x8c\x8d\x8e\x8f\xde\xdf":
        if b"mmtfVersion" in data[:4096] or b"xCoordList" in data:
            return ".mmtf"
        if b"dataBlocks" in data:
            return ".bcif"
        return None
    if b"\0" in head:
        return None
    text = head.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    lines = text.split(b"\n")
    first = next((line for line in lines if line.strip() and line[:1] != b"#"), b"")
    if first.lower().startswith(b"data_") or b"\n_atom_site." in text:
        return ".cif"
    if b"@<TRIPOS>MOLECULE" in text:
        return ".mol2"
    if first.startswith(b"PSF"):
        return ".psf"
    if len(lines) > 3 and _COUNTS.match(lines[3]):
        return ".sdf"
    if _PDB_RECORD.search(text):
        return ".pdb"
    if len(lines) > 2 and lines[1].strip().isdigit() and _GRO_ATOM.match(lines[2]):
        return ".gro"
    if len(lines) > 2 and lines[0].strip().isdigit() and _XYZ_ATOM.match(lines[2]):
        return ".xyz"
    return None
