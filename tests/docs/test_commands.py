"""Every command and every Python example of the documentation runs."""

import re
import shlex
from pathlib import Path

import pytest

from scuro.app.cli import run

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
NETWORK = "# downloads"
"""Marks, in the documentation, a command that needs the network."""


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.M | re.S)


def commands(page: Path) -> list[str]:
    lines = "".join(blocks(page, "sh")).splitlines()
    return [line for line in lines if line.startswith("scuro ") and NETWORK not in line]


@pytest.mark.parametrize("page", [p for p in PAGES if commands(p)], ids=lambda p: p.name)
def test_commands_run_in_order(page, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    for line in commands(page):
        arguments = shlex.split(line, comments=True)[1:]
        if arguments[0] in ("render", "compare", "bench") and "--size" not in arguments:
            arguments += ["--size", "96x64"]
        assert run(arguments) == 0, f"{line}\n{capfd.readouterr().err}"
        if arguments[0] in ("render", "save"):
            assert Path(arguments[arguments.index("-o") + 1]).stat().st_size > 0


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p, "python")], ids=lambda p: p.name)
def test_python_examples_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for block in blocks(page, "python"):
        exec(compile(block, page.name, "exec"), names)


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
        if not target.startswith("http"):
            assert (page.parent / target).exists(), f"{page.name} links to {target}"


def test_scripts_named_in_the_readme_can_be_run():
    for name in re.findall(r"^scripts/\w+", (ROOT / "README.md").read_text(), re.M):
        assert (ROOT / name).stat().st_mode & 0o100
