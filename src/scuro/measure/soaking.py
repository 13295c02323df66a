"""What ``scripts/soak`` runs: random hands on the viewer, and a line that says how memory grew."""

from __future__ import annotations

import faulthandler
import signal
import sys
import tempfile
from pathlib import Path

from scuro.errors import ScuroError
from scuro.export.scene_file import Input, SceneFile
from scuro.measure.soak import Soaked, soak
from scuro.measure.soak_tour import documents

MOST_GROWTH = 0.05
"""Share by which memory may grow."""
_STUCK = 180.0
"""Seconds without a word after which the process says where it stands and ends."""


def main(minutes: float = 10.0, *paths: str) -> int:
    """Soak a viewer.

    Args:
        minutes: Of random hands, after the tour of the features.
        paths: Files to show in turn.

    Returns:
        0 if memory kept within :data:`MOST_GROWTH`, else 1.
    """
    from scuro.render import Renderer
    from scuro.viewer.model import Model
    from scuro.viewer.screen import Screen

    result, fault = Soaked(), ""

    def say(line: str) -> None:
        faulthandler.dump_traceback_later(_STUCK, exit=True)
        print(line, flush=True)

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, stop)
    with tempfile.TemporaryDirectory() as folder:
        shown = [SceneFile(input=(Input(path=path),)) for path in paths]
        shown = shown or documents(Path(folder))
        model = Model(shown[0])
        screen = Screen(model, Renderer(), "rgba8unorm", lambda name, write: f"not saved: {name}")
        screen.resize(960.0, 540.0, 1.0)
        shown[0] = model.document
        try:
            say("every feature once")
            soak(screen, 60 * minutes, documents=shown, say=say, result=result)
        except KeyboardInterrupt:
            fault = "stopped; so far: "
        except ScuroError as error:
            fault = f"{error}; so far: "
    faulthandler.cancel_dump_traceback_later()
    for name, (first, last) in result.trends().items():
        print(f"  {name}: {first:.0f} -> {last:.0f}")
    fine = bool(result.rounds) and result.growth <= MOST_GROWTH
    print(f"RESULT {'passed' if fine else 'failed'}: {fault}{result.line()}", flush=True)
    return 0 if fine else 1


if __name__ == "__main__":
    minutes, files = sys.argv[1:2], sys.argv[2:]
    sys.exit(main(float(minutes[0]), *files) if minutes else main())
