"""Clipping: caps, spared selections, whole atoms, the navigation cube, and all techniques."""

from __future__ import annotations

import numpy as np
import pytest

from scuro import Camera, Clip, Plane, Settings
from scuro.app.cli import run
from scuro.errors import SettingsError
from scuro.export.scene_file import Input, SceneFile, Show
from scuro.render import Renderer
from scuro.scene.clip import ClippingSettings, Cut, drop_outside
from scuro.scene.geometry import Body, Geometry
from scuro.scene.scene import Scene

SIZE = (96, 72)
CAMERA = Camera((0, 0, 40), (0, 0, 0), height=12.0)
AWAY = Plane((0, 0, 0), (0, 0, -1))
"""Takes the half nearer to the camera."""


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


def ball(*rows) -> Scene:
    table = np.array(rows, np.float32)
    colors = np.tile(np.array((200, 60, 40, 255), np.uint8), (len(table), 1))
    scene = Scene()
    scene.extra_bodies.append(Body(Geometry(table, colors, np.arange(len(table), dtype=np.int32))))
    return scene


def draw(renderer, scene, camera=CAMERA, **changes):
    return renderer.render(scene, camera, Settings(size=SIZE).replace(**changes))


@pytest.mark.parametrize("way", ["raster", "raycast"])
def test_a_cut_ball_is_solid_flat_and_lies_on_the_plane(renderer, way):
    scene = ball((0, 0, 0, 4))
    scene.clip = Clip((AWAY,))
    image = draw(renderer, scene, visibility=way)
    inside = image.buffer("atom") == 0
    assert inside.sum() == pytest.approx(np.pi * 24**2, rel=0.02)
    assert np.allclose(image.buffer("depth")[inside], 40, atol=1e-3)
    assert np.allclose(image.buffer("normal")[inside], (0, 0, 1), atol=1e-3)


def test_both_ways_show_the_same_caps(renderer):
    rng = np.random.default_rng(2)
    scene = ball(*np.c_[rng.normal(size=(150, 3)) * 2, rng.uniform(0.7, 1.6, 150)])
    for normal in ((0, 0, -1), (0, 0, 1), (1, 0.3, -1)):
        scene.clip = Clip((Plane((0, 0, 0), normal),))
        found = [draw(renderer, scene, visibility=w).buffer("atom") for w in ("raster", "raycast")]
        # two atoms may be equally deep to the last bit
        assert (found[0] != found[1]).sum() <= 2


def test_an_oblique_cap_carries_the_planes_normal(renderer):
    scene = ball((0, 0, 0, 4))
    scene.clip = Clip((Plane((0, 0, 0), (0.6, 0, -0.8)),))
    normal = draw(renderer, scene).buffer("normal")[36, 40]
    assert normal == pytest.approx((-0.6, 0, 0.8), abs=1e-3)


def test_culled_matter_neither_occludes_nor_casts_shadows(renderer):
    plate = [(x, y, -3, 1.2) for x in range(-5, 6) for y in range(-4, 5)]
    roof = [(x, y, 6, 1.2) for x in range(-5, 6) for y in range(-4, 5)]
    alone = draw(renderer, ball(*plate), occlusion__technique="ray", occlusion__samples=32)
    scene = ball(*plate, *roof)
    scene.clip = Clip((Plane((0, 0, 2), (0, 0, -1)),))
    cut = draw(renderer, scene, occlusion__technique="ray", occlusion__samples=32)
    middle = slice(20, 50), slice(30, 66)
    difference = cut.pixels[middle].astype(int) - alone.pixels[middle].astype(int)
    assert np.abs(difference).mean() < 1
    scene.clip = Clip()
    behind = Camera((0, 0, -40), (0, 0, 0), height=12.0)
    assert draw(renderer, scene, behind).pixels.mean() != cut.pixels.mean()


