"""Primary visibility: frame time of the ray caster and the rasteriser by number of atoms.

Space-filling molecules from 300 to 1,000,000 atoms, whole molecule in view. Without inputs the
molecules are droplets: spheres of a protein's packing density in a ball, so that any size can be
had anywhere. A last row draws 60 instances of one droplet of 100,000.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from scuro.measure.bench import BenchOptions, label, median_seconds
from scuro.measure.memory import peak_memory_mb
from scuro.render import Renderer
from scuro.scene.geometry import Body, Geometry
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera

_SIZES = (300, 6_000, 60_000, 1_000_000)
_RASTER_MOST = 100_000
"""Atoms beyond which a software adapter takes minutes to rasterise."""
_DENSITY = 0.045
"""Non-hydrogen atoms per Å³ inside a protein, half its crystal's volume being water."""
_CAPSID, _CAPSID_ATOMS = 60, 100_000


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure every size; see the module."""
    renderer = Renderer(options.device)
    software = renderer.gpu.info.software
    rows = []
    for name, scene in scenes(options):
        for way in ("raycast", "raster"):
            options.say(f"{name}, {way}")
            row = _measure(renderer, scene, way, options, skip_raster=software)
            if row is not None:
                rows.append({"scene": name, "visibility": way, **row})
    return {
        "adapter": str(renderer.gpu.info),
        "size": list(options.size),
        "frames": options.frames,
        "rows": rows,
    }


def scenes(options: BenchOptions) -> Any:
    """Names and scenes of the inputs, or of droplets of 300 to 1,000,000 atoms and a capsid."""
    if options.inputs:
        from scuro.load import load

        for name in options.inputs:
            yield label(name), Scene().add(load(name)).show("spacefill")
        return
    for count in _SIZES:
        yield f"droplet {count:,}", droplets(count, 1)
    yield f"{_CAPSID} × droplet {_CAPSID_ATOMS:,}", droplets(_CAPSID_ATOMS, _CAPSID)


def droplets(atoms: int, copies: int) -> Scene:
    """A ball of spheres at protein density, ``copies`` of it around a larger sphere."""
    rng = np.random.default_rng(atoms)
    radius = (3 * atoms / (4 * np.pi * _DENSITY)) ** (1 / 3)
    directions = rng.normal(size=(atoms, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    centers = directions * (radius * rng.random((atoms, 1)) ** (1 / 3))
    radii = rng.choice([1.52, 1.55, 1.7], (atoms, 1), p=[0.2, 0.17, 0.63])
    palette = np.array([[255, 13, 13, 255], [48, 80, 248, 255], [144, 144, 144, 255]], np.uint8)
    colors = palette[np.searchsorted([1.53, 1.6], radii[:, 0])]
    spheres = np.concatenate([centers, radii], axis=1).astype(np.float32)
    geometry = Geometry(spheres, colors, np.arange(atoms, dtype=np.int32))
    scene = Scene()
    if copies == 1:
        scene.extra_bodies.append(Body(geometry, name="droplet"))
        return scene
    steps = np.arange(copies) + 0.5  # spherical Fibonacci points
    z, turn = 1 - 2 * steps / copies, np.pi * (1 + 5**0.5) * steps
    shell = np.stack([np.cos(turn) * np.sqrt(1 - z * z), np.sin(turn) * np.sqrt(1 - z * z), z], 1)
    rotations = rng.normal(size=(copies, 4))
    rotations /= np.linalg.norm(rotations, axis=1, keepdims=True)
    spread = radius * np.sqrt(copies) * 0.6
    scene.extra_bodies.append(
        Body(geometry, rotations.astype(np.float32), shell * spread, name="capsid")
    )
    return scene


def _measure(
    renderer: Renderer, scene: Scene, way: str, options: BenchOptions, *, skip_raster: bool
) -> dict[str, Any] | None:
    settings = options.plain().replace(visibility=way)
    camera = view_camera(scene, ViewSettings(), options.size[0] / options.size[1])
    start = time.perf_counter()
    accelerator = renderer.accelerator(scene)
    renderer.gpu.finish()
    built = time.perf_counter() - start
    if way == "raster" and skip_raster and accelerator.spheres > _RASTER_MOST:
        return None

    def frame() -> None:
        renderer.timings = renderer.frame(scene, camera, settings).recorder.submit()
        renderer.gpu.finish()

    seconds = median_seconds(frame, options.frames)
    return {
        "spheres": accelerator.spheres,
        "build_s": round(built, 4),
        "frame_s": round(seconds, 4),
        "gpu_mb": round(accelerator.bytes / 2**20, 1),
        "peak_memory_mb": peak_memory_mb(),
    }
