"""``docs/results.md`` on disk: a heading, then sections that are replaced one by one."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from scuro.export.files import replacing

HEAD = """# Results

Every section stands under the command that measures and writes it again. Times are medians on the
adapter named there; figures of the theses, printed for graphics cards of their time, stand beside.
"""


def replace_section(
    path: Path, title: str, command: str, paragraphs: Iterable[str], order: Sequence[str]
) -> None:
    """Write one section of the page anew; the others stay, all in the given order of titles."""
    sections = read_sections(path)
    sections[title] = "\n\n".join([f"    {command}", *paragraphs])
    known = [name for name in order if name in sections]
    parts = [HEAD, *(f"## {name}\n\n{sections[name]}\n" for name in known)]
    with replacing(path) as file:
        file.write("\n".join(parts).encode())


def read_sections(path: Path) -> dict[str, str]:
    """Text of each section by its title; none if there is no page yet."""
    if not path.exists():
        return {}
    pieces = re.split(r"^## (.+)\n", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {title: text.strip("\n") for title, text in zip(pieces[1::2], pieces[2::2], strict=True)}


def grid(heads: Sequence[str], rows: Mapping[str, tuple[float | str | None, ...]]) -> str:
    """A Markdown table; numbers with three significant digits."""
    lines = [f"| {' | '.join(heads)} |", f"|---|{'---:|' * (len(heads) - 1)}"]
    for name, values in rows.items():
        lines.append(f"| {name} | {' | '.join(_cell(value) for value in values)} |")
    return "\n".join(lines)


def _cell(value: float | str | None) -> str:
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"
