"""Names of the regions in view, and all but a chosen subtree stepping back."""

import numpy as np
import PIL.Image
import pytest
import tifffile

from scuro.errors import SettingsError
from scuro.export.parts import save_in_parts
from scuro.load import load
from scuro.passes.part import split
from scuro.passes.post.attention import chosen_table
from scuro.passes.post.stereo import eye_camera
from scuro.render import Renderer
from scuro.render_names import Standing, namer_of, wanted
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.model import Ingredient, MesoscaleModel, Part, Structure
from scuro.scene.projection import project
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera
from scuro.style.region_labels import Namer, levels_between, region_labels, region_numbers

SIZE = (160, 120)
CAMERA = Camera((0, 0, 200), (0, 0, 0), (0, 1, 0), 30)


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


@pytest.fixture(scope="module")
def cell() -> Scene:
    """A large ball left, a small one right of it in the same compartment, one of another above."""

    def ingredient(path: str, radius: float, *centers) -> Ingredient:
        ball = Structure.of_spheres(path, np.array([[0, 0, 0, radius]]))
        turns = np.tile(np.array([0, 0, 0, 1], np.float32), (len(centers), 1))
        return Ingredient(
            ("cell", *path.split("/")), (Part(ball, turns, np.array(centers, float)),)
        )

    return Scene().add(
        MesoscaleModel(
            "cell",
            (
                ingredient("virus_0_1/surface/env_1", 20, (-25, 0, 0)),
                ingredient("virus_0_1/surface/ma", 8, (25, 0, 0), (25, -25, 0)),
                ingredient("plasma/igg", 12, (10, 32, 0)),
            ),
        )
    )


def settings_at(level: int, **changes) -> Settings:
    """The camera, 200 away, stands exactly on a level."""
    steps = tuple(200.0 * 2.0 ** (level - k) for k in range(4))
    return Settings(size=SIZE).replace(
        semantic__mode="screen",
        semantic__thresholds=steps,
        semantic__distance_to="target",
        **changes,
    )


def labels_of(renderer: Renderer, scene: Scene, level: int, blend: float = 0.0):
    survey = renderer.survey(scene, CAMERA, settings_at(level))
    hierarchy = scene.hierarchy()
    return region_labels(survey, Namer(hierarchy), levels_between(hierarchy, level, blend))


def test_names_follow_the_level_and_sit_in_their_regions(renderer, cell):
    names = [level.name for level in cell.hierarchy().levels]
    assert names == ["compartment 1", "ingredient", "instance", "chain"]
    far = labels_of(renderer, cell, 0)
    assert [label.text for label in far] == ["virus", "plasma"], "the largest first"
    near = labels_of(renderer, cell, 1)
    assert {label.text for label in near} == {"env", "ma", "igg"}
    big = next(label for label in near if label.text == "env")
    # the middle of the left ball: 25 of 107 scene units across 160 pixels left of the middle
    scale = SIZE[1] / (2 * 200 * np.tan(np.radians(15)))
    assert (big.x, big.y) == pytest.approx((80 - 25 * scale, 60), abs=2.5)
    assert len(labels_of(renderer, cell, 2)) == 3, "one of two instances stands for both"


def test_names_go_over_from_level_to_level(renderer, cell):
    def shown(blend: float) -> dict[str, float]:
        return {label.text: label.opacity for label in labels_of(renderer, cell, 0, blend)}

    assert shown(0.2) == {"virus": 1.0, "plasma": 1.0}
    assert shown(0.8) == {"env": 1.0, "ma": 1.0, "igg": 1.0}
    half = shown(0.5)
    assert half.keys() == {"virus", "plasma", "env", "ma", "igg"}
    assert list(half.values()) == pytest.approx([0.5] * 5)


def test_region_numbers_divide_as_the_shader_does(renderer, cell):
    for level in range(4):
        image = renderer.render(cell, CAMERA, settings_at(level))
        ours = region_numbers(image.buffer("ids"), cell.hierarchy(), cell.hierarchy().levels[level])
        pairs = np.stack([ours.ravel(), image.buffer("regions.x").ravel().astype(np.int64)], 1)
        both = np.unique(pairs, axis=0)
        assert len(both) == len(np.unique(both[:, 0])) == len(np.unique(both[:, 1])) > 2


