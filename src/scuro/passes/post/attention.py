"""Guided attention: everything but a chosen part of the scene steps back."""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.passes.frame import Frame
from scuro.settings import SettingsGroup, setting, unknown

if TYPE_CHECKING:
    from scuro.scene.scene import Scene

HOW = ("light", "desaturate", "fade")


class AttentionSettings(SettingsGroup):
    """Draw the eye to one subtree of the scene."""

    subtree: str = setting(
        "",
        "what stays as it is: a compartment or ingredient (names with / and *), or atoms in "
        "PyMOL's words",
        main=True,
    )
    how: str = setting(
        "desaturate",
        "what happens to all else: its light goes, its colour goes, or it fades away",
        choices=HOW,
    )
    strength: float = setting(0.8, "how much of it goes", low=0, high=1)


def draw_attention(frame: Frame, scene: Scene) -> None:
    """Take light, colour or presence from ``color`` outside the chosen subtree.

    Raises:
        SettingsError: The subtree is neither in the scene nor a selection.
    """
    settings: AttentionSettings = frame.settings.attention
    if not settings.subtree:
        return

    def table() -> Any:
        return frame.gpu.buffer(chosen_table(scene, settings.subtree), label="chosen")

    key = settings.subtree, frame.bodies
    chosen = frame.targets.table("attention", key, table)
    attention = {"how": HOW.index(settings.how), "strength": settings.strength}
    frame.replace_color(
        "passes/post/attention.wgsl", {"attention": attention, "chosen": chosen}, tiles=True
    )


def chosen_table(scene: Scene, words: str) -> NDArray[np.uint32]:
    """For each object 0 (not chosen), 1 (chosen), or where its elements' zeros and ones begin.

    Raises:
        SettingsError: Nothing answers to the words.
    """
    from scuro.style.selection import select

    bodies = scene.bodies()
    heads = np.array([_below(body.path, words) for body in bodies] or [False], np.uint32)
    if heads.any():
        return heads
    elements: list[NDArray[np.uint32]] = []
    total = len(heads)
    owners = scene.owners()
    for item in scene.molecules:
        try:
            mask = select(item.molecule, words).astype(np.uint32)
        except SettingsError as error:
            raise SettingsError(f"--attention '{words}': {error}") from None
        if mask.any():
            heads[[owner is item for owner, _, _ in owners]] = total
            elements.append(mask)
            total += len(mask)
    if not elements:
        known = sorted({name for body in bodies for name in body.path})
        raise SettingsError(f"--attention: {unknown('subtree', words, known)}")
    return np.concatenate([heads, *elements])


def _below(path: tuple[str, ...], words: str) -> bool:
    """Whether a path runs through the named nodes, one right below the other."""
    wanted = [w.strip().lower() for w in words.split("/")]
    names = [name.lower() for name in path]
    return any(
        all(fnmatchcase(name, w) for name, w in zip(names[i:], wanted, strict=False))
        for i in range(len(names) - len(wanted) + 1)
    )
