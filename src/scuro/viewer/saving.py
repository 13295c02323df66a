"""Pictures, films and scene files from the panel: the same as the command line makes."""

from __future__ import annotations

import itertools
import shutil
from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SaveError, ScuroError, SettingsError
from scuro.export.files import replacing
from scuro.export.film_names import film_names
from scuro.export.motion import Moment, Motion, MovieSettings, mixed
from scuro.export.movie import Film, check_format
from scuro.export.scene_file import SceneFile, write_scene_file
from scuro.image import Image
from scuro.passes.frame import Frame
from scuro.render import Renderer
from scuro.render_marks import picture_marks
from scuro.render_names import Names
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.scene import Scene
from scuro.settings import SettingsGroup, setting
from scuro.steps import in_thread
from scuro.style.marks import paint
from scuro.viewer.drawing import Drawing, Drawn
from scuro.viewer.jobs import Jobs, Work, in_turns, scaled
from scuro.viewer.view import View

LARGEST = 16384
"""Pixels along a side of a picture from the panel."""
Deliver = Callable[[str, Callable[[Path], None]], str]
"""Takes a name and a function that writes the file to a path; returns a sentence for people."""


class PictureSettings(SettingsGroup):
    """Pictures from the panel."""

    name: str = setting("scuro.png", "file name: .png, .tif, .exr, .jpg or .webp")
    scale: float = setting(
        1.0, "size in relation to what is on the screen", low=0.1, high=16, unit="×"
    )
    bits: str = setting("8", "per channel, in PNG and TIFF", choices=("8", "16"))


class FilmSettings(SettingsGroup):
    """Films from the panel."""

    name: str = setting(
        "scuro.gif", "file name: .gif, .mp4 or .webm; without an ending a folder of numbered frames"
    )
    scale: float = setting(
        1.0, "size in relation to what is on the screen", low=0.1, high=8, unit="×"
    )


class Saving:
    """What one screen saves, drawn a slice at a time beside what it shows.

    Args:
        view: Of what.
        jobs: Does the slices.
        deliver: Where files go.
        elsewhere: Whether that is another machine: paths in files are then absolute.
    """

    def __init__(self, view: View, jobs: Jobs, deliver: Deliver, elsewhere: bool = False) -> None:
        self.view = view
        self._jobs = jobs
        self._deliver = deliver
        self._elsewhere = elsewhere
        self.picture_settings = PictureSettings()
        self.film_settings = FilmSettings()
        self.movie = MovieSettings(length=60)

    def scene(self) -> None:
        """A scene file."""
        document = self.view.document()
        relative = not self._elsewhere
        self.deliver("scene.toml", lambda path: write_scene_file(path, document, relative=relative))

    def deliver(self, name: str, write: Callable[[Path], None]) -> None:
        """A file that is written at once."""
        try:
            self._jobs.message, self._jobs.failed = self._deliver(name, write), False
        except ScuroError as error:
            self._jobs.message, self._jobs.failed = str(error), True

    def picture(self) -> None:
        """The full picture of what is on the screen."""
        chosen = self.picture_settings
        document = self._sized(chosen.scale, LARGEST)
        self._jobs.add(chosen.name, self._picture(document, self.view.camera, chosen))

    def film(self) -> None:
        """A film that begins with what is on the screen."""
        most = self.view.renderer.gpu.max_texture
        document = self._sized(self.film_settings.scale, min(LARGEST, most))
        self._jobs.add(self.film_settings.name, self._film(document, self.movie))

    def _sized(self, scale: float, most: int) -> SceneFile:
        document = self.view.document()
        width, height = (max(1, round(s * scale)) for s in self.view.size)
        if max(width, height) > most:
            raise SettingsError(
                f"a picture from the panel has at most {most} pixels a side: lower its scale, or "
                "save the scene file for 'scuro render'"
            )
        settings = document.settings.replace(size=(width, height))
        if self.view.model.settings.text is None and settings.text is not None:
            settings = settings.replace(text=settings.text * scale)  # of the screen's letters
        return replace(document, settings=settings)

    def _picture(self, document: SceneFile, camera: Camera, chosen: PictureSettings) -> Work:
        from scuro.export.formats import check_format as check_picture

        name = _file_name(chosen.name)
        check_picture(name, document.settings.size, int(chosen.bits))
        model, renderer = self.view.model, self.view.renderer.sibling()
        state = model.history.present

        def dressed() -> Scene:
            if model.history.present is not state:
                raise SettingsError("the scene was changed meanwhile: save it again")
            return model.dressed(camera)

        several = len(renderer.parts(document.settings)) > 1
        if several or chosen.bits == "16" or name.lower().endswith(".exr"):
            return (
                yield from self._print(name, renderer, dressed, camera, document, int(chosen.bits))
            )
        pixels = yield from _pixels(renderer, dressed, camera, document.settings)
        image = Image(pixels, None, document.settings)

        def write(path: Path) -> None:
            folder = None if self._elsewhere else path.parent
            image.save(path, settings=document.as_dict(folder))

        return self._deliver(name, write)

    def _print(
        self,
        name: str,
        renderer: Renderer,
        dressed: Callable[[], Scene],
        camera: Camera,
        document: SceneFile,
        bits: int,
    ) -> Work:
        """Draw a picture part by part, each a slice, into a file that is delivered when whole."""
        from scuro.export.parts import save_in_parts

        settings = document.settings
        count = len(renderer.parts(settings))

        def draw(path: Path, pause: Callable[[float], None]) -> None:
            done = itertools.count(1)

            def on_part(frame: Frame) -> None:
                pause(min(next(done) / count, 1.0))
                dressed()

            save_in_parts(
                path,
                renderer,
                dressed(),
                camera,
                settings,
                bits=bits,
                note=document.as_dict(None if self._elsewhere else Path.cwd()),
                on_part=on_part,
            )

        with TemporaryDirectory(prefix="scuro-") as folder:
            made = Path(folder) / name
            yield from in_turns(partial(draw, made))
            return self._deliver(name, lambda path: _copy(made, path))

    def _film(self, document: SceneFile, movie: MovieSettings) -> Work:
        name = _file_name(self.film_settings.name)
        check_format(name)
        # a scene of its own: what is on the screen may change meanwhile
        motion = yield from in_thread(lambda: Motion(document, movie))
        renderer, other = (Renderer(gpu=self.view.renderer.gpu) for _ in range(2))
        with TemporaryDirectory(prefix="scuro-") as folder:
            film = Film(Path(folder) / name, motion, {})
            names = film_names(renderer, motion)
            for number in range(motion.length):
                shown = names.at(number) if names is not None else None
                frame = _moment(renderer, other, motion.at(number), shown)
                film.keep(number, (yield from _shifted(frame, number, motion.length)))
            yield from scaled(in_thread(film.join), 1.0, 1.0)
            if film.joined:
                return self._deliver(name, lambda path: _copy(film.path, path))
            if not self._elsewhere:
                return self._deliver(name, lambda path: _copy_folder(film.path, path))
            packed = Path(folder) / f"{name}.zip"
            yield from scaled(in_thread(partial(_pack, film.path, packed)), 1.0, 1.0)
            return self._deliver(packed.name, lambda path: _copy(packed, path))