def test_labels_change_only_pixels_of_words(renderer, cell):
    bare = np.asarray(renderer.render(cell, CAMERA, settings_at(1)))
    named = np.asarray(renderer.render(cell, CAMERA, settings_at(1, labels__show="regions")))
    one = settings_at(1, labels__show="regions", labels__most=1)
    single = np.asarray(renderer.render(cell, CAMERA, one))
    changed = [(picture != bare).any(axis=-1).mean() for picture in (named, single)]
    assert 0.2 > changed[0] > 1.5 * changed[1] > 0


def test_names_are_the_same_in_pictures_drawn_in_parts(renderer, cell, monkeypatch, tmp_path):
    settings = settings_at(1, labels__show="regions", scale_bar__show=True, axes__show=True)
    whole = renderer.render(cell, CAMERA, settings)
    # parts as they would be of a print
    monkeypatch.setattr("scuro.passes.part.fits", lambda *rest: False)
    smaller = {"edge": 96, "margin": 16}
    monkeypatch.setattr(
        "scuro.render_parts.split", lambda size, **options: split(size, **options | smaller)
    )
    assert len(renderer.parts(settings)) > 2
    parted = np.asarray(renderer.render(cell, CAMERA, settings))
    assert (np.abs(parted.astype(int) - np.asarray(whole)).max(axis=-1) > 2).mean() < 0.002
    for name, bits in (("a.png", 8), ("a16.png", 16), ("a.tif", 16)):
        save_in_parts(tmp_path / name, renderer, cell, CAMERA, settings, bits=bits)
    with PIL.Image.open(tmp_path / "a.png") as image:
        np.testing.assert_array_equal(np.asarray(image.convert("RGBA")), parted)
    found = tifffile.imread(tmp_path / "a.tif")[..., :3] / 257
    assert np.abs(found - parted[..., :3]).max() < 4


def test_both_eyes_see_the_names(renderer, cell):
    changes = {"stereo__mode": "side-by-side", "labels__show": "regions"}
    settings = settings_at(1).replace(size=(320, 120), **changes)
    named = np.asarray(renderer.render(cell, CAMERA, settings)).astype(int)
    bare = np.asarray(renderer.render(cell, CAMERA, settings.replace(labels__show="none")))
    changed = (named != bare).any(axis=-1)
    left, right = changed[:, :160].sum(), changed[:, 160:].sum()
    assert left > 100 and 0.6 < left / right < 1.6


def test_through_glasses_names_lie_as_deep_as_what_they_name(renderer):
    ball = Structure.of_spheres("ball", np.array([[0, 0, 0, 12.0]]))
    turn = np.array([[0, 0, 0, 1]], np.float32)
    near = Ingredient(("cell", "near"), (Part(ball, turn, np.array([[0.0, 20, 60]])),))
    there = Ingredient(("cell", "there"), (Part(ball, turn, np.array([[0.0, -22, -10]])),))
    scene = Scene().add(MesoscaleModel("cell", (near, there)))
    changes = {"stereo__mode": "red-cyan", "stereo__separation": 0.2}
    settings = Settings(size=(240, 180)).replace(text=10.0, **changes)
    bare = np.asarray(renderer.render(scene, CAMERA, settings))
    named = renderer.render(scene, CAMERA, settings.replace(labels__show="regions"))
    marks = [m for m in named._marks if getattr(m, "text", "") in ("near", "there")]
    extent = renderer.accelerator(scene).extent
    left, right = (eye_camera(CAMERA, eye, 0.2 * extent, 180) for eye in (-1, 1))
    apart = {}
    for name, point in (("near", (0, 20, 72)), ("there", (0, -22, 2))):
        (a, b) = (next(m for m in marks if (m.text, m.eye) == (name, eye)) for eye in (-1, 1))
        seen = [project(c, [point], (240, 180))[0, 0] - shift[0] for c, shift in (left, right)]
        assert a.x - b.x == pytest.approx(seen[0] - seen[1], abs=0.6), name
        apart[name] = a.x - b.x
    assert abs(apart["there"]) < 3 < apart["near"]
    # and each is drawn through its own glass
    changed = np.asarray(named)[..., :3] != bare[..., :3]
    red, cyan = (np.nonzero(changed[:90, :, n])[1].mean() for n in (0, 1))
    parallax = project(left[0], [(0, 20, 72)], (240, 180))[0, 0] - left[1][0] - 120
    assert red - cyan == pytest.approx(2 * parallax, abs=1.5)


