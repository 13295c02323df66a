"""Frames leave no memory behind, as those of lavapipe may (docs/decisions.md, Viewer)."""

import gc

import pytest

from scuro.export.scene_file import Input, SceneFile, Show
from scuro.gpu.program import Programs
from scuro.measure.memory import held
from scuro.render_settings import Settings
from scuro.scene.clip import Clip, Plane

MOST = 150.0
"""kB a frame: such a loss is 200 kB a dispatch, the caches of uniforms that still fill some 30."""


def used():
    """kB that malloc has given out."""
    gc.collect()
    pieces = held()
    if not pieces:
        pytest.skip("needs mallinfo2 of the GNU C library")
    return 1024 * sum(pieces.values())


@pytest.fixture(scope="module")
def scenes():
    def scene(style):
        document = SceneFile(input=(Input(path="sample:1hpv"),), show=(Show(style=style),))
        return document.scene()

    return {style: scene(style) for style in ("spacefill", "cartoon")}


@pytest.mark.parametrize("cut", [False, True], ids=["whole", "cut"])
@pytest.mark.parametrize(
    ("style", "changes"),
    [
        ("spacefill", {}),
        ("spacefill", {"occlusion__technique": "hybrid"}),
        ("spacefill", {"semantic__mode": "screen"}),
        ("spacefill", {"renderer": "path", "path__samples": 4}),
        ("cartoon", {"visibility": "raster"}),
    ],
    ids=["full", "hybrid", "semantic", "path", "raster"],
)
def test_frames_keep_memory(renderer, scenes, style, changes, cut):
    scene = scenes[style]
    settings = Settings().replace(size=(64, 48), **changes)
    _check(renderer, scene, settings, cut)


def test_drawing_all_kinds_of_primitives_keeps_memory(renderer):
    show = (Show(style="cartoon"), Show(style="licorice"))
    scene = SceneFile(input=(Input(path="sample:1hpv"),), show=show).scene()
    settings = Settings(size=(64, 48), visibility="raster").replace(lighting__preset="simple")
    _check(renderer, scene, settings, False)


def _check(renderer, scene, settings, cut):
    middle = tuple(scene.bounds().mean(axis=0))
    scene.clip = Clip(planes=(Plane(normal=(1, 0, 0), point=middle),) if cut else ())
    camera = renderer.fitted(scene, settings)

    def draw(count):
        for turn in range(count):
            renderer.frame(scene, camera.orbited(3 * turn, 1), settings).recorder.submit()
            renderer.gpu.finish()

    draw(8)
    before = used()
    draw(12)
    assert (used() - before) / 12 < MOST


def test_pipelines_are_bounded_and_pictures_the_same_when_they_are_made_anew(
    renderer, scenes, monkeypatch
):
    settings = Settings().replace(size=(64, 48))
    scene = scenes["spacefill"]
    camera = renderer.fitted(scene, settings)
    before = renderer.render(scene, camera, settings).pixels
    monkeypatch.setattr("scuro.gpu.program.MOST_PROGRAMS", 3)
    monkeypatch.setattr(renderer.gpu, "programs", Programs(renderer.gpu.device))
    for _ in range(2):
        image = renderer.render(scene, camera, settings)
        assert renderer.gpu.programs.count <= 3
        assert (image.pixels == before).all()
