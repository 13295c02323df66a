"""What comparisons hold against each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Variant:
    """A way to draw the scene: its name, and what it changes of the settings."""

    name: str
    changes: dict[str, Any]
    """As for :meth:`scuro.settings.SettingsGroup.replace`."""