def test_residues_and_atoms_have_names(renderer):
    scene = Scene().add(load("sample:1hpv"))
    camera = view_camera(scene, ViewSettings(focus="organic"), 1.5)
    settings = Settings(size=(480, 320)).replace(labels__most=200)

    def names(**labels) -> list[str]:
        chosen = settings.replace(**{f"labels__{k}": v for k, v in labels.items()})
        survey = renderer.survey(scene, camera, chosen)
        standing = Standing(camera, chosen, renderer.accelerator(scene))
        found = region_labels(survey, namer_of(scene, chosen), wanted(scene, standing))
        # each where its own elements are
        molecule = scene.molecules[0].molecule
        for label in found:
            depth = survey.depth[int(label.y), int(label.x)]
            assert np.linalg.norm(molecule.positions[label.element[0]] - label.anchor) < 2.5
            assert depth > 0
        return [label.text for label in found]

    residues = names(show="residues")
    assert "478 200" in residues and len(residues) > 20
    atoms = names(show="atoms", select="organic")
    assert "C16" in atoms, "of one residue"
    assert "478 200 C16" in names(show="atoms", select="organic or resi 25")
    assert {"chain A", "chain B"} <= set(names(show="chains"))
    with pytest.raises(SettingsError, match="no residues"):
        wanted(Scene(), Standing(camera, settings.replace(labels__show="residues"), None))


def test_a_name_stays_on_its_point_while_it_can(renderer, cell):
    hierarchy, namer = cell.hierarchy(), Namer(cell.hierarchy())
    levels = levels_between(hierarchy, 1, 0.0)

    def seen(azimuth: float, keep=None) -> dict:
        survey = renderer.survey(cell, CAMERA.orbited(azimuth, 0), settings_at(1))
        return {la.text: la for la in region_labels(survey, namer, levels, keep)}

    first = seen(0)
    keep = {label.key: label.anchor for label in first.values()}
    free, kept = seen(6), seen(6, keep)
    assert kept["env"].anchor == first["env"].anchor != free["env"].anchor
    # turned away, the point is behind the ball: a new one is found
    assert seen(120, keep)["env"].anchor != first["env"].anchor


def test_all_but_the_chosen_steps_back(renderer, cell):
    def linear(**attention):
        changes = {f"attention__{k}": v for k, v in attention.items()}
        image = renderer.render(cell, CAMERA, settings_at(1, antialias__method="none", **changes))
        return image.buffer("object"), image.buffer("linear")[..., :3]

    things, plain = linear()
    chosen, others = things == 1, (things >= 0) & (things != 1)
    for how in ("light", "desaturate", "fade"):
        _, found = linear(subtree="virus*/surface/ma", how=how, strength=0.5)
        np.testing.assert_array_equal(found[chosen], plain[chosen])
        rest = {
            "light": np.zeros_like(plain),
            "desaturate": np.repeat(plain @ [[0.2126], [0.7152], [0.0722]], 3, axis=2),
            "fade": np.ones_like(plain),  # the background is white
        }[how]
        np.testing.assert_allclose(found[others], (plain + rest)[others] / 2, atol=3e-3)


def test_a_subtree_is_a_node_a_pattern_or_a_selection(cell):
    assert chosen_table(cell, "virus_0_1").tolist() == [1, 1, 0]
    assert chosen_table(cell, "PLASMA/igg").tolist() == [0, 0, 1]
    assert chosen_table(cell, "surface/*").tolist() == [1, 1, 0]
    with pytest.raises(SettingsError, match=r"known: .*plasma"):
        chosen_table(cell, "plasm/igg")
    molecule = Scene().add(load("sample:1hpv"))
    table = chosen_table(molecule, "chain A")
    np.testing.assert_array_equal(table[table[0] :], molecule.molecules[0].molecule.chain == 0)
