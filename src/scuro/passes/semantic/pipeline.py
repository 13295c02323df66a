"""The passes of the thesis, in order. Each leaves its buffer in the frame under the shader's name.

``regions`` (t and t + 1), ``calm_surface``, ``diffuse``, ``gathered`` (light, visibility),
``bounce``, ``lit``, the blurred forms of the last three, and ``color``.
"""

from __future__ import annotations

import math
import weakref
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.gpu import Gpu
from scuro.passes.frame import Frame
from scuro.passes.semantic.settings import SemanticSettings
from scuro.scene.camera import Camera
from scuro.scene.regions import Hierarchy, level_at
from scuro.style.hierarchy import hierarchy_colors
from scuro.trace.table import float_table

ATOM_PIXELS = 12.0
"""The nearest default threshold is where an atom is this many pixels wide."""


@dataclass(frozen=True)
class Place:
    """Where on the ladder of levels the camera stands."""

    level: int
    """t: index into the hierarchy's levels."""
    blend: float
    """From t (0) to t + 1 (1)."""
    depth: float
    """1 at the first threshold and beyond, 0 at the last."""


def shade_semantic(frame: Frame, hierarchy: Hierarchy) -> None:
    """Light the G-buffer with semantic occlusion, shadows and bounce: ``color``."""
    settings: SemanticSettings = frame.settings.semantic
    here = place(frame, hierarchy)
    frame.resources["levels"] = _levels_uniform(hierarchy, here)
    frame.resources["region_table"] = _table(frame.gpu, hierarchy)
    if settings.color and hierarchy.paths:
        _recolor(frame, hierarchy, here)
    frame.target("regions", "rg32uint", clear=(0, 0, 0, 0))
    frame.compute_tiles("passes/semantic/regions.wgsl")
    _calm(frame, settings)
    calm = {"surface": frame.resources["calm_surface"]}
    frame.target("diffuse", "rgba16float", clear=(0, 0, 0, 0))
    frame.compute_tiles("passes/semantic/direct.wgsl", calm)
    if settings.mode == "traced":
        _trace(frame, settings, calm, here)
    else:
        _occlude(frame, settings, calm)
        _shadow(frame, settings, calm, here)
    occlusion = {
        "gathered": _blurred(frame, "gathered", settings.blur_occlusion, settings),
        "bounce": _blurred(frame, "bounce", settings.blur_bounce, settings),
        "lit": _blurred(frame, "lit", settings.blur_shadow, settings),
    }
    frame.target("color", "rgba16float", clear=(0, 0, 0, 0))
    frame.compute_tiles("passes/semantic/combine.wgsl", occlusion, label="combine")


def place(frame: Frame, hierarchy: Hierarchy) -> Place:
    """Algorithm 1: level, blend and depth from the camera's distance and the thresholds."""
    settings: SemanticSettings = frame.settings.semantic
    distance = camera_distance(frame.camera, frame.accelerator.center, settings.distance_to)
    steps = thresholds(frame, hierarchy)
    level, blend = level_at(distance, steps)
    if len(steps) < 2:
        return Place(level, blend, 0.0 if distance <= steps[0] else 1.0)
    span = math.log(steps[0] / steps[-1])
    depth = math.log(max(distance, 1e-9) / steps[-1]) / span
    return Place(level, blend, min(max(depth, 0.0), 1.0))


def camera_distance(camera: Camera, center: Any, to: str = "scene") -> float:
    """Distance that decides the level; for orthographic cameras, of the one that sees as much."""
    if camera.orthographic:
        return camera.half_height() / math.tan(math.radians(Camera.fov) / 2)
    target = center if to == "scene" else camera.target
    return float(np.linalg.norm(np.subtract(camera.position, target)))


def thresholds(frame: Frame, hierarchy: Hierarchy) -> tuple[float, ...]:
    """The user's thresholds, or equal segments from the whole scene to single atoms.

    Raises:
        SettingsError: More thresholds than levels.
    """
    settings: SemanticSettings = frame.settings.semantic
    count = len(hierarchy.levels)
    if settings.thresholds is not None:
        if len(settings.thresholds) > count:
            names = ", ".join(level.name for level in hierarchy.levels)
            raise SettingsError(
                f"{len(settings.thresholds)} thresholds for {count} levels ({names}): "
                "give at most one for each"
            )
        return settings.thresholds
    half = frame.camera.half_height() if not frame.camera.orthographic else math.tan(math.pi / 12)
    scene = frame.accelerator
    far = scene.extent / math.sin(math.atan(half))
    near = 2 * _atom_radius(frame) * frame.settings.size[1] / (2 * half * ATOM_PIXELS)
    near = min(near, far / 2)
    if settings.spacing == "linear":
        return tuple(np.linspace(far, near, count).tolist())
    return tuple(np.geomspace(far, near, count).tolist())


