"""``baked``: QuteMol's irradiance map (Tarini et al. 2006): visibility in a patch for every atom
and every bond, gathered once and free at run time.

Patches of spheres unfold as octahedra, those of rods by height and angle, each with a border of
replicated texels. Every texel sends half as many rays as there are directions, spread by the
cosine; one that another atom hides sends them from the nearest spot of its own that is seen. A
geometry of several instances is baked on its first: in an assembly all copies have like
surroundings. Triangles have no patch and stay open. With more than ``MOST_PATCHES`` primitives a
patch is one texel, the average over the whole atom.
"""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.passes.frame import Frame
from scuro.passes.occlusion.neighbours import neighbours_in_steps
from scuro.passes.occlusion.ray import fan_constants, fibonacci_sphere
from scuro.settings import SettingsGroup, setting
from scuro.steps import finished, scaled
from scuro.trace import Accelerator
from scuro.trace.pack import NO_PRIMITIVE, pack_geometry
from scuro.trace.table import float_table

MOST_PATCHES = 1_000_000
_NEIGHBOURS = 32
_LIMIT = 65535 * 64


class BakedSettings(SettingsGroup):
    """Baked occlusion."""

    directions: int = setting(
        128, "directions over the whole sphere, of which each texel sees half", low=2, high=8192
    )
    megabytes: float = setting(
        48.0, "most memory for the atlas: decides the size of a patch", low=1, high=4096, unit="MB"
    )
    edge: int | None = setting(
        None, "texels along a patch; from the memory by default", low=1, high=62, unit="texels"
    )


@dataclass(eq=False)
class Atlas:
    """Baked visibility of a scene."""

    texture: Any
    patch_of: Any
    """Buffer: patch of each slot."""
    edge: int
    """Texels along a patch, without its border."""
    columns: int
    patches: int
    directions: int
    seconds: float
    """Time that the baking took."""

    @property
    def bytes(self) -> int:
        """GPU memory of the atlas."""
        width, height, _ = self.texture.size
        return 4 * int(width) * int(height)


def draw(frame: Frame) -> None:
    """Fill ``visibility``, baking first if geometry, clipping or settings changed."""
    if frame.constants["HAS_NESTING"]:
        raise SettingsError(
            "baked occlusion is per instance and knows no assemblies that are placed as a whole: "
            "use --occlusion ray"
        )
    atlas = _kept(frame)
    if atlas is None:
        atlas = _keep(frame, bake(frame))
    frame.compute_tiles(
        "passes/occlusion/baked.wgsl",
        {
            "baked": {
                "edge": atlas.edge,
                "columns": atlas.columns,
            },
            "patch_of": atlas.patch_of,
            "atlas": atlas.texture,
            "result": frame.target("visibility", "r32float", clear=(1, 1, 1, 1)),
        },
        label="occlusion",
    )


def prepare(frame: Frame) -> Iterator[float]:
    """Bake in slices what :func:`draw` would bake at once; yields the share that is done."""
    if _kept(frame) is None:
        _keep(frame, (yield from bake_in_steps(frame)))


_atlases: WeakKeyDictionary[Accelerator, tuple[Any, Atlas]] = WeakKeyDictionary()
"""The last atlas of each scene: all views of it share one."""


def _kept(frame: Frame) -> Atlas | None:
    key, atlas = _atlases.get(frame.accelerator, (None, None))
    return atlas if key == _key(frame) else None


def _keep(frame: Frame, atlas: Atlas) -> Atlas:
    _atlases[frame.accelerator] = _key(frame), atlas
    return atlas


def _key(frame: Frame) -> tuple:
    planes = np.asarray(frame.resources["scene"]["planes"]).tobytes()
    return planes, frame.settings.occlusion.baked


def bake(frame: Frame) -> Atlas:
    """Bake all at once."""
    return finished(bake_in_steps(frame))


