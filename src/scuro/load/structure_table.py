"""Which function reads which structure format to a table of atoms."""

from __future__ import annotations

from importlib import import_module

from scuro.errors import LoadError
from scuro.load.source import Source
from scuro.load.table import AtomTable

_FORMATS = {
    "pdb": ("a PDB file", "scuro.load.pdb", "read_table"),
    "pqr": ("a PQR file", "scuro.load.pdb", "read_pqr"),
    "cif": ("an mmCIF file", "scuro.load.mmcif", "read_text"),
    "bcif": ("a BinaryCIF file", "scuro.load.mmcif", "read_binary"),
    "mmtf": ("an MMTF file", "scuro.load.mmtf", "read_table"),
    "sdf": ("an SD file", "scuro.load.mdl", "read_table"),
    "mol2": ("a MOL2 file", "scuro.load.mol2", "read_table"),
    "xyz": ("an XYZ file", "scuro.load.xyz", "read_table"),
    "gro": ("a GRO file", "scuro.load.gro", "read_table"),
    "psf": ("a PSF file", "scuro.load.psf", "read_table"),
}
"""Format to its name in sentences, and the module and function that fill an AtomTable."""


def read_table(format: str, source: Source) -> AtomTable:
    """All atoms of a file. Whatever goes wrong while decoding is the file's fault: say so."""
    label, module, function = _FORMATS[format]
    data = source.data  # its own errors come first
    try:
        return getattr(import_module(module), function)(source)
    except LoadError:
        raise
    except MemoryError:
        raise LoadError(
            source.name, f"{len(data)} bytes do not fit into memory, or its lengths are damaged"
        ) from None
    except Exception as error:
        said = " ".join(str(error).split())[:120] or type(error).__name__
        raise LoadError(source.name, f"is damaged, or is not {label} ({said})") from error
