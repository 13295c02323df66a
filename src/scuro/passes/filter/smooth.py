"""Edge-aware smoothing of a noisy one-channel picture; also brings half resolution to full."""

from __future__ import annotations

from scuro.passes.frame import Frame


def smooth(frame: Frame, name: str, kind: str = "auto", *, radius: int = 4) -> None:
    """Replace the texture ``name`` by its smoothed form at full resolution.

    Args:
        frame: With ``surface`` filled.
        name: A one-channel texture, full or half resolution.
        kind: ``bilateral`` (also ``auto``): separable cross-bilateral, depth and normal aware;
            ``atrous``: edge-avoiding à-trous wavelets (Dammertz et al. 2010), three levels.
        radius: Of the bilateral kernel, in pixels.
    """
    source = frame.resources[name]
    if tuple(source.size[:2]) != tuple(frame.size):
        source = _run(frame, "upsample", source, f"{name}_full", 1)
    if kind == "atrous":
        for level in range(3):
            source = _run(frame, "atrous", source, f"{name}_{'ab'[level % 2]}", 1 << level)
    else:
        source = _run(frame, "across", source, f"{name}_a", radius)
        source = _run(frame, "down", source, f"{name}_b", radius)
    frame.resources[name] = source


def _run(frame: Frame, entry: str, source: object, target: str, reach: int) -> object:
    result = frame.target(target, "r32float", clear=(1, 1, 1, 1))
    index = int(frame.resources["view"]["frame"])
    frame.compute_tiles(
        "passes/filter/smooth.wgsl",
        {
            "smooth_settings": {"reach": reach, "offset": index % 4},
            "source": source,
            "result": result,
        },
        entry=entry,
        label="filter",
    )
    return result
