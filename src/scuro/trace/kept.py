"""The acceleration structures of a scene, kept while its bodies are."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from scuro.steps import Sharing, finished
from scuro.trace.accelerator import Accelerator, build_in_steps

if TYPE_CHECKING:
    from scuro.gpu import Gpu
    from scuro.scene.scene import Scene

_Steps = Generator[float, None, Accelerator]
_Shared = Callable[[Any, Callable[[], _Steps]], _Steps]
"""Takes steps, begun by others perhaps, by what they build."""


@dataclass
class _Built:
    """An acceleration structure and what it was built from."""

    bodies: tuple[Any, ...] = ()
    accelerator: Accelerator | None = None
    bounds: Any = None
    """(2, 3) world box of the scene it was built for."""

    def holds(self, bodies: tuple[Any, ...], bounds: Any) -> bool:
        """Whether it is of these bodies."""
        # without bodies the middle of the scene is still the origin of all that is drawn
        return bodies == self.bodies and (bool(bodies) or np.array_equal(bounds, self.bounds))


class Accelerators:
    """That of what occludes and that of what is shown as context, each rebuilt only if a body was.

    Renderers of several views of one scene share them.
    """

    def __init__(self, gpu: Gpu) -> None:
        self.gpu = gpu
        self._scene = _Built()
        self._context = _Built()
        self._sharing: Sharing[Accelerator] = Sharing()

    def scene(self, scene: Scene) -> Accelerator:
        """That of all but the context."""
        return finished(self._scene_in_steps(scene, lambda key, build: build()))

    def scene_in_steps(self, scene: Scene) -> Generator[float, None, Accelerator]:
        """The same in short steps, which all who ask for it share.

        The one that was there stays until the new one is whole.
        """
        return self._scene_in_steps(scene, self._sharing.steps)

    def _scene_in_steps(self, scene: Scene, shared: _Shared) -> Generator[float, None, Accelerator]:
        bodies, built = tuple(scene.occluders()), self._scene
        bounds = scene.bounds()
        if built.accelerator is None or not built.holds(bodies, bounds):
            center = bounds.mean(axis=0)
            made = yield from shared(
                ("scene", bodies, bounds.tobytes()),
                lambda: build_in_steps(self.gpu, bodies, center, bounds=bounds),
            )
            built.accelerator, built.bodies, built.bounds = made, bodies, bounds
        return built.accelerator

    def context(self, scene: Scene) -> Accelerator | None:
        """That of what the scene shows as context, about the same centre; ``None`` without any."""
        return finished(self._context_in_steps(scene, lambda key, build: build()))

    def context_in_steps(self, scene: Scene) -> Generator[float, None, Accelerator | None]:
        """The same in short steps, after those of :meth:`scene_in_steps`."""
        return self._context_in_steps(scene, self._sharing.steps)

    def _context_in_steps(
        self, scene: Scene, shared: _Shared
    ) -> Generator[float, None, Accelerator | None]:
        bodies, built = tuple(scene.context()), self._context
        center = (yield from self._scene_in_steps(scene, shared)).center
        if not bodies:
            built.bodies, built.accelerator = (), None
        elif not self._holds_context(bodies):
            made = yield from shared(
                ("context", bodies, center.tobytes()),
                lambda: build_in_steps(self.gpu, bodies, center),
            )
            built.accelerator, built.bodies = made, bodies
        return built.accelerator

    def hold(self, scene: Scene) -> bool:
        """Whether a frame of the scene needs nothing new."""
        if self._scene.accelerator is None:
            return False
        return self._scene.holds(tuple(scene.occluders()), scene.bounds()) and self._holds_context(
            tuple(scene.context())
        )

    def _holds_context(self, bodies: tuple[Any, ...]) -> bool:
        scene, context = self._scene.accelerator, self._context.accelerator
        if not bodies or scene is None or context is None:
            return not bodies
        return bodies == self._context.bodies and np.array_equal(scene.center, context.center)
