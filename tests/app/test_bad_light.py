"""Bad input to occlusion and shadows, and a GPU that gives up: one sentence, no file."""

import pytest

from scuro.app.cli import run
from scuro.errors import GpuError, SettingsError
from scuro.gpu.errors import telling
from scuro.passes.occlusion.occlusion import TECHNIQUES
from scuro.passes.shadow.shadow import TECHNIQUES as SHADOWS
from scuro.render_settings import Settings
from scuro.scene.lights import Light


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"occlusion__samples": 0}, "samples must be at least 1"),
        ({"occlusion__samples": -3}, "samples must be at least 1"),
        ({"occlusion__samples": 5000}, "samples must be at most 4096"),
        ({"shadows__samples": 0}, "samples must be at least 1"),
        ({"path__samples": 0}, "samples must be at least 1"),
        ({"occlusion__distance": float("nan")}, "distance needs a finite number"),
        ({"occlusion__strength": float("nan")}, "strength needs a finite number"),
        ({"occlusion__screen__radius": float("inf")}, "radius needs a finite number"),
        ({"shadows__penumbra": float("nan")}, "penumbra needs a finite number"),
    ],
)
def test_wrong_numbers_are_said(change, words):
    with pytest.raises(SettingsError, match=words):
        Settings().replace(**change)


def test_unknown_techniques_list_those_there_are():
    for group, known in (("occlusion", TECHNIQUES), ("shadows", SHADOWS)):
        with pytest.raises(SettingsError) as said:
            Settings().replace(**{f"{group}__technique": "magic"})
        assert all(name in str(said.value) for name in ("none", *known))


def test_a_light_without_direction_is_said():
    with pytest.raises(SettingsError, match="light 'key' has no direction"):
        Light(direction=(0, 0, 0), name="key")
    with pytest.raises(SettingsError, match="finite"):
        Light(direction=(0, float("nan"), 1))


class GPUOutOfMemoryError(Exception):
    """Called as the native layer's."""


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (GPUOutOfMemoryError("not enough memory"), "out of memory"),
        (RuntimeError("Parent device is lost"), "the GPU was lost during pass 'occlusion'"),
    ],
)
def test_a_gpu_that_gives_up_is_one_sentence_and_no_file(
    error, words, tmp_path, monkeypatch, capfd
):
    from scuro.gpu.recorder import Recorder

    def broken(self, *args, **kwargs):
        with telling("pass 'occlusion'"):
            raise error

    monkeypatch.setattr(Recorder, "submit", broken)
    output = tmp_path / "out.png"
    assert run(["render", "sample:1hpv", "--size", "64x48", "-o", str(output)]) == 1
    said = capfd.readouterr().err.strip().splitlines()[-1]
    assert words in said and "lower" in said and "Traceback" not in said
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(GpuError, match=words), telling("pass 'occlusion'"):
        raise error
