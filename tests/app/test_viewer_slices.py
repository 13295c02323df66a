"""Long pictures are drawn in slices: the same pictures, and other pages have their turn."""

import itertools
from concurrent.futures import Future

import numpy as np
import pytest

from scuro.export.scene_file import Input, SceneFile, Show
from scuro.passes import pieces
from scuro.passes.frame import Frame
from scuro.passes.targets import TargetPool
from scuro.render_settings import Settings
from scuro.viewer.drawing import Drawing
from scuro.viewer.model import Model
from scuro.viewer.view import REST, View

SIZE = (160, 120)


@pytest.fixture
def view(renderer, clock):
    document = SceneFile(input=(Input(path="sample:1hpv"),), show=(Show(style="spacefill"),))
    return View(Model(document), renderer.sibling(), SIZE, clock)


@pytest.fixture(autouse=True)
def pieces_of_64_tiles(request, monkeypatch):
    if "time" not in request.node.name:
        monkeypatch.setattr(pieces, "FIRST", 64)
        monkeypatch.setattr(pieces, "PIECE", 1e9)
        monkeypatch.setattr(pieces, "_GROWTH", 1)


def pixels(view):
    return view.renderer.gpu.read_texture(view.drawn.resources["picture"])


@pytest.mark.parametrize("most", [1 << 13, 1 << 21], ids=["bands", "whole"])
@pytest.mark.parametrize(
    "changes",
    [
        {"occlusion__technique": "ray"},
        {"occlusion__technique": "hybrid"},
        {"occlusion__technique": "ssao"},
        {"shadows__technique": "area", "shadows__samples": 8},
        {"semantic__mode": "traced"},
        {"renderer": "path", "path__samples": 2},
    ],
    ids=["ray", "hybrid", "ssao", "area", "traced", "path"],
)
def test_a_picture_drawn_in_slices_is_the_whole_one(view, renderer, monkeypatch, changes, most):
    monkeypatch.setattr("scuro.viewer.drawing.MOST_AT_ONCE", most)
    settings = Settings(size=(120, 200)).replace(
        lighting__preset="full", occlusion__filter="atrous", occlusion__samples=1,
        occlusion__resolution="half", **changes,
    )  # fmt: skip
    scene, camera = view.model.dressed(view.camera), view.camera
    ticks = itertools.count()
    drawing = Drawing(renderer.sibling(), lambda: float(next(ticks)), rate=1.0)
    *shares, drawn = drawing.draw(scene, camera, settings, slices=True)
    assert len(shares) >= 10 and shares == sorted(shares) and shares[-1] < 1
    picture = renderer.gpu.read_texture(drawn.resources["picture"])
    assert (picture == renderer.render(scene, camera, settings).pixels).all()


def test_pieces_of_a_pass_take_the_time_that_they_should(renderer):
    """On a machine that takes 0.01 s for a tile: 8 tiles in 0.08 s, then five at a time."""
    gpu, worked = renderer.gpu, []
    lists = {"tile_list": gpu.buffer(4 * 100), "tile_count": gpu.buffer(16, indirect=True)}
    gpu.write_buffer(lists["tile_list"], np.arange(100, dtype=np.uint32))
    gpu.write_buffer(lists["tile_count"], np.array([100, 1, 1, 0], np.uint32))
    shares, ticks = [], itertools.cycle((False, True))
    times = (0.01 * len(worked[-1]) * after for after in ticks)
    frame = Frame(
        gpu, gpu.recorder(), TargetPool(gpu), None, None, None, (8, 8), lists, breathe=shares.append
    )

    def record(resources, count):
        frame.recorder.flush()
        n = int(gpu.read_buffer(count, np.uint32)[0])
        worked.append(gpu.read_buffer(resources["tile_list"], np.uint32)[:n].tolist())

    pieces.run_in_pieces(frame, record, lambda: next(times))
    assert [len(w) for w in worked] == [8] + [5] * 18 + [2]
    assert (
        sorted(itertools.chain(*worked)) == list(range(100))
        and shares[-1] == 1
        and shares == sorted(shares)
    )


def test_another_page_is_drawn_between_the_slices_of_a_long_picture(
    view, renderer, clock, monkeypatch
):
    monkeypatch.setattr("scuro.viewer.drawing._TURN", 0.0)
    model = view.model
    settings = model.settings.replace(occlusion__technique="ray", occlusion__samples=64)
    model.change(settings=settings)
    other = View(model, renderer.sibling(), (64, 48), clock)
    view.drawing.rate = 1.0
    clock.now += 2 * REST
    seen = 0
    for _ in range(5000):
        view.draw()
        if view.complete:
            break
        share = view.share
        other.move(other.camera.orbited(5, 0))
        before, _ = other.drawn, other.draw()
        seen += other.drawn is not before and view.share == share
    assert view.complete and seen > 30
    expected = renderer.render(model.dressed(view.camera), view.camera, view.full_settings)
    assert (pixels(view) == expected.pixels).all()


def test_the_window_lives_while_a_pipeline_is_made(view, renderer, clock, monkeypatch):
    """Pictures go on with what was drawn, say why, and one that is given up leaves it to others."""
    programs, coming = renderer.gpu.programs, []

    def rest():
        clock.now += 2 * REST
        for _ in range(5000):
            view.draw()
            if view.complete:
                return

    class Maker:
        def submit(self, make):
            coming.append((make, Future()))
            return coming[-1][1]

    rest()
    before = view.drawn
    for key in [k for k in programs._programs if "occlusion" in repr(k[0])]:
        del programs._programs[key]
    monkeypatch.setattr(programs, "_maker", Maker())
    settings = view.model.settings.replace(occlusion__technique="ray", occlusion__samples=4)
    view.model.change(settings=settings)
    for _ in range(50):
        if coming:
            break
        view.draw()
    assert len(coming) == 1 and view.status == "compiling shaders" and view.drawn is before
    view.model.change(settings=settings.replace(seed=5))
    view.move(view.camera.orbited(5, 0))
    for _ in range(3):
        view.draw()
    assert len(coming) == 1, "the pipeline is made twice"
    made = 0
    for _ in range(200):
        while made < len(coming):
            make, future = coming[made]
            future.set_result(make())
            made += 1
        view.draw()
        if view.share:
            break
    assert view.share and view.status != "compiling shaders"
    monkeypatch.undo()
    rest()
    expected = renderer.render(view.model.scene, view.camera, view.full_settings)
    assert (pixels(view) == expected.pixels).all()
