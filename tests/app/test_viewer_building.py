"""What pictures need first is built in short steps, beside the pages, and once for all of them."""

import threading

import numpy as np
import pytest

from scuro.export.scene_file import Input, SceneFile
from scuro.passes.volume import built
from scuro.passes.volume.draw import VolumePicture
from scuro.passes.volume.grid import VolumeGrid
from scuro.passes.volume.settings import VolumeSettings
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.clip import Clip
from scuro.scene.scene import Scene
from scuro.scene.volume import Volume
from scuro.steps import finished
from scuro.style.transfer_auto import automatic
from scuro.trace import accelerator
from scuro.viewer.model import Model
from scuro.viewer.view import View


@pytest.fixture(scope="module")
def volume():
    across = np.linspace(-1, 1, 44, dtype=np.float32)
    bell = np.exp(-4 * across**2)
    values = np.einsum("i,j,k->ijk", bell[:30], bell[3:40], bell)
    return Volume(values * (1 + 0.3 * np.sin(20 * across)))


@pytest.fixture(autouse=True)
def impatient(monkeypatch):
    """Each step is a turn of its own."""
    monkeypatch.setattr(Renderer, "patience", 0.0)


CENTER = np.zeros(3)


def test_a_grid_uploaded_in_slabs_is_the_same(renderer, volume):
    gpu = renderer.gpu
    whole = VolumeGrid(gpu, volume, CENTER)
    sliced = VolumeGrid(gpu, volume, CENTER, fill=False)
    shares = list(sliced.fill(slab=1 << 15))
    assert len(shares) > 8 and shares == sorted(shares) and shares[-1] == 1.0
    samples = gpu.read_texture(sliced.texture)
    expected = (volume.values - whole.low) / (whole.high - whole.low)
    assert np.abs(samples.astype(float) - expected).max() < 5e-4
    assert (samples == gpu.read_texture(whole.texture)).all()
    ranges = gpu.read_buffer(sliced.ranges, np.uint16).reshape(-1, 2) / 65535
    nx, ny, nz = sliced.blocks
    blocks = ranges[: nx * ny * nz].reshape(nz, ny, nx, 2)
    for z, y, x in [(0, 0, 0), (nz - 1, ny - 1, nx - 1), (3, 4, 5), (nz // 2, 1, 2)]:
        seen = tuple(slice(max(4 * n - 1, 0), 4 * n + 5) for n in (z, y, x))
        part = samples[seen].astype(float)
        assert blocks[z, y, x] == pytest.approx([part.min(), part.max()], abs=2e-5)


def test_a_pyramid_built_in_passes_is_the_same(renderer, volume, monkeypatch):
    monkeypatch.setattr(built, "SLICE_BYTES", 1 << 14)
    gpu = renderer.gpu
    settings = VolumeSettings().replace(occlusion__on=True)
    transfer = automatic(volume)
    levels = []
    for in_steps in (False, True):
        picture = VolumePicture(gpu, volume, CENTER, filled=not in_steps)
        if in_steps:
            shares = list(picture.prepare(settings, transfer, Clip(), None))
            assert len(shares) > 60, "four passes a slab of each level, and the grid"
            assert not list(picture.prepare(settings, transfer, Clip(), None)), "built again"
        pyramid = picture.pyramid(picture.classified(transfer, settings), settings, Clip())
        levels.append([gpu.read_texture(pyramid.texture, mip=n) for n in range(pyramid.levels)])
    assert len(levels[0]) == 6
    for whole, sliced in zip(*levels, strict=True):
        assert whole.max() > 0 and (whole == sliced).all()


def test_packing_goes_on_beside_the_steps(renderer, monkeypatch):
    scene = SceneFile(input=(Input(path="sample:1tii"),)).scene()
    pack, packed = accelerator.pack_bodies, threading.Event()

    def slowly(bodies):
        assert threading.current_thread() is not threading.main_thread()
        assert packed.wait(20), "nobody had a turn meanwhile"
        return pack(bodies)

    monkeypatch.setattr(accelerator, "pack_bodies", slowly)
    steps = renderer.accelerators.scene_in_steps(scene)
    assert [next(steps) for _ in range(3)] == [0.0, 0.0, 0.0]
    packed.set()
    assert finished(steps) is renderer.accelerator(scene)


def test_tables_are_uploaded_in_steps(renderer):
    """Each yields, and they end where the work does."""
    scene = SceneFile(input=(Input(path="sample:1tii"),)).scene()
    shares = list(renderer.accelerators.scene_in_steps(scene))
    assert shares == sorted(shares) and shares[-1] > 0.9
    for low, high in [(0.1, 0.3), (0.3, 0.45), (0.45, 0.5), (0.5, 1.0)]:
        assert any(low < share <= high for share in shares), f"none from {low} to {high}"


@pytest.mark.parametrize("kind", ["molecule", "volume"])
def test_two_pages_share_what_is_built(renderer, volume, monkeypatch, kind):
    filled, begun = [], []
    fill, build = VolumeGrid.fill, accelerator.build_in_steps
    monkeypatch.setattr(
        VolumeGrid, "fill", lambda self, slab: (filled.append(self), fill(self, 1 << 15))[1]
    )
    monkeypatch.setattr(
        "scuro.trace.kept.build_in_steps",
        lambda *args, **options: (begun.append(args), build(*args, **options))[1],
    )
    own = renderer.sibling()
    if kind == "volume":
        scene = Scene().add(volume)
    else:
        scene = SceneFile(input=(Input(path="sample:1tii"),)).scene()
    model = Model(SceneFile(settings=Settings(size=(96, 54))), scene)
    views = [View(model, own.sibling(), (96, 54)) for _ in range(2)]
    assert not any(view.drawable for view in views)
    while not all(view.drawable for view in views):
        for view in views:
            view.draw()
            assert view.drawn is None or view.drawable
            assert not view.error
    for view in views:
        while view.drawn is None:
            view.draw()
    assert len(begun) == 1 and len(filled) == (kind == "volume")


def test_a_volume_that_was_not_prepared_is_drawn_all_the_same(renderer, volume):
    settings = Settings(size=(48, 32))
    pictures = []
    for prepared in (True, False):
        scene = Scene().add(Volume(volume.values.copy()))
        camera = renderer.fitted(scene, settings)
        steps = renderer.prepare(scene, camera, settings)
        if prepared:
            list(steps)
            assert renderer.holds(scene)
        else:
            assert not renderer.holds(scene)
            next(steps, None)  # and left there
        pictures.append(np.asarray(renderer.render(scene, camera, settings)))
    assert np.ptp(pictures[0]) > 50 and (pictures[0] == pictures[1]).all()


def test_the_colours_of_a_volume_are_chosen_once(renderer, volume, monkeypatch):
    from scuro.style import transfer_auto

    calls = []
    density = transfer_auto._density
    monkeypatch.setattr(
        transfer_auto, "_density", lambda *args: (calls.append(args), density(*args))[1]
    )
    scene = Scene().add(Volume(volume.values.copy()))
    settings = Settings(size=(48, 32))
    for _ in range(3):
        renderer.render(scene, renderer.fitted(scene, settings), settings)
    assert len(calls) == 1
