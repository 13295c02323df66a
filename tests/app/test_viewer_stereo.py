"""Stereo in the viewer: what lies over the picture is seen by each eye where it should be."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from test_viewer_screen import move, rest, screen_of

from scuro.probe.probe import ProbeSettings
from scuro.scene.clip import Cut
from scuro.viewer import overlay
from scuro.viewer.eyes import eye_at
from scuro.viewer.overlay import arrow as draw_arrow
from scuro.viewer.pick import atom_name, pick

SIZE = (420.0, 240.0)
MODES = ("side-by-side", "red-cyan")


@pytest.fixture(params=MODES)
def screen(renderer, request):
    screen = screen_of(renderer, SIZE, stereo__mode=request.param)
    rest(screen)
    yield screen
    screen.close()


def middle_pick(screen):
    """An atom in the middle of the (last) eye's picture."""
    eye = screen.view.eyes(SIZE)[-1]
    x = (eye.start + eye.size[0] / 2) / SIZE[0]
    return pick(screen.view.drawn, screen.model.scene, x, 0.5)


def test_an_atom_is_picked_where_each_eye_sees_it(screen):
    drawn, scene = screen.view.drawn, screen.model.scene
    found = middle_pick(screen)
    eyes = drawn.eyes(drawn.size)
    x, y, _ = eyes[-1].project([found.position])[0]
    assert (x, y) == pytest.approx(
        (eyes[-1].start + eyes[-1].size[0] / 2, drawn.size[1] / 2), abs=1.01
    )
    if eyes[0].start != eyes[-1].start:
        other = eyes[0].project([found.position])[0]
        again = pick(drawn, scene, other[0] / drawn.size[0], other[1] / drawn.size[1])
        assert again.same_place(found)
        assert np.linalg.norm(np.subtract(again.position, found.position)) < 0.3
        assert abs(other[0] - (x - eyes[1].start)) > 1, "no parallax: this shows nothing"


def test_the_outline_of_an_atom_is_about_it_in_both_eyes(screen):
    model = screen.model
    if screen._joined:  # far apart: an outline in the other eye's place is none of this one's
        model.change(settings=model.settings.replace(stereo__separation=0.8))
    before = rest(screen).astype(int)
    found = middle_pick(screen)
    if screen._joined:
        left, right = (eye.project([found.anchor])[0, 0] for eye in screen.view.eyes(SIZE))
        assert left - right > 20, "no parallax: this shows nothing"
    screen.view.select(found)
    move(screen, 5.0, 5.0)
    changed = np.abs(rest(screen).astype(int) - before) > 60
    for eye in screen.view.eyes(SIZE):
        x, y = eye.project([found.anchor])[0, :2]
        here = changed.copy()
        if screen._joined:
            here[..., [1, 2] if eye.number < 0 else [0]] = False
        here = here.any(axis=-1)
        here[:, : int(eye.start)] = False
        here[:, int(eye.start + eye.size[0]) :] = False
        here[:20, :] = False
        rows, columns = np.nonzero(here)
        near = np.hypot(columns + 0.5 - x, rows + 0.5 - y) < 16
        assert near.sum() > 15, eye.number
        # others may hide a part of it
        assert columns[near].mean() + 0.5 == pytest.approx(x, abs=6.0)
        assert rows[near].mean() + 0.5 == pytest.approx(y, abs=9.0)


def test_a_handle_is_held_where_each_eye_sees_it(screen):
    model = screen.model
    target = np.asarray(screen.view.camera.target)
    toward = screen.view.camera.view_from_world()[2, :3]
    point = tuple((target + 16.0 * toward).tolist())
    model.change(clip=(Cut(normal=(1.0, 0.0, 0.0), point=point),))
    rest(screen)
    eyes = screen.view.eyes(SIZE)
    places = [eye.project([point])[0] for eye in eyes]
    parallax = (places[1][0] - eyes[1].start) - (places[0][0] - eyes[0].start)
    assert parallax < -3  # nearer than the target: crossed
    for eye, (x, y, _) in zip(eyes, places, strict=True):
        assert screen.handles.near((x, y), eye).kind == "push"
        assert eye.unproject((x, y), eye.project([point])[0, 2]) == pytest.approx(point)
    if not screen._joined:
        for x, y, _ in places:
            assert eye_at(eyes, x) is eyes[int(x >= SIZE[0] / 2)]
            press = {"event_type": "pointer_down", "x": x, "y": y, "button": 1, "modifiers": ()}
            screen.controls.handle(press)
            assert screen.handles.held.kind == "push"
            screen.controls.handle({**press, "event_type": "pointer_up"})
        screen.handles.chosen = None
    # the knob is drawn there, light in the middle
    move(screen, 5.0, 5.0)
    shown = rest(screen)
    for eye, (x, y, _) in zip(eyes, places, strict=True):
        knob = shown[int(y), int(x)]
        if screen._joined:
            knob = knob[[0] if eye.number < 0 else [1, 2]]
        assert (knob > 200).all(), eye.number


