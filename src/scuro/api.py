"""The first line of every script: from files to a scene."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from scuro.errors import SettingsError
from scuro.load import load as read
from scuro.scene.scene import Scene


def load(
    *inputs: str | Path, format: str | None = None, assembly: str | None = None, **options: Any
) -> Scene:
    """Read files into one scene.

    Args:
        inputs: Paths, PDB IDs (downloaded once), ``sample:1tii``, or ``-`` for standard input.
        format: The format's usual ending, where a name does not say.
        assembly: The biological assembly to show, by its number in the file.
        options: What to read: see :class:`scuro.load.LoadOptions`, e.g. ``waters=False``.

    Raises:
        LoadError: A file is missing, damaged, or of no known format.
        SettingsError: An unknown option, or no inputs.
    """
    if not inputs:
        raise SettingsError("load needs at least one path or PDB ID")
    scene = Scene()
    for name in inputs:
        scene.add(read(name, format=format, **options))
    for item in scene.molecules:
        item.assembly = assembly
    return scene
