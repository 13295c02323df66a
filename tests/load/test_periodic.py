"""Trajectories in periodic boxes: what the walls cut is put together, and held in place."""

from __future__ import annotations

import struct

import biotraj
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scuro.app.cli import run
from scuro.errors import LoadError
from scuro.load import load
from scuro.load.periodic import box_of, shortest_height
from scuro.load.trajectory import open_trajectory
from scuro.load.trajectory_frames import cell_vectors

BOXES = {
    "cube": np.diag([70.0, 72.0, 75.0]),
    # a rhombic dodecahedron, as GROMACS writes it
    "slanted": 80.0 * np.array([[1, 0, 0], [0, 1, 0], [0.5, 0.5, np.sqrt(0.5)]]),
}


@pytest.fixture(scope="module")
def protein():
    return load("sample:1hpv")


def wrapped(positions: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Every atom by itself in the box, as a simulation may write it."""
    share = positions @ np.linalg.inv(box)
    return ((share - np.floor(share)) @ box).astype(np.float32)


def drifting(protein, box: np.ndarray) -> list[np.ndarray]:
    """Whole positions of four frames: walking through a wall, the same to each other."""
    return [protein.positions + np.array([9.0, -7, 11]) * n for n in range(4)]


def write(path, frames: list[np.ndarray], box: np.ndarray) -> str:
    nm = np.stack(frames).astype(np.float32) / 10
    boxes = np.repeat(box[None].astype(np.float32) / 10, len(frames), axis=0)
    numbers = np.arange(len(frames))
    kind = {".xtc": "XTCTrajectoryFile", ".trr": "TRRTrajectoryFile"}[path.suffix]
    with getattr(biotraj, kind)(str(path), "w") as file:
        file.write(nm, numbers.astype(np.float32), numbers.astype(np.int32), boxes)
    return str(path)


def lengths(molecule, positions: np.ndarray) -> np.ndarray:
    a, b = molecule.bonds.T
    return np.linalg.norm(positions[a] - positions[b], axis=1)


@pytest.mark.parametrize("ending", ["xtc", "trr"])
@pytest.mark.parametrize("box", BOXES)
def test_molecules_that_a_box_cuts_are_whole_and_stay(protein, tmp_path, box, ending):
    vectors = BOXES[box]
    frames = drifting(protein, vectors)
    path = write(tmp_path / f"a.{ending}", [wrapped(f, vectors) for f in frames], vectors)
    made = open_trajectory("sample:1hpv", path)
    polymer = np.isin(made.molecule.kind, (0, 1))
    assert len(made.molecule.bonds) == len(protein.bonds), "found across the walls"
    places = [made.positions(n)[polymer] for n in range(4)]
    for n, place in enumerate(places):
        assert lengths(protein, made.positions(n)) == pytest.approx(
            lengths(protein, protein.positions),
            abs=0.03,  # XTC keeps hundredths
        )
        # both chains, in the same place to each other and to the picture
        assert np.abs(place - places[0]).max() < 0.03
        offset = (place - frames[0][polymer]).mean(axis=0)
        assert np.abs(place - frames[0][polymer] - offset).max() < 0.03
    raw = open_trajectory("sample:1hpv", path, whole=False)
    # longer than any bond, but what the file says
    assert any(lengths(protein, raw.positions(n)).max() > 30 for n in range(4))


def test_what_is_about_the_polymers_is_where_it_is_nearest(protein, tmp_path):
    box = BOXES["cube"]
    path = write(tmp_path / "a.xtc", [wrapped(f, box) for f in drifting(protein, box)], box)
    made = open_trajectory("sample:1hpv", path)
    others = ~np.isin(made.molecule.kind, (0, 1))
    for n in range(4):
        now = made.positions(n)
        middle = now[~others].mean(axis=0)
        assert (np.abs(now[others] - middle) < np.diag(box) / 2 + 12).all()


def test_polymers_that_part_stay_in_their_images(protein, tmp_path):
    """One chain walks off, beyond half of the box: it does not turn up on the other side."""
    box = np.diag([160.0, 160.0, 160.0])
    second = protein.chain == 1
    frames = [protein.positions.copy() for _ in range(3)]
    for n, frame in enumerate(frames):
        frame[second] += (0, 0, 45 + 20 * n)
    path = write(tmp_path / "a.trr", [wrapped(f, box) for f in frames], box)
    made = open_trajectory("sample:1hpv", path)
    polymer = np.isin(protein.kind, (0, 1))
    a, b = polymer & ~second, polymer & second
    for n, frame in enumerate(frames):
        apart = made.positions(n)[b].mean(axis=0) - made.positions(n)[a].mean(axis=0)
        assert apart == pytest.approx(frame[b].mean(axis=0) - frame[a].mean(axis=0), abs=0.01)


def test_between_frames_nothing_flies_across_the_box(protein, tmp_path):
    box = BOXES["cube"]
    frames = [protein.positions.copy() for _ in range(2)]
    water = np.flatnonzero(protein.kind == 3)[0]
    middle = frames[0][np.isin(protein.kind, (0, 1))].mean(axis=0)
    far = np.array([0, 0.49 * box[1, 1], 0])
    frames[0][water], frames[1][water] = middle + far, middle - far
    made = open_trajectory("sample:1hpv", write(tmp_path / "a.trr", frames, box))
    assert made.between(0.25)[water] == pytest.approx(made.positions(0)[water])
    assert made.between(0.75)[water] == pytest.approx(made.positions(1)[water])


def test_poses_are_held_by_the_best_fit(protein, tmp_path):
    middle = protein.positions.mean(axis=0)
    turn = Rotation.from_euler("xyz", [40, 100, -70], degrees=True).as_matrix()
    frames = [protein.positions, (protein.positions - middle) @ turn.T + middle + 20]
    path = write(tmp_path / "a.trr", frames, np.zeros((3, 3)))
    held = open_trajectory("sample:1hpv", path, hold="pose")
    assert np.abs(held.positions(1) - held.positions(0)).max() < 1e-3
    place = open_trajectory("sample:1hpv", path, hold="place")
    polymer = np.isin(protein.kind, (0, 1))
    assert place.positions(1)[polymer].mean(axis=0) == pytest.approx(
        place.positions(0)[polymer].mean(axis=0), abs=1e-3
    )
    assert np.abs(place.positions(1) - place.positions(0)).max() > 10
    # without a box nothing is held unless it is asked for
    free = open_trajectory("sample:1hpv", path)
    assert np.abs(free.positions(1) - frames[1]).max() < 1e-3


def test_boxes_of_unit_cells_and_of_nothing():
    assert box_of(np.zeros((3, 3))) is None and box_of(None) is None
    cell = cell_vectors(np.array([10, 20, 30]), np.array([90, 90, 90]))
    assert cell == pytest.approx(np.diag([10.0, 20, 30]))
    slanted = cell_vectors(np.array([10, 10, 10]), np.array([60, 60, 90]))
    assert slanted == pytest.approx(BOXES["slanted"] / 8)
    assert shortest_height(slanted) == pytest.approx(10 * np.sqrt(0.5))


def test_a_gro_file_that_its_box_cuts_is_whole(tmp_path):
    def line(n: int, name: str, x: float) -> str:
        return f"    1LIG  {name:>5}{n:5d}{x:8.3f}{1:8.3f}{1:8.3f}\n"

    text = "ligand\n 3\n" + line(1, "C1", 2.9) + line(2, "C2", 0.05) + line(3, "C3", 0.2)
    path = tmp_path / "cut.gro"
    path.write_text(text + "   3.00000   3.00000   3.00000\n")
    made = load(path)
    assert np.ptp(made.positions[:, 0]) == pytest.approx(3.0, abs=1e-3)
    assert len(made.bonds) == 2
    assert np.ptp(load(path, whole=False).positions[:, 0]) == pytest.approx(28.5, abs=1e-3)


def dcd(path, frames: int, said: int) -> str:
    """A DCD file of three atoms whose header claims another number of frames."""

    def record(content: bytes) -> bytes:
        return struct.pack("<i", len(content)) + content + struct.pack("<i", len(content))

    header = b"CORD" + struct.pack("<9i", said, 1, 1, 0, 0, 0, 0, 0, 0)
    header += struct.pack("<f", 1.0) + struct.pack("<10i", *[0] * 9, 24)
    data = record(header) + record(struct.pack("<i", 1) + b" " * 80)
    data += record(struct.pack("<i", 3))
    for n in range(frames):
        for axis in range(3):
            data += record(struct.pack("<3f", *(n + axis + i for i in range(3))))
    path.write_bytes(data)
    return str(path)


def test_what_the_dcd_reader_says_is_a_note_and_not_in_the_output(tmp_path, capfd):
    xyz = tmp_path / "three.xyz"
    xyz.write_text("3\n\nC 0 0 0\nC 1 1 1\nC 2 2 2\n")
    short = dcd(tmp_path / "short.dcd", frames=4, said=9)
    made = open_trajectory(xyz, short)
    assert len(made) == 4
    assert capfd.readouterr() == ("", "")
    assert any("9 frames" in note and "4 frames" in note for note in made.molecule.notes)
    arguments = ["render", str(xyz), "--trajectory", short, "--size", "16x12", "--style"]
    assert run([*arguments, "spacefill", "-o", str(tmp_path / "a.png")]) == 0
    assert capfd.readouterr() == ("", "")
    damaged = tmp_path / "damaged.dcd"
    damaged.write_bytes(b"no trajectory at all" * 9)
    with pytest.raises(LoadError, match="damaged"):
        open_trajectory(xyz, damaged)
    assert capfd.readouterr() == ("", "")
