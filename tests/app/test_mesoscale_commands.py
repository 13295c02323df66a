"""``scuro make-mesoscale``, ``info`` and ``render`` of what it writes; clutter falls."""

import numpy as np
from PIL import Image

from scuro.app.cli import run
from scuro.measure.clutter import edge_density, subband_entropy


def test_a_scene_is_made_described_and_drawn(tmp_path, capfd):
    table = tmp_path / "cell.csv"
    assert run(["make-mesoscale", "sample:1hpv", "-o", str(table), "--atoms", "3e5"]) == 0
    assert "compartment 2" in capfd.readouterr().out
    assert run(["info", str(table)]) == 0
    assert "compartment 2" in capfd.readouterr().out
    pictures = []
    for mode in ("plain", "screen"):
        out = tmp_path / f"{mode}.png"
        arguments = ["render", str(table), "-o", str(out), "--size", "160x120"]
        assert run([*arguments, "--semantic", mode]) == 0
        pictures.append(np.asarray(Image.open(out)))
    assert (pictures[0] != pictures[1]).any()


def test_what_is_not_a_structure_is_refused(tmp_path, capfd):
    (tmp_path / "x.csv").write_text("ingredient,x,y,z\na,0,0,0\n")
    assert run(["make-mesoscale", str(tmp_path / "x.csv"), "-o", str(tmp_path / "y.meso")]) == 2
    assert "is not a structure" in capfd.readouterr().err


def test_clutter_measures_know_calm_from_busy():
    rng = np.random.default_rng(0)
    busy = np.full((64, 64, 3), 255, np.uint8)
    busy[8:56, 8:56] = rng.integers(0, 200, (48, 48, 1))
    calm = np.full((64, 64, 3), 255, np.uint8)
    calm[8:56, 8:56] = 120
    assert edge_density(busy) > 5 * edge_density(calm) > 0
    assert subband_entropy(busy) > 2 * subband_entropy(calm)


def test_a_missing_structure_is_named_and_drawn_or_refused(tmp_path, capfd):
    table = tmp_path / "cell.csv"
    table.write_text("ingredient,x,y,z,qx,qy,qz,qw\nlost,0,0,0,0,0,0,2\nlost,90,0,0,0,0,0,1\n")
    out = tmp_path / "cell.png"
    arguments = ["render", str(table), "-o", str(out), "--size", "48x36"]
    assert run(arguments) == 0 and out.exists()
    said = capfd.readouterr().err
    assert "structure 'lost' of ingredient 'lost' is missing" in said
    assert "1 quaternions were not of unit length" in said
    assert run([*arguments, "--strict"]) == 1
    assert "--structures" in capfd.readouterr().err


def test_thresholds_out_of_order_are_a_usage_error(tmp_path, capfd):
    arguments = ["render", "sample:1hpv", "-o", str(tmp_path / "a.png"), "--semantic", "screen"]
    assert run([*arguments, "--semantic-thresholds", "10,20"]) == 2
    assert "far to near" in capfd.readouterr().err
