"""Readers of structure files: one function per format, each to a :class:`Molecule`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from scuro.errors import LoadError
from scuro.load.build import build
from scuro.load.options import LoadOptions
from scuro.load.source import Source
from scuro.load.table import AtomTable
from scuro.scene.molecule import Molecule


@contextmanager
def _reading(source: Source, format: str) -> Iterator[None]:
    """Whatever goes wrong while decoding damaged bytes is the file's fault: say so."""
    try:
        yield
    except LoadError:
        raise
    except MemoryError:
        raise LoadError(
            source.name, "does not fit into memory, or its lengths are damaged"
        ) from None
    except Exception as error:
        said = " ".join(str(error).split())[:120] or type(error).__name__
        raise LoadError(source.name, f"is damaged, or is not {format} ({said})") from error


def _read(
    source: Source, options: LoadOptions, format: str, table: Callable[[], AtomTable]
) -> Molecule:
    with _reading(source, format):
        return build(source, table(), options)


def read_pdb(source: Source, options: LoadOptions) -> Molecule:
    """A PDB file."""
    from scuro.load import pdb

    return _read(source, options, "a PDB file", lambda: pdb.read_table(source))


def read_pqr(source: Source, options: LoadOptions) -> Molecule:
    """A PQR file: PDB with charges and radii."""
    from scuro.load import pdb

    return _read(source, options, "a PQR file", lambda: pdb.read_table(source, pqr=True))


def read_cif(source: Source, options: LoadOptions) -> Molecule:
    """An mmCIF file."""
    from scuro.load import cif, mmcif

    def table() -> AtomTable:
        return mmcif.read_table(source, cif.TextCif(source.data, mmcif.ATOM_COLUMNS))

    return _read(source, options, "an mmCIF file", table)


def read_bcif(source: Source, options: LoadOptions) -> Molecule:
    """A BinaryCIF file."""
    from scuro.load import bcif, mmcif

    def table() -> AtomTable:
        return mmcif.read_table(source, bcif.BinaryCif(source.data))

    return _read(source, options, "a BinaryCIF file", table)


def read_mmtf(source: Source, options: LoadOptions) -> Molecule:
    """An MMTF file (the PDB's former compressed format)."""
    from scuro.load import mmtf

    return _read(source, options, "an MMTF file", lambda: mmtf.read_table(source))


def read_sdf(source: Source, options: LoadOptions) -> Molecule:
    """An MDL mol or SD file, V2000 or V3000; records are models."""
    from scuro.load import mdl

    return _read(source, options, "an SD file", lambda: mdl.read_table(source))


def read_mol2(source: Source, options: LoadOptions) -> Molecule:
    """A Tripos MOL2 file; molecules are models."""
    from scuro.load import mol2

    return _read(source, options, "a MOL2 file", lambda: mol2.read_table(source))


def read_xyz(source: Source, options: LoadOptions) -> Molecule:
    """An XYZ file; frames are models."""
    from scuro.load import xyz

    return _read(source, options, "an XYZ file", lambda: xyz.read_table(source))


def read_gro(source: Source, options: LoadOptions) -> Molecule:
    """A GROMACS GRO file; frames are models."""
    from scuro.load import gro

    return _read(source, options, "a GRO file", lambda: gro.read_table(source))