def _levels_uniform(hierarchy: Hierarchy, here: Place) -> dict[str, Any]:
    """Field values of ``Levels`` (wgsl/region.wgsl)."""
    last = len(hierarchy.levels) - 1
    starts = _starts(hierarchy)

    def entry(index: int) -> dict[str, int]:
        level = hierarchy.levels[min(index, last)]
        table = {0: "labels", 1: "labels", 2: "offsets"}[level.kind]
        objects = hierarchy.labels.shape[1]
        first = starts[table] + level.division * objects
        return {"kind": level.kind, "table": first, "pad0": 0, "pad1": 0}

    return {
        "here": entry(here.level),
        "next": entry(here.level + 1),
        "fibres": starts["fibres"],
        "ranges": starts["ranges"],
        "groups": starts["groups"],
        "pad": 0,
        "blend": here.blend,
        "depth": here.depth,
    }


def _starts(hierarchy: Hierarchy) -> dict[str, int]:
    """Where the parts of the region table begin."""
    labels, offsets = hierarchy.labels.size, hierarchy.offsets.size
    return {
        "labels": 0,
        "offsets": labels,
        "fibres": labels + offsets,
        "ranges": labels + offsets + hierarchy.fibre.size,
        "groups": labels + offsets + hierarchy.fibre.size + hierarchy.ranges.size,
    }


_tables: weakref.WeakKeyDictionary[Hierarchy, tuple[Gpu, Any]] = weakref.WeakKeyDictionary()


def _table(gpu: Gpu, hierarchy: Hierarchy) -> Any:
    """The region table on the GPU, uploaded once."""
    held = _tables.get(hierarchy)
    if held is None or held[0] is not gpu:
        h = hierarchy
        parts = (h.labels, h.offsets, h.fibre, h.ranges, h.groups)
        joined = np.concatenate([p.astype(np.uint32).ravel() for p in parts])
        held = _tables[hierarchy] = (gpu, gpu.buffer(joined, label="regions"))
    return held[1]


def _recolor(frame: Frame, hierarchy: Hierarchy, here: Place) -> None:
    """Replace ``albedo`` of what is coloured by hierarchy with the colours of the level in view."""
    levels = hierarchy.levels
    now, then = (levels[min(here.level + k, len(levels) - 1)].depth for k in (0, 1))
    depth = now + here.blend * (then - now)
    colors = np.zeros((len(hierarchy.paths), 4), np.uint8)
    painted = [i for i, path in enumerate(hierarchy.paths) if path]
    colors[painted, :3] = hierarchy_colors([hierarchy.paths[i] for i in painted], depth)
    colors[painted, 3] = 255
    albedo = frame.resources["albedo"]
    frame.target("level_albedo", "rgba16float", clear=(0, 0, 0, 0))
    object_colors = frame.gpu.buffer(colors.view(np.uint32)[:, 0], label="colours")
    frame.compute_tiles(
        "passes/semantic/recolor.wgsl", {"albedo": albedo, "object_colors": object_colors}
    )
    frame.resources["albedo"] = frame.resources["level_albedo"]


def _calm(frame: Frame, settings: SemanticSettings) -> None:
    frame.target("calm_surface", "rgba32float", clear=(0, 0, 0, 0))
    calm = {
        "reach": settings.calm,
        "atom": 2 * _atom_radius(frame),
        "depth_limit": _depth_limit(frame, settings),
    }
    frame.compute_tiles("passes/semantic/calm.wgsl", {"calm": calm})