def test_a_mesh_is_capped_like_a_solid(renderer):
    """A tetrahedron cut through the middle: no hole, and the cap lies on the plane."""
    corners = np.array([(3, 3, 3), (-3, -3, 3), (-3, 3, -3), (3, -3, -3)], np.float32)
    faces = corners[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    outward = (normals * faces.mean(axis=1)).sum(axis=1) > 0
    faces[~outward] = faces[~outward][:, ::-1]
    normals[~outward] *= -1
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    geometry = Geometry(
        triangles=faces,
        triangle_normals=np.repeat(normals[:, None], 3, axis=1).astype(np.float32),
        triangle_colors=np.full((4, 3, 4), 180, np.uint8),
        triangle_ids=np.zeros((4, 3), np.int32),
    )
    scene = Scene()
    scene.extra_bodies.append(Body(geometry))
    scene.clip = Clip((AWAY,))
    image = draw(renderer, scene)
    # at z = 0 the section is a square with corners half way along the edges
    depth = image.buffer("depth")[36, 36:60]
    assert np.allclose(depth, 40, atol=1e-3)


def test_whole_atoms_stay_or_go_by_their_centres(renderer):
    scene = ball((0, 0, 1, 2), (0, 0, -1, 2))
    scene.clip = Clip((AWAY,), whole=True)
    image = draw(renderer, scene)
    assert set(np.unique(image.buffer("atom"))) == {-1, 1}
    assert image.buffer("depth").min() == pytest.approx(39, abs=0.01)
    (body,) = scene.bodies()
    assert scene.bodies()[0] is body  # nothing is rebuilt for the next frame


def test_instances_stay_or_go_as_a_whole():
    geometry = ball((0, 0, 0, 1)).extra_bodies[0].geometry
    turns = np.tile(np.array([0, 0, 0, 1], np.float32), (3, 1))
    body = Body(geometry, turns, np.array([[0, 0, -5.0], [0, 0, 1], [0, 0, 5]]))
    left = drop_outside(body, Clip((AWAY,), whole=True))
    assert left.positions[:, 2].tolist() == [-5.0] and left.geometry is geometry


def test_the_cube_keeps_what_lies_within_at_any_turn():
    planes = ClippingSettings(cube=(4, 2, 2), cube_turn=(0, 0, 90)).box(np.zeros(3))
    clip = Clip(planes)
    points = np.array([(0, 1.9, 0), (1.9, 0, 0), (0.9, 0, 0.9), (0, 0, 1.1)])
    assert clip.keeps(points).tolist() == [True, False, True, False]


def test_a_spared_ligand_is_whole_and_the_rest_of_a_cube_is_a_trace():
    spared = SceneFile(
        (Input(path="sample:1hpv"),),
        (Show(style="spacefill"),),
        clip=(Cut(normal=(0, 0, -1)),),
        clipping=ClippingSettings(spare="organic"),
    ).scene()
    assert [body.clipped for body in spared.bodies()] == [True, False]
    cube = SceneFile(
        (Input(path="sample:1hpv"),), clipping=ClippingSettings(cube=(10, 10, 10))
    ).scene()
    atoms, trace = cube.bodies()
    assert atoms.clipped and not trace.clipped and len(trace.geometry.rods) > 150
    assert len(cube.clip.planes) == 6


def test_zero_normals_empty_spares_and_too_many_planes_are_refused(tmp_path, capsys):
    def said(*arguments: str) -> str:
        out = str(tmp_path / "a.png")
        assert run(["render", "sample:1hpv", "--size", "32x24", *arguments, "-o", out]) == 2
        return capsys.readouterr().err

    assert "normal that is not zero" in said("--clip", "0,0,0")
    assert "selects no atoms" in said("--clip", "0,0,1", "--spare", "resn XYZ")
    assert "'offst'" in said("--clip", "0,0,1,offst=3")
    with pytest.raises(SettingsError, match="at most 32"):
        Clip((AWAY,) * 33)


def test_a_clip_that_removes_everything_gives_the_background_and_says_so(tmp_path, capsys):
    from PIL import Image

    out = tmp_path / "a.png"
    assert run(["render", "sample:1hpv", "--size", "32x24", "--clip", "0,0,-1,offset=500",
                "-o", str(out)]) == 0  # fmt: skip
    assert "removes everything" in capsys.readouterr().err
    assert (np.asarray(Image.open(out)) == 255).all()
