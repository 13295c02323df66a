"""The commands of docs/reservoirs.md, run on a model of that name."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from scuro.app.cli import run
from scuro.measure.bench.reservoir import write_egrid
from scuro.scene.cornerpoint_synthetic import faulted_dome

PAGE = Path(__file__).parents[2] / "docs" / "reservoirs.md"


def test_commands_run(tmp_path, monkeypatch, capfd) -> None:
    resfo = pytest.importorskip("resfo", reason="needs the extra 'reservoir'")
    monkeypatch.chdir(tmp_path)
    grid = faulted_dome(14, 13, 4)
    write_egrid(Path("MODEL.EGRID"), grid)
    contents = []
    for number, step in enumerate(grid.steps):
        head = np.zeros(100, np.int32)
        head[2], head[64:67] = 1, (step.date.day, step.date.month, step.date.year)
        contents += [("SEQNUM  ", np.array([number], np.int32)), ("INTEHEAD", head)]
        contents += [("STARTSOL", resfo.MESS)]
        contents += [(f"{name:8}", step.read(name)) for name in step.names]
        contents += [("ENDSOL  ", resfo.MESS)]
    resfo.write("MODEL.UNRST", contents)
    lines = re.findall(r"^\$ (scuro .*)$", PAGE.read_text(), re.M)
    assert len(lines) == 8
    for line in lines:
        arguments = shlex.split(line, comments=True)[1:]
        if arguments[0] == "bench":
            continue  # minutes; its parts are tested apart
        assert run([*arguments, "--size", "96x64"]) == 0, f"{line}\n{capfd.readouterr().err}"
