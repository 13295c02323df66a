"""A corner-point grid in the form the GPU walks: pillars, and depths of surfaces on them.

Between two consecutive surfaces of a column lies one *layer*: a cell, or a gap where the file has
the cell below not touch the one above. A cell's bottom and the top of the next one are thus stored
once, which halves the eight depths a cell, and 16-bit steps within each pillar's range of depths
halve them again: 8 bytes of depths and 8 of vertex values a cell. Neighbours need no list: the
next layer of the same column, or the same layer of the next column, where the corners agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from scuro.scene.cornerpoint import CornerPointGrid
from scuro.scene.cornerpoint_topology import SPLIT_TOLERANCE, THIN

STEPS = 65535
"""Depths and values are stored as whole numbers from 0 to this."""

AREAL = 1.75
"""Voxels of the areal grid per column along each axis (the thesis's r)."""

RING = ((0, 0), (0, 1), (1, 1), (1, 0))
"""Corners (dj, di) of a column in the order of their components in the shaders."""

PILLAR = np.dtype(
    [
        ("at", np.float32, 2),
        ("slope", np.float32, 2),
        ("base", np.float32),
        ("step", np.float32),
        ("pad", np.float32, 2),
    ]
)
"""``Pillar`` of columns.wgsl: two texels of 16 bytes."""

COLUMN = np.dtype(
    [("start", np.uint32), ("first", np.uint32), ("count", np.uint32), ("words", np.uint32)]
)
"""``Column`` of columns.wgsl: 16 bytes."""


@dataclass(eq=False)
class PackedReservoir:
    """Host copies of the tables of cells.wgsl, in scene space.

    Args:
        grid: The model.
        center: World position of the scene's origin.
        exaggeration: Factor on heights.
    """

    grid: CornerPointGrid
    center: NDArray
    exaggeration: float

    def __post_init__(self) -> None:
        grid = self.grid
        ni, nj, nk = grid.dimensions
        gaps = _gaps(grid)
        self.top_surface = np.concatenate([[0], np.cumsum(1 + gaps)]).astype(np.int32)
        """(nk,) surface of each layer of cells' top; its bottom is the next one."""
        self.layers = int(self.top_surface[-1]) + 1
        """Layers a column may have, gaps counted."""
        used: NDArray[np.bool_] = np.asarray(grid.active.any(axis=0))
        first = np.where(used, grid.active.argmax(axis=0), 0)
        last = np.where(used, nk - 1 - grid.active[::-1].argmax(axis=0), -1)
        count = np.where(used, self.top_surface[last] - self.top_surface[first] + 2, 0)
        self.columns = np.zeros(ni * nj, COLUMN)
        ends = np.cumsum(count.ravel())
        self.surfaces = int(ends[-1])
        """Surfaces of all columns together."""
        self.columns["start"] = ends - count.ravel()
        self.columns["first"] = self.top_surface[first].ravel()
        self.columns["count"] = count.ravel()
        self.words = -(-self.layers // 32)
        """32-bit words of flags a column."""
        self.columns["words"] = np.arange(ni * nj) * self.words
        self.pillars, base, step = self._pillars()
        self.depths = self._depths(base, step)

    def _pillars(self) -> tuple[NDArray, NDArray, NDArray]:
        """The pillar table, and each pillar's smallest depth and depth per step."""
        grid = self.grid
        ni, nj, _ = grid.dimensions
        low = np.full((nj + 1, ni + 1), np.inf)
        high = np.full((nj + 1, ni + 1), -np.inf)
        lowest, highest = grid.column_range
        for dj, di in RING:
            at = (slice(dj, nj + dj), slice(di, ni + di))
            low[at] = np.minimum(low[at], lowest[:, dj, :, di])
            high[at] = np.maximum(high[at], highest[:, dj, :, di])
        empty = ~np.isfinite(low)
        low[empty], high[empty] = 0, 1
        step = np.maximum(high - low, 1e-3) / STEPS
        place, slope = grid.pillar_lines()
        axes = grid.axes
        if grid.map_axes is not None:
            place, slope = place @ axes.T + grid.map_axes[2:4], slope @ axes.T
        # depth d is at scene height z = -exaggeration d - center z
        e, cz = self.exaggeration, self.center[2]
        table = np.zeros(low.shape, PILLAR)
        table["at"] = place - slope * (cz / e) - self.center[:2]
        table["slope"] = -slope / e
        table["base"] = -e * low - cz
        table["step"] = e * step
        return table.ravel(), low, step

    def _depths(self, base: NDArray, step: NDArray) -> NDArray[np.uint16]:
        """(surfaces, 4): each column's surfaces from the top, at its corners in ring order."""
        grid = self.grid
        ni, nj, nk = grid.dimensions
        out = np.zeros((self.surfaces, 4), np.uint16)
        start = self.columns["start"].reshape(nj, ni).astype(np.int64)
        first = self.columns["first"].reshape(nj, ni).astype(np.int64)
        count = self.columns["count"].reshape(nj, ni).astype(np.int64)
        for corner, (dj, di) in enumerate(RING):
            at = (slice(dj, nj + dj), slice(di, ni + di))
            for k in range(nk):
                for side in range(2):
                    surface = self.top_surface[k] + side - first
                    inside = (surface >= 0) & (surface < count)
                    depth = grid.zcorn[k, side, :, dj, :, di][inside]
                    steps = (depth - base[at][inside]) / step[at][inside]
                    steps = np.clip(np.rint(steps), 0, STEPS).astype(np.uint16)
                    out[start[inside] + surface[inside], corner] = steps
        return out

    @cached_property
    def slots(self) -> NDArray[np.uint32]:
        """(n_active,) place of each active cell among the layers, counted like surfaces."""
        k, j, i = np.nonzero(self.grid.active)
        column = self.columns[j * self.grid.dimensions[0] + i]
        return (column["start"] + self.top_surface[k] - column["first"]).astype(np.uint32)

    @cached_property
    def cell_of_layer(self) -> NDArray[np.int32]:
        """(layers,) k of each layer counted from surface 0, -1 for gaps."""
        table = np.full(self.layers, -1, np.int32)
        table[self.top_surface] = np.arange(len(self.top_surface))
        return table

    @cached_property
    def corner_heights(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Lowest and highest z of every column's cells in scene space, (nj · ni,); empty: inf."""
        lowest, highest = self.grid.column_range
        top, bottom = lowest.min(axis=(1, 3)), highest.max(axis=(1, 3))
        scale, shift = -self.exaggeration, -self.center[2]
        return (
            (bottom.ravel() * scale + shift).astype(np.float32),
            (top.ravel() * scale + shift).astype(np.float32),
        )

    @cached_property
    def mean_extents(self) -> NDArray[np.float64]:
        """(3,) mean extent of active cells along i, j and k, in scene units."""
        grid = self.grid
        corners = grid.to_world(grid.corners(_sample(grid.active)), self.exaggeration)
        along_i = np.linalg.norm(corners[:, :, :, 1] - corners[:, :, :, 0], axis=-1).mean()
        along_j = np.linalg.norm(corners[:, :, 1] - corners[:, :, 0], axis=-1).mean()
        along_k = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=-1).mean()
        return np.array([along_i, along_j, along_k])

    @property
    def tolerance(self) -> float:
        """How far corners may lie apart, in scene units, to be one vertex."""
        return SPLIT_TOLERANCE * self.exaggeration

    def areal_grid(self) -> tuple[dict, NDArray[np.uint32], NDArray[np.uint32]]:
        """Which columns lie over each voxel of a regular grid in x and y, and between which z.

        Pillars order the cells of a column by depth, so two dimensions are enough.

        Returns:
            Fields of ``Model``; (voxels, 4) first place in the lists, count, bits of lowest and
            highest z; the lists of columns.
        """
        ni, nj, _ = self.grid.dimensions
        z_low, z_high = self.corner_heights
        used = np.flatnonzero(self.columns["count"])
        j, i = np.divmod(used, ni)
        corners = np.empty((len(used), 2, 4, 2), np.float32)
        for n, (dj, di) in enumerate(RING):
            pillar = self.pillars[(j + dj) * (ni + 1) + i + di]
            for end, z in enumerate((z_low[used], z_high[used])):
                corners[:, end, n] = pillar["at"] + pillar["slope"] * z[:, None]
        low = corners.min(axis=(1, 2)).astype(np.float64)
        high = corners.max(axis=(1, 2)).astype(np.float64)
        origin, end = low.min(axis=0), high.max(axis=0)
        margin = 1e-4 * (end - origin).max() + 1e-6
        origin, end = origin - margin, end + margin
        dims = np.maximum(1, np.rint(AREAL * np.array([ni, nj]))).astype(np.int64)
        # a grid turned against the map's axes needs voxels along x and y by extent, not by i and j
        size = end - origin
        area = np.prod(dims)
        dims = np.maximum(1, np.rint(np.sqrt(area * size / size[::-1]))).astype(np.int64)
        voxel = size / dims
        first = np.clip(((low - margin / 2 - origin) / voxel).astype(np.int64), 0, dims - 1)
        last = np.clip(((high + margin / 2 - origin) / voxel).astype(np.int64), 0, dims - 1)
        spans = last - first + 1
        counts = spans.prod(axis=1)
        item = np.repeat(np.arange(len(used)), counts)
        number = np.arange(len(item)) - np.repeat(np.cumsum(counts) - counts, counts)
        x = first[item, 0] + number % spans[item, 0]
        y = first[item, 1] + number // spans[item, 0]
        kept = _overlap(corners, item, origin + voxel * (np.stack([x, y], 1) + 0.5), voxel / 2)
        item, index = item[kept], (y * dims[0] + x)[kept]
        order = np.argsort(index, kind="stable")
        starts = np.searchsorted(index[order], np.arange(dims.prod() + 1))
        listed = used[item[order]].astype(np.uint32)
        heights = np.empty((int(dims.prod()), 2), np.float32)
        heights[:] = 1, -1
        filled = np.flatnonzero(np.diff(starts))
        heights[filled, 0] = np.minimum.reduceat(z_low[listed], starts[filled])
        heights[filled, 1] = np.maximum.reduceat(z_high[listed], starts[filled])
        voxels = np.empty((len(heights), 4), np.uint32)
        voxels[:, 0], voxels[:, 1] = starts[:-1], np.diff(starts)
        voxels[:, 2:] = heights.view(np.uint32)
        fields = {"areal_origin": origin, "areal_voxel": voxel, "areal_dims": dims}
        return fields, voxels, listed


def _overlap(corners: NDArray, item: NDArray, middle: NDArray, half: NDArray) -> NDArray[np.bool_]:
    """Whether columns' outlines and voxels overlap, by separating axes across the outlines' edges.

    Args:
        corners: (n, 2, 4, 2) outlines at two heights.
        item: (m,) which outline.
        middle: (m, 2) middles of voxels.
        half: (2,) half their size.
    """
    kept = np.ones(len(item), bool)
    outline = corners.reshape(len(corners), 8, 2)
    for n in range(4):
        edge = corners[:, 0, (n + 1) % 4] - corners[:, 0, n]
        normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1)
        along = np.einsum("npc,nc->np", outline, normal)
        place = np.einsum("mc,mc->m", middle, normal[item])
        reach = np.abs(normal[item]) @ (half * 1.001)
        kept &= (place + reach >= along.min(axis=1)[item]) & (
            place - reach <= along.max(axis=1)[item]
        )
    return kept


def _gaps(grid: CornerPointGrid) -> NDArray[np.int32]:
    """(nk - 1,) 1 where some cell's bottom is not the top of the next, beside an active cell."""
    gaps = np.zeros(grid.dimensions[2] - 1, np.int32)
    for k in range(len(gaps)):
        beside = grid.active[k, :, None, :, None] | grid.active[k + 1, :, None, :, None]
        apart = np.abs(grid.zcorn[k + 1, 0] - grid.zcorn[k, 1]) > THIN
        gaps[k] = (beside & apart).any()
    return gaps


def _sample(active: NDArray, most: int = 200_000) -> NDArray[np.int64]:
    """Flat indices of active cells, evenly thinned."""
    cells = np.flatnonzero(active)
    return cells[:: -(-len(cells) // most)]
