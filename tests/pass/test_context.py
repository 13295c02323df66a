"""Context: in simple light, it leaves no trace on anything else, and nothing on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import draw, floor, renderer, scene_of, spheres
from scipy.ndimage import binary_dilation, binary_erosion

from scuro import Camera, Clip, Plane
from scuro.app.cli import run
from scuro.export.scene_file import SceneFile, Show, read_scene_file, write_scene_file
from scuro.passes.occlusion import occlusion
from scuro.passes.semantic.settings import SemanticSettings
from scuro.passes.shadow import shadow
from scuro.scene.lights import Light, Lighting
from scuro.settings import parameters
from scuro.viewer.pick import placed_bodies

CAMERA = Camera((6, 4, 40), (0, 0, 0), height=13.0)
SEMANTIC = next(p for p in parameters(SemanticSettings) if p.name == "mode").choices
PLAIN = {"lighting__preset": "full", "occlusion__technique": "none", "shadows__technique": "none"}
WAYS = {
    **{f"occlusion {name}": {"occlusion__technique": name} for name in occlusion.TECHNIQUES},
    "ssao guarded": {"occlusion__technique": "ssao", "occlusion__screen__guard": 16},
    "ray half": {"occlusion__technique": "ray", "occlusion__resolution": "half"},
    **{f"shadows {name}": {"shadows__technique": name} for name in shadow.TECHNIQUES},
    **{f"semantic {name}": {"semantic__mode": name} for name in SEMANTIC if name != "off"},
    "path": {"renderer": "path", "path__samples": 4},
    "raster": {"visibility": "raster"},
}
ROOF = [(x, y, 5.0, 1.1) for x in range(-4, 2) for y in range(-3, 4)]


def bumps():
    """A bumpy floor."""
    rng = np.random.default_rng(3)
    place = np.mgrid[-5:6, -4:5].reshape(2, -1).T.astype(float)
    table = np.c_[place, rng.uniform(-0.6, 0.6, len(place)), rng.uniform(0.8, 1.3, len(place))]
    return spheres(*map(tuple, table), color=(210, 160, 120, 255))


def roofed(*, context: bool | None):
    """The floor below a roof, shown or not; small atoms far away hold the bounds."""
    far = [(x, y, z, 0.1) for x in (-20, 20) for y in (-20, 20) for z in (-9, 9)]
    roof = [] if context is None else [replace(spheres(*ROOF), context=context)]
    return scene_of(*roof, bumps(), spheres(*far))


@pytest.mark.parametrize("name", WAYS)
def test_context_leaves_no_trace_and_nothing_darkens_it(name):
    changes = PLAIN | WAYS[name]
    alone = draw(roofed(context=None), CAMERA, **changes)
    without = alone.buffer("linear").copy()
    with_context = draw(roofed(context=True), CAMERA, **changes)
    here = with_context.buffer("object") == 2
    assert 500 < here.sum() < here.size - 3000
    # the path tracer smooths edges, of the scene over context, too
    traced = changes.get("renderer") == "path"
    near = binary_dilation(here, np.ones((3, 3))) if traced else here
    beside = ~near & (without[..., 3] == 1)
    assert np.array_equal(with_context.buffer("linear")[beside], without[beside])
    here = binary_erosion(here, np.ones((3, 3))) if traced else here
    light = with_context.buffer("linear")[here]
    for buffer in ("visibility", "shadow"):
        if name.startswith(("occlusion", "shadows")) and buffer in with_context.buffers():
            assert (with_context.buffer(buffer)[here] == 1).all()
    roof = scene_of(spheres(*ROOF))
    lone = draw(roof, CAMERA, **PLAIN).buffer("linear")[here]
    off = light - lone
    # means over pixels differ from their middles, to both sides
    assert (abs(off.mean()) if traced else np.abs(off).mean()) < 2e-3


def test_context_is_numbered_after_all_else():
    scene = roofed(context=True)
    image = draw(scene, CAMERA, **PLAIN)
    thing, atom = image.buffer("object"), image.buffer("atom")
    assert [body.context for _, _, body, _ in placed_bodies(scene)] == [False, False, True]
    assert np.array_equal(image.buffer("instance"), thing)
    top = ROOF.index((0, 0, 5.0, 1.1))
    at = np.argwhere((thing == 2) & (atom == top))
    position = image.buffer("position")[tuple(at[len(at) // 2])]
    assert np.linalg.norm(position - (0, 0, 5)) == pytest.approx(1.1, abs=0.01)


@pytest.mark.parametrize("way", [{}, {"renderer": "path", "path__samples": 16}])
def test_context_fills_what_it_lies_behind(way):
    """White on white leaves no line where the scene's edge covers a part of a pixel."""
    wall = replace(floor(-3, half=60), context=True)
    scene = scene_of(spheres((0, 0, 0, 2)), wall, lighting=Lighting((), ambient=1.0))
    above = Camera((0, 0, 30), (0, 0, 0), (0, 1, 0), height=9)
    linear = draw(scene, above, background="black", **way).buffer("linear")
    assert np.abs(linear - 1).max() < 0.01


