"""Looks: how a picture is drawn, by name. Each is a scene file without inputs.

Those of the package are in ``scuro/style/looks``; a file of the same form in the user's own folder
(:func:`user_folder`) is a look, too, and takes the place of one of the same name.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from scuro.errors import SettingsError
from scuro.export.scene_file import SceneFile, read_scene_file
from scuro.settings import unknown

_FOLDER = Path(__file__).resolve().parents[1] / "style" / "looks"


def user_folder() -> Path:
    """Where users put looks of their own."""
    from platformdirs import user_config_path

    return user_config_path("scuro") / "looks"


def looks() -> dict[str, Path]:
    """Every look's file by name."""
    files = [*_FOLDER.glob("*.toml"), *user_folder().glob("*.toml")]
    return {file.stem: file for file in sorted(files, key=lambda f: (f.parent != _FOLDER, f.stem))}


def about(name: str) -> str:
    """What a look is: the comment in its first line."""
    first = looks()[name].read_text(encoding="utf-8").partition("\n")[0]
    return first.removeprefix("#").strip() if first.startswith("#") else ""


def with_look(document: SceneFile, name: str) -> SceneFile:
    """A document drawn in a look: representations, lights and settings are the look's.

    The picture's size and resolution, its seed and its stereo mode stay.

    Raises:
        SettingsError: There is no such look, or its file names inputs.
        LoadError: Its file is at fault.
    """
    known = looks()
    if name not in known:
        raise SettingsError(f"{unknown('look', name, known)} (your own go to {user_folder()})")
    look = read_scene_file(known[name])
    if look.input:
        raise SettingsError(f"{known[name]}: a look names no inputs")
    kept = document.settings
    settings = look.settings.replace(
        size=kept.size, dpi=kept.dpi, seed=kept.seed, stereo=kept.stereo
    )
    return replace(
        document,
        show=look.show or document.show,
        light=look.light or document.light,
        settings=settings,
    )
