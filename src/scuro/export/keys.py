"""Key frames of the camera: a TOML file of views, each at its second of the film."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from scuro.errors import LoadError, SettingsError
from scuro.export import toml
from scuro.export.reading import Fault, group_from
from scuro.scene.camera import Camera
from scuro.scene.view import ViewSettings
from scuro.settings import unknown

EASINGS: dict[str, Callable[[float], float]] = {
    "linear": lambda t: t,
    "smooth": lambda t: t * t * (3 - 2 * t),
    "in": lambda t: t * t,
    "out": lambda t: t * (2 - t),
}
"""How time passes between two key frames, 0 to 1."""


class KeyFrames:
    """Cameras on the way through key frames.

    Args:
        path: A TOML file of ``[[key]]`` tables: ``at`` (second), ``ease`` toward it, and any values
            of a view.
        view: What a key does not say.
        camera: Makes the camera of a view.

    Raises:
        LoadError: The file cannot be read; the message names the line.
    """

    def __init__(
        self, path: str, view: ViewSettings, camera: Callable[[ViewSettings], Camera]
    ) -> None:
        text = toml.read(path)
        values, lines = toml.parse(text, path), toml.Lines(text)
        others = sorted(set(values) - {"key"})
        if others:
            raise LoadError(path, unknown("key", others[0], ["key"]), lines.find((others[0],)))
        tables = values.get("key", [])
        if not isinstance(tables, list) or not all(isinstance(t, dict) for t in tables):
            raise LoadError(path, "its key frames are an array of tables: write [[key]]")
        found: list[tuple[float, str, Camera]] = []
        for index, given in enumerate(tables):
            line = lines.find(("key", index))
            at, ease = given.pop("at", None), given.pop("ease", "smooth")
            if isinstance(at, bool) or not isinstance(at, int | float) or not 0 <= at < math.inf:
                raise LoadError(path, "a [[key]] needs 'at', its second in the film", line)
            if ease not in EASINGS:
                raise LoadError(path, unknown("ease", str(ease), EASINGS), line)
            if any(at == earlier for earlier, _, _ in found):
                raise LoadError(path, f"two [[key]] tables are at second {at:g}", line)
            try:
                said = group_from(ViewSettings, given, ("key", index))
                changed = view.replace(**{name: getattr(said, name) for name in given})
                found.append((float(at), ease, camera(changed)))
            except Fault as fault:
                raise LoadError(path, fault.why, lines.find(fault.key)) from None
            except SettingsError as error:
                raise LoadError(path, str(error), line) from None
        if not found:
            raise LoadError(path, "has no [[key]] tables")
        self._keys = sorted(found, key=lambda key: key[0])

    @property
    def seconds(self) -> float:
        """When the last key is reached."""
        return self._keys[-1][0]

    def camera(self, second: float) -> Camera:
        """The camera at a time; before the first and after the last key it rests there."""
        before = after = self._keys[0]
        for key in self._keys:
            if key[0] <= second:
                before = after = key
            else:
                after = key
                break
        span = after[0] - before[0]
        if span <= 0:
            return before[2]
        return between(before[2], after[2], EASINGS[after[1]]((second - before[0]) / span))


def between(a: Camera, b: Camera, share: float) -> Camera:
    """A camera on the way from one to another: turning evenly about a target that moves straight.

    What is as far as the target grows or shrinks by equal factors in equal times.

    Args:
        a: At 0.
        b: At 1.
        share: How far, 0 to 1.
    """
    from scipy.spatial.transform import Rotation, Slerp

    rows = np.stack([camera.view_from_world()[:3, :3] for camera in (a, b)])
    turned = Slerp([0, 1], Rotation.from_matrix(rows))(share).as_matrix()
    target = (1 - share) * np.asarray(a.target) + share * np.asarray(b.target)
    distance = _geometric(a.distance, b.distance, share)
    eye = target + distance * turned[2]
    height = None
    if a.height is not None and b.height is not None:
        height = _geometric(a.height, b.height, share)
    near, far = (math.tan(math.radians(camera.fov) / 2) for camera in (a, b))
    fov = 2 * math.degrees(math.atan(_geometric(near, far, share)))
    place = tuple(eye.tolist()), tuple(target.tolist()), tuple(turned[1].tolist())
    return Camera(*place, fov, height)


def _geometric(a: float, b: float, share: float) -> float:
    return float(a ** (1 - share) * b**share)
