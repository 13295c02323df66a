"""Every example runs and leaves what it says; docs/techniques.md is what the code declares."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    example.SIZE = (96, 72)
    for name, small in (("ATOMS", 2e5), ("SAMPLES", 2), ("SPACING", 1.5)):
        if hasattr(example, name):
            setattr(example, name, small)
    example.main()
    pictures = list(tmp_path.glob("*.png"))
    assert bool(pictures) == ("save(" in path.read_text())
    for picture in pictures:
        assert picture.stem.startswith(path.stem)
        colors = Image.open(picture).convert("RGB").getcolors(96 * 72)
        assert len(colors) > 50, f"{picture.name} shows next to nothing"
    if not pictures:
        assert re.search(r"\d\.\d", capsys.readouterr().out)


def test_every_example_has_its_line_in_the_index():
    index = (ROOT / "examples" / "README.md").read_text()
    assert [p.name for p in EXAMPLES] == re.findall(r"\]\((\w+\.py)\)", index)


def test_the_page_of_techniques_is_new():
    script = ROOT / "scripts" / "techniques"
    done = subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
