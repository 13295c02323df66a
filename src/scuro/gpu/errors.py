"""The native layer's errors as sentences."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from scuro.errors import GpuError


@contextmanager
def telling(what: str) -> Iterator[None]:
    """Turn the native layer's errors into one sentence that says what was asked for."""
    try:
        yield
    except GpuError:
        raise
    except Exception as error:
        kind = type(error).__name__
        if "OutOfMemory" in kind:
            raise GpuError(
                f"the GPU is out of memory: {what}; "
                "lower --size, the samples or the resolution of the technique"
            ) from None
        if "lost" in str(error).lower():
            raise GpuError(f"the GPU was lost during {what}; lower --size or the samples") from None
        if kind.startswith("GPU"):
            raise GpuError(f"{what}: {error}") from error
        raise
