"""From the rough picture of a moving scene to the full one, in steps that can be left any time.

What a technique is called matters nowhere here: groups of settings are read by their shape. Numbers
of samples are settings called ``samples``, resolutions relative to the data's are fractions called
``…resolution``. A group is off when its switch, its main or first setting, is false, ``none`` or
``off``, or when another setting could choose it by name and does not (``renderer`` and ``path``).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from scuro.passes.compose.lighting import with_implied
from scuro.render_settings import Settings
from scuro.settings import Parameter, SettingsGroup, parameters, subgroups

MOVING_SAMPLES = 4
"""Samples a pixel of every sampling technique, at most, while something moves."""
MOVING_RESOLUTION = 0.25
"""Of light that is made anew for every picture, relative to the data's, at most, while something
moves: small pictures pay as much for it as large ones, at half the resolution an eighth."""
GROWTH = 4
"""Each step has so many times the samples of the one before, so that all steps before the last
together cost a third of it."""
_OFF = ("none", "off")


@dataclass(frozen=True)
class Step:
    """One picture on the way."""

    settings: Settings
    share: float
    """Samples in relation to the full picture's."""


def steps(settings: Settings) -> Iterator[Step]:
    """The pictures up to the full one, whose settings are those given."""
    full = max((value or 0 for _, value in _samples(settings)), default=0)
    samples = MOVING_SAMPLES
    while samples < full if settings.renderer == "path" else samples * GROWTH <= full:
        yield Step(_capped(settings, samples), samples / full)
        # the path tracer goes on from the picture before; all others begin anew
        samples = samples + MOVING_SAMPLES if settings.renderer == "path" else samples * GROWTH
    yield Step(settings, 1.0)


def coarse(settings: Settings) -> Settings:
    """The settings with numbers of samples and resolutions as low as a moving picture needs."""
    settings = with_implied(settings)
    open_ones = {name: MOVING_SAMPLES for name, value in _samples(settings) if value is None}
    fine = {name: MOVING_RESOLUTION for name, value in _resolutions(settings)
            if value > MOVING_RESOLUTION}  # fmt: skip
    return _capped(settings, MOVING_SAMPLES).replace(**open_ones, **fine)


def plain(settings: Settings) -> Settings:
    """The settings with every technique off that can be: what a very slow machine can move."""
    off: dict[str, Any] = {}
    for path, group in _groups(settings):
        switch = _switch(type(group))
        if switch is not None:
            off["__".join((*path, switch.name))] = _off_value(switch)
    return settings.replace(**off)


def _capped(settings: Settings, most: int) -> Settings:
    return settings.replace(
        **{name: most for name, value in _samples(settings) if value is not None and value > most}
    )


def _samples(settings: Settings) -> Iterator[tuple[str, int | None]]:
    """Name for ``replace`` and value of the numbers of samples of all techniques that are on."""
    chosen = [(p.choices or (), getattr(settings, p.name)) for p in parameters(Settings)]
    for path, group in _groups(settings):
        switch = _switch(type(group))
        off = switch is not None and getattr(group, switch.name) in (False, *_OFF)
        if not getattr(group, "sampled", True):
            continue
        if off or any(path[0] in words and word != path[0] for words, word in chosen):
            continue
        for p in parameters(type(group)):
            if p.name == "samples" and p.type is int and not p.many:
                yield "__".join((*path, p.name)), getattr(group, p.name)


def _resolutions(settings: Settings) -> Iterator[tuple[str, float]]:
    """Name for ``replace`` and value of all resolutions that are shares of the data's."""
    for path, group in _groups(settings):
        for p in parameters(type(group)):
            if p.name.endswith("resolution") and p.type is float:
                yield "__".join((*path, p.name)), getattr(group, p.name)


def _groups(
    group: SettingsGroup, path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], SettingsGroup]]:
    for name, _ in subgroups(type(group)):
        inner = getattr(group, name)
        yield (*path, name), inner
        yield from _groups(inner, (*path, name))


def _switch(group: type[SettingsGroup]) -> Parameter | None:
    """The setting that turns a group's technique off."""
    known = parameters(group)
    first = next((p for p in known if p.main), known[0] if known else None)
    if first is None or _off_value(first) is None:
        return None
    return first


def _off_value(p: Parameter) -> Any:
    if p.type is bool and not p.many:
        return False
    return next((word for word in _OFF if word in (p.choices or ())), None)
