"""Occlusion and shadows precomputed over a volume, where the rays of the picture will read them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from scuro.gpu import Gpu, Recorder
from scuro.passes.pieces import PIECE
from scuro.passes.volume.cone_sections import cone_sections
from scuro.passes.volume.grid import VolumeGrid
from scuro.passes.volume.pyramid import Pyramid
from scuro.passes.volume.scaling import scaled_view
from scuro.passes.volume.settings import PEERS, VolumeSettings

BRICK = 4
"""Edge in texels of the bricks in which light is made (illuminate.wgsl has the same)."""

MARK_SCALE = 2.0
"""Rays that look for the bricks to light are cast for one pixel in so many along each side, or for
parts of pixels that are wider than the light's texels."""

MARK_APART = 1.5
"""Texels of the light that these rays lie apart at most: mark.wgsl marks half as many about each
of them."""

MOST_MARKING = 1 << 21
"""More rays than these cost more than the light they spare: all of it is made."""

LISTED_A_ROW = 65536
"""Threads along x of the pass that lists bricks."""

LEAST_LIGHT = math.exp(-6)
"""Share of light below which cones are not followed farther."""

MOST_ITERATIONS = 50_000
"""Iterations of loops in one invocation: lavapipe ends every loop after 65,535 in all, silently."""

FIRST_BRICKS = 256
"""Bricks of the first piece, where somebody waits beside."""

LIGHT_GROUPS = 1024
"""Workgroups that share the bricks to light, if that is not too much for one."""


def cone_kinds(
    grid: VolumeGrid, pyramid: Pyramid, settings: VolumeSettings
) -> list[dict[str, Any]]:
    """The ``Cone`` structs of cone.wgsl: of occlusion and of shadows."""
    kinds = []
    for chosen in (settings.occlusion, settings.shadow):
        sections = cone_sections(
            chosen.angle,
            chosen.length * grid.diagonal / grid.voxel,
            sigma=pyramid.sigma,
            gap=chosen.gap,
            most_cones=chosen.cones,
            levels=pyramid.levels,
            constant_exact=settings.constant_exact,
        )
        kinds.append(
            {
                "counts": sections.counts,
                "sigma": pyramid.sigma,
                "starts": sections.starts,
                "tangent": sections.tangent,
                "attenuation": chosen.attenuation,
                "reach": chosen.length * grid.diagonal,
                "parts": sections.parts,
                "correlation": chosen.correlation,
                "opaque": largest_depth(chosen.correlation),
                "sections": sections.table,
            }
        )
    return kinds


def largest_depth(correlation: float) -> float:
    """Optical depth beyond which less light than :data:`LEAST_LIGHT` gets through a cone."""
    if correlation == 0:
        return -math.log(LEAST_LIGHT)
    return (LEAST_LIGHT**-correlation - 1) / correlation


def iterations(kinds: list[dict[str, Any]], resources: Mapping[str, Any]) -> int:
    """Iterations of loops, at most, for the light of one point: of cones, or of peers' steps."""
    lights = sum(light["shadow"] >= 0 for light in resources["lights"]["list"])
    counts = [sum(n * k for n, k in zip(kind["counts"], (1, 3, 7), strict=True)) for kind in kinds]
    # peers take a step a voxel near the apex of narrow cones
    counts = [max(n, int(kind["reach"] / resources["volume"]["voxel"]))
              for n, kind in zip(counts, kinds, strict=True)]  # fmt: skip
    return 32 + counts[0] + lights * counts[1]


def light_constants(settings: VolumeSettings) -> dict[str, Any]:
    """Constants of illumination.wgsl."""
    return {
        "OCCLUSION": settings.occlusion.on,
        "SHADOWS": settings.shadow.on,
        "METHOD": PEERS.get(settings.light, 0),
        "LOCAL_RADIUS": settings.radius,
    }


