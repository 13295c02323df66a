"""The result of a comparison as a table for people and as JSON for programs."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scuro.export.files import replacing
from scuro.measure.metrics import Scores

if TYPE_CHECKING:
    from rich.table import Table


@dataclass(frozen=True)
class Row:
    """One technique held against the reference."""

    technique: str
    settings: dict[str, Any]
    """Those that differ from the defaults."""
    milliseconds: float
    """A steady frame."""
    object: Scores | None = None
    """Over the object's pixels; None for the reference itself."""
    picture: Scores | None = None
    """Over the whole picture."""
    image: str = ""
    """File name, relative to the report."""
    notes: dict[str, Any] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        return {
            "technique": self.technique,
            "settings": self.settings,
            "milliseconds": self.milliseconds,
            "object": self.object and self.object.as_dict(),
            "picture": self.picture and self.picture.as_dict(),
            "image": self.image,
            **self.notes,
        }


def table(rows: list[Row], title: str) -> Table:
    """A rich table of the rows: measures over the object's pixels, PSNR in dB."""
    from rich import box
    from rich.table import Table

    made = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left")
    made.add_column("technique", no_wrap=True)
    for name in ("ms", "RMSE", "PSNR", "SSIM", "ΔE2000", "FLIP", "gain", "contrast"):
        made.add_column(name, justify="right", no_wrap=True)
    memory = any("megabytes" in row.notes for row in rows)
    if memory:
        made.add_column("MB", justify="right", no_wrap=True)
    made.add_column("settings")
    for row in rows:
        made.add_row(
            row.technique,
            f"{row.milliseconds:.0f}",
            *_cells(row),
            *([f"{row.notes.get('megabytes', 0.0):.2f}"] if memory else []),
            " ".join(f"{k}={v}" for k, v in row.settings.items()),
        )
    return made


def _cells(row: Row) -> list[str]:
    o = row.object
    if o is None:
        return ["reference", *[""] * 6]
    return [
        f"{o.rmse:.4f}",
        f"{o.psnr:.1f}",
        f"{o.ssim:.3f}",
        f"{o.delta_e:.2f}",
        f"{o.flip:.3f}",
        f"{o.gain:.2f}",
        f"{o.local_contrast / max(o.local_contrast_reference, 1e-9):.2f}×",
    ]


def write_json(path: Path, rows: list[Row], **about: Any) -> None:
    """Write the rows and what is said ``about`` the run as one JSON object."""
    text = json.dumps({**about, "techniques": [r.as_dict() for r in rows]}, indent=2)
    with replacing(path) as file:
        file.write(text.encode() + b"\n")
