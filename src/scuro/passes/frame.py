"""What one frame's passes share: the recorder, named textures and uniforms, camera and settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu, Recorder
from scuro.passes.pieces import run_in_pieces
from scuro.scene.camera import Camera
from scuro.trace import Accelerator

if TYPE_CHECKING:
    from scuro.passes.filter.temporal import History
    from scuro.render_settings import Settings
    from scuro.scene.geometry import Body


_IDLE = 8
"""Frames after which a texture that none of them used is freed: its technique is off."""


class TargetPool:
    """Textures kept between frames by name, size and format."""

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu
        self._size: tuple[int, int] | None = None
        self._held: dict[str, tuple[tuple, Any]] = {}
        self._lasting: set[str] = set()
        self._used: dict[str, int] = {}
        self._frames = 0
        self.frame: Frame | None = None
        """The last frame that drew into these textures: what they hold is its."""
        self._buffers: dict[str, tuple[tuple, Any]] = {}
        self._tables: dict[str, tuple[Any, Any]] = {}

    def begin(self, size: tuple[int, int]) -> None:
        """A frame of this size begins: free the textures that one of another size left, and those
        that are no longer used.

        Made anew one by one, small ones would settle in the gaps between large ones, and keep the
        blocks of memory that those were in. What the frame does not use would stay for ever.
        """
        freed = self._age()
        if size != self._size:
            self._size, self.frame = size, None
            freed |= self._clear()
        if freed:
            self._gpu.release()

    @property
    def _pools(self) -> list[TargetPool]:
        return [value for _, value in self._tables.values() if isinstance(value, TargetPool)]

    def _age(self) -> bool:
        """Forget textures that were idle too long; says whether there were any."""
        self._frames += 1
        idle = [name for name in self._held if self._frames - self._used[name] > _IDLE]
        for name in idle:
            del self._held[name]
        inner = [pool._age() for pool in self._pools]
        return bool(idle) or any(inner)

    def _clear(self) -> bool:
        """Forget all but what has to last; says whether there was anything."""
        forgotten = self._held.keys() - self._lasting
        for name in forgotten:
            del self._held[name]
        self._buffers.clear()
        inner = [pool._clear() for pool in self._pools]
        return bool(forgotten) or any(inner)

    def get(
        self,
        name: str,
        size: Sequence[int],
        format: str,
        attachment: bool = False,
        lasting: bool = False,
    ) -> Any:
        """The texture of that name, made anew if size or format changed.

        A ``lasting`` one outlives frames of other sizes; none outlives more than a few that do not
        use it.
        """
        if lasting:
            self._lasting.add(name)
        self._used[name] = self._frames
        key = (*size, format, attachment)
        held = self._held.get(name)
        if held is None or held[0] != key:
            texture = self._gpu.texture(size, format, attachment=attachment, label=name)
            self._held[name] = held = (key, texture)
        return held[1]

    def buffer(self, name: str, size: int, indirect: bool = False) -> Any:
        """The buffer of that name, made anew if its size changed."""
        key = (size, indirect)
        held = self._buffers.get(name)
        if held is None or held[0] != key:
            self._buffers[name] = held = (
                key,
                self._gpu.buffer(size, label=name, indirect=indirect),
            )
        return held[1]

    def table(self, name: str, key: Any, make: Callable[[], Any]) -> Any:
        """What ``make`` gives, kept under ``name`` as long as ``key`` stays the same."""
        held = self._tables.get(name)
        if held is None or held[0] != key:
            self._tables[name] = held = (key, make())
        return held[1]

    @property
    def bytes(self) -> int:
        """GPU memory held by textures, those of pools within it too."""
        texel = {"r32float": 4, "rg32float": 8, "rgba8unorm": 4, "depth32float": 4, "r32uint": 4}
        own = sum(
            int(np.prod(key[:-2])) * texel.get(key[-2], 16 if "32" in key[-2] else 8)
            for key, _ in self._held.values()
        )
        return own + sum(pool.bytes for pool in self._pools)


@dataclass(eq=False)
class Frame:
    """One picture in the making. Passes read and add to ``resources`` by name."""

    gpu: Gpu
    recorder: Recorder
    targets: TargetPool
    accelerator: Accelerator
    camera: Camera
    settings: Settings
    size: tuple[int, int]
    """Width and height of the tile that is drawn, in samples."""
    resources: dict[str, Any] = field(default_factory=dict)
    constants: dict[str, float] = field(default_factory=dict)
    scale: int = 1
    """Samples along the edge of an output pixel."""
    sparse: Any = None
    """The texture that ``color`` was when it was last known to be empty outside of the tiles."""
    smoothed: bool = False
    """Whether edges were smoothed already, by a pass that others follow."""
    history: History | None = None
    """What earlier frames found, if this one goes on from them."""
    breathe: Callable[[float], None] | None = None
    """Called between pieces of passes that may take long, with the share of the pass that is done:
    whoever shows the picture can do something else meanwhile. ``None`` draws without a break."""
    context: Frame | None = None
    """What was drawn in simple light, in textures of its own: see passes/compose/context.py."""

    def __post_init__(self) -> None:
        self.targets.frame = self

    @property
    def bodies(self) -> tuple[Body, ...]:
        """All that is drawn, by the numbers of objects in ``ids``."""
        return self.accelerator.bodies + (self.context.bodies if self.context else ())

    @property
    def px(self) -> float:
        """Samples to a length of 1 px in the settings: see :attr:`Settings.px`."""
        return self.scale * self.settings.px

    @property
    def screen_reach(self) -> float:
        """Samples that techniques of screen space look about: see :func:`part.screen_reach`."""
        from scuro.passes.part import screen_reach  # which needs the tiles, and those this module

        return float(screen_reach(int(self.resources["view"]["size"][1])))

    def target(
        self,
        name: str,
        format: str,
        *,
        size: Sequence[int] | None = None,
        attachment: bool = False,
        clear: tuple[float, float, float, float] | None = None,
    ) -> Any:
        """A texture of the frame's size (or another), known to later passes by its name.

        ``clear`` fills it first: tiled passes leave the rest of the picture untouched.
        """
        attachment = attachment or clear is not None
        texture = self.targets.get(name, size or self.size, format, attachment)
        if clear is not None:
            self.recorder.clear_texture(texture, clear)
        self.resources[name] = texture
        return texture

    def scratch(self, name: str, size: int, *, indirect: bool = False) -> Any:
        """A storage buffer of at least ``size`` bytes, known to later passes by its name."""
        buffer = self.targets.buffer(name, size, indirect)
        self.resources[name] = buffer
        return buffer

    def replace_color(
        self,
        shader: str,
        resources: Mapping[str, Any],
        *,
        tiles: bool = False,
        constants: Mapping[str, float] | None = None,
    ) -> None:
        """Run a pass that makes ``replaced`` from ``color``, and go on with what it made.

        ``tiles``: only where there may be a surface, or a line around one; the rest stays.
        """
        color = self.resources["color"]
        size = color.size[:2]
        # two textures take turns: a pass cannot write what it reads
        name = "post_b" if color is self.resources.get("post_a") else "post_a"
        replaced = self.target(name, "rgba16float", size=size, attachment=True)
        if tiles:
            if color is self.sparse:
                self.recorder.clear_texture(replaced, (0, 0, 0, 0))
                self.sparse = replaced
            else:
                self.recorder.copy_texture(color, replaced)
            self.compute_tiles(shader, {**resources, "replaced": replaced}, constants=constants)
        else:
            self.compute(
                shader, {**resources, "replaced": replaced}, threads=size, constants=constants
            )
        self.resources["color"] = replaced

    def compute_tiles(
        self,
        shader: str,
        resources: Mapping[str, Any] | None = None,
        *,
        entry: str = "main",
        constants: Mapping[str, float] | None = None,
        label: str = "",
    ) -> None:
        """Record a compute pass over the tiles that may show a surface (wgsl/tiles.wgsl)."""
        bound = self.resources | dict(resources or {})
        constants = self.constants | dict(constants or {})

        def record(other: dict[str, Any], count: Any) -> None:
            self.recorder.compute(shader, entry, (), bound | other, constants, label, count)

        if self.breathe is None:
            record({}, self.resources["tile_count"])
        else:
            run_in_pieces(self, record)

    def compute_shown(
        self,
        shader: str,
        resources: Mapping[str, Any] | None = None,
        *,
        threads: Sequence[int] | None = None,
        label: str = "",
    ) -> None:
        """Record a compute pass over what ``color`` shows.

        That is the shader's entry ``tiles`` where the rest is known to be empty, ``everywhere``
        (over its pixels, or other threads) otherwise.
        """
        color = self.resources["color"]
        if color is self.sparse:
            self.compute_tiles(shader, resources, entry="tiles", label=label)
        else:
            self.compute(
                shader,
                resources,
                entry="everywhere",
                threads=threads or color.size[:2],
                label=label,
            )

    def compute(
        self,
        shader: str,
        resources: Mapping[str, Any] | None = None,
        *,
        entry: str = "main",
        threads: Sequence[int] | None = None,
        constants: Mapping[str, float] | None = None,
        indirect: Any = None,
        label: str = "",
    ) -> None:
        """Record a compute pass over the frame's pixels, other threads, or ``indirect``."""
        self.recorder.compute(
            shader,
            entry,
            threads or self.size,
            self.resources | dict(resources or {}),
            self.constants | dict(constants or {}),
            label,
            indirect,
        )


def view_uniform(
    camera: Camera,
    center: NDArray,
    size: tuple[int, int],
    *,
    tile: tuple[int, int] = (0, 0),
    jitter: tuple[float, float] = (0.0, 0.0),
    frame: int = 0,
    seed: int = 0,
) -> dict[str, Any]:
    """Field values of ``View`` (wgsl/view.wgsl).

    Args:
        camera: In world space.
        center: World position of the origin of scene space.
        size: Width and height of the whole picture.
        tile: First pixel of the part that is drawn.
        jitter: Shift of the sample within its pixel.
        frame: Frames since the picture last changed.
        seed: Of all random sequences.
    """
    view_from_world = camera.view_from_world()
    world_from_scene = np.eye(4)
    world_from_scene[:3, 3] = center
    view_from_scene = view_from_world @ world_from_scene
    half = camera.half_height()
    return {
        "view_from_scene": view_from_scene,
        "scene_from_view": np.linalg.inv(view_from_scene),
        "size": size,
        "origin": tile,
        "half_extent": (half * size[0] / size[1], half),
        "jitter": jitter,
        "orthographic": int(camera.orthographic),
        "frame": frame,
        "seed": seed,
        "distance": float(np.linalg.norm(view_from_scene[:3, 3])),
    }
