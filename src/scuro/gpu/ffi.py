"""wgpu-py's bridge to its native library, made quicker.

Every C type that wgpu-py names for the first time (``"WGPUBufferDescriptor *"``) is parsed by cffi
together with a line for each of the header's 450 typedefs. Measured: over 30 ms a type, 2 s of CPU
time in a process that draws one picture. Only the typedefs that the type names are needed.
"""

from __future__ import annotations

import re
from typing import Any


def quicken(ffi: Any) -> None:
    """Let ``ffi`` parse types with the declarations they name; harmless where cffi is another."""
    parser: Any = getattr(ffi, "_parser", None)
    if not isinstance(getattr(parser, "_declarations", None), dict):
        return
    parse = parser.parse_type

    def parse_type(text: str) -> Any:
        # cffi calls this under its own lock
        everything = parser._declarations
        words = set(re.findall(r"\w+", text))
        parser._declarations = {
            name: kind for name, kind in everything.items() if name.split()[-1] in words
        }
        try:
            return parse(text)
        except Exception:
            parser._declarations = everything
            return parse(text)
        finally:
            parser._declarations = everything

    parser.parse_type = parse_type
