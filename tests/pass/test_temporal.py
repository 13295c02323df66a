"""Reuse over frames: exact at rest, better than nothing on the move, never a ghost."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import draw, floor, oblique, renderer, scene_of, spheres

from scuro.image import Image
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.lights import Light, Lighting

SIZE = (96, 72)
HEAP = [(x, y, 0.3 * ((x + y) % 3), 1.0) for x in range(-3, 4) for y in range(-3, 4)]
ABOVE = Camera((0, -6, 12), (0, 0, 0), (0, 0, 1))


def frames(scene, cameras, name="visibility", **changes):
    """Buffers of frames that go on from each other; the first is a fresh one."""
    settings = Settings(size=SIZE).replace(**changes)
    renderer().restart()
    for camera in cameras:
        frame = renderer().frame(scene, camera, settings, accumulate=True)
        frame.recorder.submit()
        yield Image(np.zeros((SIZE[1], SIZE[0], 4), np.uint8), frame, settings).buffer(name).copy()


def turned(camera, angle):
    """The camera, orbited about z."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return replace(camera, position=tuple(turn @ np.array(camera.position)))


RAY = {"occlusion__technique": "ray", "occlusion__samples": 1}


def test_frames_of_one_sample_are_the_mean_of_as_many_samples():
    scene = scene_of(spheres(*HEAP))
    *_, last = frames(scene, [ABOVE] * 16, occlusion__filter="none", **RAY)
    at_once = draw(
        scene, ABOVE, SIZE, occlusion__technique="ray", occlusion__samples=16,
        occlusion__filter="none",
    ).buffer("visibility")  # fmt: skip
    assert np.allclose(last, at_once, atol=1e-5)


def test_frames_of_area_shadows_are_the_mean_of_as_many_samples():
    light = Light(direction=(0, 0.3, -1), relative_to="world", size=6)
    scene = scene_of(floor(), spheres((0, 0, 3, 1)), lighting=Lighting((light,), ambient=0.0))
    area = {"shadows__technique": "area", "shadows__filter": False}
    *_, last = frames(scene, [oblique()] * 8, "shadow", shadows__samples=1, **area)
    at_once = draw(scene, oblique(), SIZE, shadows__samples=8, **area).buffer("shadow")
    assert np.allclose(last, at_once, atol=1e-5)


@pytest.mark.parametrize(
    ("technique", "resolution", "filter"),
    [
        ("ray", "full", "auto"), ("ray", "half", "auto"), ("hybrid", "full", "auto"),
        ("hybrid", "half", "atrous"), ("ssao", "full", "none"),
    ],
)  # fmt: skip
def test_smoothed_frames_come_nearer_to_the_truth(technique, resolution, filter):
    scene = scene_of(spheres(*HEAP))
    kind = "ssao" if technique == "ssao" else "ray"
    truth = draw(
        scene, ABOVE, SIZE, occlusion__technique=kind, occlusion__samples=1024,
        occlusion__filter="none",
    )  # fmt: skip
    seen, truth = truth.buffer("object") >= 0, truth.buffer("visibility")
    changes = {
        "occlusion__technique": technique,
        "occlusion__resolution": resolution,
        "occlusion__filter": filter,
    }
    found = [
        np.sqrt(np.mean((v - truth)[seen] ** 2)) for v in frames(scene, [ABOVE] * 24, **changes)
    ]
    assert found[-1] < 0.75 * found[0]
    assert max(np.diff(found[8:])) < 0.01, "smoothing fades, it does not stop"


def test_a_moved_camera_goes_on_from_what_was_known():
    scene = scene_of(spheres(*HEAP))
    truth = draw(
        scene, ABOVE, SIZE, occlusion__technique="ray", occlusion__samples=1024,
        occlusion__filter="none",
    )  # fmt: skip
    seen, truth = truth.buffer("object") >= 0, truth.buffer("visibility")
    orbit = [turned(ABOVE, 0.02 * step) for step in range(8, -1, -1)]
    for changes, share in (
        (RAY | {"occlusion__filter": "none"}, 0.5),
        (RAY | {"occlusion__technique": "hybrid"}, 0.9),
    ):
        *_, reused = frames(scene, orbit, **changes)
        (fresh,) = frames(scene, [ABOVE], **changes)
        assert np.std((reused - truth)[seen]) < share * np.std((fresh - truth)[seen])


def test_what_comes_into_view_has_no_ghost():
    # floor that the sphere hid begins anew: it gets this frame's own samples and nothing else
    scene = scene_of(floor(), spheres((0, 0, 3, 1)))
    before, after = oblique(), turned(oblique(), 0.12)
    changes = RAY | {"occlusion__filter": "none"}
    *_, reused = frames(scene, [before] * 9 + [after], **changes)
    image = draw(scene, after, SIZE, **changes)
    position = image.buffer("position")
    eye = np.array(before.position)
    to_eye = eye - position
    to_eye /= np.linalg.norm(to_eye, axis=-1, keepdims=True)
    to_center = np.array([0, 0, 3]) - position
    along = (to_center * to_eye).sum(axis=-1)
    off = np.linalg.norm(to_center - along[..., None] * to_eye, axis=-1)
    hidden = (np.abs(position[..., 2]) < 1e-3) & (off < 0.9)
    assert hidden.sum() > 30
    # one sample is open or not; a mean with anything else is in between
    assert np.isin(reused[hidden], (0.0, 1.0)).all()
    shown = (np.abs(position[..., 2]) < 1e-3) & (off > 1.3)
    assert (~np.isin(reused[shown], (0.0, 1.0))).mean() > 0.1


def test_a_change_of_settings_or_scene_forgets_everything():
    scene = scene_of(spheres(*HEAP))
    settings = Settings(size=SIZE).replace(**RAY)
    renderer().restart()
    for samples in (1, 1, 2):
        changed = settings.replace(occlusion__samples=samples)
        renderer().frame(scene, ABOVE, changed, accumulate=True).recorder.submit()
    assert renderer().history._signals["visibility"].frames == 1
    renderer().frame(scene, ABOVE, changed, accumulate=True).recorder.submit()
    assert renderer().history._signals["visibility"].frames == 2
    other = scene_of(spheres(*HEAP[1:]))
    renderer().frame(other, ABOVE, changed, accumulate=True).recorder.submit()
    assert renderer().history._signals["visibility"].frames == 1
