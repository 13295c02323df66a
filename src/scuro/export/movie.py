"""Films: frames drawn one by one into a folder beside the film, then joined.

Whatever stops the work, finished frames stay; the same command goes on from them, and since every
frame depends on nothing but its number, the film is the same as without the break.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import shutil
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from scuro.errors import MissingExtraError, SaveError, SettingsError
from scuro.export.encoders import CODECS, frames_in, write_gif, write_video
from scuro.export.files import check_writable, replacing
from scuro.export.film_names import film_names
from scuro.export.motion import Motion, mixed
from scuro.export.png import PngWriter
from scuro.render import Renderer
from scuro.settings import unknown

_PLAN = "plan.json"
FORMATS = (".gif", *CODECS)
_FRAME = "[0-9]" * 6 + ".png"
"""Pattern of the frames' names."""


class Film:
    """A film on its way to a file.

    Args:
        path: ``.gif``, ``.mp4``, ``.webm``, or a folder for numbered PNG frames.
        motion: What is drawn.
        about: All that the frames depend on; frames of another film are not taken for this one's.

    Raises:
        SettingsError: No such format.
        SaveError: The place cannot be written.
    """

    def __init__(self, path: str | PathLike[str], motion: Motion, about: dict[str, Any]) -> None:
        self.path, self.motion = Path(path), motion
        check_format(path)
        self.joined = self.path.suffix.lower() in FORMATS
        if self.joined:
            check_writable(path)
            self.folder = self.path.with_name(f"{self.path.name}.frames")
        else:
            self.folder = self.path
        self._digest = hashlib.sha256(json.dumps(about, sort_keys=True).encode()).hexdigest()
        self._prepare()

    def _prepare(self) -> None:
        plan = self.folder / _PLAN
        known = None
        with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
            known = json.loads(plan.read_text("utf-8"))["film"]
        if self.folder.exists() and not self.folder.is_dir():
            raise SaveError(self.folder, "is a file: give a folder for numbered frames")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise SaveError(self.folder, f"cannot be made: {error.strerror}") from None
        for begun in (*self.folder.glob(f".{_FRAME}.*"), *self.folder.glob(f".{_PLAN}.*")):
            begun.unlink(missing_ok=True)  # of a process that was killed
        if known != self._digest:
            for left in self.folder.glob(_FRAME):
                left.unlink()
            with replacing(plan) as file:
                file.write(json.dumps({"film": self._digest}).encode())

    def frame_path(self, number: int) -> Path:
        """Where a frame is kept."""
        return self.folder / f"{number:06d}.png"

    @property
    def missing(self) -> list[int]:
        """Numbers of the frames still to draw."""
        return [n for n in range(self.motion.length) if not self.frame_path(n).exists()]

    def draw(self, renderer: Renderer) -> Iterator[int]:
        """Draw the missing frames; gives the number of each when it is safe on disk."""
        missing = self.missing
        names = film_names(renderer, self.motion) if missing else None
        other: Renderer | None = None
        for number in missing:
            moment = self.motion.at(number)
            shown = names.at(number) if names is not None else None
            pixels = renderer.render(moment.scene, moment.camera, moment.settings, shown).pixels
            if (over := moment.over) is not None:
                # with what is built for the other look, which stays from frame to frame
                other = other or Renderer(gpu=renderer.gpu)
                image = other.render(over.scene, moment.camera, over.settings, shown)
                pixels = mixed(pixels, image.pixels, over.share)
            try:
                self.keep(number, pixels)
            except SaveError as error:
                raise self._kept(error) from None
            yield number

    def keep(self, number: int, pixels: NDArray[np.uint8]) -> None:
        """Write a frame (h, w, 4) that was drawn."""
        height, width = pixels.shape[:2]
        with replacing(self.frame_path(number)) as file:
            writer = PngWriter(file, (width, height), 4)
            writer.write_rows(pixels)
            writer.finish()

    def join(self) -> None:
        """Make the film of its frames and remove them; numbered frames stay as they are."""
        if not self.joined:
            (self.folder / _PLAN).unlink()
            return
        suffix, movie = self.path.suffix.lower(), self.motion.movie
        try:
            # what is half written stays in the folder, which goes or is used again
            with replacing(self.path, self.folder) as file:
                if suffix == ".gif":
                    write_gif(file, self._frames, self.motion.length, movie.fps)
                else:
                    self._video(file, suffix)
        except SaveError as error:
            raise self._kept(error) from None
        shutil.rmtree(self.folder, ignore_errors=True)

    def _kept(self, error: SaveError) -> SaveError:
        return SaveError(
            self.path,
            f"{error.why}; the finished frames are kept in {self.folder}: make room, then run the "
            "same command again",
        )

    def _video(self, file: BinaryIO, suffix: str) -> None:
        made = self.folder / f"film{suffix}"
        try:
            write_video(made, self._frames(), self.motion.settings.size, self.motion.movie.fps)
            # the encoder's exit says nothing of a disk that was full: count what it wrote
            if frames_in(made) != self.motion.length:
                raise SaveError(self.path, "cannot be written: the encoder stopped, disk full?")
            with open(made, "rb") as whole:
                shutil.copyfileobj(whole, file)
        finally:
            made.unlink(missing_ok=True)

    def _frames(self) -> Iterator[NDArray[np.uint8]]:
        """Opaque RGB frames: films lie over the background, or over white."""
        from PIL import Image

        for number in range(self.motion.length):
            with Image.open(self.frame_path(number)) as image:
                pixels = np.asarray(image.convert("RGBA"))
            alpha = pixels[..., 3:].astype(np.float32) / 255
            yield (pixels[..., :3] * alpha + 255 * (1 - alpha) + 0.5).astype(np.uint8)


def check_format(path: str | PathLike[str]) -> None:
    """Raise if a film cannot be written in the format that a name asks for."""
    suffix = Path(path).suffix.lower()
    if not Path(path).name:
        raise SettingsError(f"'{path}' is no name for a film: give a file, or a folder for frames")
    if suffix and suffix not in FORMATS:
        raise SettingsError(
            unknown("film format", suffix, FORMATS) + ", or a folder for numbered frames"
        )
    if suffix in CODECS:
        try:
            import imageio_ffmpeg  # noqa: F401
        except ImportError:
            raise MissingExtraError("MP4 and WebM films", "movie") from None


def stamps(paths: list[str]) -> list[Any]:
    """Sizes and times of input files: a changed input makes another film."""
    files = map(Path, paths)
    return [[f.stat().st_size, f.stat().st_mtime_ns] if f.is_file() else str(f) for f in files]
