"""One volume's picture: space skipping, pyramid, light and ray casting, kept while unchanged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu, Recorder
from scuro.passes.volume.classify import Classified
from scuro.passes.volume.cone_sections import ConeSections, cone_sections
from scuro.passes.volume.grid import VolumeGrid
from scuro.passes.volume.pyramid import Pyramid
from scuro.passes.volume.settings import VolumeSettings
from scuro.passes.volume.solids import solid_fraction, texels_for
from scuro.reference.volume_cones import draw_monte_carlo
from scuro.scene.clip import Clip
from scuro.scene.geometry import Body
from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction

BRICK = 4
"""Edge in texels of the bricks in which precomputed light is made (illuminate.wgsl)."""

MARK_SCALE = 2
"""Rays that look for the bricks to light are cast for one pixel in so many along each side."""


LISTED_A_ROW = 65536
"""Threads along x of the pass that lists bricks."""

LIGHT_GROUPS = 1024
"""Workgroups that share the bricks to light."""


@dataclass
class VolumePicture:
    """Everything of one volume that outlives a frame.

    Built on first use and rebuilt piece by piece as its inputs change: the grid with the data, the
    classification with the transfer function, the pyramid with both and the clipping.
    """

    gpu: Gpu
    volume: Volume
    center: NDArray

    def __post_init__(self) -> None:
        self.grid = VolumeGrid(self.gpu, self.volume, self.center)
        self._kept: dict[str, tuple[Any, Any]] = {}

    def _keep(self, name: str, key: Any, make: Any) -> Any:
        """The value made last under ``name`` if its key is the same, else a new one."""
        kept = self._kept.get(name)
        if kept is None or kept[0] != key:
            self._kept.pop(name, None)  # free the old one before making the new one
            self._kept[name] = kept = (key, make())
        return kept[1]

    def classified(self, transfer: TransferFunction, settings: VolumeSettings) -> Classified:
        """Tables and empty space of a transfer function."""
        key = (transfer, settings.step, settings.iso)
        return self._keep(
            "classified", key, lambda: Classified(self.grid, transfer, settings.step, settings.iso)
        )

    def uniform(self, settings: VolumeSettings, clip: Clip, classified: Classified) -> dict:
        """The ``Volume`` uniform."""
        return self.grid.uniform(settings.step, clip, self.center, classified.table_end)

    def pyramid(
        self, classified: Classified, settings: VolumeSettings, clip: Clip, solids: Any = None
    ) -> Pyramid:
        """The extinction pyramid for the current transfer function and clipping."""
        key = (id(classified), settings.sigma, settings.coefficients, clip, id(solids))
        return self._keep(
            "pyramid" if solids is None else "pyramid with solids",
            key,
            lambda: Pyramid(
                classified,
                self.uniform(settings, clip, classified),
                sigma=settings.sigma,
                factor=settings.coefficients,
                solids=solids,
            ),
        )

    def sections(self, settings: VolumeSettings, pyramid: Pyramid, kind: str) -> ConeSections:
        """Samples of the occlusion or shadow cones."""
        chosen = getattr(settings, kind)
        return cone_sections(
            chosen.angle,
            chosen.length * self.grid.diagonal / self.grid.voxel,
            sigma=pyramid.sigma,
            gap=chosen.gap,
            most_cones=chosen.cones,
            levels=pyramid.levels,
            constant_exact=settings.constant_exact,
        )

    def cones(self, settings: VolumeSettings, pyramid: Pyramid) -> dict[str, Any]:
        """What cone.wgsl wants bound besides the volume."""
        kinds = []
        for kind in ("occlusion", "shadow"):
            sections = self.sections(settings, pyramid, kind)
            chosen = getattr(settings, kind)
            kinds.append(
                {
                    "counts": sections.counts,
                    "sigma": pyramid.sigma,
                    "starts": sections.starts,
                    "tangent": sections.tangent,
                    "attenuation": chosen.attenuation,
                    "reach": chosen.length * self.grid.diagonal,
                    "parts": sections.parts,
                    "pad": 0,
                    "sections": sections.table,
                }
            )
        return {"pyramid": pyramid.texture, "cones": {"kinds": kinds}}

    def illuminated(
        self, record: Recorder, resources: dict[str, Any], settings: VolumeSettings,
        size: tuple[int, int], constants: dict[str, Any],
    ) -> Any:  # fmt: skip
        """Precompute occlusion and shadows over the volume, where the picture's rays read them."""
        texels = tuple(max(1, round(n * settings.light_resolution)) for n in self.grid.size)
        texture = self._keep(
            "light",
            texels,
            lambda: self.gpu.texture(texels, "rgba16float", dimension="3d", label="volume light"),
        )
        bricks = tuple(-(-n // BRICK) for n in texels)
        marks = self._keep(
            "marks", bricks, lambda: self.gpu.buffer(4 * int(np.prod(bricks)), label="light marks")
        )
        wanted = self._keep(
            "wanted", bricks, lambda: self.gpu.buffer(4 + 4 * int(np.prod(bricks)), label="bricks")
        )
        fields = {"size": texels, "width": bricks[0], "height": bricks[1]}
        if not settings.light_all:
            record.clear_buffer(marks)
            small = tuple(-(-n // MARK_SCALE) for n in size)
            view = dict(resources["view"])
            view["size"] = tuple(n / MARK_SCALE for n in view["size"])
            view["origin"] = tuple(n / MARK_SCALE for n in view["origin"])
            march = resources["march"] | {"width": small[0], "height": small[1]}
            record.compute(
                "passes/volume/mark.wgsl",
                "main",
                small,
                {**resources, "view": view, "march": march, "bricks": fields, "marks": marks},
                {"ISOSURFACE": constants["ISOSURFACE"]},
                label="volume marks",
            )
        resources = {
            **resources,
            "bricks": {**fields, "depth": bricks[2], "all_bricks": int(settings.light_all)},
            "marks": marks,
            "wanted": wanted,
            "illuminated": texture,
        }
        chosen = {"OCCLUSION": settings.occlusion.on, "SHADOWS": settings.shadow.on}
        record.clear_buffer(wanted)
        shader = "passes/volume/illuminate.wgsl"
        rows = -(-int(np.prod(bricks)) // LISTED_A_ROW)
        record.compute(
            shader, "list_bricks", (LISTED_A_ROW, rows), resources, chosen, label="volume marks"
        )
        groups = min(LIGHT_GROUPS, int(np.prod(bricks)))
        record.compute(
            shader, "main", (BRICK * groups, BRICK, BRICK), resources, chosen, label="volume light"
        )
        return texture

    def solids(self, bodies: Sequence[Body]) -> Any:
        """A texture over the volume that is 1 where surfaces fill space; None without surfaces."""
        if not bodies:
            return None
        size = texels_for(self.grid.size)
        world_from_scene = np.eye(4)
        world_from_scene[:3, 3] = -np.asarray(self.center)
        matrix = self.grid.texture_from_scene @ world_from_scene
        return self._keep(
            "solids",
            tuple(map(id, bodies)),
            lambda: self.gpu.texture_from(
                solid_fraction(bodies, matrix, size), "r16float", dimension="3d"
            ),
        )

    def light_surfaces(
        self,
        record: Recorder,
        settings: VolumeSettings,
        transfer: TransferFunction,
        *,
        view: dict[str, Any],
        lights: dict[str, Any],
        size: tuple[int, int],
        surface: Any,
        out: Any,
        clip: Clip,
    ) -> None:
        """Record how much light the volume's matter leaves to each pixel's surface.

        Args:
            surface: The G-buffer's ``surface`` texture.
            out: r32float texture, 1 where nothing is taken; see :meth:`draw` for the others.
        """
        classified = self.classified(transfer, settings)
        pyramid = self.pyramid(classified, settings, clip)
        record.compute(
            "passes/volume/on_surfaces.wgsl",
            "main",
            size,
            {
                **classified.resources(),
                **self.cones(settings, pyramid),
                "volume": self.uniform(settings, clip, classified),
                "view": view,
                "lights": lights,
                "surface": surface,
                "surface_light": out,
            },
            {"OCCLUSION": settings.occlusion.on, "SHADOWS": settings.shadow.on},
            label="volume on surfaces",
        )

    def draw(
        self,
        record: Recorder,
        settings: VolumeSettings,
        transfer: TransferFunction,
        *,
        view: dict[str, Any],
        lights: dict[str, Any],
        size: tuple[int, int],
        color: Any,
        depth: Any,
        clip: Clip | None = None,
        surface: Any = None,
        solids: Any = None,
    ) -> None:
        """Record the volume's picture.

        Args:
            record: Where to.
            settings: How.
            transfer: Colour and opacity.
            view: The ``View`` uniform.
            lights: The ``Lights`` uniform; layers 0 to 2 cast shadows.
            size: Width and height of the picture (or tile).
            color: rgba16float texture for premultiplied linear colour and opacity.
            depth: r32float texture for the depth of half the opacity.
            clip: Half-spaces to keep.
            surface: The G-buffer's ``surface`` texture, whose depths stop rays.
            solids: Texture that is 1 where surfaces fill space, for cones to see them.
        """
        clip = clip or Clip()
        classified = self.classified(transfer, settings)
        lighted = settings.occlusion.on or settings.shadow.on
        resources = {
            **classified.resources(),
            "view": view,
            "lights": lights,
            "volume": self.uniform(settings, clip, classified),
            "march": {
                "cutoff": settings.cutoff,
                "jitter": settings.jitter,
                "iso": classified.iso or 0.0,
                "width": size[0],
                "height": size[1],
            },
            "shading": {
                "phong": int(settings.shading == "phong"),
                "diffuse": 1.0,
                "specular": settings.specular,
                "shininess": settings.shininess,
                "flat": 0.02,
                "shadows": int(settings.shadow.on),
            },
            "surface": surface or self._keep("no surface", 0, self._no_surface),
            "volume_color": color,
            "volume_depth": depth,
            "illuminated": self._keep("no light", 0, self._no_light),
        }
        constants = {"ISOSURFACE": settings.iso is not None, "SURFACES": surface is not None}
        chosen = {"OCCLUSION": settings.occlusion.on, "SHADOWS": settings.shadow.on}
        if lighted and settings.light == "monte-carlo":
            sums = self._keep(
                "sums", size, lambda: self.gpu.buffer(16 * size[0] * size[1], label="volume truth")
            )
            draw_monte_carlo(
                record, resources, {**constants, **chosen}, self.grid, settings, size, sums
            )
            return
        if lighted:
            pyramid = self.pyramid(classified, settings, clip, solids)
            resources |= self.cones(settings, pyramid)
        if lighted and settings.light == "image":
            record.compute(
                "passes/volume/raycast_cones.wgsl",
                "main",
                size,
                resources,
                {**constants, **chosen},
                label="volume",
            )
            return
        if lighted:
            resources["illuminated"] = self.illuminated(
                record, resources, settings, size, constants
            )
        record.compute(
            "passes/volume/raycast.wgsl",
            "main",
            size,
            resources,
            {**constants, "ILLUMINATED": lighted},
            label="volume",
        )

    def _no_surface(self) -> Any:
        return self.gpu.texture((1, 1), "rgba32float")

    def _no_light(self) -> Any:
        return self.gpu.texture((1, 1, 1), "rgba16float", dimension="3d")
