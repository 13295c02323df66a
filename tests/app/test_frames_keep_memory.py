"""Frames leave no memory behind, as those of lavapipe may (docs/decisions.md, Viewer)."""

import ctypes
import gc
import weakref
from types import SimpleNamespace

import pytest

from scuro.export.scene_file import Input, SceneFile, Show
from scuro.gpu.program import Programs
from scuro.heap import give_back, held
from scuro.kept import kept_with
from scuro.measure.memory import resident_mb
from scuro.passes.targets import TargetPool
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.clip import Clip, Plane
from scuro.viewer.model import Model
from scuro.viewer.view import REST, View

MOST = 150.0
"""kB a frame: such a loss is 200 kB a dispatch, the caches of uniforms that still fill some 30."""


def used():
    """kB that malloc has given out."""
    gc.collect()
    pieces = held()
    if not pieces:
        pytest.skip("needs mallinfo2 of the GNU C library")
    return 1024 * (pieces["small pieces, MB"] + pieces["large pieces, MB"])


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


def test_a_fine_picture_leaves_its_blocks_of_memory_behind(clock):
    used()
    before = held()["large pieces, MB"]
    model = Model(SceneFile(input=(Input(path="sample:1hpv"),)))
    view = View(model, Renderer(), (480, 270), clock)  # whose blocks no other test has filled
    for method in ("fxaa", "4x", "fxaa"):
        model.change(settings=model.settings.replace(antialias__method=method))
        for _ in range(2):
            clock.now += 2 * REST
            while not view.complete:
                view.draw()
            view.move(view.camera.orbited(3, 1))
            while view.share == 0:
                view.draw()
        if method == "4x":
            assert held()["large pieces, MB"] - before > 250
    # that with the scene's tables, and the newest, which the picture is now in
    assert held()["large pieces, MB"] - before < 200


def test_frames_of_another_size_find_an_empty_pool(renderer):
    gpu = renderer.gpu
    pool = TargetPool(gpu)
    pool.begin((32, 32))
    gone = [pool.get("a", (32, 32), "r32float"), pool.buffer("b", 64)]
    inner = pool.table("layer", 0, lambda: TargetPool(gpu))
    gone.append(inner.get("c", (32, 32), "r32float"))
    known = pool.get("known", (32, 32), "r32float", lasting=True)
    refs = [weakref.ref(thing) for thing in gone]
    assert pool.bytes == 3 * 4 * 32 * 32
    pool.begin((32, 32))
    assert pool.get("a", (32, 32), "r32float") is gone[0]
    gone.clear()
    pool.begin((16, 16))
    assert not any(ref() for ref in refs)
    assert pool.get("known", (32, 32), "r32float", lasting=True) is known


@pytest.mark.parametrize("lasting", [False, True])
def test_what_is_off_is_freed(renderer, lasting):
    gpu = renderer.gpu
    pool = TargetPool(gpu)

    def frame(*used):
        pool.begin((32, 32))
        return [pool.get(name, (32, 32), "r32float", lasting=lasting) for name in used]

    def layered():
        """A frame with a pool of its own, which knows the frame that drew into it."""
        inner = pool.table("layer", 0, lambda: TargetPool(gpu))
        texture = inner.get("off", (32, 32), "r32float", lasting=lasting)
        inner.frame = SimpleNamespace(resources={"off": texture})
        return [inner, texture, pool.buffer("off", 64), *frame("off")]

    (on,) = frame("on")
    refs = [weakref.ref(thing) for thing in layered()]
    for _ in range(3):
        assert frame("on") == [on]
    assert all(ref() for ref in refs), "freed at once: a person may switch it on again"
    for _ in range(10):
        assert frame("on") == [on]
    assert not any(ref() for ref in refs)
    assert pool.bytes == 4 * 32 * 32


