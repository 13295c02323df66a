"""``scuro make-mesoscale``: a plausible cell-scale scene of any size."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from scuro.app.options import SettingsCommand, take_changes, with_settings
from scuro.app.output import stage
from scuro.errors import SettingsError
from scuro.scene.generate import GenerateSettings


@with_settings(GenerateSettings, title="Scene")
@click.command(cls=SettingsCommand)
@click.argument("inputs", nargs=-1, required=True, metavar="STRUCTURE...")
@click.option("-o", "--output", required=True, metavar="FILE", help="Table: .meso, .csv or .tsv.")
def command(inputs: tuple[str, ...], output: str, **values: Any) -> None:
    """Fill nested compartments with copies of STRUCTUREs and write a table of instances.

    The structures' spheres are written beside the table; 'scuro render FILE' draws it.
    """
    from scuro.load import load
    from scuro.load.mesoscale_structures import structure_of_molecule
    from scuro.load.mesoscale_table import save_table
    from scuro.scene.generate import generate
    from scuro.scene.molecule import Molecule

    settings = GenerateSettings().replace(**take_changes(GenerateSettings, values))
    structures = []
    for name in inputs:
        with stage(f"reading {name}"):
            molecule = load(name)
        if not isinstance(molecule, Molecule):
            raise SettingsError(f"{name} is not a structure: molecules fill the compartments")
        structures.append(structure_of_molecule(molecule))
    with stage("building the scene"):
        model = generate(structures, settings)
        save_table(Path(output), model)
    click.echo("\n".join(model.outline()))
