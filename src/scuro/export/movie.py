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
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import MissingExtraError, SaveError, SettingsError
from scuro.export.files import check_writable, replacing
from scuro.export.film_names import film_names
from scuro.export.motion import Motion
from scuro.export.png import PngWriter
from scuro.render import Renderer
from scuro.settings import unknown

_PLAN = "plan.json"
_GIF_COLORS = 96
"""Of 256: fewer make smaller files. Chosen by k-means they are nearer to the frames than 192 by
median cut (mean error 0.7 against 2.1 of 255 for a turntable of 1HPV), in three quarters of the
bytes."""
_GIF_ROUNDS = 3
_CODECS = {
    ".mp4": ["-c:v", "libx264", "-crf", "18", "-preset", "medium", "-movflags", "+faststart"],
    ".webm": ["-c:v", "libvpx-vp9", "-crf", "28", "-b:v", "0", "-row-mt", "1"],
}
_COLORS = [
    # chroma in pairs of pixels needs even sizes
    "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white,"
    "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int",
    # said in the file: players take what says nothing for one or the other by its size
    "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1",
    "-color_range", "tv",
]  # fmt: skip
"""HD video's way from sRGB to luma and chroma."""
FORMATS = (".gif", *_CODECS)


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
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise SaveError(self.folder, f"cannot be made: {error.strerror}") from None
        if known != self._digest:
            for left in self.folder.glob("[0-9]" * 6 + ".png"):
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
        for number in missing:
            moment = self.motion.at(number)
            shown = names.at(number) if names is not None else None
            image = renderer.render(moment.scene, moment.camera, moment.settings, shown)
            self.keep(number, image.pixels)
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
        suffix = self.path.suffix.lower()
        try:
            with replacing(self.path) as file:
                if suffix == ".gif":
                    self._gif(file)
                else:
                    self._video(file, _CODECS[suffix], suffix)
        except SaveError as error:
            raise SaveError(
                self.path,
                f"{error.why}; the finished frames are kept in {self.folder}: make room, then run "
                "the same command again",
            ) from None
        shutil.rmtree(self.folder, ignore_errors=True)

    def _frames(self) -> Iterator[NDArray[np.uint8]]:
        """Opaque RGB frames: films lie over the background, or over white."""
        from PIL import Image

        for number in range(self.motion.length):
            with Image.open(self.frame_path(number)) as image:
                pixels = np.asarray(image.convert("RGBA"))
            alpha = pixels[..., 3:].astype(np.float32) / 255
            yield (pixels[..., :3] * alpha + 255 * (1 - alpha) + 0.5).astype(np.uint8)

    def _gif(self, file: Any) -> None:
        """One palette for all frames, from some of them; no dither, which flickers and is large."""
        from PIL import Image

        step = max(1, self.motion.length // 8)
        some = [f[::2, ::2] for i, f in enumerate(self._frames()) if i % step == 0]
        palette = Image.fromarray(np.concatenate(some)).quantize(
            _GIF_COLORS, Image.Quantize.MEDIANCUT, kmeans=_GIF_ROUNDS
        )
        frames = (
            Image.fromarray(f).quantize(palette=palette, dither=Image.Dither.NONE)
            for f in self._frames()
        )
        first = next(frames)
        # GIF counts in hundredths of a second
        duration = max(20, round(100 / self.motion.movie.fps) * 10)
        first.save(
            file, "GIF", save_all=True, append_images=frames, duration=duration, loop=0,
            optimize=False, disposal=1,
        )  # fmt: skip

    def _video(self, file: Any, codec: list[str], suffix: str) -> None:
        import imageio_ffmpeg

        width, height = self.motion.settings.size
        beside = self.folder / f"film{suffix}"
        writer = imageio_ffmpeg.write_frames(
            str(beside),
            (width, height),
            fps=self.motion.movie.fps,
            codec=codec[1],
            quality=None,
            macro_block_size=1,
            pix_fmt_out="yuv420p",
            output_params=[*codec[2:], *_COLORS],
        )
        try:
            writer.send(None)
            for frame in self._frames():
                writer.send(np.ascontiguousarray(frame))
            writer.close()
            # the encoder's exit says nothing of a disk that was full: count what it wrote
            if _frames_in(beside) != self.motion.length:
                raise StopIteration
            with open(beside, "rb") as made:
                shutil.copyfileobj(made, file)
        except (OSError, StopIteration) as error:
            why = getattr(error, "strerror", None) or "the encoder stopped, is the disk full?"
            raise SaveError(self.path, f"cannot be written: {why}") from None
        finally:
            beside.unlink(missing_ok=True)


def _frames_in(path: Path) -> int:
    """Frames of a video; 0 where it is damaged."""
    import imageio_ffmpeg

    try:
        return int(imageio_ffmpeg.count_frames_and_secs(str(path))[0])
    except (RuntimeError, OSError):
        return 0


def check_format(path: str | PathLike[str]) -> None:
    """Raise if a film cannot be written in the format that a name asks for."""
    suffix = Path(path).suffix.lower()
    if suffix and suffix not in FORMATS:
        raise SettingsError(
            unknown("film format", suffix, FORMATS) + ", or a folder for numbered frames"
        )
    if suffix in _CODECS:
        try:
            import imageio_ffmpeg  # noqa: F401
        except ImportError:
            raise MissingExtraError("MP4 and WebM films", "movie") from None


def stamps(paths: list[str]) -> list[Any]:
    """Sizes and times of input files: a changed input makes another film."""
    files = map(Path, paths)
    return [[f.stat().st_size, f.stat().st_mtime_ns] if f.is_file() else str(f) for f in files]
