"""The molecules' section of the results page."""

import json

from scuro.measure.bench import BenchOptions
from scuro.measure.results import molecules


def test_no_technique_takes_less_than_no_time(tmp_path, monkeypatch):
    monkeypatch.setattr(molecules, "Renderer", _Renderer)
    found = {table.number: [-0.457] * len(table.columns) for table in molecules.TABLES}
    found["4.9"] = {"none": [-3.99, None, 1.2, 0.8, 0.9, 4.4]}
    measured = tmp_path / "measured.json"
    measured.write_text(json.dumps({"x.pdb": {"atoms": 5, **found}}))
    page = "\n".join(molecules.section(BenchOptions((), (40, 30), 1, measured=measured)))
    assert "| x.pdb, 5 | below noise | below noise | below noise |" in page
    assert "| none | below noise |  | 1.2 |" in page and "| -" not in page


class _Renderer:
    def __init__(self, device):
        self.gpu = type("Gpu", (), {"info": "an adapter"})()
