"""Loading WGSL: the one preprocessor feature, the declared bindings, and errors that name a line.

``//#include "ray.wgsl"`` alone on a line is replaced by that file, once a shader. Files are looked
for in ``scuro/wgsl`` and beside the including file. What a shader wants bound is read from its own
declarations, so that resources are given by name.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from scuro.errors import ShaderError
from scuro.gpu.layout import WgslType, parse_structs

ROOT = Path(__file__).resolve().parent.parent
_INCLUDE = re.compile(r'//#include\s+"([^"]+)"\s*')
_BINDING = re.compile(
    r"@group\((\d+)\)\s*@binding\((\d+)\)\s*var(?:<([^>]*)>)?\s+(\w+)\s*:\s*([^;]+);([^\n]*)"
)
_ENTRY = re.compile(r"@compute\s*@workgroup_size\(([^)]*)\)\s*fn\s+(\w+)")


@dataclass(frozen=True)
class Binding:
    """A resource that a shader declares."""

    group: int
    slot: int
    name: str
    space: str
    """``uniform``, ``storage, read`` …; empty for textures and samplers."""
    type: str
    filterable: bool
    """Whether a float texture is declared ``// filterable``."""
    nearest: bool
    """Whether a sampler is declared ``// nearest``: it suits textures that are not filterable."""

    def layout(self) -> dict:
        """The entry of a bind group layout, but for ``binding`` and ``visibility``."""
        kind = self.type.strip()
        if self.space == "uniform":
            return {"buffer": {"type": "uniform"}}
        if self.space.startswith("storage"):
            writes = "read_write" in self.space
            return {"buffer": {"type": "storage" if writes else "read-only-storage"}}
        if kind == "sampler":
            return {"sampler": {"type": "non-filtering" if self.nearest else "filtering"}}
        if kind == "sampler_comparison":
            return {"sampler": {"type": "comparison"}}
        if m := re.fullmatch(r"texture_storage_(\w+?)<\s*(\w+)\s*,\s*(\w+)\s*>", kind):
            return {
                "storage_texture": {
                    "access": f"{m.group(3).replace('_', '-')}".replace("write", "write-only")
                    if m.group(3) == "write"
                    else ("read-only" if m.group(3) == "read" else "read-write"),
                    "format": m.group(2),
                    "view_dimension": m.group(1).replace("_", "-"),
                }
            }
        if m := re.fullmatch(r"texture_depth_(\w+)", kind):
            return {"texture": {"sample_type": "depth", "view_dimension": m[1].replace("_", "-")}}
        if m := re.fullmatch(r"texture_(\w+?)<\s*(\w+)\s*>", kind):
            sample = {"f32": "unfilterable-float", "u32": "uint", "i32": "sint"}[m.group(2)]
            if self.filterable:
                sample = "float"
            return {"texture": {"sample_type": sample, "view_dimension": m[1].replace("_", "-")}}
        raise ValueError(kind)


@dataclass(frozen=True)
class Source:
    """A WGSL file with its includes, and what it declares."""

    file: str
    text: str
    lines: tuple[tuple[str, int], ...]
    """For each line of ``text``: the file and the line it came from."""
    bindings: tuple[Binding, ...]
    structs: dict[str, WgslType]
    workgroups: dict[str, tuple[int, int, int]]
    """Workgroup size of each compute entry point."""
    overrides: frozenset[str]
    """Names of the ``override`` constants."""

    def where(self, line: int) -> tuple[str, int]:
        """The file and its line for a one-based line of ``text``."""
        return self.lines[line - 1] if 0 < line <= len(self.lines) else (self.file, line)


@cache
def load(file: str) -> Source:
    """Read a shader of the package, e.g. ``"passes/compose/shade.wgsl"``."""
    lines: list[tuple[str, int]] = []
    text: list[str] = []
    _expand(ROOT / file, file, set(), text, lines)
    return parse("\n".join(text), file, tuple(lines))


def load_text(body: str, file: str) -> Source:
    """A shader given as text (tests, generated kernels); it may include files of ``scuro/wgsl``."""
    lines: list[tuple[str, int]] = []
    text: list[str] = []
    _expand_lines(body, ROOT / "wgsl" / file, file, set(), text, lines)
    return parse("\n".join(text), file, tuple(lines))


def parse(text: str, file: str, lines: tuple[tuple[str, int], ...]) -> Source:
    """Find bindings, structs and entry points in a flattened shader."""
    bindings = tuple(
        Binding(
            int(m.group(1)),
            int(m.group(2)),
            m.group(4),
            re.sub(r"\s+", " ", m.group(3) or "").strip(),
            m.group(5),
            "// filterable" in m.group(6),
            "// nearest" in m.group(6),
        )
        for m in _BINDING.finditer(text)
    )
    workgroups = {}
    for m in _ENTRY.finditer(text):
        size = [int(s.strip().rstrip("u")) for s in m.group(1).split(",") if s.strip()]
        workgroups[m.group(2)] = (*size, 1, 1)[:3]
    overrides = frozenset(re.findall(r"^\s*override\s+(\w+)", text, re.M))
    structs = parse_structs(text, file)
    return Source(file, text, lines, bindings, structs, workgroups, overrides)  # type: ignore[arg-type]


def _expand(
    path: Path, name: str, seen: set[Path], text: list[str], lines: list[tuple[str, int]]
) -> None:
    try:
        body = path.read_text(encoding="utf-8")
    except OSError:
        raise ShaderError(name, None, "there is no such shader") from None
    _expand_lines(body, path, name, seen, text, lines)


def _expand_lines(
    body: str, path: Path, name: str, seen: set[Path], text: list[str], lines: list[tuple[str, int]]
) -> None:
    seen.add(path)
    for number, line in enumerate(body.splitlines(), start=1):
        match = _INCLUDE.fullmatch(line.strip())
        if match is None:
            text.append(line)
            lines.append((name, number))
            continue
        for folder in (ROOT / "wgsl", path.parent):
            target = (folder / match.group(1)).resolve()
            if target.exists():
                break
        else:
            raise ShaderError(name, number, f"cannot include '{match.group(1)}': no such file")
        if target not in seen:
            _expand(target, target.relative_to(ROOT).as_posix(), seen, text, lines)
