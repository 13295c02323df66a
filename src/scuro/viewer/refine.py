"""From the rough picture of a moving scene to the full one, in steps that can be left any time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from scuro.render_settings import Settings
from scuro.settings import walk

MOVING_SAMPLES = 4
"""Samples a pixel of every sampling technique, at most, while something moves."""
GROWTH = 4
"""Each step has so many times the samples of the one before, so that all steps before the last
together cost a third of it."""


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
    while samples * GROWTH <= full:
        yield Step(_capped(settings, samples), samples / full)
        samples *= GROWTH
    yield Step(settings, 1.0)


def coarse(settings: Settings) -> Settings:
    """The settings with all numbers of samples as low as a moving picture needs."""
    open_ones = {name: MOVING_SAMPLES for name, value in _samples(settings) if value is None}
    return _capped(settings, MOVING_SAMPLES).replace(**open_ones)


def _capped(settings: Settings, most: int) -> Settings:
    return settings.replace(
        **{name: most for name, value in _samples(settings) if value is not None and value > most}
    )


def _samples(settings: Settings) -> Iterator[tuple[str, int | None]]:
    """Name for ``replace`` and value of every setting that is a number of samples."""
    for path, parameter in walk(type(settings)):
        if parameter.name != "samples" or parameter.type is not int or parameter.many:
            continue
        value: Any = settings
        for name in path:
            value = getattr(value, name)
        yield "__".join(path), value