def mark_scale(
    view: Mapping[str, Any], volume: Mapping[str, Any], texels: tuple[int, int, int]
) -> float:
    """Pixels between rays that look for the bricks to light, along each side of the picture.

    Args:
        view: The ``View`` uniform.
        volume: The ``Volume`` uniform.
        texels: Of the light.
    """
    corners = np.array([[x, y, z, 1.0] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    view_from_texture = np.asarray(view["view_from_scene"]) @ volume["scene_from_texture"]
    far = 1.0 if view["orthographic"] else float(-(corners @ view_from_texture.T)[:, 2].min())
    pixel = 2 * view["half_extent"][1] / view["size"][1] * far
    edges = np.linalg.norm(np.asarray(volume["scene_from_texture"])[:3, :3], axis=0)
    texel = float((edges / texels).min())
    return min(MARK_SCALE, MARK_APART * texel / max(pixel, 1e-30))


class LightTexture:
    """Visibility and the shadows of three lights over a volume (Campagnolo 2021, 3.3.3).

    Args:
        gpu: Where to put it.
        texels: Along x, y, z.
    """

    def __init__(self, gpu: Gpu, texels: tuple[int, int, int]) -> None:
        self.gpu = gpu
        self.texels = texels
        self.texture = gpu.texture(texels, "rgba16float", dimension="3d", label="volume light")
        self.bricks = tuple(-(-n // BRICK) for n in texels)
        count = int(np.prod(self.bricks))
        self._marks = gpu.buffer(4 * count, label="light marks")
        self._wanted = gpu.buffer(4 + 4 * count, label="bricks to light")

    @staticmethod
    def texels_for(grid: VolumeGrid, settings: VolumeSettings) -> tuple[int, int, int]:
        """Texels of the light of a volume."""
        x, y, z = (max(1, round(n * settings.light_resolution)) for n in grid.size)
        return x, y, z

    def make(
        self,
        record: Recorder,
        resources: Mapping[str, Any],
        settings: VolumeSettings,
        size: tuple[int, int],
        constants: Mapping[str, Any],
        marks: Any = None,
        breathe: Callable[[float], None] | None = None,
    ) -> None:
        """Record the light of all bricks, or of those that the picture's rays read.

        Args:
            record: Where to.
            resources: What march.wgsl and cone.wgsl want bound.
            settings: Of the volume.
            size: Width and height of the picture.
            constants: ``ISOSURFACE`` as the picture has it.
            marks: Buffer with a word that is not 0 for every brick to light, where that is known.
            breathe: Called between pieces of what takes long, with the share that is done; all that
                is recorded is then submitted.
        """
        fields = {"size": self.texels, "width": self.bricks[0], "height": self.bricks[1]}
        everywhere = settings.light_all and marks is None
        if marks is None and not everywhere:
            scale = mark_scale(resources["view"], resources["volume"], self.texels)
            everywhere = math.prod(size) > MOST_MARKING * scale**2
            if not everywhere:
                record.clear_buffer(self._marks)
                self._mark(record, resources, fields, size, constants, scale)
        count = int(np.prod(self.bricks))
        resources = {
            **resources,
            "bricks": {
                **fields,
                "depth": self.bricks[2],
                "all_bricks": int(everywhere),
                "first": 0,
                "end": count,
            },
            "marks": self._marks if marks is None else marks,
            "wanted": self._wanted,
            "illuminated": self.texture,
        }
        chosen = light_constants(settings) | {"LIGHT_COUNT": resources["lights"]["count"]}
        shader = "passes/volume/illuminate.wgsl"
        record.clear_buffer(self._wanted)
        listing = (LISTED_A_ROW, -(-count // LISTED_A_ROW))
        record.compute(shader, "list_bricks", listing, resources, chosen, label="volume marks")
        most = MOST_ITERATIONS // iterations(resources["cones"]["kinds"], resources)
        groups = max(min(LIGHT_GROUPS, count), min(-(-count // max(most, 1)), 65535))

        def light(first: int, end: int) -> None:
            some = resources | {"bricks": resources["bricks"] | {"first": first, "end": end}}
            threads = (BRICK * min(groups, end - first), BRICK, BRICK)
            record.compute(shader, "main", threads, some, chosen, label="volume light")

        if breathe is None:
            light(0, count)
            return
        record.flush()
        total = int(self.gpu.read_buffer(self._wanted, np.uint32)[0])
        done, bricks = 0, FIRST_BRICKS
        while done < total:
            end = min(done + bricks, total)
            start = time.perf_counter()
            light(done, end)
            record.flush()
            self.gpu.finish()
            seconds = max(time.perf_counter() - start, 1e-6)
            bricks = max(1, min(round((end - done) * PIECE / seconds), 4 * bricks))
            done = end
            breathe(done / total)

    def _mark(
        self,
        record: Recorder,
        resources: Mapping[str, Any],
        fields: dict[str, Any],
        size: tuple[int, int],
        constants: Mapping[str, Any],
        scale: float,
    ) -> None:
        width, height = (math.ceil(n / scale) for n in size)
        march = resources["march"] | {
            "width": width,
            "height": height,
            "surface_scale": scale * np.asarray(resources["march"]["surface_scale"]),
        }
        view = scaled_view(dict(resources["view"]), 1 / np.array((scale, scale)))
        record.compute(
            "passes/volume/mark.wgsl",
            "main",
            (width, height),
            {**resources, "view": view, "march": march, "bricks": fields, "marks": self._marks},
            {"ISOSURFACE": constants["ISOSURFACE"]},
            label="volume marks",
        )
