"""How much memory the process holds, and has held at most."""

from __future__ import annotations

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
