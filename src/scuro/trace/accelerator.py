"""The acceleration structure: uniform grids over primitives, under one over instances.

A geometry that several bodies share is kept once.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu
from scuro.scene.camera import Camera
from scuro.scene.clip import MAX_PLANES, Clip
from scuro.scene.geometry import Body
from scuro.steps import finished, in_thread, scaled
from scuro.trace.build import build_grids
from scuro.trace.grids import GRID, GridPlan, Growth, plan_grids, weighted_median
from scuro.trace.objects import object_table
from scuro.trace.pack import PackedGeometry, pack_bodies
from scuro.trace.placement import Placement, place
from scuro.trace.table import filled_in_steps, table, table_bytes


@dataclass(eq=False)
class Accelerator:
    """A scene on the GPU, ready to be traced: resources and constants of ``wgsl/scene.wgsl``."""

    resources: dict[str, Any]
    constants: dict[str, float]
    bytes: int
    """GPU memory held."""
    instances: int
    primitives: int
    """Primitives stored (each geometry once)."""
    spheres: int
    """Spheres drawn, instances counted."""
    center: NDArray[np.float64]
    extent: float
    """Radius of the scene: half the diagonal of its box."""
    primitive_radius: float
    """Median radius of spheres and rods: the scale of occlusion distances and penumbras."""
    bodies: tuple[Body, ...]
    packed: dict[int, PackedGeometry]
    """By ``id(geometry)``."""
    first_slots: dict[int, int]
    """By ``id(geometry)``: its first slot in ``slots``."""
    cluster_runs: tuple[tuple[int, int, int, int], ...]
    """For each body outside assemblies: first instance, instances, first cluster, clusters."""
    whole_runs: tuple[tuple[int, int], ...]
    """Runs of instances that the grid over the scene lists: first and number."""
    frame_run: tuple[int, int]
    """The same of assemblies' frames alone."""
    scene: dict[str, Any]
    """Field values of the ``scene`` uniform, but for the clipping planes."""
    _grown: tuple[Growth, dict[str, Any]] | None = None

    @property
    def cluster_instances(self) -> int:
        """Clusters drawn, instances counted."""
        return sum(copies * clusters for _, copies, _, clusters in self.cluster_runs)

    def detail_for(self, camera: Camera, height: int, pixels: float) -> dict[str, Any]:
        """Fields of the ``scene`` uniform that choose levels of detail.

        Args:
            camera: Where distances are measured from.
            height: Of the picture, in pixels.
            pixels: Largest diameter of a merged sphere on the picture; 0 for single atoms always.
        """
        radius = pixels * camera.half_height() / height
        slope, floor = (0.0, radius) if camera.orthographic else (radius, 0.0)
        eye = np.asarray(camera.position) - self.center
        return {"eye": eye, "detail_slope": slope, "detail_floor": floor}

    def clipped(self, clip: Clip) -> tuple[dict[str, Any], dict[str, float]]:
        """Resources and constants with a clip's planes in place: nothing is rebuilt."""
        planes = clip.equations()
        planes[:, 3] += planes[:, :3] @ self.center
        spared = any(not body.clipped for body in self.bodies)
        uniform = self.scene | {
            "planes": planes if len(planes) else np.zeros((MAX_PLANES, 4)),
            "plane_count": len(planes),
            "spared": int(spared),
        }
        return self.resources | {"scene": uniform}, self.constants | {"CLIPPED": bool(len(planes))}

    def grown(self, gpu: Gpu, growth: Growth) -> dict[str, Any]:
        """Resources with grids that list all solids as if they were larger.

        For queries of what a ray passes closely. Built when first asked for, kept until another
        growth is; ``scene`` holds only the field that differs.
        """
        return finished(self.grown_in_steps(gpu, growth))

    def grown_in_steps(self, gpu: Gpu, growth: Growth) -> Generator[float, None, dict[str, Any]]:
        """The same in short steps; yields the share that is done."""
        if self._grown is None or self._grown[0] != growth:
            self._grown = None  # frees the old ones first

            def lay_out() -> tuple[Placement, GridPlan, NDArray]:
                placement = place(self.bodies, self.center, self.packed)
                plan = plan_grids(self.bodies, self.packed, placement, self.center, growth)
                return placement, plan, object_table(self.bodies, self.packed, plan, placement)

            placement, plan, objects = yield from in_thread(lay_out)
            resources, fields = yield from build_grids(
                gpu, plan, self.resources["slots"], self.resources["instances"]
            )
            resources["objects"] = table(gpu, objects.view(np.uint32).reshape(-1, 4), "objects")
            resources["scene"] = {
                "top": _top(objects, plan, placement),
                "reach": plan.farthest,
                **fields,
            }
            self._grown = (growth, resources)
        return self._grown[1]


def build_accelerator(
    gpu: Gpu, bodies: Sequence[Body], center: NDArray, *, bounds: NDArray | None = None
) -> Accelerator:
    """Upload bodies and build their grids, all at once: see :func:`build_in_steps`."""
    return finished(build_in_steps(gpu, bodies, center, bounds=bounds))


