"""Which levels of the hierarchy a picture is made of (Algorithm 1), and their tables on the GPU."""

from __future__ import annotations

import math
import weakref
from dataclasses import dataclass
from typing import Any

import numpy as np

from scuro.errors import SettingsError
from scuro.gpu import Gpu
from scuro.passes.frame import Frame
from scuro.passes.semantic.settings import SemanticSettings
from scuro.scene.camera import Camera
from scuro.scene.regions import Hierarchy, level_at

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


def place(frame: Frame, hierarchy: Hierarchy) -> Place:
    """Algorithm 1: level, blend and depth from the camera's distance and the thresholds."""
    settings: SemanticSettings = frame.settings.semantic
    distance = distance_of(frame, settings)
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
    near = 2 * atom_radius(frame) * frame.settings.size[1] / (2 * half * ATOM_PIXELS)
    near = min(near, far / 2)
    if settings.spacing == "linear":
        return tuple(np.linspace(far, near, count).tolist())
    return tuple(np.geomspace(far, near, count).tolist())


def levels_uniform(hierarchy: Hierarchy, here: Place) -> dict[str, Any]:
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


def region_table(gpu: Gpu, hierarchy: Hierarchy) -> Any:
    """The region table on the GPU, uploaded once."""
    held = _tables.get(hierarchy)
    if held is None or held[0] is not gpu:
        h = hierarchy
        parts = (h.labels, h.offsets, h.fibre, h.ranges, h.groups)
        joined = np.concatenate([p.astype(np.uint32).ravel() for p in parts])
        held = _tables[hierarchy] = (gpu, gpu.buffer(joined, label="regions"))
    return held[1]


def distance_of(frame: Frame, settings: SemanticSettings) -> float:
    """Distance that decides the level of a frame."""
    return camera_distance(frame.camera, frame.accelerator.center, settings.distance_to)


def atom_radius(frame: Frame) -> float:
    """Median radius of spheres and rods; a small share of a scene that has none."""
    scene = frame.accelerator
    return scene.primitive_radius or scene.extent / 500


def depth_limit(frame: Frame) -> float:
    """Difference of depths, scene units, beyond which pixels show different surfaces."""
    settings: SemanticSettings = frame.settings.semantic
    return settings.blur_depth * distance_of(frame, settings)


def edges_uniform(frame: Frame) -> dict[str, float]:
    """Differences of depth, and products of normals, at which blurs see an edge."""
    return {
        "depth_limit": depth_limit(frame),
        "normal_limit": frame.settings.semantic.blur_normal,
    }