def bake_in_steps(frame: Frame, slice_rays: int = 1 << 19) -> Generator[float, None, Atlas]:
    """Bake a few texels at a time; yields the share that is done, returns the :class:`Atlas`.

    Args:
        frame: Of the scene; nothing of it is drawn.
        slice_rays: Rays a step, in whole texels.
    """
    start = time.perf_counter()
    gpu, settings = frame.gpu, frame.settings.occlusion.baked
    patches, patch_of = _patches(frame)
    edge = settings.edge or _edge(len(patches), settings.megabytes)
    wide = edge + 2
    columns = max(1, min(8192 // wide, len(patches)))
    rows = max(1, -(-len(patches) // columns))
    rays = max(1, settings.directions // 2)
    texels = edge * edge * len(patches)
    atlas = gpu.texture((columns * wide, rows * wide), "r32float", label="baked occlusion")
    found = yield from scaled(neighbours_in_steps(frame, _NEIGHBOURS), 0.0, 0.1)
    resources = (
        frame.resources
        | found.resources
        | {
            "patches": gpu.buffer(np.concatenate([patches, np.zeros((1, 2), np.uint32)])),
            "directions": float_table(
                gpu, np.pad(fibonacci_sphere(rays), ((0, 0), (0, 1))).astype("f4"), "directions"
            ),
            "open_texels": gpu.buffer(4 * (texels + 1), label="texels to bake"),
            "values": gpu.buffer(4 * max(1, texels), label="baked occlusion"),
            "atlas": atlas,
        }
    )
    uniform = {
        "edge": edge,
        "columns": columns,
        "patches": len(patches),
        "rays": rays,
        "texels": found.texels,
    }
    constants = frame.constants | fan_constants(frame, rays)

    def run(entry: str, threads: int, step: int) -> Iterator[float]:
        for offset in range(0, threads, step):
            count = min(step, threads - offset)
            bake = {"bake": uniform | {"offset": offset, "count": count}}
            shader = "passes/occlusion/bake.wgsl"
            gpu.compute(shader, entry, (count,), resources | bake, constants)
            gpu.finish()
            yield min(1.0, (offset + step) / threads)

    for share in run("sift", texels, 1 << 18):
        yield 0.1 + 0.1 * share
    listed = int(gpu.read_buffer(resources["open_texels"], np.uint32)[0])
    for share in run("gather", listed, min(_LIMIT, max(64, slice_rays // rays))):
        yield 0.2 + 0.75 * share
    for share in run("finish", wide * wide * len(patches), 1 << 20):
        yield 0.95 + 0.05 * share
    seconds = time.perf_counter() - start
    return Atlas(
        atlas,
        gpu.buffer(patch_of, label="patches"),
        edge,
        columns,
        len(patches),
        settings.directions,
        seconds,
    )


def _edge(patches: int, megabytes: float) -> int:
    """Texels along a patch: the budget shared out, proportional to √(budget / patches)."""
    if patches > MOST_PATCHES:
        return 1
    return int(np.clip(np.sqrt(megabytes * 2**20 / 4 / max(1, patches)) - 2, 1, 30))


def _patches(frame: Frame) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
    """Primitive and instance (p, 2) of each patch, and the patch of each slot."""
    accelerator = frame.accelerator
    total = 1 + max(
        (
            accelerator.first_slots[id(b.geometry)] + len(pack_geometry(b.geometry).slots)
            for b in accelerator.bodies
        ),
        default=0,
    )
    patch_of = np.full(total, NO_PRIMITIVE, np.uint32)
    found = [np.zeros((0, 2), np.uint32)]
    seen: set[int] = set()
    instance = count = 0
    for body in accelerator.bodies:
        key = id(body.geometry)
        if key not in seen and len(body.positions):
            seen.add(key)
            solids = len(body.geometry.spheres) + len(body.geometry.rods)
            primitives = pack_geometry(body.geometry).primitives[:solids]
            primitives = primitives + np.uint32(accelerator.first_slots[key])
            found.append(np.stack([primitives, np.full(solids, instance, np.uint32)], 1))
            slots = primitives & np.uint32(0x1FFFFFFF)
            patch_of[slots] = count + np.arange(solids, dtype=np.uint32)
            count += solids
        instance += len(body.positions)
    return np.concatenate(found), patch_of
