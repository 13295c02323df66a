"""Readers of structure files: one function per format, each to a :class:`Molecule`."""

from __future__ import annotations

from functools import partial

from scuro.load.build import build
from scuro.load.options import LoadOptions
from scuro.load.periodic import box_of, put_together
from scuro.load.source import Source
from scuro.load.structure_table import read_table
from scuro.load.trajectory import Trajectory
from scuro.scene.molecule import Molecule


def read(format: str, source: Source, options: LoadOptions) -> Molecule:
    """Read a structure file; with a trajectory, at the frame that the options name.

    Raises:
        LoadError: The file is damaged, has no atoms, or nothing is left of it.
    """
    if options.trajectory is not None or options.frame:
        return Trajectory.open(format, source, options).at(options.frame)
    table = read_table(format, source)
    molecule = build(source, table, options)
    if options.whole and options.model == "first" and table.boxes is not None:
        put_together(molecule, box_of(table.boxes[0]))
    return molecule


read_pdb = partial(read, "pdb")
read_pqr = partial(read, "pqr")
read_cif = partial(read, "cif")
read_bcif = partial(read, "bcif")
read_mmtf = partial(read, "mmtf")
read_sdf = partial(read, "sdf")
read_mol2 = partial(read, "mol2")
read_xyz = partial(read, "xyz")
read_gro = partial(read, "gro")
read_psf = partial(read, "psf")
