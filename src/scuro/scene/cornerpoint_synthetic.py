"""A made-up reservoir of any size: a dome with faults, slanted pillars, pinch-outs and holes."""

from __future__ import annotations

from datetime import date, timedelta

import numpy as np
from numpy.typing import NDArray

from scuro.scene.cornerpoint import CornerPointGrid, TimeStep, Well


def faulted_dome(
    ni: int = 40, nj: int = 40, nk: int = 12, *, steps: int = 4, throw: float = 1.5, seed: int = 1
) -> CornerPointGrid:
    """A dome cut by two faults, with an elliptical outline, a pinched-out layer and inactive cells.

    About 70 % of the cells are active. Saturations show water rising from the flanks.

    Args:
        ni: Cells along i.
        nj: Cells along j.
        nk: Layers.
        steps: Time steps of SWAT, SGAS and PRESSURE, a year apart.
        throw: Displacement of the faults, in layers.
        seed: Of the porosity and of the layers' unevenness.
    """
    rng = np.random.default_rng(seed)
    width, thick = 100.0, 4.0
    x, y = np.meshgrid(np.arange(ni + 1) * width, np.arange(nj + 1) * width)
    lean = 0.15 * (2 * x / (ni * width) - 1)
    top = np.stack([x - 50 * lean, y, np.full_like(x, 1800.0)], -1)
    bottom = np.stack([x + 500 * lean, y + 30 * lean, np.full_like(x, 2600.0)], -1)
    coord = np.stack([top, bottom], axis=2)

    u, v = 2 * x / (ni * width) - 1, 2 * y / (nj * width) - 1
    reach = max(ni, nj) * width
    node_top = 2000 + 0.05 * reach * (u**2 + v**2)
    node_top += 0.3 * thick * np.sin(7 * u) * np.cos(5 * v)
    # depths at columns' corners: faults displace whole columns, so corners split at pillars
    corner = _at_corners(node_top)
    drop = np.zeros((nj, ni))
    drop[:, ni // 3 :] += throw * thick
    for j in range(nj):
        drop[j, (2 * ni // 3 + j // 4) % ni :] -= 1.7 * throw * thick * j / nj
    corner = corner + drop[:, None, :, None].astype(np.float32)
    swell = _at_corners(1 + 0.35 * np.sin(3 * u + 1) * np.sin(4 * v))
    zcorn = np.empty((nk, 2, nj, 2, ni, 2), np.float32)
    depth = corner
    thin_layer = nk // 2
    for k in range(nk):
        factor = 0.7 + 0.6 * rng.random()
        layer = np.float32(thick * factor) * swell
        if k == thin_layer and nk > 2:
            layer = layer * np.clip(_at_corners(1.2 * (u + 0.4)), 0, 1)
        zcorn[k, 0] = depth
        depth = depth + layer
        zcorn[k, 1] = depth

    uc, vc = u[:-1, :-1] + 1 / ni, v[:-1, :-1] + 1 / nj
    inside = uc**2 + vc**2 < 0.95
    active = np.repeat(inside[None], nk, 0)
    hole = (uc - 0.3) ** 2 + (vc + 0.2) ** 2 < 0.02
    active[nk // 3 : nk // 3 + 2, hole] = False
    active &= (zcorn[:, 1] - zcorn[:, 0]).max(axis=(2, 4)) > 1e-3
    return CornerPointGrid(
        coord, zcorn, active, name="faulted dome",
        statics={"PORO": _porosity(active, rng)},
        steps=tuple(_step(n, active, zcorn, steps) for n in range(steps)),
        wells=(
            Well("P1", _vertical(active, ni // 2, nj // 2), "producer"),
            Well("I1", _vertical(active, ni // 5, nj // 2), "water injector"),
        ),
    )  # fmt: skip


def _at_corners(nodes: NDArray) -> NDArray[np.float32]:
    """(nj, 2, ni, 2) values of the nodes around each column."""
    nj, ni = nodes.shape[0] - 1, nodes.shape[1] - 1
    out = np.empty((nj, 2, ni, 2), np.float32)
    for dj, di in np.ndindex(2, 2):
        out[:, dj, :, di] = nodes[dj : nj + dj, di : ni + di]
    return out


def _porosity(active: NDArray, rng: np.random.Generator) -> NDArray[np.float32]:
    nk, nj, ni = active.shape
    along_k = 0.2 + 0.08 * np.sin(np.arange(nk) * 1.3)
    phase = rng.random() * 6
    j, i = np.mgrid[0:nj, 0:ni]
    areal = 0.05 * np.sin(i * 19 / ni + phase) * np.cos(j * 13 / nj)
    whole = along_k[:, None, None] + areal[None]
    return whole[active].astype(np.float32)


def _step(n: int, active: NDArray, zcorn: NDArray, steps: int) -> TimeStep:
    start = date(2020, 1, 1)

    def read(name: str) -> NDArray[np.float32]:
        depth = zcorn[:, 0, :, 0, :, 0][active]
        low, high = float(depth.min()), float(depth.max())
        below = (depth - low) / max(high - low, 1e-6)
        if name == "PRESSURE":
            return (200 + 60 * below - 8 * n).astype(np.float32)
        rise = 0.3 * n / max(steps - 1, 1)
        if name == "SWAT":
            return np.clip(0.15 + 1.4 * (below - 0.55 + rise), 0.15, 1).astype(np.float32)
        return np.clip(0.6 - 4 * below, 0, 0.6).astype(np.float32)

    names = ("PRESSURE", "SWAT", "SGAS")
    return TimeStep(n, start + timedelta(days=365 * n), names, read)


def _vertical(active: NDArray, i: int, j: int) -> NDArray[np.int32]:
    k = np.flatnonzero(active[:, j, i])
    return np.stack([np.full_like(k, i), np.full_like(k, j), k], 1).astype(np.int32)
