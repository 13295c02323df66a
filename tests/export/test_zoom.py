"""The zoom from the whole to single atoms: where it goes, and that nothing jumps on the way."""

import numpy as np
import pytest

from scuro.app.cli import run
from scuro.export.zoom import landing_point, zoom_of, zoom_settings
from scuro.passes.semantic.levels import thresholds
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip, Plane
from scuro.scene.generate import GenerateSettings, generate
from scuro.scene.model import Structure
from scuro.scene.scene import Scene
from scuro.scene.sphere import fibonacci_sphere


@pytest.fixture(scope="module")
def scene() -> Scene:
    """A small cell of globules."""
    atoms = np.concatenate([18 * fibonacci_sphere(300), np.full((300, 1), 1.9)], axis=1)
    globule = Structure.of_spheres("globule", atoms.astype(np.float32))
    return Scene().add(generate([globule], GenerateSettings(atoms=4e5)))


def test_the_zoom_lands_on_what_the_picture_shows_in_its_middle(scene):
    renderer = Renderer()
    settings = Settings(size=(65, 65), detail=0.0)
    camera = renderer.fitted(scene, settings)
    middle = renderer.render(scene, camera, settings).buffer("position")[32, 32]
    np.testing.assert_allclose(landing_point(scene, camera), middle, atol=0.02)
    scene.clip = Clip((Plane((0, 0, 100.0), (0, 0, -1.0)),))
    try:
        cut = landing_point(scene, camera)
        middle = renderer.render(scene, camera, settings).buffer("position")[32, 32]
    finally:
        scene.clip = Clip()
    np.testing.assert_allclose(cut, middle, atol=0.02)


def test_distances_shrink_by_equal_factors_and_the_middle_stays(scene):
    start = Camera((0, 0, 5000.0), (0, 0, 0), (0, 1, 0), 30)
    zoom = zoom_of(scene, start, (100.0, 50.0, 300.0))
    shots = [zoom.camera(share) for share in np.linspace(0, 1, 9)]
    assert shots[0] == start
    np.testing.assert_allclose(shots[-1].target, (100, 50, 300))
    distances = np.array([shot.distance for shot in shots])
    np.testing.assert_allclose(distances[1:] / distances[:-1], distances[1] / distances[0])
    # 15 atoms of 1.9 Å radius make up the last picture's height
    height = 2 * shots[-1].distance * np.tan(np.radians(15))
    assert height == pytest.approx(15 * 2 * zoom_radius(scene), rel=1e-5)
    flat = zoom_of(scene, Camera((0, 0, 5000.0), (0, 0, 0), (0, 1, 0), 30, 3000.0), (0, 0, 0))
    assert flat.camera(1).height / 3000 == pytest.approx(flat.camera(1).distance / 5000)


def zoom_radius(scene: Scene) -> float:
    return float(np.median(np.concatenate([b.geometry.spheres[:, 3] for b in scene.bodies()])))


def test_mean_luminance_never_jumps_on_the_way(scene):
    """At most 1 % of full scale between two of 300 frames: measured where all levels are crossed.

    A step in a threshold, a level of detail or the bounce shows between neighbouring frames, so
    every twelfth frame is compared with the one after it.
    """
    renderer = Renderer()
    settings = zoom_settings(scene, Settings(size=(96, 54)))
    zoom = zoom_of(scene, renderer.fitted(scene, settings), None)
    jumps = []
    for frame in range(0, 299, 12):
        pair = [
            np.asarray(renderer.render(scene, zoom.camera(share / 299), settings))[..., :3].mean()
            for share in (frame, frame + 1)
        ]
        jumps.append(abs(pair[1] - pair[0]) / 255)
    assert max(jumps) < 0.01


def test_nothing_jumps_where_a_level_is_reached(scene):
    """Just before and just after each threshold the picture is the same, pixel by pixel."""
    renderer = Renderer()
    settings = zoom_settings(scene, Settings(size=(192, 108)))
    zoom = zoom_of(scene, renderer.fitted(scene, settings), None)
    frame = renderer.frame(scene, zoom.start, settings)
    frame.recorder.submit()
    steps = [t for t in thresholds(frame, scene.hierarchy()) if zoom.nearest < t]
    assert len(steps) >= 3
    for step in steps[1:]:
        share = np.log(zoom.start.distance / step) / np.log(zoom.start.distance / zoom.nearest)
        before, after = (
            np.asarray(renderer.render(scene, zoom.camera(share + d), settings))[..., :3].astype(
                int
            )
            for d in (-1e-6, 1e-6)
        )
        assert np.abs(after - before).mean() < 0.1


def test_one_command_makes_the_film(tmp_path):
    arguments = ["sample:1hpv", "-o", str(tmp_path / "zoom"), "--motion", "zoom", "--length", "3"]
    assert run(["movie", *arguments, "--size", "64x48", "--zoom-to", "0,10,5"]) == 0
    assert len(list((tmp_path / "zoom").glob("*.png"))) == 3