def test_names_hang_on_their_places_in_both_eyes(renderer):
    screen = screen_of(
        renderer, SIZE, stereo__mode="side-by-side", labels__show="residues", labels__most=6
    )
    rest(screen)
    screen.names._clock = lambda: screen.names._surveyed + 100.0
    screen.names.marks(-1)
    ratios = []
    eyes = screen.view.drawn.eyes(screen.view.full_settings.size)
    shown = [{m.text: m for m in screen.names.marks(n) if hasattr(m, "text")} for n in (-1, 1)]
    both = set(shown[0]) & set(shown[1])
    tracks = {t.label.text: t for t in screen.names._tracks.values() if t.opacity > 0}
    for text in both & set(tracks):
        for eye, marks in zip(eyes, shown, strict=True):
            x = eye.project([tracks[text].label.anchor])[0, 0]
            assert marks[text].x == pytest.approx(x, abs=1e-6)
            assert eye.start <= marks[text].x <= eye.start + eye.size[0]
        ratios.append(text)
    assert ratios, "no name in both pictures"
    screen.close()


def test_through_glasses_each_eye_has_its_own_names(renderer, monkeypatch):
    screen = screen_of(
        renderer, SIZE, stereo__mode="red-cyan", labels__show="residues", labels__most=6
    )
    rest(screen)
    screen.names._clock = lambda: screen.names._surveyed + 100.0
    drawn = []
    monkeypatch.setattr(
        "scuro.viewer.screen.draw_marks", lambda paper, marks, ratio: drawn.append(marks)
    )
    for _ in range(3):  # they come by fading
        screen.draw(screen.gpu.texture(screen.physical, "rgba8unorm", attachment=True))
    left, right = ({m.text: m.x for m in marks if hasattr(m, "text")} for marks in drawn[-2:])
    eyes = screen.view.drawn.eyes(screen.view.full_settings.size)
    anchors = {t.label.text: t.label.anchor for t in screen.names._tracks.values()}
    both = set(left) & set(right) & set(anchors)
    assert both, "no name in both pictures"
    for text in both:
        seen = [eye.project([anchors[text]])[0, 0] for eye in eyes]
        assert (left[text], right[text]) == pytest.approx(seen, abs=1e-6)
        assert abs(seen[0] - seen[1]) > 0.5
    screen.close()


def test_names_of_atoms_measures_path_and_force_hang_on_their_places(screen, monkeypatch):
    pytest.importorskip("numba", reason="needs the viewer extra")
    model, probing = screen.model, screen.probing
    toward = screen.view.camera.view_from_world()[2, :3]
    first = middle_pick(screen)
    molecule = first.molecule
    away = np.argmax(molecule.positions @ toward)
    second = replace(first, element=int(away))
    screen.view.selection = [first, second]
    screen.panel._tools.names = True
    model.set_probe(ProbeSettings(), first.anchor + 20 * toward)
    probe = probing.probe
    probe.path[:] = [(first.anchor + n * toward).tolist() for n in (18.0, 20.0, 22.0)]
    probe.target = probe.position + 0.5 * screen.view.camera.view_from_world()[0, :3]
    words, trails, arrows = [], [], []
    monkeypatch.setattr(
        overlay, "_text", lambda paper, corner, text, *inks: words.append((text, corner))
    )
    monkeypatch.setattr(
        "scuro.viewer.probing._trail", lambda paper, places: trails.append(places.copy())
    )
    monkeypatch.setattr(
        overlay, "arrow", lambda paper, eye, start, vector, ink: arrows.append((eye.number, start))
    )
    screen.draw(screen.gpu.texture(screen.physical, "rgba8unorm", attachment=True))
    eyes = screen.view.eyes(SIZE)
    assert [number for number, _ in arrows] == [-1, 1]
    for eye in eyes:  # the arrow itself: from root to tip
        drawn = []
        paper = SimpleNamespace(
            add_line=lambda a, b, *ink: drawn.append(a),  # noqa: B023
            add_triangle_filled=lambda tip, *rest: drawn.append(tip),  # noqa: B023
        )
        draw_arrow(paper, eye, first.anchor, 6 * toward + 3, 0)
        ends = eye.project([first.anchor, first.anchor + 6 * toward + 3])[:, :2]
        assert drawn[-2:] == [pytest.approx(end) for end in ends.tolist()]
    for eye, places in zip(eyes, trails, strict=True):
        assert places == pytest.approx(eye.project(probe.path))
    by_text = {text: [corner for t, corner in words if t == text] for text, _ in words}
    (distance,) = [t for t in by_text if t.endswith(" Å")]
    middles = [eye.project([first.anchor, second.anchor])[:, :2].mean(axis=0) for eye in eyes]
    assert by_text[distance] == [pytest.approx((x + 6, y + 4)) for x, y in middles]
    name = atom_name(molecule, int(away))
    (left, right), seen = by_text[name], [eye.project([second.anchor])[0] for eye in eyes]
    assert right[0] - left[0] == pytest.approx(seen[1][0] - seen[0][0])
    assert abs(seen[1][0] - eyes[1].start - seen[0][0]) > 1, "no parallax: this shows nothing"
