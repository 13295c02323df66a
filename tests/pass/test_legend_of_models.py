"""The legend of cell-scale models: names and colours of what is in view, at the level in view."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from scuro.export.film_names import FilmNames
from scuro.render import Renderer
from scuro.render_marks import picture_marks
from scuro.render_names import name_text
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.model import Ingredient, MesoscaleModel, Part, Structure
from scuro.scene.scene import Scene
from scuro.style.labels import overlapping
from scuro.style.marks import Box, Text

PLACES = {
    ("cell", "outside", "albumin"): -30.0,
    ("cell", "inside", "enzyme_0_1_0"): 0.0,
    ("cell", "inside", "capsid"): 30.0,
}


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


def cell() -> Scene:
    """Three balls beside each other, each an ingredient; the middle one is the smallest."""
    made = []
    for path, x in PLACES.items():
        radius = 8.0 if path[-1].startswith("enzyme") else 12.0
        ball = Structure.of_spheres(path[-1], np.array([[0, 0, 0, radius]], np.float32))
        turn = np.array([[0, 0, 0, 1]], np.float32)
        made.append(Ingredient(path, (Part(ball, turn, np.array([[x, 0, 0]])),)))
    return Scene().add(MesoscaleModel("cell", tuple(made)))


def legend(renderer: Renderer, camera: Camera, **changes) -> dict[str, tuple[int, int, int]]:
    """Colours by name, in the order of the lines, as they are drawn; the title has none."""
    settings = Settings(size=(160, 120)).replace(legend__show=True, **changes)
    marks = picture_marks(renderer, cell(), camera, settings)
    swatches = [m for m in marks if isinstance(m, Box)][1:]
    title, *names = [m.text for m in marks if isinstance(m, Text)]
    assert title in ("compartment", "ingredient") and len(names) == len(swatches)
    return {name: box.color[:3] for name, box in zip(names, swatches, strict=True)}


def camera(distance: float, x: float = 0.0) -> Camera:
    return Camera((x, 0, distance), (x, 0, 0), (0, 1, 0), 30)


def test_lines_are_those_of_the_level_in_view(renderer):
    semantic = {"semantic__mode": "screen", "semantic__thresholds": (400.0, 200.0)}
    assert list(legend(renderer, camera(400), **semantic)) == ["outside", "inside"]
    near = legend(renderer, camera(200), **semantic)
    assert list(near) == ["albumin", "enzyme", "capsid"]
    # without levels the ingredients' own colours
    assert list(legend(renderer, camera(400))) == ["albumin", "enzyme", "capsid"]


def test_only_what_is_in_view_is_told(renderer):
    assert list(legend(renderer, camera(60, x=-32))) == ["albumin"]


def test_colours_are_those_of_the_picture(renderer):
    for changes in ({}, {"semantic__mode": "screen", "semantic__palette": "#ff8000,#0060ff"}):
        told = legend(renderer, camera(200), **changes)
        settings = Settings(size=(160, 120)).replace(**changes)
        for _, frame in renderer.frames(cell(), camera(200), settings):
            albedo = renderer.gpu.read_texture(frame.resources["albedo"]).astype(float)
            ids = renderer.gpu.read_texture(frame.resources["ids"])[..., 2]
        for number, color in enumerate(told.values()):
            linear = albedo[ids == number][0, :3]
            srgb = np.where(
                linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055
            )
            np.testing.assert_allclose(255 * srgb, color, atol=1.0)


def test_names_of_a_film_keep_off_the_legend(renderer):
    """Its lines go with what is in view; names keep off the largest that it becomes."""
    settings = Settings(size=(320, 240)).replace(
        labels__show="regions", legend__show=True, lighting__preset="simple"
    )
    scene = cell()
    at = [Camera((x, 22, 130), (x, 22, 0), (0, 1, 0), 30) for x in np.linspace(-30, 50, 12)]
    film = SimpleNamespace(
        settings=settings, movie=SimpleNamespace(fps=6.0), length=len(at), scene=scene,
        camera=lambda n: at[n],
        at=lambda n: SimpleNamespace(scene=scene, camera=at[n], settings=settings, plays=False),
    )  # fmt: skip
    names = FilmNames(renderer, film)
    shown = 0
    for n, here in enumerate(at):
        (legend,) = (
            m for m in picture_marks(renderer, scene, here, settings, []) if isinstance(m, Box)
            and m.box[2] - m.box[0] > 60
        )  # fmt: skip
        boxes = [name_text(*name, settings).box for name in names.at(n)]
        shown += len(boxes)
        assert not any(overlapping(np.array([legend.box]), np.array(box)).any() for box in boxes)
    assert shown