def _copy(made: Path, path: Path) -> None:
    """Put a finished file where it was wanted, whole or not at all."""
    with made.open("rb") as source, replacing(path) as file:
        shutil.copyfileobj(source, file)


def _copy_folder(made: Path, path: Path) -> None:
    """Put a finished folder where it was wanted, whole or not at all."""
    begun = path.with_name(f".{path.name}.part")
    try:
        shutil.copytree(made, begun, dirs_exist_ok=True)
        begun.rename(path)
    except OSError as error:
        raise SaveError(path, f"cannot be written: {error.strerror}") from None
    finally:
        shutil.rmtree(begun, ignore_errors=True)


def _pack(folder: Path, path: Path) -> None:
    """Write a folder of pictures, which cannot be compressed any more, into a ZIP file."""
    with ZipFile(path, "w") as packed:
        for file in sorted(folder.iterdir()):
            packed.write(file, f"{folder.name}/{file.name}")


def _moment(
    renderer: Renderer, other: Renderer, moment: Moment, names: Names | None
) -> Generator[float, None, NDArray[np.uint8]]:
    """Draw a film's frame in slices; ``other`` draws what it passes over into."""
    over = moment.over
    count = 1 if over is None else 2
    first = _pixels(renderer, lambda: moment.scene, moment.camera, moment.settings, names)
    pixels = yield from _shifted(first, 0, count)
    if over is not None:
        second = _pixels(other, lambda: over.scene, moment.camera, over.settings, names)
        pixels = mixed(pixels, (yield from _shifted(second, 1, count)), over.share)
    return pixels


def _shifted(
    frame: Generator[float, None, NDArray], number: int, length: int
) -> Generator[float, None, NDArray]:
    """A frame's share of its film."""
    with closing(frame):
        while True:
            try:
                share = next(frame)
            except StopIteration as end:
                pixels: NDArray = end.value
                return pixels
            yield (number + share) / length


def _pixels(
    renderer: Renderer,
    scene: Callable[[], Scene],
    camera: Camera,
    settings: Settings,
    names: Names | None = None,
) -> Generator[float, None, NDArray[np.uint8]]:
    """Draw a full picture in slices: the pixels (h, w, 4) that :meth:`Renderer.render` makes."""
    import time

    from scuro.viewer.refine import steps

    drawing = Drawing(renderer, time.perf_counter, kept={"picture": "rgba8unorm"})
    for share in renderer.prepare(scene(), camera, settings):
        yield share / 2
        scene()
    path = settings.renderer == "path"
    for step in steps(settings) if path else [None]:
        for made in drawing.draw(scene(), camera, step.settings if step else settings, not path):
            if isinstance(made, Drawn):
                drawn = made
                yield step.share if step else 1.0
            else:
                yield made
            scene()
    pixels = renderer.gpu.read_texture(drawn.resources["picture"])
    return paint(pixels, picture_marks(renderer, scene(), camera, settings, names))


def _file_name(name: str) -> str:
    """A name without a folder: where files go is not for pages to choose."""
    bare = Path(name.replace("\\", "/")).name
    if not bare or bare.startswith("."):
        raise SettingsError(f"'{name}' is no name of a file")
    return bare
