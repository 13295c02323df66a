"""Checks of triangle meshes."""

from __future__ import annotations

import numpy as np


def assert_closed_and_outward(geometry):
    """Every directed edge has its reverse, and shading normals agree with the faces' sense."""
    corners = geometry.triangles.astype(np.float64)
    _, number = np.unique(np.round(corners.reshape(-1, 3), 4), axis=0, return_inverse=True)
    number = number.reshape(-1, 3)
    edges = np.concatenate([number[:, [0, 1]], number[:, [1, 2]], number[:, [2, 0]]])
    edges = edges[edges[:, 0] != edges[:, 1]]
    forward = np.unique(edges, axis=0, return_counts=True)
    backward = np.unique(edges[:, ::-1], axis=0, return_counts=True)
    assert (forward[0] == backward[0]).all()
    assert (forward[1] == backward[1]).all()
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.linalg.norm(across, axis=-1).min() > 0
    agree = (across[:, None] * geometry.triangle_normals).sum(-1)
    assert (agree > 0).mean() > 0.999
    assert np.allclose(np.linalg.norm(geometry.triangle_normals, axis=-1), 1, atol=1e-5)