def build_in_steps(
    gpu: Gpu, bodies: Sequence[Body], center: NDArray, *, bounds: NDArray | None = None
) -> Generator[float, None, Accelerator]:
    """Upload bodies and build their grids, in steps of some hundredths of a second.

    Args:
        gpu: Where to. Steps are handed to it without waiting for their end.
        bodies: What is to be traced; empty ones are allowed.
        center: World position that becomes the origin of scene space.
        bounds: (2, 3) world box of the whole scene, other data included; the bodies' by default.

    Yields:
        The share that is done.
    """

    def lay_out() -> tuple[dict[int, PackedGeometry], Placement, GridPlan, NDArray]:
        packed = pack_bodies(bodies)
        placement = place(bodies, center, packed)
        plan = plan_grids(bodies, packed, placement, center)
        return packed, placement, plan, object_table(bodies, packed, plan, placement)

    packed, placement, plan, objects = yield from in_thread(lay_out)
    slot_table = yield from scaled(
        filled_in_steps(gpu, [p.slots for p in packed.values()], "rgba32float", "primitives"),
        0.1, 0.3,
    )  # fmt: skip
    attributes = yield from scaled(
        filled_in_steps(gpu, [p.attributes for p in packed.values()], "rgba32uint", "attributes"),
        0.3, 0.45,
    )  # fmt: skip
    resources = {
        "slots": slot_table,
        "attributes": attributes,
        "objects": table(gpu, objects.view(np.uint32).reshape(-1, 4), "objects"),
    }
    instances = yield from scaled(placement.upload(gpu), 0.45, 0.5)
    grids, fields = yield from scaled(build_grids(gpu, plan, slot_table, instances), 0.5, 1.0)
    resources |= {"instances": instances, **grids}
    single = placement.single
    clusters, runs = _clusters(bodies, packed, placement)
    resources["clusters"] = gpu.buffer(clusters, label="clusters")
    if bounds is None:
        boxes = [b.bounds for b in bodies if len(b.positions) and len(b.geometry)]
        bounds = (
            np.stack([np.min([b[0] for b in boxes], 0), np.max([b[1] for b in boxes], 0)])
            if boxes
            else np.zeros((2, 3))
        )
    extent = float(np.linalg.norm(bounds[1] - bounds[0]) / 2)
    # triangles have no radius: a cartoon takes its scale from the sticks and spheres beside it
    sized = [b for b in bodies if packed[id(b.geometry)].median_radius > 0]
    primitive_radius = (
        weighted_median(
            [packed[id(b.geometry)].median_radius for b in sized],
            [len(packed[id(b.geometry)].primitives) * b.instances for b in sized],
        )
        if sized
        else extent / 100
    )
    return Accelerator(
        resources=resources,
        constants={
            "HAS_RODS": any(p.has_rods for p in packed.values()),
            "HAS_TRIANGLES": any(p.has_triangles for p in packed.values()),
            "HAS_TOP_LEVEL": placement.single is None,
            "HAS_OPACITY": any(b.material.opacity < 1 for b in bodies),
            "HAS_NESTING": bool(placement.assemblies),
            "HAS_LEVELS": any(b.geometry.levels for b in bodies),
            **placement.encoding.constants,
        },
        bytes=sum(table_bytes(t) for n, t in resources.items() if n != "clusters"),
        instances=sum(b.instances for b in bodies),
        primitives=sum(len(p.primitives) for p in packed.values()),
        spheres=sum(len(b.geometry.spheres) * b.instances for b in bodies),
        center=np.asarray(center, np.float64),
        extent=extent,
        primitive_radius=primitive_radius,
        bodies=tuple(bodies),
        packed=packed,
        first_slots=plan.first_slots,
        cluster_runs=runs,
        whole_runs=placement.listed[0],
        frame_run=(len(placement) - placement.frames, placement.frames),
        scene={
            "top": _top(objects, plan, placement),
            "rotation": (0, 0, 0, 1) if single is None else single.rotations[0],
            "center": (0, 0, 0) if single is None else single.centers(0, 1)[0],
            "extent": extent,
            "primitive_radius": primitive_radius,
            "eye": (0.0, 0.0, 0.0),
            "detail_slope": 0.0,
            "detail_floor": 0.0,
            **placement.encoding.uniform(),
            "inner_step": placement.encoding.steps[1],
            "reach": plan.farthest,
            **fields,
        },
    )


def _top(objects: NDArray, plan: GridPlan, placement: Placement) -> dict[str, Any]:
    """The grid where rays start: a single instance needs none above its own."""
    single = placement.single
    top = plan.grids[0] if single is None else objects[single.number]["grid"]
    return {name: top[name] for name in GRID.names or ()}


def _clusters(
    bodies: Sequence[Body], packed: dict[int, PackedGeometry], placement: Placement
) -> tuple[NDArray[np.float32], tuple[tuple[int, int, int, int], ...]]:
    """Bounding spheres of all geometries' clusters, and where each body finds its own."""
    firsts: dict[int, int] = {}
    tables, total = [np.zeros((1, 4), np.float32)], 1
    runs = []
    for index, body in enumerate(bodies):
        key = id(body.geometry)
        clusters = packed[key].clusters
        if key not in firsts:
            firsts[key] = total
            tables.append(clusters)
            total += len(clusters)
        if len(clusters) and len(body.positions) and body.frames is None:
            row = placement.runs[index].first
            runs.append((row, len(body.positions), firsts[key], len(clusters)))
    return np.concatenate(tables), tuple(runs)
