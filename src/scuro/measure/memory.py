"""How much memory the process holds, and has held at most."""

from __future__ import annotations

import ctypes
import sys


def peak_memory_mb() -> float | None:
    """The most memory this process has held, in MB; None where the system does not tell."""
    try:
        import resource
    except ImportError:  # Windows
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(peak / (1 << 20 if sys.platform == "darwin" else 1 << 10), 1)


def resident_mb() -> float:
    """Memory of this process that is in RAM, in MB."""
    import psutil

    return float(psutil.Process().memory_info().rss / (1 << 20))


class _Heap(ctypes.Structure):
    """struct mallinfo2 of the GNU C library."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in (
            "arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks",
            "fordblks", "keepcost",
        )
    ]  # fmt: skip


def held() -> dict[str, float]:
    """MB that malloc has given out and not got back, in small pieces and in large ones.

    Empty where the C library does not tell.
    """
    try:
        mallinfo2 = ctypes.CDLL("libc.so.6").mallinfo2
    except (OSError, AttributeError):
        return {}
    mallinfo2.restype = _Heap
    heap = mallinfo2()
    mb = 1 << 20
    return {"small pieces, MB": heap.uordblks / mb, "large pieces, MB": heap.hblkhd / mb}
