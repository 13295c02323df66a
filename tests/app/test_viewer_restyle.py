"""Styles of large molecules are built beside the pages: none waits, and none sees half of it."""

import threading
import time

import pytest

from scuro.export.scene_file import Input, SceneFile, Show
from scuro.style import representation
from scuro.viewer.model import Model
from scuro.viewer.restyle import Reading
from scuro.viewer.view import View


@pytest.fixture
def model(monkeypatch):
    monkeypatch.setattr("scuro.viewer.restyle.LARGE", 1000)
    return Model(SceneFile(input=(Input(path="sample:1hpv"),), show=(Show(style="spacefill"),)))


@pytest.fixture
def gate(monkeypatch):
    """Cartoons that are built only when the test lets them, and who built them."""
    gate, real = threading.Event(), representation.STYLES["cartoon"]
    gate.threads = []

    def build(*inputs):
        gate.threads.append(threading.current_thread())
        assert gate.wait(20)
        return real(*inputs)

    monkeypatch.setitem(representation.STYLES, "cartoon", build)
    return gate


def styles(model):
    return [shown.style for shown in model.scene.molecules[0].shown]


def settle(model):
    end = time.monotonic() + 20
    while model.restyle is not None:
        assert time.monotonic() < end
        model.tick()


def test_pages_show_the_old_style_until_the_new_one_is_built(model, gate, renderer, clock):
    view = View(model, renderer.sibling(), (64, 48), clock)
    bodies = model.scene.bodies()
    assert model.change(show=(Show(style="cartoon"),))
    for _ in range(3):
        model.tick()
        view.draw()
    assert model.wait and styles(model) == ["spacefill"] and model.scene.bodies() == bodies
    assert model.change(settings=model.settings.replace(seed=3))  # goes on meanwhile
    gate.set()
    settle(model)
    assert styles(model) == ["cartoon"] and model.settings.seed == 3 and model.wait is None
    assert gate.threads and threading.main_thread() not in gate.threads and len(gate.threads) == 1
    model.undo()
    assert styles(model) == ["cartoon"]  # until its atoms are there again
    settle(model)
    assert styles(model) == ["spacefill"] and model.settings.seed == 3


def test_undo_takes_back_what_is_being_built_and_a_later_choice_overtakes_it(model, gate):
    model.change(show=(Show(style="cartoon"),))
    model.undo()
    assert model.restyle is None and not model.history.can_undo
    model.change(show=(Show(style="cartoon"),))
    model.change(show=(Show(style="licorice"),))
    gate.set()
    settle(model)
    assert styles(model) == ["licorice"]
    model.undo()
    settle(model)
    assert styles(model) == ["spacefill"] and not model.history.can_undo


def test_what_cannot_be_built_changes_nothing_and_is_told(model):
    document = model.document
    model.change(show=(Show(style="spacefill", color="no such colour"),))
    settle(model)
    assert "no such colour" in model.message and model.document == document
    assert styles(model) == ["spacefill"]


def test_large_files_are_read_beside_the_pages_and_undo_leaves_them(model, monkeypatch):
    monkeypatch.setattr("scuro.viewer.restyle.LARGE_FILES", 0)
    gate, real = threading.Event(), SceneFile.scene
    readers = []

    def scene(document):
        readers.append(threading.current_thread())
        assert gate.wait(20)
        return real(document)

    monkeypatch.setattr(SceneFile, "scene", scene)
    other = SceneFile(input=(Input(path="sample:1tii"),))
    before = model.scene
    assert model.open(other) and model.scene is before and model.wait
    model.undo()
    assert model.restyle is None and not model.history.can_undo
    model.open(other)
    gate.set()
    settle(model)
    assert model.document == other and len(model.scene.molecules[0].molecule) > 4000
    assert readers and threading.main_thread() not in readers
    model.open(SceneFile(input=(Input(path="sample:none"),)))
    settle(model)
    assert "none" in model.message and model.document == other


@pytest.mark.parametrize("name", ["model.json", "scan.mhd", "series/", "1abc"])
def test_what_may_be_of_any_size_is_read_beside_the_pages(tmp_path, name):
    path = tmp_path / name
    if name.endswith("/"):
        path.mkdir()
    elif "." in name:
        path.write_text("{}")
    document = SceneFile(input=(Input(path=name if name == "1abc" else str(path)),))
    assert Reading(document, lambda: None).needed
    small = tmp_path / "small.pdb"
    small.write_text("END")
    small_ones = SceneFile(input=(Input(path=str(small)), Input(path="sample:1hpv")))
    assert not Reading(small_ones, lambda: None).needed
