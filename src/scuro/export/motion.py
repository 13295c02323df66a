"""What moves in a film: the camera, clipping planes, models of a molecule, the look."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.export.keys import KeyFrames
from scuro.export.looks import with_look
from scuro.export.scene_file import SceneFile
from scuro.export.zoom import zoom_of, zoom_settings
from scuro.load.trajectory import Trajectory, open_trajectory
from scuro.passes.compose.lighting import with_implied
from scuro.passes.post.stereo import eye_size
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip, Plane
from scuro.scene.points import moving_points
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera
from scuro.settings import SettingsGroup, setting

_LONGEST = 100_000
"""Frames of a film."""
_STEADY = 16
"""Rays of occlusion a pixel in films; see docs/decisions.md."""
_A_MODEL = 10
"""Frames from one model of an ensemble to the next."""


class MovieSettings(SettingsGroup):
    """A film: what moves, and for how long. All motions can be combined."""

    motion: str = setting(
        "turntable",
        "the camera's own: once around, to and fro, from the whole to single atoms, or none",
        choices=("turntable", "rock", "zoom", "none"),
    )
    length: int | None = setting(
        None,
        "number of frames (default: 120, 300 zooming; with --play one a frame of the trajectory, "
        "or ten from model to model)",
        low=1,
        high=_LONGEST,
        unit="frames",
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
class Over:
    """What a frame passes over into."""

    scene: Scene
    settings: Settings
    share: float
    """How much it shows, 0 to 1."""


@dataclass(frozen=True)
class Moment:
    """All that a frame of a film is drawn with."""

    scene: Scene
    camera: Camera
    settings: Settings
    plays: bool = False
    """Whether atoms move from frame to frame."""
    over: Over | None = None
    """A second picture to mix with (:func:`mixed`), on the way to another look."""


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
        data = document.read()
        self.scene = document.scene(data)
        self.settings = document.settings
        self._other: tuple[Scene, Settings] | None = None
        if movie.to_look:
            other = with_look(document, movie.to_look)
            same = (other.show, other.light) == (document.show, document.light)
            self._other = self.scene if same else other.scene(data), other.settings
        self._trajectory = self._open_trajectory(document) if movie.play else None
        width, height = eye_size(document.settings.stereo, document.settings.size)
        turning = movie.motion in ("turntable", "rock") and not movie.keys
        seen = partial(
            view_camera, self.scene, aspect=width / height, points=self._points(document.view)
        )
        self._camera = seen(document.view, turning=turning)
        self._zoom = None
        if movie.motion == "zoom":
            self._zoom = zoom_of(self.scene, self._camera, movie.zoom_to)
            self.settings = zoom_settings(self.scene, self.settings)
        self._clip = self.scene.clip
        if movie.sweep and not self._clip.planes:
            raise SettingsError("--sweep moves clipping planes: give --clip, too")
        self._keys = KeyFrames(movie.keys, document.view, seen) if movie.keys else None
        self.length = self._length()

    def _points(self, view: ViewSettings) -> NDArray[np.float64] | None:
        """What the camera must see where atoms move or are shown in two ways: hulls of moments."""
        last = 0 if self._trajectory is None else len(self._trajectory) - 1
        if not last and len(self._scenes) == 1:
            return None
        points = moving_points(self._scenes, self._play, last, view.focus)
        self._play(0)
        return points

    @property
    def _scenes(self) -> list[Scene]:
        """What is shown, in either look."""
        if self._other is None or self._other[0] is self.scene:
            return [self.scene]
        return [self.scene, self._other[0]]

    def _play(self, place: float) -> None:
        if self._trajectory is not None:
            molecule = self._trajectory.at(place)
            for scene in self._scenes:
                scene.molecules[0].molecule = molecule

    def _length(self) -> int:
        if self.movie.length is not None:
            return self.movie.length
        if self._keys:
            found = round(self._keys.seconds * self.movie.fps) + 1
            if found > _LONGEST:
                raise SettingsError(
                    f"{self.movie.keys}: its last key comes after {found:,} frames; a film has "
                    f"{_LONGEST:,} at most"
                )
            return found
        if self._trajectory is not None:
            count = len(self._trajectory)
            return count if self._trajectory.timed else (count - 1) * _A_MODEL + 1
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
        if self._trajectory is not None:
            self._play(share * (len(self._trajectory) - 1))
        self.scene.clip = self._swept(share)
        moment = Moment(self.scene, self.camera(frame), steady(self.settings), self.movie.play)
        return moment if self._other is None else self._between_looks(moment, share)

    def _between_looks(self, moment: Moment, share: float) -> Moment:
        """Numbers go over; where words differ, too, a picture in one look passes over the other."""
        assert self._other is not None
        scene, settings = self._other
        scene.clip = moment.scene.clip
        between = blended(self.settings, settings, share) if scene is moment.scene else None
        if between is not None:
            return replace(moment, settings=steady(between))
        if share == 1:
            return replace(moment, scene=scene, settings=steady(settings))
        over = Over(scene, steady(settings), share) if share else None
        return replace(moment, over=over)

    def camera(self, frame: int) -> Camera:
        """The camera of a frame, from 0."""
        # a turntable must not show its first frame twice; all else ends where it should
        turn = frame / self.length
        share = frame / max(self.length - 1, 1)
        camera = self._keys.camera(frame / self.movie.fps) if self._keys else self._camera
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


def steady(settings: Settings) -> Settings:
    """Settings of a film's frame: enough rays of occlusion that its grain does not flicker.

    A number of samples that someone chose stays.
    """
    implied = with_implied(settings).occlusion
    if settings.occlusion.samples is not None or implied.technique not in ("ray", "hybrid"):
        return settings
    return settings.replace(occlusion__samples=_STEADY)


def blended(a: Any, b: Any, share: float) -> Any | None:
    """Settings on the way from one to another, by their numbers; ``None`` where words differ."""
    made = {}
    for name, value in vars(a).items():
        other = getattr(b, name)
        if isinstance(value, SettingsGroup):
            value = blended(value, other, share)
            if value is None:
                return None
        elif isinstance(value, float) and isinstance(other, float):
            value = (1 - share) * value + share * other
        elif value != other:
            return None
        made[name] = value
    return type(a)(**made)


def mixed(a: NDArray[np.uint8], b: NDArray[np.uint8], share: float) -> NDArray[np.uint8]:
    """Pictures (h, w, 4) laid over each other, the second ``share`` opaque (a dissolve).

    In display values, in which equal steps look equal, as films are cut.
    """
    weights = (1 - share) * a[..., 3:].astype(np.float32), share * b[..., 3:].astype(np.float32)
    alpha = weights[0] + weights[1]
    color = a[..., :3] * weights[0] + b[..., :3] * weights[1]
    color = np.divide(color, alpha, out=np.zeros_like(color), where=alpha > 0)
    return (np.concatenate([color, alpha], axis=-1) + 0.5).astype(np.uint8)
