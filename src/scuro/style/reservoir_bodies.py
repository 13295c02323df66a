"""Opaque parts of a reservoir: cells, slices, isosurfaces, faults, edges and wells."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.cornerpoint_faces import Faces, fault_faces, isosurface, outer_faces
from scuro.scene.cornerpoint_topology import vertex_values
from scuro.scene.geometry import Body, Geometry, Material
from scuro.style.reservoir import item_transfer
from scuro.style.reservoir_options import parse_slices

if TYPE_CHECKING:
    from scuro.scene.reservoir import ReservoirItem

_NO_VALUE = (150, 150, 150, 255)
_EDGE = (40, 40, 46, 255)
_FAULT = (150, 52, 40, 255)
_WELLS = {
    "producer": (40, 150, 70, 255),
    "water injector": (30, 100, 215, 255),
    "gas injector": (205, 60, 45, 255),
}
_OTHER_WELL = (110, 110, 115, 255)
EDGE_RADIUS = 6e-4
EDGE_SHARE = 0.06
CLEAR_EDGES = 10
"""Edges are drawn unasked where their rods' diameter fits in an edge of a cell so many times."""
"""Edges are no thicker than this share of the narrowest way across their faces."""
WELL_RADIUS = 2e-3
"""Of the model's diagonal."""
WELL_HEAD = 0.15
"""Wells rise so far above the model, in its heights."""
_MATTE = Material(specular=0.08, shininess=20)


def reservoir_bodies(item: ReservoirItem) -> list[Body]:
    """The bodies that an item's settings ask for.

    Raises:
        SettingsError: A property, step or slice does not exist.
    """
    grid, settings = item.grid, item.settings
    name, e = grid.name, item.exaggeration
    chosen = np.zeros(grid.active.shape, bool)
    lines = _edges_show(item) if settings.lines is None else settings.lines
    if item.show != "volume" or settings.faults or lines:
        chosen[grid.active] = item.chosen()
    bodies = []
    passing = chosen
    if item.show == "slices":
        chosen = chosen & layers_mask(item)
    if item.show in ("cells", "slices"):
        faces = outer_faces(grid, chosen, e)
        bodies.append(_body(_quads(faces, _cell_colors(item, faces.cells)), f"{name} cells"))
    else:
        faces = None
    if item.show == "iso":
        bodies.append(_iso_body(item, chosen))
    if settings.faults:
        split = fault_faces(grid, passing, e)
        colors = np.tile(np.array(_FAULT, np.uint8), (len(split.cells), 1))
        bodies.append(_body(_quads(split, colors), f"{name} faults"))
    if lines:
        shell = faces if faces is not None else outer_faces(grid, chosen, e)
        bodies.append(_body(_edges(shell, _diagonal(item) * EDGE_RADIUS), f"{name} edges"))
    if settings.wells and grid.wells:
        bodies.append(_body(_wells(item), f"{name} wells"))
    return [body for body in bodies if len(body.geometry)]


def _body(parts: tuple[Geometry, NDArray], name: str) -> Body:
    geometry, origin = parts
    return Body(
        geometry, positions=origin[None], name=name, path=(name,), material=_MATTE, closed=False
    )


def _diagonal(item: ReservoirItem) -> float:
    low, high = item.bounds
    return float(np.linalg.norm(high - low))


def _edges_show(item: ReservoirItem) -> bool:
    """Whether edges set cells apart instead of covering them."""
    (low, high), (ni, nj, _) = item.grid.bounds, item.grid.dimensions
    across = math.sqrt(float(np.prod(high[:2] - low[:2])) / (ni * nj))
    opaque = item.show in ("cells", "slices")
    return opaque and across > CLEAR_EDGES * 2 * EDGE_RADIUS * _diagonal(item)