def _occlude(frame: Frame, settings: SemanticSettings, calm: dict[str, Any]) -> None:
    frame.target("gathered", "rgba16float", clear=(0, 0, 0, 0))
    frame.target("bounce", "rgba16float", clear=(0, 0, 0, 0))
    _halton(frame, settings.samples)
    ssdo = {
        "samples": settings.samples,
        "near_radius": settings.near_radius * _atom_radius(frame),
        "far_radius": settings.far_radius * _distance(frame, settings),
        "strength": settings.strength,
        "bounce": settings.bounce,
        "plain": int(settings.mode == "plain"),
    }
    frame.compute_tiles(
        "passes/semantic/ssdo.wgsl",
        calm | {"ssdo": ssdo},
        constants={"HAS_BOUNCE": settings.bounce > 0},
    )


def _halton(frame: Frame, samples: int) -> None:
    """Bind ``halton_points``: each further frame takes the next points of the sequence."""
    first = 1 + int(frame.resources["view"]["frame"]) * samples

    def points() -> Any:
        return float_table(frame.gpu, halton_points(first, samples), "Halton points")

    frame.resources["halton_points"] = frame.targets.table("halton", (first, samples), points)


def halton_points(first: int, count: int) -> NDArray[np.float32]:
    """(count, 4) points ``first``, … of the Halton sequence in bases 2, 3 and 5 (equation 2.6)."""
    found = np.zeros((count, 4))
    for axis, base in enumerate((2, 3, 5)):
        rest, digit = np.arange(first, first + count), 1.0
        while rest.any():
            digit /= base
            found[:, axis] += rest % base * digit
            rest //= base
    return found.astype(np.float32)


def _trace(frame: Frame, settings: SemanticSettings, calm: dict[str, Any], here: Place) -> None:
    """Occlusion and shadow in object space; the bounce stays one of screen space."""
    if settings.bounce > 0 and here.depth < 1:
        _occlude(frame, settings, calm)
    else:
        frame.target("bounce", "rgba16float", clear=(0, 0, 0, 0))
    frame.target("gathered", "rgba16float", clear=(0, 0, 0, 0))
    frame.target("lit", "rgba16float", clear=(1, 1, 1, 1))
    _halton(frame, settings.rays)
    rays = {
        "samples": settings.rays,
        "near_radius": settings.near_radius * _atom_radius(frame),
        "far_radius": settings.far_radius * _distance(frame, settings),
        "strength": settings.strength,
        "shadow": settings.shadow * here.depth,
    }
    frame.compute_tiles(
        "passes/semantic/traced.wgsl", calm | {"rays": rays}, constants={"HAS_SKIPS": True}
    )


def _shadow(frame: Frame, settings: SemanticSettings, calm: dict[str, Any], here: Place) -> None:
    frame.target("lit", "rgba16float", clear=(1, 1, 1, 1))
    distance = _distance(frame, settings)
    shadow = {
        "steps": settings.shadow_steps,
        "reach": 0.5 * distance,
        "thickness": 0.25 * distance,
        # faded out on the way in: single molecules would lie in the dark (thesis, chapter 5)
        "strength": settings.shadow * here.depth,
    }
    if settings.shadow == 0 or settings.mode == "plain":
        shadow["steps"] = 0
    frame.compute_tiles("passes/semantic/shadow.wgsl", calm | {"shadow": shadow})


def _blurred(frame: Frame, name: str, amount: int, settings: SemanticSettings) -> Any:
    """A buffer after Algorithm 3, along x and then along y."""
    if amount == 0:
        return frame.resources[name]
    source = frame.resources[name]
    for step, target in (((1, 0), f"{name}_x"), ((0, 1), f"{name}_blurred")):
        blur = {
            "step": step,
            "amount": amount,
            "depth_limit": _depth_limit(frame, settings),
            "normal_limit": settings.blur_normal,
        }
        frame.target(target, "rgba16float", clear=(0, 0, 0, 0))
        frame.compute_tiles(
            "passes/semantic/blur.wgsl",
            {
                "blur": blur,
                "surface": frame.resources["calm_surface"],
                "source": source,
                "blurred": frame.resources[target],
            },
            label=f"blur {name}",
        )
        source = frame.resources[target]
    return source


def _distance(frame: Frame, settings: SemanticSettings) -> float:
    return camera_distance(frame.camera, frame.accelerator.center, settings.distance_to)


def _atom_radius(frame: Frame) -> float:
    """Median radius of spheres and rods; a small share of a scene that has none."""
    scene = frame.accelerator
    return scene.primitive_radius or scene.extent / 500


def _depth_limit(frame: Frame, settings: SemanticSettings) -> float:
    return settings.blur_depth * _distance(frame, settings)
