"""Frames leave no memory behind, as those of lavapipe may (docs/decisions.md, Viewer)."""

import ctypes
import gc

import pytest

from scuro.export.scene_file import Input, SceneFile, Show
from scuro.render_settings import Settings
from scuro.scene.clip import Clip, Plane

MOST = 150.0
"""kB a frame: such a loss is 200 kB a dispatch, the caches of uniforms that still fill some 30."""


_FIELDS = (
    "arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks", "fordblks",
    "keepcost",
)  # fmt: skip


class _Heap(ctypes.Structure):
    _fields_ = [(name, ctypes.c_size_t) for name in _FIELDS]


def used():
    """kB that malloc has given out."""
    try:
        mallinfo2 = ctypes.CDLL("libc.so.6").mallinfo2
    except (OSError, AttributeError):
        pytest.skip("needs mallinfo2 of the GNU C library")
    mallinfo2.restype = _Heap
    gc.collect()
    heap = mallinfo2()
    return (heap.uordblks + heap.hblkhd) / 1024


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
