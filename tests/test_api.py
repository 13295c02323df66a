"""The public names, as a script uses them."""

import subprocess
import sys

import numpy as np
import pytest

import scuro


def python(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_a_few_obvious_lines_make_a_picture(tmp_path):
    scene = scuro.load("sample:1hpv", waters=False)
    scene.show("cartoon", color="chain").show("licorice", select="organic")
    image = scuro.render(scene, size=(96, 64))
    image.save(tmp_path / "a.png")
    assert np.asarray(image).shape == (64, 96, 4)
    assert image.pil.size == (96, 64)
    assert image.buffer("depth").shape == (64, 96)
    assert image._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    "first", ["import scuro.load.options", "import scuro.render", "scuro.Renderer, scuro.Scene"]
)
def test_load_and_render_stay_functions_whatever_was_imported(first):
    code = (
        f"import scuro\n{first}\nimport scuro\nprint(callable(scuro.load), callable(scuro.render))"
    )
    assert python(code) == "True True"


def test_importing_scuro_loads_nothing_heavy():
    heavy = "{'numpy', 'wgpu', 'gemmi', 'PIL'} & set(sys.modules)"
    assert python(f"import sys, scuro; print(sorted({heavy}))") == "[]"


def test_every_public_name_is_there():
    assert all(getattr(scuro, name) is not None for name in scuro.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'lod'"):
        scuro.lod  # noqa: B018


def test_load_needs_an_input():
    with pytest.raises(scuro.ScuroError, match="at least one"):
        scuro.load()
