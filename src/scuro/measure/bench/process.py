"""Whole processes: reading 1,000,000 atoms, and 'scuro render' from its start to the written PNG.

Each is a process of its own, so that imports, opening the GPU and compiling shaders count. Without
inputs the files are copies of 1TII in mmCIF: 60,000 atoms to render and 1,000,000 to read.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from scuro.errors import ScuroError
from scuro.measure.bench import BenchOptions

_RENDERED, _READ = 60_000, 1_000_000
_LOAD = "import sys; from scuro.load import load; load(sys.argv[1])"


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure every file; see the module."""
    with tempfile.TemporaryDirectory() as folder:
        rows = []
        for name, what in _files(options, Path(folder)):
            options.say(f"{what} {Path(name).name}")
            picture = str(Path(folder) / "picture.png")
            size = "x".join(map(str, options.size))
            device = ["--device", options.device] if options.device else []
            arguments = (
                ["-c", _LOAD, name]
                if what == "load"
                else ["-m", "scuro", "render", name, "-o", picture, "--size", size,
                      "--style", "spacefill", *device]
            )  # fmt: skip
            times = [_seconds(arguments) for _ in range(options.frames)]
            rows.append(
                {
                    "file": Path(name).name,
                    "process": what,
                    "median_s": round(statistics.median(times), 3),
                    "best_s": round(min(times), 3),
                }
            )
    return {"size": list(options.size), "runs": options.frames, "rows": rows}


def _files(options: BenchOptions, folder: Path) -> list[tuple[str, str]]:
    """Each file and what is done with it: ``load`` or ``render``."""
    if options.inputs:
        return [(name, what) for name in options.inputs for what in ("load", "render")]
    small, large = folder / "toxins-60k.cif", folder / "toxins-1M.cif"
    write_copies(small, _RENDERED)
    write_copies(large, _READ)
    return [(str(small), "render"), (str(large), "load")]


_COLUMNS = (
    "group_PDB", "id", "type_symbol", "label_atom_id", "label_alt_id", "label_comp_id",
    "label_asym_id", "label_entity_id", "label_seq_id", "Cartn_x", "Cartn_y", "Cartn_z",
    "occupancy", "B_iso_or_equiv", "auth_seq_id", "auth_asym_id",
)  # fmt: skip


def write_copies(path: Path, atoms: int) -> None:
    """About so many atoms: copies of the sample 1TII side by side, as mmCIF."""
    from scuro.load import load
    from scuro.style.elements import SYMBOLS

    m = load("sample:1tii", waters=False)
    rows = list(
        zip(
            [SYMBOLS[number] for number in m.element],
            m.atom_name.tolist(),
            m.residue_name[m.residue].tolist(),
            m.residue_number[m.residue].tolist(),
            [m.chain_names[chain] for chain in m.chain],
            m.positions.tolist(),
            strict=True,
        )
    )
    with path.open("w") as file:
        file.write("data_TOXINS\nloop_\n")
        file.writelines(f"_atom_site.{key}\n" for key in _COLUMNS)
        for copy in range(round(atoms / len(rows))):
            column, row = copy % 14, copy // 14
            for serial, (symbol, name, residue, number, chain, (x, y, z)) in enumerate(rows):
                file.write(
                    f'ATOM {copy * len(rows) + serial + 1} {symbol} "{name}" . {residue} '
                    f"{chain}{copy} 1 {number} {x + 80 * column:.3f} {y + 80 * row:.3f} {z:.3f} "
                    f"1.00 20.00 {number} {chain}{copy}\n"
                )


def _seconds(arguments: list[str]) -> float:
    start = time.perf_counter()
    done = subprocess.run([sys.executable, *arguments], capture_output=True, text=True)
    if done.returncode:
        raise ScuroError(done.stderr.strip() or f"{arguments[:3]} failed")
    return time.perf_counter() - start
