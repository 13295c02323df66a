"""``scuro compare`` and ``scuro bench`` on a small molecule."""

import json

import pytest
from PIL import Image

from scuro.app.cli import run
from scuro.app.compare import reference_variant
from scuro.errors import SettingsError
from scuro.measure.compare import variants, varied


def test_compare_writes_pictures_sheet_and_numbers(tmp_path, capfd):
    folder = tmp_path / "out"
    arguments = ["compare", "sample:1hpv", "--vary", "lighting", "--techniques", "simple,flat"]
    options = ["--reference", "simple,key=0.5", "--size", "96x72", "--frames", "1", "-o"]
    assert run([*arguments, *options, str(folder)]) == 0
    out = capfd.readouterr().out
    assert "reference" in out and "1,631 atoms" in out
    report = json.loads((folder / "compare.json").read_text())
    reference, simple, flat = report["techniques"]
    assert reference["object"] is None and reference["milliseconds"] > 0
    assert reference["settings"] == {"lighting.preset": "simple", "lighting.key": 0.5}
    assert flat["object"]["ssim"] < 1 and flat["object"]["rmse"] > simple["object"]["rmse"] > 0
    assert simple["picture"]["rmse"] < simple["object"]["rmse"], "the background flatters"
    for row in report["techniques"]:
        with Image.open(folder / row["image"]) as picture:
            assert picture.size == (96, 72)
    with Image.open(folder / "sheet.png") as sheet:
        assert sheet.width > 2 * 96


def test_every_variant_is_a_value_of_its_setting():
    known = varied()
    assert {"visibility", "lighting"} <= set(known)
    for name in known:
        assert len(variants(name)) >= 1
    assert "auto" not in [v.name for v in variants("visibility")]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: variants("nothing"), "unknown setting to vary"),
        (lambda: variants("lighting", ["fulll"]), "did you mean 'full'"),
        (lambda: reference_variant("lighting", "full,kye=1"), "did you mean 'key'"),
        (lambda: reference_variant("lighting", "full,key=x"), "needs a number"),
    ],
)
def test_wrong_names_are_said(call, words):
    with pytest.raises(SettingsError, match=words):
        call()


def test_bench_lists_runs_and_refuses(capfd):
    assert run(["bench"]) == 0
    assert "visibility:" in capfd.readouterr().out
    small = ["--size", "64x48", "--frames", "1", "--json"]
    assert run(["bench", "visibility", "sample:1hpv", *small]) == 0
    report = json.loads(capfd.readouterr().out)
    assert {row["visibility"] for row in report["rows"]} == {"raycast", "raster"}
    assert all(row["frame_s"] > 0 and row["spheres"] == 1551 for row in report["rows"])
    assert run(["bench", "visiblity"]) == 2
    assert "did you mean 'visibility'" in capfd.readouterr().err
    assert run(["bench", "visibility", "--size", "0x9"]) == 2


def test_every_list_of_rows_is_a_table(monkeypatch, capfd):
    from scuro.measure.bench import navigation

    rows = [{"molecule": "a", "frame_s": 0.25}]
    report = {"size": [64, 48], "rows": rows, "rest": [{"rest": "cartoon", "ratio": 1.5}]}
    monkeypatch.setattr(navigation, "run", lambda options: report)
    assert run(["bench", "navigation"]) == 0
    out = capfd.readouterr().out
    assert "0.25" in out and "navigation: rest" in out and "cartoon" in out and "1.5" in out


def test_bench_shadows_holds_each_technique_to_area_lights(capfd):
    assert (
        run(["bench", "shadows", "sample:1hpv", "--size", "96x72", "--frames", "1", "--json"]) == 0
    )
    rows = {row["shadows"]: row for row in json.loads(capfd.readouterr().out)["rows"]}
    assert set(rows) == {"none", "hard", "soft", "area", "mapped"}
    assert rows["hard"]["rmse"] > rows["soft"]["rmse"]
    assert rows["none"]["rmse"] > 2 * max(rows[k]["rmse"] for k in ("hard", "soft", "area"))


def test_compare_holds_the_deferred_picture_to_the_path_tracer(tmp_path):
    folder = tmp_path / "out"
    options = ["--vary", "renderer", "--techniques", "deferred", "--lighting", "full"]
    reference = ["--reference", "path,path.samples=4,path.bounces=1"]
    small = ["--size", "64x48", "--frames", "1", "-o", str(folder)]
    assert run(["compare", "sample:1hpv", *options, *reference, *small]) == 0
    truth, deferred = json.loads((folder / "compare.json").read_text())["techniques"]
    assert truth["settings"]["path.samples"] == 4 and truth["milliseconds"] > 0
    assert deferred["object"]["ssim"] > 0.5


def test_the_results_page_has_every_table_beside_the_thesis(tmp_path):
    from scuro.measure.results.__main__ import main

    page = tmp_path / "results.md"
    page.write_text("# Results\n\n## Molecules: occlusion and shadows\n\nold\n\n## Gone\n\nx\n")
    measured = tmp_path / "measured.json"
    measured.write_text("{}")
    options = ["-o", str(page), "--size", "48x36", "--frames", "1", "--measured", str(measured)]
    main(["molecules", "sample:1hpv", *options])
    first = page.read_text()
    main(["molecules", "--measured", str(measured), "-o", str(page), "--size", "48x36"])
    text = page.read_text()
    assert text == first, "what was measured is written again, not measured again"
    assert "old" not in text and "## Gone" not in text
    for number in ("Table 4.1", "Table 4.3", "Table 5.2", "Table 5.3", "Figure 4.9"):
        assert number in text
    assert "| 1AON, 58,870 | 38 | 50.1 |" in text and "| sample:1hpv, " in text


def test_the_results_of_the_navigation_cube_hold_the_atoms_at_327(tmp_path, monkeypatch):
    from scuro.measure.results import navigation
    from scuro.measure.results.__main__ import main

    monkeypatch.setattr(navigation, "_SIZES", (327, 2000))
    page = tmp_path / "results.md"
    main(["navigation", "-o", str(page), "--size", "48x36", "--frames", "1"])
    text = page.read_text()
    assert "| droplet, 2,000 | " in text and "| 3IYN, 99,595 | 0.38 | 0.06 | 19.2 | 6.55 |" in text
