"""The C library's heap: what it holds, and giving back what is free."""

from __future__ import annotations

import ctypes
import sys
from functools import cache
from typing import Any


@cache
def _library() -> Any:
    """The GNU C library; ``None`` elsewhere."""
    if sys.platform != "linux":
        return None
    try:
        library = ctypes.CDLL("libc.so.6")
        library.mallinfo2.restype = _Heap
    except (OSError, AttributeError):
        return None
    return library


class _Heap(ctypes.Structure):
    """struct mallinfo2."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in (
            "arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks",
            "fordblks", "keepcost",
        )
    ]  # fmt: skip


def held() -> dict[str, float]:
    """MB that malloc has given out and not got back, in small pieces and in large ones, and those
    that it keeps for others.

    Empty where the C library does not tell.
    """
    if _library() is None:
        return {}
    heap = _library().mallinfo2()
    mb = 1 << 20
    return {
        "small pieces, MB": heap.uordblks / mb,
        "large pieces, MB": heap.hblkhd / mb,
        "free pieces, MB": heap.fordblks / mb,
    }


def give_back() -> None:
    """Give free memory back to the system, where the C library can: a compiled shader leaves
    megabytes, and each thread keeps its own. Takes some milliseconds."""
    if _library() is not None:
        _library().malloc_trim(0)
