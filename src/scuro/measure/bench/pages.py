"""Pages of the viewer: how long one that turns waits while the scene is changed from another.

Without inputs a page turns a molecule of 60,000 atoms, copies of the sample 1TII, while another
has rays traced, and loads and shows otherwise one of 500,000.
"""

from __future__ import annotations

import asyncio
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from scuro.measure.bench import BenchOptions, label

_SMALL, _LARGE = 60_000, 500_000
"""Atoms of what is shown first, and of what is loaded while a page looks on."""
_SIZE = (480, 270)
_MOST = 20.0
"""Seconds each of that may take."""


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure all of it; see the module."""
    from scuro.export.scene_file import Input, SceneFile
    from scuro.measure.bench.process import write_copies
    from scuro.measure.onlooker import gaps
    from scuro.render import Renderer
    from scuro.render_settings import Settings
    from scuro.viewer.model import Model
    from scuro.viewer.screen import Screen

    with tempfile.TemporaryDirectory() as folder:
        large = Path(folder) / "toxins-large.cif"
        write_copies(large, _LARGE)
        path = options.inputs[0] if options.inputs else str(Path(folder) / "toxins.cif")
        if not options.inputs:
            write_copies(Path(path), _SMALL)
        model = Model(SceneFile(input=(Input(path=path),)))
        renderer = Renderer(options.device)

        def show(**changes: Any) -> Any:
            return lambda: model.change(show=(model.document.show[0].replace(**changes),))

        def rays() -> Any:
            settings = model.settings.replace(occlusion__technique="ray", occlusion__samples=4096)
            return model.change(settings=settings)

        full = Settings().replace(lighting__preset="full")
        deeds = {
            "4,096 rays a pixel": rays,
            f"{_LARGE:,} atoms loaded": lambda: model.open(
                replace(model.document, input=(Input(path=str(large)),), settings=full)
            ),
            f"{_LARGE:,} atoms coloured": show(color="chain"),
            f"{_LARGE:,} atoms as balls and sticks": show(style="ball+stick"),
            f"{_LARGE:,} atoms as cartoon": show(style="cartoon"),
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
    rows = [{"what": what, "longest_gap_ms": round(1000 * s)} for what, s in found.items()]
    return {"file": label(path), "size": list(_SIZE), "rows": rows}
