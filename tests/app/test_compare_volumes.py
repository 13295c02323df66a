"""``scuro compare`` on a volume: every method against Monte Carlo, fitted, with maps."""

import json

import numpy as np
from PIL import Image

from scuro.app.cli import run


def test_methods_are_compared_with_difference_maps(tmp_path, capfd):
    z, y, x = np.indices((20, 20, 20)) - 9.5
    np.save(tmp_path / "ball.npy", (200 * (np.hypot(np.hypot(x, y), z) < 8)).astype(np.uint8))
    folder = tmp_path / "out"
    options = ["--size", "48x48", "--frames", "1", "--fit", "--reference", "monte-carlo,samples=8"]
    names = "object,image,slices,voxel-cones,summed-area,local-sphere"
    call = ["compare", str(tmp_path / "ball.npy"), "--techniques", names, *options]
    assert run([*call, "-o", str(folder)]) == 0
    out = capfd.readouterr().out
    assert "8,000 voxels" in out and "differences.png" in out
    report = json.loads((folder / "compare.json").read_text())
    reference, *rows = report["techniques"]
    assert [row["technique"] for row in rows] == names.split(",")
    assert reference["settings"]["volume.samples"] == 8
    for row in rows:
        assert 0 < row["object"]["delta_e"] < 12
        assert "volume.occlusion.attenuation" in row["settings"]
        with Image.open(folder / f"{row['technique']}-difference.png") as picture:
            assert picture.size == (48, 48)


def test_a_reference_is_asked_for_where_none_is_known(tmp_path, capfd):
    np.save(tmp_path / "box.npy", np.ones((4, 4, 4), np.uint8))
    call = ["compare", str(tmp_path / "box.npy"), "--vary", "shading"]
    assert run([*call, "-o", str(tmp_path / "out")]) == 2
    assert "--reference" in capfd.readouterr().err


def test_notes_of_readers_are_told_when_rendering(tmp_path, capfd):
    values = np.ones((6, 6, 6), np.float32)
    values[0, 0, :2] = np.nan, np.inf
    values[2:4] = 5.0
    np.save(tmp_path / "holes.npy", values)
    call = ["render", str(tmp_path / "holes.npy"), "-o", str(tmp_path / "out.png")]
    assert run([*call, "--size", "24x24", "--voxels-limit", "100"]) == 0
    told = capfd.readouterr().err
    assert "more than the limit" in told and "means of" in told
    assert run([*call, "--size", "24x24"]) == 0
    assert "2 voxels" in capfd.readouterr().err
