"""Names and legends over the live picture."""

import numpy as np
import pytest

from scuro.export.scene_file import Input, SceneFile, Show
from scuro.render_settings import Settings
from scuro.style.marks import Strip, Text, covered
from scuro.viewer import navigate
from scuro.viewer.model import Model
from scuro.viewer.names import FADE, Names
from scuro.viewer.view import REST, View

SIZE = (320, 240)


def rest(view, clock):
    """Let the view come to rest and refine to the end."""
    clock.now += 2 * REST
    while view.wait is not None:
        view.draw()


def shown_by(renderer, clock, **changes):
    settings = Settings().replace(occlusion__technique="none", **changes)
    document = SceneFile(
        input=(Input(path="sample:1hpv"),),
        show=(Show(style="spacefill", color="chain"),),
        settings=settings,
    )
    view = View(Model(document), renderer.sibling(), SIZE, clock)
    rest(view, clock)
    return view, Names(view, clock)


def words(names):
    return {m.text: m for m in names.marks() if isinstance(m, Text) and m.color[3] > 0}


def test_names_fade_in_move_with_the_camera_and_never_overlap(renderer, clock):
    view, names = shown_by(renderer, clock, labels__show="residues", labels__most=20)
    assert words(names) == {} and names.wait == pytest.approx(1 / 30)
    clock.now += FADE / 2
    half = words(names)
    assert half and all(0 < m.color[3] < 255 for m in half.values())
    clock.now += FADE
    first = words(names)
    assert set(first) == set(half) and all(m.color[3] == 255 for m in first.values())
    assert names.wait is None
    anchors = {key: t.label.anchor for (key, _), t in names._tracks.items() if t.opacity > 0}
    kept, jumps = 0, []
    for _ in range(12):
        view.move(navigate.orbit(view.camera, (3, 1), SIZE))
        view.draw()
        clock.now += 0.04
        before, now = first, words(names)
        boxes = [m.box for m in now.values()]
        for n, a in enumerate(boxes):
            for b in boxes[n + 1 :]:
                apart = a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
                assert apart or min(m.color[3] for m in now.values()) < 255
        jumps += [abs(now[t].x - before[t].x) for t in set(now) & set(before)]
        changes = [abs(now[t].color[3] - before[t].color[3]) for t in set(now) & set(before)]
        assert max(changes, default=0) <= 255 * 0.04 / FADE + 2, "nothing pops"
        first = now
    still = {key: t.label.anchor for (key, _), t in names._tracks.items() if t.opacity > 0}
    kept = sum(anchors[key] == still.get(key) for key in anchors)
    assert kept >= len(anchors) / 2 and max(jumps) < 12


def test_what_cannot_be_named_is_said(renderer, clock):
    view, names = shown_by(renderer, clock, labels__show="residues", labels__select="chain (")
    names.marks()
    assert view.remark
    view.model.change(settings=view.model.settings.replace(labels__show="none"))
    names.marks()
    assert view.remark == "" and names.wait is None


def test_the_live_legend_is_the_saved_pictures(renderer, clock):
    view, names = shown_by(renderer, clock, legend__show=True, scale_bar__show=True)
    live = names.marks()
    picture = view.renderer.render(view.model.scene, view.camera, view.full_settings)
    assert live == picture._marks or covered(live) == covered(picture._marks)
    view.model.change(settings=view.model.settings.replace(legend__show=False))
    assert not any(isinstance(m, Strip) or getattr(m, "text", "") == "chain" for m in names.marks())


def test_a_screen_shows_what_a_picture_has_written_over_it(renderer):
    pytest.importorskip("imgui_bundle", reason="needs the viewer extra")
    from scuro.viewer.screen import Screen

    settings = Settings().replace(occlusion__technique="none", legend__show=True)
    show = (Show(color="bfactor"),)
    document = SceneFile(input=(Input(path="sample:1hpv"),), show=show, settings=settings)
    screen = Screen(Model(document), renderer, "rgba8unorm", lambda name, write: name)
    screen.panel.open = False
    screen.resize(480.0, 300.0, 1.0)
    target = renderer.gpu.texture((480, 300), "rgba8unorm", attachment=True)
    for _ in range(60):
        screen.draw(target)
        if screen.view.complete and screen.wait is None:
            break
    shown = renderer.gpu.read_texture(target)[..., :3].astype(int)
    wanted = np.asarray(screen.view.renderer.render(
        screen.model.scene, screen.view.camera, screen.view.full_settings
    ))[..., :3].astype(int)  # fmt: skip
    left, top, right, bottom = map(int, covered(screen.names.marks()))
    apart = np.abs(shown - wanted)[top:bottom, left:right].mean()
    bare = settings.replace(legend__show=False, size=(480, 300))
    plain = np.asarray(screen.view.renderer.render(screen.model.scene, screen.view.camera, bare))
    without = np.abs(plain[..., :3].astype(int) - wanted)[top:bottom, left:right].mean()
    assert apart < 0.35 * without, (apart, without)
    screen.close()