def test_edges_stay_smooth_over_context_in_traced_paths():
    wall = replace(floor(-3, half=60), context=True)
    ball = spheres((0, 0, 0, 2), color=(255, 0, 0, 255))
    above = Camera((0, 0, 30), (0, 0, 0), (0, 1, 0), height=9)
    scene = scene_of(ball, wall, lighting=Lighting((), ambient=1.0))
    image = draw(scene, above, renderer="path", path__samples=16)
    green, ours = image.buffer("linear")[..., 1], image.buffer("object") == 0
    # covered by less than a half, their middle misses the ball
    assert ((green > 0.55) & (green < 0.95) & ~ours).sum() > 20
    assert ((green > 0.05) & (green < 0.45) & ours).sum() > 20


def test_edges_of_context_are_as_smooth_as_traced_paths():
    ball = replace(spheres((0, 0, 0, 2), color=(255, 0, 0, 255)), context=True)
    above = Camera((0, 0, 30), (0, 0, 0), (0, 1, 0), height=9)
    lighting = Lighting((), ambient=1.0)
    way = {"renderer": "path", "path__samples": 16, "background": "black"}
    traced = draw(scene_of(replace(ball, context=False), lighting=lighting), above, **way)
    truth = traced.buffer("linear")[..., 0].copy()
    edge = (truth > 0.02) & (truth < 0.98)
    assert edge.sum() > 50
    for wall in (), (floor(-3, half=60, color=(0, 0, 0, 255)),):
        image = draw(scene_of(ball, *wall, lighting=lighting), above, **way)
        found = image.buffer("linear")[..., 0]
        # sixteen random places in a pixel tell how far it is covered to about 0.1
        assert np.abs(found - truth).max() < 0.3
        assert np.sqrt(np.mean((found - truth)[edge] ** 2)) < 0.1


def test_smooth_context_goes_on_from_frame_to_frame():
    """Frames with one path more each end in the picture that is drawn at once."""
    scene = scene_of(spheres((0, 0, 0, 2)), replace(spheres((2, 1, 2, 2)), context=True))
    pictures = []
    for steps in (1, 2, 5), (5,):
        renderer().restart()
        for samples in steps:
            image = draw(scene, CAMERA, renderer="path", path__samples=samples)
        pictures.append(image.pixels)
    assert np.array_equal(*pictures)


def test_context_may_be_transparent_and_clipped():
    sky = Lighting((), ambient=1.0)
    below = floor(half=60, color=(255, 0, 0, 255))
    film = replace(spheres((0, 0, 3, 2), color=(0, 0, 255, 255), opacity=0.25), context=True)
    above = Camera((0, 0, 30), (0, 0, 0), (0, 1, 0), height=9)
    ray = {"occlusion__technique": "ray", "occlusion__samples": 16}
    image = draw(scene_of(below, film, lighting=sky), above, **ray)
    assert image.buffer("linear")[36, 48] == pytest.approx((0.75, 0, 0.25, 1), abs=2e-3)
    assert image.buffer("linear")[2, 2] == pytest.approx((1, 0, 0, 1), abs=2e-3)
    solid = replace(spheres((0, 0, 3, 2)), context=True)
    scene = scene_of(replace(below, clipped=False), solid, lighting=sky)
    scene.clip = Clip((Plane((0, 0, 3), (0, 0, -1)),))
    image = draw(scene, above, **ray)
    assert image.buffer("depth")[36, 48] == pytest.approx(27, abs=1e-3)
    assert image.buffer("normal")[36, 48] == pytest.approx((0, 0, 1), abs=1e-3)


def test_a_scene_of_context_alone():
    image = draw(scene_of(replace(spheres((0, 0, 0, 3)), context=True)), CAMERA)
    assert image.buffer("object")[36, 48] == 0 and image.pixels[36, 48, :3].max() < 255


def test_lines_and_fog_know_the_context():
    scene = scene_of(replace(spheres((0, 0, 0, 3)), context=True), spheres((30, 30, 0, 1)))
    plain = draw(scene, CAMERA, **PLAIN).pixels.astype(int)
    lined = draw(scene, CAMERA, borders__width=3.0, **PLAIN).pixels.astype(int)
    assert (np.abs(lined - plain).max(axis=-1) > 60).sum() > 100


def test_a_light_that_shadows_context_elsewhere_does_not_here():
    """A lone shadow caster over a context floor leaves the floor as bright as it is."""
    lamp = Lighting((Light(direction=(0, 0, -1), intensity=1, relative_to="world"),), ambient=0.2)
    ground = replace(floor(half=60), context=True)
    above = Camera((12, 0, 11), (0, 0, 0), (0, 0, 1))
    scene = scene_of(ground, spheres((0, 0, 3, 1)), lighting=lamp)
    image = draw(scene, above, shadows__technique="hard", occlusion__technique="ray")
    of_floor = image.buffer("linear")[..., 0][image.buffer("object") == 1]
    assert np.ptp(of_floor) < 2e-3


def test_context_is_said_in_words_and_in_files(tmp_path):
    shown = (Show(style="cartoon"), Show(style="backbone", context=True))
    path = tmp_path / "scene.toml"
    write_scene_file(path, SceneFile(show=shown))
    assert read_scene_file(path).show == shown
    out = tmp_path / "a.png"
    assert run(["render", "sample:1hpv", "--size", "32x24", "--show", "backbone,context=true",
                "-o", str(out)]) == 0  # fmt: skip
    assert [show.context for show in read_scene_file(out).show] == [True]
