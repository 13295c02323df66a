"""From a file to plain arrays: :func:`load` and the table of readers. Never imports the GPU.

A reader is a function ``read(source: Source, options: LoadOptions)`` that returns one of the
dataclasses of :mod:`scuro.scene` or raises :class:`~scuro.errors.LoadError`. Readers are imported
when a file of theirs is first read.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

from scuro.errors import LoadError, SettingsError
from scuro.load.options import LoadOptions
from scuro.load.source import Source, open_source
from scuro.settings import unknown

__all__ = ["READERS", "LoadOptions", "Source", "load", "open_source"]

_STRUCTURE = "scuro.load.structure"
_ECLIPSE = "scuro.load.reservoir_eclipse"
_GRDECL = "scuro.load.reservoir_grdecl"
_ROFF = "scuro.load.reservoir_roff"
_VOLUME = "scuro.load.volume_files"

READERS: dict[str, tuple[str, str]] = {
    ".pdb": (_STRUCTURE, "read_pdb"),
    ".ent": (_STRUCTURE, "read_pdb"),
    ".pqr": (_STRUCTURE, "read_pqr"),
    ".cif": (_STRUCTURE, "read_cif"),
    ".mmcif": (_STRUCTURE, "read_cif"),
    ".bcif": ("scuro.load.mesoscale_bcif", "read_bcif"),
    ".mmtf": (_STRUCTURE, "read_mmtf"),
    ".sdf": (_STRUCTURE, "read_sdf"),
    ".sd": (_STRUCTURE, "read_sdf"),
    ".mol": (_STRUCTURE, "read_sdf"),
    ".mol2": (_STRUCTURE, "read_mol2"),
    ".xyz": (_STRUCTURE, "read_xyz"),
    ".gro": (_STRUCTURE, "read_gro"),
    ".psf": (_STRUCTURE, "read_psf"),
    ".egrid": (_ECLIPSE, "read_eclipse"),
    ".fegrid": (_ECLIPSE, "read_eclipse"),
    ".grid": (_ECLIPSE, "read_eclipse"),
    ".init": (_ECLIPSE, "read_eclipse"),
    ".unrst": (_ECLIPSE, "read_eclipse"),
    ".grdecl": (_GRDECL, "read_grdecl"),
    ".data": (_GRDECL, "read_grdecl"),
    ".roff": (_ROFF, "read_roff"),
    ".json": ("scuro.load.mesoscale", "read_json"),
    ".csv": ("scuro.load.mesoscale_table", "read_table"),
    ".tsv": ("scuro.load.mesoscale_table", "read_table"),
    ".meso": ("scuro.load.mesoscale_table", "read_table"),
    ".nii": (_VOLUME, "read_itk"),
    ".nrrd": (_VOLUME, "read_itk"),
    ".nhdr": (_VOLUME, "read_itk"),
    ".mha": (_VOLUME, "read_itk"),
    ".mhd": (_VOLUME, "read_itk"),
    ".dcm": (_VOLUME, "read_itk"),
    ".vti": (_VOLUME, "read_vtk"),
    ".vtk": (_VOLUME, "read_vtk"),
    ".slc": (_VOLUME, "read_vtk"),
    ".mrc": (_VOLUME, "read_mrc"),
    ".map": (_VOLUME, "read_mrc"),
    ".ccp4": (_VOLUME, "read_mrc"),
    ".cube": (_VOLUME, "read_cube"),
    ".cub": (_VOLUME, "read_cube"),
    ".dx": (_VOLUME, "read_dx"),
    ".tif": (_VOLUME, "read_tiff"),
    ".tiff": (_VOLUME, "read_tiff"),
    ".npy": (_VOLUME, "read_numpy"),
    ".npz": (_VOLUME, "read_numpy"),
    ".raw": (_VOLUME, "read_raw"),
}
"""Suffix (lower case, without ``.gz``) to the module and function that reads it."""

_LOOKS_LIKE = {".pqr": ".pdb"}
"""Formats whose content is taken for another's: here the suffix decides."""


def load(
    name: str | Path,
    *,
    format: str | None = None,
    options: LoadOptions | None = None,
    **changes: Any,
) -> Any:
    """Read a file.

    Args:
        name: A path, ``-`` for standard input, a PDB ID (downloaded once), or ``sample:1tii``.
        format: The format's usual ending (``"pdb"``, ``"cif"``, …), where the name does not say.
        options: What to read of the file.
        changes: Single options by name, e.g. ``model=2``, ``waters=False``.

    Raises:
        LoadError: The file is missing, damaged, or of no known format.
        SettingsError: An unknown format or option.
    """
    if "model" in changes:
        changes["model"] = str(changes["model"])
    chosen = (options or LoadOptions()).replace(**changes)
    source = open_source(name)
    module, function = find_reader(source, format)
    return getattr(import_module(module), function)(source, chosen)


def find_reader(source: Source, format: str | None = None) -> tuple[str, str]:
    """Module and function that read a source: by the format said, the suffix, or the content."""
    if format is not None:
        suffix = f".{format.lower().lstrip('.')}"
        if suffix not in READERS:
            raise SettingsError(unknown("format", format, [s[1:] for s in READERS]))
        return READERS[suffix]
    if source.path is not None and source.path.is_dir():
        return _VOLUME, "read_folder"
    from scuro.load.sniff import sniff

    named = READERS.get(source.suffix)
    if named is not None and named[0] != _STRUCTURE:
        return named
    # structures are often misnamed (an mmCIF file called .pdb): the content decides
    found = sniff(source.data)
    if named is not None and found in (None, _LOOKS_LIKE.get(source.suffix)):
        return named
    if found is None:
        known = ", ".join(sorted(READERS))
        raise LoadError(
            source.name,
            f"neither its ending nor its content is of a known format; known endings: {known}; "
            "or say --format",
        )
    return READERS[found]
