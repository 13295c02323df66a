"""``docs/results.md``: this program's numbers beside those of the theses it builds on.

Each topic is one module here, found by its name. It has a ``TITLE`` and
``section(options: BenchOptions) -> Iterator[str]``, the Markdown paragraphs of its section, which
are measured as they are asked for. One topic is written at a time; the other sections stay:

    python -m scuro.measure.results TOPIC [IN...] [-o docs/results.md] [--size WxH] [--frames N]
"""

from __future__ import annotations

import importlib
import pkgutil
from types import ModuleType

ORDER = ("molecules", "navigation", "volumes", "volumes_error", "mesoscale", "reservoirs")
"""Topics as they stand on the page; others follow by name."""


def topics() -> dict[str, ModuleType]:
    """Every topic's module, in the order of the page."""
    found = {m.name for m in pkgutil.iter_modules(__path__)} - {"page", "__main__"}
    names = [name for name in ORDER if name in found] + sorted(found - set(ORDER))
    return {name: importlib.import_module(f"{__name__}.{name}") for name in names}