def test_a_survey_holds_nothing_of_the_scene(renderer):
    settings = Settings(size=(64, 48))
    scene, other = (
        SceneFile(input=(Input(path=f"sample:{name}"),)).scene() for name in ("1tii", "1hpv")
    )
    renderer.survey(scene, renderer.fitted(scene, settings), settings)
    tables = weakref.ref(renderer.accelerator(scene))
    renderer.render(other, settings=settings)
    gc.collect()
    assert tables() is None


def test_free_pieces_are_given_back():
    used()
    library = ctypes.CDLL(None)
    library.malloc.restype = ctypes.c_void_p
    pieces = [library.malloc(100_000) for _ in range(500)]
    for piece in pieces:
        ctypes.memset(piece, 1, 100_000)
    for piece in pieces[:-1]:  # the last keeps the heap from shrinking by itself
        library.free(ctypes.c_void_p(piece))
    before = resident_mb()
    give_back()
    assert resident_mb() < before - 30
    library.free(ctypes.c_void_p(pieces[-1]))


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


def test_a_closed_reservoir_is_forgotten(renderer):
    """Its picture, histogram, ranges and cells' boxes are kept with it, and no longer."""
    from scuro.scene.cornerpoint_synthetic import faulted_dome
    from scuro.scene.scene import Scene
    from scuro.viewer.screen import Screen
    from scuro.viewer.under import words_at

    model = Model(SceneFile(), Scene().add(faulted_dome()))
    settings = {"reservoir__show": "volume", "occlusion__technique": "none"}
    model.change(settings=model.settings.replace(**settings))
    screen = Screen(model, renderer, "rgba8unorm", lambda name, write: "")
    screen.resize(800, 240, 1.0)  # with the panel's histogram beside the picture
    target = renderer.gpu.texture(screen.physical, "rgba8unorm", attachment=True)
    while screen.wait == 0.0:
        screen.draw(target)
    places = (0.2, 0.4, 0.6, 0.8)
    assert any("cell" in words_at(screen.view, x, y) for x in places for y in places)
    item = model.scene.reservoirs[0]
    refs = [weakref.ref(thing) for thing in (item, item.grid)]
    del item
    model.open(SceneFile(input=(Input(path="sample:1hpv"),)))
    while screen.wait == 0.0:
        screen.draw(target)
    gc.collect()
    assert [ref() for ref in refs] == [None, None]
    screen.close()


def test_what_is_kept_with_a_thing_is_found_once():
    calls = []

    @kept_with
    def double(thing, factor):
        calls.append(factor)
        return 2 * factor

    thing = Settings  # anything that has an identity
    assert [double(thing, n) for n in (1, 2, 1)] == [2, 4, 2]
    assert calls == [1, 2]
    for n in range(100):
        double(thing, n)
    calls.clear()
    double(thing, 99)
    double(thing, 1)
    assert calls == [1], "a few results are kept, the last ones"


@pytest.mark.parametrize(
    "changes",
    [
        {"renderer": "path", "path__samples": 1},
        {"occlusion__technique": "hybrid"},
        {"labels__show": "chains"},
        {"semantic__mode": "screen"},
    ],
    ids=["path", "hybrid", "labels", "semantic"],
)
def test_a_closed_scene_is_forgotten_by_techniques_that_are_off(renderer, changes):
    def scene(opacity=1.0):
        show = (Show(opacity=opacity),)
        return SceneFile(input=(Input(path="sample:1hpv"),), show=show).scene()

    plain = Settings(size=(64, 48)).replace(occlusion__technique="none")
    old = scene(0.5)
    camera = renderer.fitted(old, plain)
    for _ in range(2):
        renderer.frame(old, camera, plain.replace(**changes), accumulate=True).recorder.submit()
    if "labels__show" in changes:
        renderer.render(old, camera, plain.replace(**changes))
    body = old.bodies()[0]
    known = (old, old.hierarchy(), renderer.accelerator(old), body, body.geometry)
    refs = [weakref.ref(thing) for thing in known]
    del old, body, known
    new = scene()
    for _ in range(12):
        renderer.frame(new, camera, plain, accumulate=True).recorder.submit()
    gc.collect()
    assert [ref() for ref in refs] == [None] * 5
