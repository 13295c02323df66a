"""Fixtures of the viewer's tests."""

import pytest

from scuro.render import Renderer


class Clock:
    """Seconds that pass when a test says so."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture(scope="module")
def renderer():
    return Renderer()


@pytest.fixture(autouse=True)
def _whole_builds(monkeypatch):
    """The tables of a scene are built in one slice, however busy the machine is."""
    monkeypatch.setattr(Renderer, "patience", 60.0)
