"""What one frame's passes share: the recorder, named textures and uniforms, camera and settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu, Recorder
from scuro.passes.pieces import run_in_pieces
from scuro.passes.targets import TargetPool
from scuro.scene.camera import Camera
from scuro.trace import Accelerator

if TYPE_CHECKING:
    from scuro.passes.filter.temporal import History
    from scuro.render_settings import Settings
    from scuro.scene.geometry import Body


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

    outline: NDArray[np.float64] | None = None
    """(n, 3) world points that bound what shows besides bodies, for depth cues."""

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
