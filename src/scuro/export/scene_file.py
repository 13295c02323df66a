"""Scene files: all that a picture depends on, as readable TOML, or inside a PNG of ours.

A scene file names its inputs by paths relative to itself, how they are shown, the view and every
setting. The same document is embedded in each picture, so that it can be made again.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from os import PathLike
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from scuro.errors import LoadError, SaveError, SettingsError
from scuro.export import toml
from scuro.export.files import replacing
from scuro.export.paths import found_path, moved, named_path, relative_path
from scuro.export.png import is_png, read_settings
from scuro.export.reading import Fault, group_from
from scuro.load import LoadOptions
from scuro.render_settings import Settings
from scuro.scene.clip import Clip, ClippingSettings, Cut
from scuro.scene.lights import Light
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings
from scuro.scene.volume import Volume
from scuro.settings import SettingsGroup, parameters, setting, unknown
from scuro.style.options import Representation

VERSION = 1
"""Of the format; raised when an older scuro could not read what a newer one writes."""
_VERSION_KEY = "scuro"
_ARRAYS = ("input", "show", "light", "clip")


class Input(SettingsGroup):
    """A file to read."""

    path: str = setting("", "path, PDB ID, or sample:NAME; '-' is standard input")
    format: str | None = setting(None, "the format's usual ending, where the path does not say")
    assembly: str | None = setting(None, "biological assembly to show, by its number in the file")


class Show(SettingsGroup):
    """One representation of some atoms."""

    style: str = setting(
        "auto",
        "spacefill, ball+stick, licorice, backbone, cartoon, surface, or auto: by content and size",
    )
    color: str = setting("auto", "color scheme, color name or #rrggbb")
    select: str = setting(
        "auto", "which atoms, in PyMOL's words; auto is all but the water about it"
    )
    opacity: float = setting(1.0, "1 is solid", low=0, high=1)
    optional: bool = setting(False, "leave it out where the selection matches nothing")
    context: bool = setting(
        False, "surroundings in simple light: neither occluded and shadowed nor doing so to others"
    )
    sizes: Representation = Representation()


@dataclass(frozen=True)
class SceneFile:
    """The document: what is read, how it is shown, from where, and all settings."""

    input: tuple[Input, ...] = ()
    show: tuple[Show, ...] = ()
    light: tuple[Light, ...] = ()
    """Instead of the lights of the lighting preset, whose ambient light stays."""
    clip: tuple[Cut, ...] = ()
    clipping: ClippingSettings = field(default_factory=ClippingSettings)
    load: LoadOptions = field(default_factory=LoadOptions)
    view: ViewSettings = field(default_factory=ViewSettings)
    settings: Settings = field(default_factory=Settings)

    def read(self) -> list[Any]:
        """What the inputs hold.

        Raises:
            LoadError: An input cannot be read.
        """
        from scuro.load import load

        if not self.input:
            raise SettingsError("the scene names no input: it was made in Python, not from files")
        return [load(line.path, format=line.format, options=self.load) for line in self.input]

    def scene(self, data: Sequence[Any] | None = None) -> Scene:
        """Read the inputs and show them.

        Args:
            data: What :meth:`read` gave, to be shown once more.

        Raises:
            LoadError: An input cannot be read.
            SettingsError: A selection, colour or style is not known, or selects nothing.
        """
        scene = Scene()
        for line, found in zip(self.input, self.read() if data is None else data, strict=True):
            scene.add(found)
            if line.assembly is not None:
                if scene.items[-1] not in scene.molecules:
                    raise SettingsError(f"{line.path} has no biological assemblies")
                scene.items[-1].assembly = line.assembly
        self.show_in(scene)
        for item in scene.volumes:
            item.seen = self._visible(item.volume)
        scene.clip = self.clipped(scene.bounds().mean(axis=0))
        return scene

    def _visible(self, volume: Volume) -> NDArray:
        from scuro.style.transfer_choose import choose_transfer
        from scuro.style.volume_extent import visible_corners

        given = self.settings.volume
        transfer = choose_transfer(volume, given.transfer, given.opacity, given.window, given.level)
        return visible_corners(volume, transfer, given.iso)

    def clipped(self, middle: NDArray) -> Clip:
        """The clipping planes, and those of the box, in a scene with this middle (3,)."""
        planes = tuple(cut.plane(middle) for cut in self.clip) + self.clipping.box(middle)
        return Clip(planes, self.clipping.whole_atoms)

    def show_in(self, scene: Scene) -> None:
        """Make a scene of these inputs look as the document says; bodies that stay are kept.

        Raises:
            SettingsError: A selection, colour or style is not known, or selects nothing.
        """
        from scuro.passes.compose.lighting import PRESETS
        from scuro.scene.geometry import Material

        scene.hide()
        scene.show_reservoirs(self.settings.reservoir)
        clipping = self.clipping
        shown = [(show, True) for show in self.show]
        if clipping.spare:
            shown = _spared(scene, self.show or (Show(),), clipping.spare)
        if clipping.cube is not None and clipping.cube_rest != "none" and scene.molecules:
            shown = shown or [(Show(), True)]
            rest = Show(style=clipping.cube_rest, color="chain", context=True)
            shown.append((rest, False))
        for show, clipped in shown:
            if show.optional and not _matches(scene, show.select):
                continue
            scene.show(
                show.style,
                select=show.select,
                color=show.color,
                material=replace(Material(), opacity=show.opacity),
                clipped=clipped,
                context=show.context,
                **_changed(show.sizes),
            )
        preset = PRESETS[self.settings.lighting.preset]
        scene.lighting = replace(preset, lights=self.light) if self.light else None

    def as_dict(self, folder: Path | None = None) -> dict[str, Any]:
        """Plain values; input paths relative to ``folder`` if one is given."""
        inputs = [line.as_dict() for line in self.input]
        for values in inputs:
            values["path"] = relative_path(values["path"], folder)
        return {
            _VERSION_KEY: VERSION,
            "input": inputs,
            "show": [show.as_dict() for show in self.show],
            "light": [light.as_dict() for light in self.light],
            "clip": [cut.as_dict() for cut in self.clip],
            "clipping": self.clipping.as_dict(),
            "load": moved(self.load, folder).as_dict(),
            "view": self.view.as_dict(),
            "settings": self.settings.as_dict(),
        }


def _spared(scene: Scene, shows: tuple[Show, ...], spare: str) -> list[tuple[Show, bool]]:
    """Each representation in two: what is cut, and what clipping spares."""
    if not _matches(scene, spare):
        raise SettingsError(f"--spare '{spare}' selects no atoms")
    found = []
    for show in shows:
        for words, clipped in (
            (f"({show.select}) and not ({spare})", True),
            (f"({show.select}) and ({spare})", False),
        ):
            if _matches(scene, words):
                found.append((show.replace(select=words), clipped))
    return found


def _matches(scene: Scene, selection: str) -> bool:
    from scuro.style.selection import select

    return any(select(item.molecule, selection).any() for item in scene.molecules)


def _changed(group: SettingsGroup) -> dict[str, Any]:
    """The values that are not the group's defaults."""
    return {
        p.name: getattr(group, p.name)
        for p in parameters(type(group))
        if getattr(group, p.name) != p.default
    }


