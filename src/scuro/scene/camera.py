"""The camera: right-handed view space, looking along -z, y up."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError


@dataclass(frozen=True)
class Camera:
    """Where the eye is and what it takes in. World units; angles in degrees."""

    position: tuple[float, float, float] = (0.0, 0.0, 10.0)
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    fov: float = 30.0
    """Vertical field of view of a perspective camera."""
    height: float | None = None
    """Height of the picture in world units: makes the camera orthographic."""

    def __post_init__(self) -> None:
        numbers = [*self.position, *self.target, *self.up, self.fov, self.height or 0.0]
        if not all(map(math.isfinite, numbers)):
            raise SettingsError(f"the camera has numbers that are not finite: {self}")
        if not 0.01 <= self.fov <= 170:
            raise SettingsError(f"the field of view must be 0.01 to 170 degrees, not {self.fov:g}")
        if self.height is not None and self.height <= 0:
            raise SettingsError(f"an orthographic height must be positive, not {self.height:g}")
        if np.allclose(self.position, self.target):
            raise SettingsError("the camera stands on its own target")

    @property
    def orthographic(self) -> bool:
        return self.height is not None

    @property
    def distance(self) -> float:
        """From the eye to the target."""
        return float(np.linalg.norm(np.subtract(self.position, self.target)))

    def view_from_world(self) -> NDArray[np.float64]:
        """(4, 4) rigid transform, column vectors."""
        eye = np.asarray(self.position, np.float64)
        back = eye - np.asarray(self.target, np.float64)
        back /= np.linalg.norm(back)
        right = np.cross(np.asarray(self.up, np.float64), back)
        if np.linalg.norm(right) < 1e-6:
            right = np.cross(np.roll(back, 1), back)
        right /= np.linalg.norm(right)
        matrix = np.eye(4)
        matrix[:3, :3] = right, np.cross(back, right), back
        matrix[:3, 3] = -matrix[:3, :3] @ eye
        return matrix

    def half_height(self) -> float:
        """Half the picture's height: at distance 1 (perspective), or in world units."""
        if self.height is not None:
            return self.height / 2
        return math.tan(math.radians(self.fov) / 2)

    def clip_from_view(self, aspect: float, near: float, far: float = 0.0) -> NDArray[np.float64]:
        """(4, 4) projection with reversed depth: 1 at ``near``, 0 at infinity (or at ``far``).

        Args:
            aspect: Width over height.
            near: Distance of the near plane (perspective) or of depth 1 (orthographic).
            far: Distance of depth 0, orthographic only.
        """
        h = self.half_height()
        m = np.zeros((4, 4))
        m[0, 0], m[1, 1] = 1 / (h * aspect), 1 / h
        if self.orthographic:
            m[2, 2] = 1 / (far - near)
            m[2, 3] = far / (far - near)
            m[3, 3] = 1
        else:
            m[2, 3] = near
            m[3, 2] = -1
        return m

    def orbited(self, azimuth: float, elevation: float) -> Camera:
        """Turned about the target: ``azimuth`` degrees to the right, ``elevation`` up."""
        rows = self.view_from_world()[:3, :3]
        a, e = math.radians(azimuth), math.radians(elevation)
        back = np.array([math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e)])
        up = np.array([-math.sin(a) * math.sin(e), math.cos(e), -math.cos(a) * math.sin(e)])
        eye = np.asarray(self.target) + self.distance * (rows.T @ back)
        return replace(self, position=tuple(eye.tolist()), up=tuple((rows.T @ up).tolist()))

    @classmethod
    def fitted(
        cls,
        bounds: NDArray,
        *,
        direction: tuple[float, float, float] = (0, 0, 1),
        up: tuple[float, float, float] = (0, 1, 0),
        fov: float = 30.0,
        aspect: float = 1.0,
        orthographic: bool = False,
        margin: float = 1.05,
        points: NDArray | None = None,
    ) -> Camera:
        """A camera that sees all of a box, or of a set of spheres, from ``direction``.

        Args:
            bounds: (2, 3) world box.
            direction: From the target to the eye.
            up: Upward direction of the picture.
            fov: Vertical field of view, degrees.
            aspect: Width over height.
            orthographic: Whether to make the camera orthographic.
            margin: How much larger than needed the picture is taken.
            points: (n, 4) centres and radii to fit more tightly than the box allows.
        """
        low, high = np.asarray(bounds, np.float64)
        center = (low + high) / 2
        if points is None:
            corners = np.array(np.meshgrid(*np.stack([low, high], 1), indexing="ij"))
            points = np.concatenate([corners.reshape(3, -1).T, np.zeros((8, 1))], axis=1)
        probe = cls(tuple(center + np.asarray(direction, float)), tuple(center), up, fov)
        local = (points[:, :3] - center) @ probe.view_from_world()[:3, :3].T
        radius = points[:, 3]
        if orthographic:
            # centre the picture on what is seen
            middle = [(np.min(c - radius) + np.max(c + radius)) / 2 for c in local[:, :2].T]
            half = [
                np.max(np.abs(c - m) + radius) for c, m in zip(local[:, :2].T, middle, strict=True)
            ]
            depth = float(np.max(local[:, 2] + radius))
            height = 2 * margin * max(half[1], half[0] / aspect, 1e-6)
            offset = probe.view_from_world()[:2, :3].T @ np.array(middle)
            target = center + offset
            back = probe.view_from_world()[2, :3]
            eye = target + back * max(depth + 0.1 * height, height)
            return cls(tuple(eye.tolist()), tuple(target.tolist()), up, fov, height)
        # each sphere must lie inside the four side planes: the farthest plane position wins
        tangent = math.tan(math.radians(fov) / 2) / margin
        distances, centers = [], []
        for axis, t in ((0, tangent * aspect), (1, tangent)):
            slope = math.hypot(1.0, t)
            side = local[:, axis]
            upper = np.max(side + radius * slope + t * local[:, 2])
            lower = np.max(-side + radius * slope + t * local[:, 2])
            distances.append((upper + lower) / (2 * t))
            centers.append((upper - lower) / 2)
        nearest = float(np.max(local[:, 2] + radius))
        distance = max(*distances, nearest * 1.02 + 1e-3)
        rows = probe.view_from_world()[:3, :3]
        target = center + rows[:2].T @ np.array(centers)
        eye = target + rows[2] * distance
        return cls(tuple(eye.tolist()), tuple(target.tolist()), up, fov)
