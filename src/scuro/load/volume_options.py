"""What the user may say about a volume that its file does not, or that has to be chosen."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from scuro.errors import SettingsError
from scuro.load.volume_blocks import MAX_VOXELS
from scuro.settings import SettingsGroup, setting


def check_spacing(
    spacing: Sequence[float] | None, error: Callable[[str], Exception] = SettingsError
) -> None:
    """Raise ``error`` unless all spacings are positive and finite."""
    if spacing is None:
        return
    if len(spacing) != 3 or not all(math.isfinite(s) and s > 0 for s in spacing):
        shown = ", ".join(f"{s:g}" for s in spacing)
        raise error(
            f"the voxel spacing ({shown}) must be three positive numbers; "
            "give it with --voxels-spacing"
        )


class VoxelOptions(SettingsGroup):
    """How a volume is read."""

    size: tuple[int, int, int] | None = setting(
        None, "voxels along x, y, z of a raw file", low=1, high=65536
    )
    type: str | None = setting(
        None, "type of a raw file's samples: u8, i16, u16, f32; >i2 is big-endian"
    )
    header: int = setting(0, "bytes to skip at the start of a raw file", low=0)
    spacing: tuple[float, float, float] | None = setting(
        None, "edge lengths of a voxel, instead of the file's", check=check_spacing
    )
    time: int = setting(0, "which time step, counted from 0", low=0)
    channel: int = setting(0, "which channel or component, counted from 0", low=0)
    array: str | None = setting(None, "which array of a file with several (npz, zarr, vti)")
    series: str | None = setting(None, "which DICOM series of a folder: its UID or the end of it")
    smooth: float | None = setting(
        None,
        "deviation of a Gaussian that takes noise away; auto: 1.5 for tomograms, else 0",
        low=0,
        high=20,
        unit="voxels",
    )
    limit: int = setting(MAX_VOXELS, "larger volumes are averaged in blocks until they fit", low=1)
