"""Contact sheets and reports."""

import io
import json

import numpy as np
import pytest
from rich.console import Console

from scuro.errors import SettingsError
from scuro.measure import contact_sheet, score
from scuro.measure.report import Row, table, write_json


def rows() -> list[Row]:
    reference = np.random.default_rng(0).random((16, 20, 3))
    picture = np.clip(reference * 0.9, 0, 1)
    scores = score(picture, reference)
    return [
        Row("ray", {"samples": 1024}, 812.0, image="ray.png"),
        Row("ssao", {"samples": 16}, 41.2, scores, scores, "ssao.png"),
    ]


def test_contact_sheet_holds_every_picture_in_its_place():
    reds = np.zeros((30, 40, 3))
    reds[..., 0] = 1
    sheet = contact_sheet(
        {"grey": np.full((30, 40), 0.5), "red": reds}, {"red": "a note"}, columns=2
    )
    pixels = np.asarray(sheet)
    assert tuple(pixels[20, 20]) == (128, 128, 128)
    assert tuple(pixels[20, 12 + 40 + 12 + 5]) == (255, 0, 0)
    assert (pixels[43:] < 128).any(), "no label was drawn"


def test_contact_sheet_scales_down_and_refuses_nothing():
    sheet = contact_sheet({"wide": np.zeros((100, 400, 3))}, width=200)
    assert sheet.width == 200 + 2 * 12
    with pytest.raises(SettingsError, match="at least one"):
        contact_sheet({})


def test_table_and_json_name_every_technique(tmp_path):
    console = Console(width=160, record=True, file=io.StringIO())
    console.print(table(rows(), "1CRN"))
    text = console.export_text()
    assert "ssao" in text and "reference" in text and "samples=16" in text
    write_json(tmp_path / "compare.json", rows(), input="1crn")
    written = json.loads((tmp_path / "compare.json").read_text())
    assert written["input"] == "1crn"
    assert [t["technique"] for t in written["techniques"]] == ["ray", "ssao"]
    assert written["techniques"][0]["object"] is None
    assert written["techniques"][1]["object"]["rmse"] > 0
