"""Names in a film: they stay on their points, do not flicker, and come and go by fading.

The whole film is known before its first frame is drawn, so a name's times are chosen with all of it
in view, as Been, Daiches and Yap (2006, "Dynamic map labeling") choose the ranges of scale in which
a map's labels are active: from surveys at a few frames a second tracks are made, each a name on one
point of the scene; the more a track shows over the film, the earlier it takes its room; and it is
active only in stretches long enough to fade in and out. All this follows from the film alone: a
film that is broken off and taken up again is the same.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scuro.passes.post.stereo import eye_size
from scuro.render_marks import Sight, fixed_marks, tells_regions
from scuro.render_names import Names, Standing, name_extent, namer_of, taken_by, text_size, wanted
from scuro.scene.projection import project
from scuro.style.labels import overlapping
from scuro.style.region_labels import RegionLabel, region_labels

if TYPE_CHECKING:
    from scuro.export.motion import Moment, Motion
    from scuro.render import Renderer
    from scuro.style.marks import Mark, Rect

SURVEYS = 5.0
"""A second of the film, at least, and so many in all: a short film changes faster."""
LEAST_SURVEYS, MOST_SURVEYS = 60, 300
FADE = 0.2
"""Seconds in which a name comes or goes."""
_SEEN = 0.02
"""Opacity below which a name is not there."""
Point = tuple[float, float, float]


@dataclass
class _Track:
    """A name on one point, through successive surveys."""

    label: RegionLabel
    first: int
    """Survey in which it appears."""
    offset: Point
    """From the atom that the point belongs to; from the origin where it belongs to none."""
    points: list[Point] = field(default_factory=list)
    weights: list[float] = field(default_factory=list)
    areas: list[float] = field(default_factory=list)

    @property
    def worth(self) -> float:
        """How much it shows over the film."""
        return float(np.dot(self.areas, self.weights))


class FilmNames:
    """The names of all frames of a film.

    Args:
        renderer: Draws the surveys.
        motion: The film.

    Raises:
        SettingsError: There is nothing of what should be named.
    """

    def __init__(self, renderer: Renderer, motion: Motion) -> None:
        self._motion = motion
        self._size = eye_size(motion.settings.stereo, motion.settings.size)
        every = min(round(motion.movie.fps / SURVEYS), motion.length // LEAST_SURVEYS)
        every = max(1, every, -(-motion.length // MOST_SURVEYS))
        self._surveyed = sorted({*range(0, motion.length, every), motion.length - 1})
        self._fixed: set[Rect] = set()
        tracks = self._tracks(renderer)
        tracks.sort(key=lambda track: -track.worth)
        self._chosen = self._active(tracks)

    def at(self, frame: int) -> Names:
        """Labels of a frame, and the pixels that they are centred on."""
        return [
            (replace(track.label, opacity=float(opacity[frame]), anchor=tuple(points[frame])),
             float(places[frame, 0]), float(places[frame, 1]))
            for track, opacity, points, places in self._chosen
            if opacity[frame] > _SEEN
        ]  # fmt: skip

    def _tracks(self, renderer: Renderer) -> list[_Track]:
        """Names and their points, from survey to survey."""
        every: list[_Track] = []
        going: dict[Hashable, _Track] = {}
        for index, frame in enumerate(self._surveyed):
            moment = self._motion.at(frame)
            scene, camera, settings = moment.scene, moment.camera, moment.settings
            settings = settings.replace(labels=self._motion.settings.labels)
            survey = renderer.survey(scene, camera, settings)
            standing = Standing(camera, settings, renderer.accelerator(scene))
            sight = Sight(standing, survey) if tells_regions(scene, settings) else None
            self._fixed |= _whole_pixels(fixed_marks(scene, camera, settings, sight))
            levels = wanted(scene, standing)
            keep = {key: _moved(track, moment) for key, track in going.items()}
            found = region_labels(survey, namer_of(scene, settings), levels, keep)
            before, going = going, {}
            for label in found:
                track = before.get(label.key)
                if track is None or label.anchor != keep[label.key]:
                    origin = _origin(label, moment)
                    track = _Track(label, index, _plus(label.anchor, -origin))
                    every.append(track)
                track.points.append(label.anchor)
                track.weights.append(label.opacity)
                track.areas.append(label.area)
                going[label.key] = track
        return every

    def _active(
        self, tracks: list[_Track]
    ) -> list[tuple[_Track, NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]]:
        """Tracks with their opacity, point and pixel in every frame."""
        settings, length = self._motion.settings, self._motion.length
        frames = np.arange(length)
        cameras = [self._motion.camera(int(n)) for n in frames]
        # legends and bars change with the view: a name that gave way to each of them would flicker
        room = _largest(self._fixed)[:, None].repeat(length, axis=1)
        count = np.zeros(length, int)
        fade = max(1, round(FADE * self._motion.movie.fps))
        chosen = []
        for track in tracks:
            at = self._surveyed[track.first : track.first + len(track.points)]
            points = np.stack(
                [np.interp(frames, at, axis) for axis in np.array(track.points).T], axis=1
            )
            weight = np.interp(frames, at, track.weights)
            weight[(frames < at[0]) | (frames > at[-1])] = 0
            places = np.array(
                [project(c, [p], self._size)[0] for c, p in zip(cameras, points, strict=True)]
            )
            wide, high = name_extent(track.label.text, text_size(settings))
            half = np.array([wide / 2, high / 2])
            boxes = np.concatenate([places[:, :2] - half, places[:, :2] + half], axis=1)
            with np.errstate(invalid="ignore"):
                seen = (boxes[:, :2] >= 0).all(axis=1) & (boxes[:, 2:] <= self._size).all(axis=1)
            seen &= (places[:, 2] > 0) & (weight > _SEEN) & (count < settings.labels.most)
            seen &= ~overlapping(room, boxes).any(axis=0)
            opacity = weight * _ramps(seen, fade)
            shown = opacity > 0
            if not shown.any():
                continue
            count += shown
            boxes[~shown] = -1e9
            room = np.concatenate([room, boxes[None]])
            chosen.append((track, opacity, points, places))
        return chosen


def film_names(renderer: Renderer, motion: Motion) -> FilmNames | None:
    """The names of a film, if its settings want any."""
    return None if motion.settings.labels.show == "none" else FilmNames(renderer, motion)


def _ramps(seen: NDArray[np.bool_], fade: int) -> NDArray[np.float64]:
    """(n,) 0 to 1: in each stretch long enough, up at its begin and down at its end.

    At the film's own ends nothing fades.
    """
    length = len(seen)
    ramps = np.zeros(length)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], seen.astype(int), [0]])))
    for start, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if end - start < min(2 * fade + 1, length):
            continue
        n = np.arange(start, end)
        up = (n - start + 1) / (fade + 1) if start > 0 else np.ones(end - start)
        down = (end - n) / (fade + 1) if end < length else np.ones(end - start)
        ramps[start:end] = np.minimum(np.minimum(up, down), 1)
    return ramps


def _whole_pixels(marks: Sequence[Mark]) -> set[Rect]:
    """Where marks lie, in whole pixels."""
    boxes = np.array(taken_by(marks)).reshape(-1, 4)
    whole = np.concatenate([np.floor(boxes[:, :2]), np.ceil(boxes[:, 2:])], axis=1)
    return {(left, top, right, bottom) for left, top, right, bottom in whole.tolist()}


def _largest(boxes: set[Rect]) -> NDArray[np.float64]:
    """(n, 4) those of different boxes that lie in no other."""
    each = np.array(sorted(boxes), np.float64).reshape(-1, 4)
    kept: list[NDArray[np.float64]] = []
    for box in each[np.argsort(-np.prod(each[:, 2:] - each[:, :2], axis=1), kind="stable")]:
        if not any((k[:2] <= box[:2]).all() and (k[2:] >= box[2:]).all() for k in kept):
            kept.append(box)
    return np.array(kept).reshape(-1, 4)


def _moved(track: _Track, moment: Moment) -> Point:
    """Where a track's point is now: it goes with its atom."""
    return _plus(track.offset, _origin(track.label, moment))


def _origin(label: RegionLabel, moment: Moment) -> NDArray[np.float64]:
    """The position of a label's atom where the film plays a trajectory; else the origin."""
    molecules = moment.scene.molecules
    if not moment.plays or label.element[0] >= len(molecules[0].molecule):
        return np.zeros(3)
    return np.asarray(molecules[0].molecule.positions[label.element[0]], np.float64)


def _plus(point: Point, other: NDArray) -> Point:
    x, y, z = (np.asarray(point) + other).tolist()
    return x, y, z
