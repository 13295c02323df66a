"""Pages of the viewer: how long one that turns waits while the scene is changed from another.

Without inputs a page turns a molecule of 60,000 atoms, copies of the sample 1TII, while another
has rays traced, and loads and shows otherwise one of 500,000 atoms, one of 1,000,000 and a volume
of 256³ voxels. The first input is what it turns instead; those that follow are loaded at the end.
The last row is the memory that the process took at most, the pages' included.
"""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from scuro.measure.bench import BenchOptions, label

_ATOMS = (60_000, 500_000, 1_000_000)
"""Of what is shown first, and of what is loaded while a page looks on."""
_VOXELS = 256
_SIZE = (480, 270)
_MOST = 20.0
"""Seconds each of that may take."""
_TARGET = 250
"""Milliseconds that no page should wait."""


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure all of it; see the module."""
    from scuro.export.scene_file import Input, SceneFile, Show
    from scuro.measure.memory import peak_memory_mb
    from scuro.measure.onlooker import gaps
    from scuro.render import Renderer
    from scuro.render_settings import Settings
    from scuro.viewer.model import Model
    from scuro.viewer.screen import Screen

    with tempfile.TemporaryDirectory() as folder:
        small, large, larger, volume = _files(Path(folder))
        path = options.inputs[0] if options.inputs else str(small)
        model = Model(SceneFile(input=(Input(path=path),)))
        renderer = Renderer(options.device)
        full = Settings().replace(lighting__preset="full")

        def load(name: str) -> Callable[[], Any]:
            document = SceneFile(input=(Input(path=name),), settings=full)
            return lambda: model.open(document)

        def show(**changes: Any) -> Callable[[], Any]:
            return lambda: model.change(show=(Show(**changes),))

        def change(**changes: Any) -> Callable[[], Any]:
            return lambda: model.change(settings=model.settings.replace(**changes))

        half, million = (f"{count:,} atoms" for count in _ATOMS[1:])
        deeds = {
            "4,096 rays a pixel": change(occlusion__technique="ray", occlusion__samples=4096),
            f"{half} loaded": load(str(large)),
            f"{half} coloured": show(color="chain"),
            f"{half} as balls and sticks": show(style="ball+stick"),
            f"{half} as cartoon": show(style="cartoon"),
            f"{million} loaded": load(str(larger)),
            f"{million} as balls and sticks": show(style="ball+stick"),
            f"{_VOXELS}³ voxels loaded": load(str(volume)),
            f"{_VOXELS}³ voxels, another window": change(volume__window=0.5, volume__level=0.5),
            **{f"{label(name)} loaded": load(name) for name in options.inputs[1:]},
        }
        found = asyncio.run(
            gaps(
                model,
                lambda deliver: Screen(model, renderer, "rgba8unorm", deliver),
                deeds,
                _SIZE,
                _MOST,
            )
        )
    rows = [
        {"what": f"{what}: longest gap", "value": round(1000 * s), "unit": "ms", "target": _TARGET}
        for what, s in found.items()
    ]
    rows.append(
        {"what": "memory", "value": round(peak_memory_mb() or 0), "unit": "MB", "target": ""}
    )
    return {"file": label(path), "size": list(_SIZE), "rows": rows}


def _files(folder: Path) -> list[Path]:
    """Molecules of so many atoms, and a volume."""
    from scuro.measure.bench.process import write_copies

    paths = [folder / f"toxins-{count}.cif" for count in _ATOMS]
    for path, count in zip(paths, _ATOMS, strict=True):
        write_copies(path, count)
    across = np.linspace(-1, 1, _VOXELS, dtype=np.float32)
    wave, bell = np.sin(20 * across), np.exp(-4 * across**2)
    values = np.einsum("i,j,k->ijk", bell, bell, bell)
    values *= 1 + 0.3 * np.einsum("i,j,k->ijk", wave, wave, wave)
    volume = folder / "waves.nrrd"
    size = f"{_VOXELS} {_VOXELS} {_VOXELS}"
    head = f"NRRD0004\ntype: float\ndimension: 3\nsizes: {size}\nencoding: raw\nendian: little\n\n"
    volume.write_bytes(head.encode() + values.astype("<f4").tobytes())
    return [*paths, volume]
