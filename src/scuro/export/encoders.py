"""Frames to one file: GIF by Pillow, MP4 and WebM by FFmpeg."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SaveError

Pixels = NDArray[np.uint8]
"""A frame: opaque sRGB, (h, w, 3)."""

GIF_COLORS = 96
"""Of 256: fewer make smaller files. Chosen by k-means they are nearer to the frames than 192 by
median cut (mean error 0.7 against 2.1 of 255 for a turntable of 1HPV), in three quarters of the
bytes."""
_GIF_ROUNDS = 3
_GIF_SAMPLES = 8
"""Frames that the palette is made from."""
CODECS = {
    ".mp4": ["-c:v", "libx264", "-crf", "18", "-preset", "medium", "-movflags", "+faststart"],
    ".webm": ["-c:v", "libvpx-vp9", "-crf", "28", "-b:v", "0", "-row-mt", "1"],
}
_COLORS = [
    "-vf", "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,"
    # said in the file: players take what says nothing for one or the other by its size. Said of the
    # frames, as what these leave open would win over what is said of the output
    "setparams=colorspace=bt709:color_primaries=bt709:color_trc=iec61966-2-1:range=tv",
]  # fmt: skip
"""HD video's way from sRGB to luma and chroma."""
_SAME = ["-fflags", "+bitexact"]
"""No random marks: the same frames make the same file."""


def write_gif(
    file: BinaryIO, frames: Callable[[], Iterator[Pixels]], length: int, fps: float
) -> None:
    """A film that loops: one palette for all frames, no dither, which flickers and is large.

    Args:
        file: Open for writing.
        frames: Gives all frames, each time it is called.
        length: How many they are.
        fps: A second; GIF counts in hundredths of one and players take none under 0.02 s.
    """
    from PIL import Image

    colors = _palette(frames(), length)
    nearest = _Nearest(colors)

    def indexed() -> Iterator[Image.Image]:
        for frame in frames():
            image = Image.fromarray(nearest(frame), "P")
            image.putpalette(colors.tobytes())
            yield image

    pages = indexed()
    first = next(pages)
    duration = max(20, round(100 / fps) * 10)
    first.save(
        file, "GIF", save_all=True, append_images=pages, duration=duration, loop=0,
        optimize=False, disposal=1,
    )  # fmt: skip


def _palette(frames: Iterable[Pixels], length: int) -> NDArray[np.uint8]:
    """(k, 3) colours for a film, from some of its frames; its commonest colour is among them."""
    from PIL import Image

    step = max(1, length // _GIF_SAMPLES)
    some = np.concatenate([f[::2, ::2] for i, f in enumerate(frames) if i % step == 0])
    image = Image.fromarray(some).quantize(GIF_COLORS, Image.Quantize.MEDIANCUT, kmeans=_GIF_ROUNDS)
    colors = np.array((image.getpalette() or [])[: 3 * GIF_COLORS], np.uint8).reshape(-1, 3)
    # a background that is a little off shows, above all on a page of its own color
    packed, counts = np.unique(_packed(some), return_counts=True)
    common = packed[np.argmax(counts)]
    exact = np.array([common >> 16, common >> 8 & 255, common & 255])
    colors[np.argmin(np.abs(colors.astype(int) - exact).sum(axis=1))] = exact
    return colors


class _Nearest:
    """The index of the palette's nearest colour for each pixel.

    Pillow's own way takes one colour for all of a cube of 4 x 4 x 4 values.
    """

    def __init__(self, colors: NDArray[np.uint8]) -> None:
        from scipy.spatial import KDTree

        self._tree = KDTree(colors.astype(np.float64))

    def __call__(self, frame: Pixels) -> NDArray[np.uint8]:
        packed, inverse = np.unique(_packed(frame), return_inverse=True)
        colors = np.stack([packed >> 16, packed >> 8 & 255, packed & 255], axis=1)
        _, index = self._tree.query(colors)
        return index.astype(np.uint8)[inverse].reshape(frame.shape[:2])


def _packed(frame: Pixels) -> NDArray[np.uint32]:
    """Each pixel's colour as one number, flat."""
    r, g, b = np.moveaxis(frame.reshape(-1, 3).astype(np.uint32), -1, 0)
    return (r << 16 | g << 8 | b).astype(np.uint32)


def write_video(path: Path, frames: Iterable[Pixels], size: tuple[int, int], fps: float) -> None:
    """MP4 or WebM, by the path's ending.

    Raises:
        SaveError: The encoder stopped.
    """
    import imageio_ffmpeg

    codec = CODECS[path.suffix]
    # chroma in pairs of pixels needs even sizes: the last row and column are repeated
    more = size[0] % 2, size[1] % 2
    writer = imageio_ffmpeg.write_frames(
        str(path),
        (size[0] + more[0], size[1] + more[1]),
        fps=fps,
        codec=codec[1],
        quality=None,
        macro_block_size=1,
        pix_fmt_out="yuv420p",
        output_params=[*codec[2:], *_COLORS, *_SAME],
    )
    try:
        writer.send(None)
        for frame in frames:
            even = np.pad(frame, ((0, more[1]), (0, more[0]), (0, 0)), "edge")
            writer.send(np.ascontiguousarray(even))
    except (OSError, StopIteration) as error:
        why = getattr(error, "strerror", None) or "the encoder stopped, is the disk full?"
        raise SaveError(path, f"cannot be written: {why}") from None
    finally:
        writer.close()


def frames_in(path: Path) -> int:
    """Frames of a video; 0 where it is damaged."""
    import imageio_ffmpeg

    try:
        return int(imageio_ffmpeg.count_frames_and_secs(str(path))[0])
    except (RuntimeError, OSError):
        return 0
