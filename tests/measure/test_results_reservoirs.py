"""The reservoirs' section of the results page, on a small dome and small pictures."""

from __future__ import annotations

import numpy as np
import pytest

from scuro.measure.bench import BenchOptions
from scuro.measure.results import reservoirs
from scuro.scene.cornerpoint_synthetic import faulted_dome


def test_every_table_has_our_rows_and_the_thesis(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reservoirs, "faulted_dome", lambda *_: faulted_dome(10, 9, 4))
    monkeypatch.setattr(reservoirs, "VIEWS", 2)
    monkeypatch.setattr(reservoirs, "RESOLUTIONS", (16,))
    parts = list(reservoirs.section(BenchOptions((), (40, 30), 1)))
    tables = [part for part in parts if part.startswith("|")]
    assert len(tables) == 11
    ours = [table for table in tables if "Campagnolo" not in table]
    for table in ours:
        rows = [line.split("|")[2:-1] for line in table.splitlines()[2:]]
        numbers = [float(c) for row in rows for c in row if c.strip().replace(".", "").isdigit()]
        assert numbers and np.isfinite(numbers).all()
    strategies = next(table for table in ours if "PLTS" in table)
    assert [line.split("|")[1].strip() for line in strategies.splitlines()[2:]] == [
        "PLTS", "SRG", "LIBC, samples", "LIBC, tables",
    ]  # fmt: skip
