"""What moves in a film: the camera, clipping planes, models of a molecule, the look."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from scuro.errors import LoadError, SettingsError
from scuro.export import toml
from scuro.export.looks import with_look
from scuro.export.scene_file import SceneFile
from scuro.export.zoom import zoom_of, zoom_settings
from scuro.load.trajectory import Trajectory, open_trajectory
from scuro.passes.compose.lighting import with_implied
from scuro.passes.post.stereo import eye_size
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip, Plane
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera
from scuro.settings import SettingsGroup, setting, unknown

EASINGS: dict[str, Callable[[float], float]] = {
    "linear": lambda t: t,
    "smooth": lambda t: t * t * (3 - 2 * t),
    "in": lambda t: t * t,
    "out": lambda t: t * (2 - t),
}
"""How time passes between two key frames, 0 to 1."""


_STEADY = 16
"""Rays of occlusion a pixel in films; see docs/decisions.md."""


class MovieSettings(SettingsGroup):
    """A film: what moves, and for how long. All motions can be combined."""

    motion: str = setting(
        "turntable",
        "the camera's own: once around, to and fro, from the whole to single atoms, or none",
        choices=("turntable", "rock", "zoom", "none"),
    )
    length: int | None = setting(
        None,
        "number of frames (default: 120, 300 zooming, or one a model with --play)",
        low=1,
        high=100_000,
    )
    fps: float = setting(30.0, "frames a second", low=1, high=120)
    swing: float = setting(20.0, "how far rocking goes to each side", low=0, high=180, unit="deg")
    zoom_to: tuple[float, float, float] | None = setting(
        None, "where zooming lands, in the file's coordinates; by default what is in the middle"
    )
    play: bool = setting(
        False, "play through the models of the file, or the frames of --trajectory"
    )
    sweep: float = setting(0.0, "move the planes of --clip so far along their directions", unit="Å")
    to_look: str = setting("", "pass over into this look")
    keys: str = setting("", "key frames of the camera: a TOML file of [[key]] tables")


@dataclass(frozen=True)
class Moment:
    """All that a frame of a film is drawn with."""

    scene: Scene
    camera: Camera
    settings: Settings
    plays: bool = False
    """Whether atoms move from frame to frame."""


class Motion:
    """A document in motion: gives the moment of any frame, independent of all others.

    Args:
        document: What is shown.
        movie: What moves.

    Raises:
        LoadError: An input, trajectory or file of key frames cannot be read.
        SettingsError: A motion does not suit the scene.
    """

    def __init__(self, document: SceneFile, movie: MovieSettings) -> None:
        self.movie = movie
        self.scene = document.scene()
        self.settings = document.settings
        self._look = with_look(document, movie.to_look).settings if movie.to_look else None
        width, height = eye_size(document.settings.stereo, document.settings.size)
        self._aspect = width / height
        self._camera = view_camera(
            self.scene, document.view, self._aspect, turning=movie.motion in ("turntable", "rock")
        )
        self._zoom = None
        if movie.motion == "zoom":
            self._zoom = zoom_of(self.scene, self._camera, movie.zoom_to)
            self.settings = zoom_settings(self.scene, self.settings)
        self._clip = self.scene.clip
        if movie.sweep and not self._clip.planes:
            raise SettingsError("--sweep moves clipping planes: give --clip, too")
        self._keys = self._read_keys(document.view) if movie.keys else []
        self._trajectory = self._open_trajectory(document) if movie.play else None
        self.length = self._length()

    def _length(self) -> int:
        if self.movie.length is not None:
            return self.movie.length
        if self._keys:
            return round(self._keys[-1][0] * self.movie.fps) + 1
        if self._trajectory is not None:
            return len(self._trajectory)
        return 300 if self._zoom is not None else 120

    def _open_trajectory(self, document: SceneFile) -> Trajectory:
        if len(document.input) != 1 or len(self.scene.molecules) != 1:
            raise SettingsError("--play needs one molecule")
        line = document.input[0]
        changes = document.load.as_dict()
        trajectory = changes.pop("trajectory")
        for key in ("frame", "model", "voxels"):
            changes.pop(key)
        found = open_trajectory(line.path, trajectory, format=line.format, **changes)
        if len(found) < 2:
            raise SettingsError(f"{line.path} has one model only: give --trajectory to play")
        return found

    def __iter__(self) -> Iterator[Moment]:
        return map(self.at, range(self.length))

    def at(self, frame: int) -> Moment:
        """The moment of a frame, from 0."""
        share = frame / max(self.length - 1, 1)
        self.scene.clip = self._swept(share)
        if self._trajectory is not None:
            place = share * (len(self._trajectory) - 1)
            self.scene.molecules[0].molecule = self._trajectory.at(place)
        settings = (
            self.settings if self._look is None else blended(self.settings, self._look, share)
        )
        plays = self._trajectory is not None
        return Moment(self.scene, self.camera(frame), steady(settings), plays)

    def camera(self, frame: int) -> Camera:
        """The camera of a frame, from 0."""
        # a turntable must not show its first frame twice; all else ends where it should
        turn = frame / self.length
        share = frame / max(self.length - 1, 1)
        camera = self._key_camera(frame / self.movie.fps) if self._keys else self._camera
        if self.movie.motion == "turntable" and not self._keys:
            camera = camera.orbited(360 * turn, 0)
        elif self._zoom is not None and not self._keys:
            camera = self._zoom.camera(share)
        elif self.movie.motion == "rock":
            camera = camera.orbited(self.movie.swing * math.sin(2 * math.pi * turn), 0)
        return camera

    def _swept(self, share: float) -> Clip:
        def moved(plane: Plane) -> Plane:
            normal = np.asarray(plane.normal, np.float64)
            shift = self.movie.sweep * share * normal / np.linalg.norm(normal)
            return replace(plane, point=tuple((np.asarray(plane.point) + shift).tolist()))

        return replace(self._clip, planes=tuple(map(moved, self._clip.planes)))

    def _read_keys(self, view: ViewSettings) -> list[tuple[float, str, Camera]]:
        """Key frames in order: second, easing toward it, camera."""
        path = self.movie.keys
        try:
            text = Path(path).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise LoadError(path, f"cannot be read: {error}") from None
        lines = toml.Lines(text)
        found = []
        for index, values in enumerate(toml.parse(text, path).get("key", [])):
            line = lines.find(("key", index))
            at, ease = values.pop("at", None), values.pop("ease", "smooth")
            if not isinstance(at, int | float):
                raise LoadError(path, "a [[key]] needs 'at', its second in the film", line)
            if ease not in EASINGS:
                raise LoadError(path, unknown("ease", str(ease), EASINGS), line)
            try:
                values = {k: tuple(v) if isinstance(v, list) else v for k, v in values.items()}
                camera = view_camera(self.scene, view.replace(**values), self._aspect)
            except SettingsError as error:
                raise LoadError(path, str(error), line) from None
            found.append((float(at), ease, camera))
        if not found:
            raise LoadError(path, "has no [[key]] tables")
        return sorted(found, key=lambda key: key[0])

    def _key_camera(self, second: float) -> Camera:
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


def steady(settings: Settings) -> Settings:
    """Settings of a film's frame: enough rays of occlusion that its grain does not flicker.

    A number of samples that someone chose stays.
    """
    implied = with_implied(settings).occlusion
    if settings.occlusion.samples is not None or implied.technique not in ("ray", "hybrid"):
        return settings
    return settings.replace(occlusion__samples=_STEADY)


def between(a: Camera, b: Camera, share: float) -> Camera:
    """A camera on the way from one to another: turning evenly about a target that moves straight.

    Args:
        a: At 0.
        b: At 1.
        share: How far, 0 to 1.
    """
    from scipy.spatial.transform import Rotation, Slerp

    rows = np.stack([camera.view_from_world()[:3, :3] for camera in (a, b)])
    turned = Slerp([0, 1], Rotation.from_matrix(rows))(share).as_matrix()
    target = (1 - share) * np.asarray(a.target) + share * np.asarray(b.target)
    distance = a.distance ** (1 - share) * b.distance**share
    eye = target + distance * turned[2]
    height = None
    if a.height is not None and b.height is not None:
        height = a.height ** (1 - share) * b.height**share
    fov = (1 - share) * a.fov + share * b.fov
    place = tuple(eye.tolist()), tuple(target.tolist()), tuple(turned[1].tolist())
    return Camera(*place, fov, height)


def blended(a: Any, b: Any, share: float) -> Any:
    """Settings on the way from one to another: numbers go over, words change in the middle."""
    made = {}
    for name, value in vars(a).items():
        other = getattr(b, name)
        if isinstance(value, SettingsGroup):
            made[name] = blended(value, other, share)
        elif isinstance(value, float) and isinstance(other, float):
            made[name] = (1 - share) * value + share * other
        else:
            made[name] = value if share < 0.5 else other
    return type(a)(**made)