def layers_mask(item: ReservoirItem) -> NDArray[np.bool_]:
    """(nk, nj, ni) cells of the layers that ``slices`` names, the middle one by default."""
    ni, nj, nk = item.grid.dimensions
    wanted = parse_slices(item.settings.slices) or [(2, (nk + 1) // 2)]
    mask = np.zeros((nk, nj, ni), bool)
    for axis, number in wanted:
        if number > (ni, nj, nk)[axis]:
            raise SettingsError(
                f"there is no slice {'ijk'[axis]}{number}: the model has {ni} x {nj} x {nk} cells"
            )
        place: list[slice | int] = [slice(None)] * 3
        place[2 - axis] = number - 1
        mask[tuple(place)] = True
    return mask


def _cell_colors(item: ReservoirItem, cells: NDArray) -> NDArray[np.uint8]:
    """(n, 4) colours of cells by the property shown."""
    values = item.values()[item.grid.active_index.ravel()[cells]]
    rgb = item_transfer(item).color(np.nan_to_num(values))
    colors = np.full((len(cells), 4), 255, np.uint8)
    colors[:, :3] = np.rint(rgb * 255)
    colors[~np.isfinite(values)] = _NO_VALUE
    return colors


def _local(points: NDArray) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Points about their middle, and the middle: map coordinates need more than 32 bits."""
    if len(points) == 0:
        return points.astype(np.float32), np.zeros(3)
    flat = points.reshape(-1, points.shape[-1])[:, :3]
    origin = (flat.min(axis=0) + flat.max(axis=0)) / 2
    moved = points.copy()
    moved[..., :3] -= origin
    return moved.astype(np.float32), origin


def _quads(faces: Faces, colors: NDArray) -> tuple[Geometry, NDArray]:
    triangles = faces.corners[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3, 3)
    normal = np.cross(
        faces.corners[:, 2] - faces.corners[:, 0], faces.corners[:, 3] - faces.corners[:, 1]
    )
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    local, origin = _local(triangles)
    return (
        Geometry(
            triangles=local,
            triangle_normals=np.repeat(normal, 6, axis=0).reshape(-1, 3, 3).astype(np.float32),
            triangle_colors=np.repeat(colors, 6, axis=0).reshape(-1, 3, 4),
            triangle_ids=np.repeat(faces.cells, 6).reshape(-1, 3).astype(np.int32),
        ),
        origin,
    )


def _iso_body(item: ReservoirItem, chosen: NDArray) -> Body:
    grid = item.grid
    values = item.values()
    finite = values[np.isfinite(values)]
    iso = item.settings.iso
    if iso is None:
        iso = float((finite.min() + finite.max()) / 2) if len(finite) else 0.0
    shown = np.where(item.chosen(), values, np.nan)
    triangles, cells = isosurface(grid, vertex_values(grid, shown), chosen, iso, item.exaggeration)
    rgb = np.rint(item_transfer(item).color(np.array([iso]))[0] * 255)
    colors = np.broadcast_to(np.array([*rgb, 255], np.uint8), (len(triangles), 3, 4))
    local, origin = _local(triangles)
    geometry = Geometry(
        triangles=local,
        triangle_normals=_smooth_normals(local),
        triangle_colors=np.ascontiguousarray(colors),
        triangle_ids=np.repeat(cells, 3).reshape(-1, 3).astype(np.int32),
    )
    return _body((geometry, origin), f"{grid.name} {item.shown_property} {iso:g}")


def _smooth_normals(triangles: NDArray[np.float32]) -> NDArray[np.float32]:
    """Unit normals at vertices: the mean over all triangles that share the vertex, by area."""
    if len(triangles) == 0:
        return np.zeros_like(triangles)
    flat = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    grain = float(np.ptp(triangles.reshape(-1, 3), axis=0).max()) * 1e-6 + 1e-12
    keys = np.rint(triangles.reshape(-1, 3) / grain).astype(np.int64)
    _, index = np.unique(keys, axis=0, return_inverse=True)
    index = index.ravel()
    sums = np.stack(
        [np.bincount(index, weights=np.repeat(flat[:, c], 3)) for c in range(3)], axis=1
    )[index]
    sums = sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-30)
    return sums.reshape(triangles.shape).astype(np.float32)


def _edges(faces: Faces, widest: float) -> tuple[Geometry, NDArray]:
    """Thin rods along the faces' edges, each edge once; thinner where cells are flat."""
    local, origin = _local(faces.corners)
    ends = np.stack([local, np.roll(local, -1, axis=1)], axis=2)
    across = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=-1)
    narrow = (across + np.roll(across, 2, axis=1)).min(axis=1) / 2
    thick = np.repeat(np.minimum(widest, EDGE_SHARE * narrow), 4)
    ends = ends.reshape(-1, 2, 3)
    keys = np.rint(ends / (widest * 0.2)).astype(np.int64)
    swapped = (keys[:, 0] > keys[:, 1]).any(axis=1) & (keys[:, 0].sum(1) > keys[:, 1].sum(1))
    keys[swapped] = keys[swapped][:, ::-1]
    _, first, which = np.unique(keys.reshape(-1, 6), axis=0, return_index=True, return_inverse=True)
    radius = np.zeros(len(first), np.float32)
    np.maximum.at(radius, which.ravel(), thick)
    kept = (np.linalg.norm(ends[first, 1] - ends[first, 0], axis=1) > radius) & (radius > 0)
    ends, radius = ends[first][kept], radius[kept]
    both = np.broadcast_to(radius[:, None, None], (len(radius), 2, 1))
    rods = np.concatenate([ends, both], axis=2)
    colors = np.tile(np.array(_EDGE, np.uint8), (len(rods), 2, 1))
    ids = np.full((len(rods), 2), -1, np.int32)
    return Geometry(rods=rods.astype(np.float32), rod_colors=colors, rod_ids=ids), origin


def _wells(item: ReservoirItem) -> tuple[Geometry, NDArray]:
    """Tubes through the middles of the connected cells, from above the model down."""
    grid = item.grid
    low, high = item.bounds
    head = high[2] + WELL_HEAD * (high[2] - low[2])
    radius = _diagonal(item) * WELL_RADIUS
    segments, joints, segment_colors, joint_colors = [], [], [], []
    nk, nj, ni = grid.active.shape
    for well in grid.wells:
        cells = well.cells
        inside = ((cells >= 0) & (cells < (ni, nj, nk))).all(axis=1)
        if not inside.any():
            continue
        i, j, k = cells[inside].T
        corners = grid.corners(np.ravel_multi_index((k, j, i), (nk, nj, ni)))
        path = grid.to_world(corners, item.exaggeration).reshape(-1, 8, 3).mean(axis=1)
        path = np.concatenate([[[path[0, 0], path[0, 1], head]], path])
        color = _WELLS.get(well.kind, _OTHER_WELL)
        segments.append(np.stack([path[:-1], path[1:]], axis=1))
        joints.append(path)
        segment_colors += [color] * (len(path) - 1)
        joint_colors += [color] * len(path)
    if not segments:
        return Geometry(), np.zeros(3)
    ends, points = np.concatenate(segments), np.concatenate(joints)
    _, origin = _local(points)
    rods = np.concatenate([ends - origin, np.full((len(ends), 2, 1), radius)], axis=2)
    spheres = np.concatenate([points - origin, np.full((len(points), 1), radius)], axis=1)
    colors = np.array(segment_colors, np.uint8)
    return (
        Geometry(
            spheres=spheres.astype(np.float32),
            sphere_colors=np.array(joint_colors, np.uint8),
            sphere_ids=np.full(len(spheres), -1, np.int32),
            rods=rods.astype(np.float32),
            rod_colors=np.stack([colors, colors], axis=1),
            rod_ids=np.full((len(rods), 2), -1, np.int32),
        ),
        origin,
    )
