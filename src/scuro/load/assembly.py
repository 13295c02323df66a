"""Biological assemblies: operators that place chains, and mmCIF's way of writing them."""

from __future__ import annotations

import itertools
import re

import numpy as np
from numpy.typing import NDArray

from scuro.scene.molecule import AssemblyPart

MAX_OPERATORS = 1_000_000
"""A bound on what a damaged operator expression may expand to."""


def part(chains: tuple[int, ...], matrices: NDArray) -> AssemblyPart:
    """An :class:`AssemblyPart` from (k, 3, 4) matrices; each is replaced by the nearest rotation.

    Files round their matrices (Mol*'s cell models quantise them), so the unit quaternion is the
    nearest rigid motion, not the matrix itself.
    """
    matrices = np.asarray(matrices, np.float64)
    return AssemblyPart(
        chains=chains,
        rotations=quaternions(matrices[:, :, :3]),
        positions=matrices[:, :, 3].copy(),
    )


def quaternions(rotations: NDArray[np.float64]) -> NDArray[np.float32]:
    """(k, 3, 3) rotation matrices to (k, 4) unit quaternions x, y, z, w with w >= 0.

    The eigenvector of the largest eigenvalue of Bar-Itzhack's symmetric matrix (2000): the nearest
    rotation, stable for every angle.
    """
    m = rotations
    k = np.empty((len(m), 4, 4))
    k[:, 0, 0] = m[:, 0, 0] - m[:, 1, 1] - m[:, 2, 2]
    k[:, 1, 1] = m[:, 1, 1] - m[:, 0, 0] - m[:, 2, 2]
    k[:, 2, 2] = m[:, 2, 2] - m[:, 0, 0] - m[:, 1, 1]
    k[:, 3, 3] = m[:, 0, 0] + m[:, 1, 1] + m[:, 2, 2]
    k[:, 0, 1] = k[:, 1, 0] = m[:, 0, 1] + m[:, 1, 0]
    k[:, 0, 2] = k[:, 2, 0] = m[:, 0, 2] + m[:, 2, 0]
    k[:, 1, 2] = k[:, 2, 1] = m[:, 1, 2] + m[:, 2, 1]
    k[:, 0, 3] = k[:, 3, 0] = m[:, 2, 1] - m[:, 1, 2]
    k[:, 1, 3] = k[:, 3, 1] = m[:, 0, 2] - m[:, 2, 0]
    k[:, 2, 3] = k[:, 3, 2] = m[:, 1, 0] - m[:, 0, 1]
    q = np.linalg.eigh(k)[1][:, :, -1] if len(m) else np.zeros((0, 4))
    return np.where(q[:, 3:] < 0, -q, q).astype(np.float32)


def expand_operators(expression: str) -> list[tuple[str, ...]]:
    """Operator names of an mmCIF ``oper_expression``, each a product applied right to left.

    ``1,3-5`` is a list; ``(1-60)(61-88)`` is the Cartesian product; ``(X0)(1-5)`` likewise. A
    range written backwards is empty (as Mol*'s cell models need).
    """
    groups = re.findall(r"\(([^()]*)\)", expression) or [expression]
    lists = [_names(group) for group in groups]
    total = 1
    for names in lists:
        total *= len(names)
    if total > MAX_OPERATORS:
        raise ValueError(f"the operator expression {expression[:40]} expands to {total} operators")
    return list(itertools.product(*lists))


def _names(group: str) -> list[str]:
    names: list[str] = []
    for item in group.split(","):
        item = item.strip()
        span = re.fullmatch(r"(\d+)\s*-\s*(\d+)", item)
        if span:
            first, last = int(span.group(1)), int(span.group(2))
            if last - first > MAX_OPERATORS:
                raise ValueError(f"the operator range {item} is too long")
            names.extend(str(n) for n in range(first, last + 1))
        elif item:
            names.append(item)
    return names