def is_scene_file(path: str) -> bool:
    """Whether an input is a scene file or a picture, rather than data."""
    return path.lower().endswith(".toml") or is_png(path)


def read_scene_file(path: str | PathLike[str]) -> SceneFile:
    """Read a scene file, or the scene embedded in a PNG of ours.

    Raises:
        LoadError: It cannot be read; the message names the line and the key at fault.
    """
    if is_png(path):
        values, lines = read_settings(path), toml.Lines("")
    else:
        text = toml.read(path)
        values, lines = toml.parse(text, path), toml.Lines(text)
    try:
        return _document(values, Path(path).parent)
    except Fault as fault:
        raise LoadError(path, fault.why, lines.find(fault.key)) from None


def write_scene_file(
    path: str | PathLike[str], document: SceneFile, *, relative: bool = True
) -> None:
    """Write a scene file with every value and what it means.

    Args:
        path: Where to.
        document: What.
        relative: Name inputs as seen from the file's folder; else by absolute paths, for a file
            that will be moved.

    Raises:
        SaveError: It cannot be written, or an input is standard input.
    """
    if any(line.path == "-" for line in document.input):
        raise SaveError(path, "standard input cannot be named in a scene file: give a file")
    folder = Path(path).parent if relative else None
    inputs = [line.replace(path=named_path(line.path, folder)) for line in document.input]
    document = replace(document, load=moved(document.load, folder, absolute=True))
    head = (
        "# A scene of scuro: render it with 'scuro render THIS -o picture.png'.\n"
        f"{_VERSION_KEY} = {VERSION}\n"
    )
    parts = [head]
    parts += [toml.dump("input", line, array=True) for line in inputs]
    parts += [toml.dump("show", line, array=True) for line in document.show]
    parts += [toml.dump("light", line, array=True) for line in document.light]
    parts += [toml.dump("clip", line, array=True) for line in document.clip]
    groups = ("clipping", "load", "view", "settings")
    parts += [toml.dump(name, getattr(document, name)) for name in groups]
    with replacing(path) as file:
        file.write("\n".join(parts).encode())


def _document(values: Mapping[str, Any], folder: Path) -> SceneFile:
    version = values.get(_VERSION_KEY)
    if not isinstance(version, int) or isinstance(version, bool) or version < 1:
        raise Fault((), f"is no scene file: it lacks the line '{_VERSION_KEY} = {VERSION}'")
    if version > VERSION:
        raise Fault(
            (_VERSION_KEY,),
            f"was written by a newer scuro (scene format {version}, this one reads {VERSION}): "
            "upgrade with 'pip install -U scuro'",
        )
    kinds: dict[str, type[SettingsGroup]] = {
        "input": Input,
        "show": Show,
        "light": Light,
        "clip": Cut,
        "clipping": ClippingSettings,
        "load": LoadOptions,
        "view": ViewSettings,
        "settings": Settings,
    }
    assert set(kinds) == {f.name for f in fields(SceneFile)}
    made: dict[str, Any] = {}
    for key, value in values.items():
        if key == _VERSION_KEY:
            continue
        if key not in kinds:
            raise Fault((key,), unknown("key", key, kinds))
        if key in _ARRAYS:
            if not isinstance(value, list):
                raise Fault((key,), f"{key} is an array of tables: write [[{key}]]")
            made[key] = tuple(group_from(kinds[key], v, (key, i)) for i, v in enumerate(value))
        else:
            made[key] = group_from(kinds[key], value, (key,))
    made["input"] = tuple(
        line.replace(path=found_path(line.path, folder)) for line in made.get("input", ())
    )
    load = made.get("load", LoadOptions())
    for name in ("trajectory", "structures"):
        if getattr(load, name) is not None:
            made["load"] = load = load.replace(**{name: found_path(getattr(load, name), folder)})
    return SceneFile(**made)
