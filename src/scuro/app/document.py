"""From a command line to the document that says what to draw: see :class:`SceneFile`."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any

import click

from scuro.app.options import parse_element, take_changes, with_settings
from scuro.errors import SettingsError
from scuro.export.looks import with_look
from scuro.export.scene_file import Input, SceneFile, Show, is_scene_file, read_scene_file
from scuro.load import LoadOptions
from scuro.render_settings import Settings
from scuro.scene.clip import ClippingSettings, Cut
from scuro.scene.lights import Light
from scuro.scene.view import ViewSettings
from scuro.settings import Parameter, checked, parameters, unknown
from scuro.style.options import Representation

_LIGHT_KEYS = ", ".join(p.name for p in parameters(Light) if p.name != "kind")


def with_document(command: click.Command) -> click.Command:
    """Decorator: give a command its inputs and every option that a picture depends on."""
    options: list[Callable] = [
        click.argument("inputs", nargs=-1, required=True, metavar="IN..."),
        click.option(
            "--show",
            multiple=True,
            metavar="STYLE[,color=…][,select=…]",
            help="Show some atoms in a style; repeat it for several at once, e.g. "
            "--show cartoon,color=chain --show licorice,select=organic. Also takes opacity=… and "
            "each size listed under Sizes, e.g. tube_radius=0.5.",
        ),
        click.option(
            "--light",
            multiple=True,
            metavar="KIND[,key=value]…",
            help="Light with these lights instead of the preset's: directional, point or spot, "
            f"e.g. --light point,position=0,20,50,intensity=2. Keys: {_LIGHT_KEYS}.",
        ),
        click.option(
            "--look",
            metavar="NAME",
            help="Draw in a look: qutemol, goodsell, textbook, clay, journal, ink, cover, or one "
            "of your own; other options change it.",
        ),
        click.option(
            "--clip",
            multiple=True,
            metavar="X,Y,Z[,offset=…][,point=x,y,z]",
            help="Cut with a plane and keep the side that this direction points to; repeat it for "
            "several. Its offset (Å) moves it along the direction, from the scene's middle or "
            "from a point.",
        ),
        click.option("--format", metavar="ENDING", help="The inputs' format, if names do not say."),
        click.option("--assembly", metavar="ID", help="Show this biological assembly."),
        with_settings(Show, title="Representation", without=[("sizes",)]),
        with_settings(Representation, title="Sizes"),
        with_settings(ClippingSettings, title="Clipping"),
        with_settings(ViewSettings, title="Camera"),
        with_settings(LoadOptions, title="Reading"),
        with_settings(Settings, title="Picture"),
    ]
    for option in options:
        option(command)
    return command


def take_document(values: dict[str, Any]) -> SceneFile:
    """Remove from a command's ``values`` what makes up the document, and make it.

    A scene file (or a picture of ours) among the inputs is the document; options change it.
    """
    inputs, format = values.pop("inputs"), values.pop("format")
    assembly, lights = values.pop("assembly"), values.pop("light")
    cuts, look = values.pop("clip"), values.pop("look")
    base = _base(inputs, format)
    if look is not None:
        base = with_look(base, look)
    if assembly is not None:
        base = replace(base, input=tuple(i.replace(assembly=assembly) for i in base.input))
    return replace(
        base,
        show=_shown(values, base.show),
        light=tuple(map(parse_light, lights)) or base.light,
        clip=tuple(map(parse_clip, cuts)) or base.clip,
        clipping=base.clipping.replace(**take_changes(ClippingSettings, values)),
        view=base.view.replace(**take_changes(ViewSettings, values)),
        load=base.load.replace(**take_changes(LoadOptions, values)),
        settings=base.settings.replace(**take_changes(Settings, values)),
    )


def _base(inputs: Sequence[str], format: str | None) -> SceneFile:
    scenes = [name for name in inputs if is_scene_file(name)]
    if not scenes:
        return SceneFile(input=tuple(Input(path=name, format=format) for name in inputs))
    if len(inputs) > 1:
        raise SettingsError(f"{scenes[0]} is a scene of its own: give it without other inputs")
    return read_scene_file(scenes[0])


def _shown(values: dict[str, Any], before: tuple[Show, ...]) -> tuple[Show, ...]:
    """The representations: those of --show, or one of --style, --color …, or as before."""
    lines = values.pop("show")
    sizes = take_changes(Representation, values)
    single = take_changes(Show, values, without=[("sizes",)])
    if lines and single:
        flags = ", ".join(f"--{name}" for name in single)
        raise SettingsError(f"give {flags} inside each --show, e.g. --show cartoon,color=chain")
    if lines:
        made = tuple(parse_show(line) for line in lines)
    elif len(before) == 1:
        made = (before[0].replace(**single),)
    elif single or (sizes and not before):
        made = (Show(**single),)
    else:
        made = before
    return tuple(show.replace(sizes=show.sizes.replace(**sizes)) for show in made)


def parse_show(text: str) -> Show:
    """Read ``STYLE[,key=value…]``.

    Raises:
        SettingsError: A key or value is not known.
    """
    own = parameters(Show)
    values = _pairs("show", text, "style", (*own, *parameters(Representation)))
    made = Show(**{p.name: values.pop(p.name) for p in own if p.name in values})
    return made.replace(sizes=Representation(**values))


def parse_light(text: str) -> Light:
    """Read ``KIND[,key=value…]``; vectors are three numbers with commas.

    Raises:
        SettingsError: A key or value is not known.
    """
    return Light(**_pairs("light", text, "kind", parameters(Light)))


def parse_clip(text: str) -> Cut:
    """Read ``X,Y,Z[,key=value]…``, the direction to the side that a plane keeps.

    Raises:
        SettingsError: A key or value is not known, or the direction is zero.
    """
    return Cut(**_pairs("clip", text, "normal", parameters(Cut)))


def _pairs(flag: str, text: str, first: str, known: Iterable[Parameter]) -> dict[str, Any]:
    """Values by key; the first has none. A value may hold commas: only ``,key=`` begins the next.

    Args:
        flag: The option, for errors.
        text: What was given to it.
        first: Key of the first value.
        known: The keys there are.
    """
    by_name = {p.name: p for p in known}
    head, *rest = re.split(r",\s*(?=[A-Za-z_-]+\s*=)", text)
    if "=" in head:
        raise SettingsError(f"--{flag} '{text}' must begin with the {first}, before any key=value")
    try:
        found = {first: _parsed(by_name[first], head.strip())}
    except SettingsError as error:
        raise SettingsError(f"--{flag} '{text}': {error}") from None
    for part in rest:
        key, _, value = part.partition("=")
        key = key.strip().replace("-", "_")
        if key not in by_name:
            raise SettingsError(f"--{flag} '{text}': {unknown('key', key, by_name)}")
        try:
            found[key] = _parsed(by_name[key], value.strip())
        except SettingsError as error:
            raise SettingsError(f"--{flag} '{text}': {error}") from None
    return found


def _parsed(p: Parameter, text: str) -> Any:
    if p.type is bool:
        words = {"on": True, "true": True, "yes": True, "off": False, "false": False, "no": False}
        return checked(p, words.get(text.lower(), text))
    if p.many:
        return checked(p, tuple(parse_element(p, v) for v in text.split(",")))
    return checked(p, parse_element(p, text))
