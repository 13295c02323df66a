"""Large files are read, and styles of large molecules built, beside the pages.

These show what was there meanwhile.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from scuro.export.scene_file import SceneFile
from scuro.scene.geometry import Body
from scuro.scene.scene import Scene
from scuro.steps import in_thread
from scuro.style.transfer_auto import automatic
from scuro.trace.pack import pack_bodies

LARGE = 100_000
"""Atoms from which on: a cartoon of so many takes a second."""
LARGE_FILES = 2_000_000
"""Bytes from which on: a structure of so many takes a tenth of a second."""
_NAMING = (".json", ".mhd", ".nhdr")
"""Suffixes of files that name others, which may be of any size."""


def _ready(bodies: Sequence[Body]) -> None:
    """Work out what a scene, its camera and its acceleration structure ask bodies for, too."""
    pack_bodies(bodies)
    for body in bodies:
        _ = body.bounds, body.geometry.outermost


def _bytes(name: str) -> float:
    """How much there is to read; infinite if that is not known."""
    path = Path(name)
    if path.is_file():
        names = path.name.lower().removesuffix(".gz").endswith(_NAMING)
        return math.inf if names else path.stat().st_size
    # a folder, or what has to be fetched
    return 0 if name.startswith("sample:") else math.inf


class Reading:
    """Reads the inputs of a document.

    Args:
        document: What shall be shown.
        then: Shows it: to be called when all is read.
    """

    def __init__(self, document: SceneFile, then: Callable[[], object]) -> None:
        self.document, self.then = document, then
        self.scene = Scene()
        """The document's, once it is read."""
        self._work: Iterator[float] = in_thread(self._read)

    @property
    def needed(self) -> bool:
        """Whether there is so much to read that somebody would have to wait."""
        return sum(_bytes(line.path) for line in self.document.input) >= LARGE_FILES

    def _read(self) -> None:
        self.scene = self.document.scene()
        _ready(self.scene.bodies())
        for item in self.scene.volumes:
            automatic(item.volume)  # kept for the transfer function and the panel's histogram

    def tick(self) -> bool:
        """Look whether all is read.

        Raises:
            ScuroError: It cannot be read.
        """
        for _ in self._work:
            return False
        return True


class Restyle:
    """Builds the bodies of a document's representations without touching the scene.

    Args:
        scene: What is shown now; its molecules are the document's.
        document: What shall be shown.
        then: Shows it: to be called when all is built.

    Raises:
        ScuroError: The document's representations cannot be.
    """

    def __init__(self, scene: Scene, document: SceneFile, then: Callable[[], object]) -> None:
        self._items = scene.molecules
        self._twins = [item.twin() for item in self._items]
        document.show_in(Scene(self._twins))
        self.then = then
        self._work: Iterator[float] = in_thread(self._build)

    @property
    def needed(self) -> bool:
        """Whether there is so much to build that somebody would have to wait."""
        atoms = sum(twin.atoms for twin in self._twins if not twin.built)
        return atoms >= LARGE

    def _build(self) -> None:
        for twin in self._twins:
            _ready(twin.bodies())

    def tick(self) -> bool:
        """Look whether it is built, and if so, hand it to the scene; says whether it was.

        Raises:
            ScuroError: It cannot be built.
        """
        for _ in self._work:
            return False
        for item, twin in zip(self._items, self._twins, strict=True):
            item.take(twin)
        return True
