"""Every feature of the viewer once: what a first use allocates is there before growth counts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from scuro.export.scene_file import Input, SceneFile, Show
from scuro.render_settings import Settings
from scuro.settings import Parameter, SettingsGroup, parameters, subgroups
from scuro.style.representation import STYLES
from scuro.viewer.screen import Screen

_COLORS = ("auto", "element", "chain", "residue", "temperature", "#804020")
_KEYS = "cvxyzobnpfi"
_NEVER = ("size", "dpi", "text", "seed", "samples", "seconds", "megabytes", "directions")
"""Settings whose values decide how much is done, not what."""
_VOLUME, _RESERVOIR = ("volume",), ("reservoir", "strategy")
_OFF = ("none", "off")


def documents(folder: Path) -> list[SceneFile]:
    """A molecule, a volume and a reservoir; the latter two are written into a folder."""
    from scuro.measure.bench.reservoir import write_egrid
    from scuro.scene.cornerpoint_synthetic import faulted_dome

    axis = np.linspace(-1.0, 1.0, 40, dtype=np.float32)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    np.save(folder / "cloud.npy", np.exp(-4 * (x * x + 2 * y * y + z * z)) * (1 + np.sin(9 * x)))
    write_egrid(folder / "dome.EGRID", faulted_dome(16, 16, 6))
    names = ("sample:1hpv", str(folder / "cloud.npy"), str(folder / "dome.EGRID"))
    return [SceneFile(input=(Input(path=name),)) for name in names]


def tour(screen: Screen, draw: Callable[[], None]) -> Iterator[str]:
    """Use all that concerns what is open; the document is left as it was.

    Args:
        screen: What a person has before them.
        draw: Called with each feature in use: draws what there is to see.

    Yields:
        The feature that was used, in words.
    """
    model = screen.model
    document = model.document
    for name, settings in variations(document.settings, _groups_of(screen)):
        if model.change(settings=settings):
            draw()
            yield name
    model.change(settings=document.settings)
    for show in _shows(document) if model.scene.molecules else ():
        if model.change(show=(show,)):
            draw()
            yield f"{show.style} {show.color} {show.opacity:g}"
    model.change(show=document.show)
    for key in _KEYS:
        screen.handle({"event_type": "key_down", "key": key, "modifiers": ()})
        screen.view.spinning = False
        draw()
        yield f"key {key}"
    for name, settings in variations(document.settings, _groups_of(screen), main=True):
        # with what the keys left: cuts, a cube, a probe and parallel rays make other pipelines
        if model.change(settings=settings):
            draw()
            yield f"{name}, cut"
    model.open(document)


def variations(
    settings: Settings, groups: tuple[str, ...], main: bool = False
) -> Iterator[tuple[str, Settings]]:
    """Each value of each setting that chooses something, its technique switched on for it.

    Args:
        settings: From which each differs in one feature.
        groups: Names of the groups of settings that count; those of the picture as a whole, too.
        main: Whether only the groups' own switches count.
    """
    for path, group, before in _walk(settings, (), {}):
        if path and path[0] not in groups:
            continue
        for p in parameters(group):
            if p.name in _NEVER or p.many or (main and not p.main):
                continue
            for value in _values(p):
                name = "__".join((*path, p.name))
                yield f"{name}={value}", settings.replace(**{**before, name: value})


def _walk(
    group: SettingsGroup, path: tuple[str, ...], before: dict[str, Any]
) -> Iterator[tuple[tuple[str, ...], type[SettingsGroup], dict[str, Any]]]:
    """All groups, and what has to be set for their settings to count."""
    yield path, type(group), before
    choosing = [p for p in parameters(type(group)) if p.choices]
    for name, kind in subgroups(type(group)):
        inside = dict(before)
        inside |= {"__".join((*path, p.name)): name for p in choosing if name in (p.choices or ())}
        switch = next((p for p in parameters(kind) if p.main), None)
        on = None if switch is None else next((v for v in _values(switch) if v not in _OFF), None)
        if switch is not None and on is not None and switch.default in (None, False, 0, *_OFF):
            inside["__".join((*path, name, switch.name))] = on
        yield from _walk(getattr(group, name), (*path, name), inside)


def _values(p: Parameter) -> list[Any]:
    if p.choices:
        return [*p.choices]
    if p.type is bool:
        return [not p.default]
    if p.type in (int, float) and p.default in (None, 0) and None not in (p.low, p.high):
        assert p.low is not None and p.high is not None
        return [p.type(p.low + (p.high - p.low) / 8)]
    return []


def _groups_of(screen: Screen) -> tuple[str, ...]:
    """Names of the settings that concern what is open."""
    scene = screen.model.scene
    if scene.volumes:
        return _VOLUME
    if scene.reservoirs:
        return _RESERVOIR
    return tuple(n for n, _ in subgroups(Settings) if n not in (*_VOLUME, *_RESERVOIR))


def _shows(document: SceneFile) -> Iterator[Show]:
    show = document.show[0] if document.show else Show()
    for style in STYLES:
        yield show.replace(style=style)
        yield show.replace(style=style, opacity=0.5)
    for color in _COLORS:
        yield replace(show, color=color)
