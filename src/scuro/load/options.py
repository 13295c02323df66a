"""What to read of a file: the options of :func:`scuro.load.load`."""

from __future__ import annotations

from scuro.errors import SettingsError
from scuro.load.periodic import HOLDS
from scuro.load.volume_options import VoxelOptions
from scuro.settings import SettingsGroup, setting


def _check_model(value: str) -> None:
    if value not in ("first", "all") and not value.removeprefix("-").isdigit():
        raise SettingsError(f"model is 'first', 'all' or a model's number, not '{value}'")


def _check_altloc(value: str) -> None:
    if value not in ("highest", "all") and not (len(value) == 1 and value.isprintable()):
        raise SettingsError(
            f"altloc is 'highest' (occupancy), 'all' or one location's letter, not '{value}'"
        )


class LoadOptions(SettingsGroup):
    """What to keep of a structure's atoms."""

    model: str = setting(
        "first",
        "which model of several to read: first, all, or its number (in SD files: the record)",
        check=_check_model,
    )
    altloc: str = setting(
        "highest",
        "alternate locations: those of highest occupancy, all, or one letter",
        check=_check_altloc,
    )
    hydrogens: bool = setting(True, "keep hydrogen atoms")
    waters: bool = setting(True, "keep water")
    ligands: bool = setting(True, "keep ligands and ions")
    trajectory: str | None = setting(
        None, "a trajectory (XTC, TRR, DCD) with coordinates for the structure's atoms"
    )
    frame: float = setting(
        0.0,
        "which frame of the trajectory, or model of the file, from 0; -1 is the last; between two "
        "frames where it is not whole",
    )
    whole: bool = setting(
        True, "put together what the periodic box of a simulation cuts, and take what is about it"
    )
    hold: str = setting(
        "auto",
        "what stays where the first frame has it: nothing, the polymers' place, or also their pose "
        "(the best fit); auto is place where there is a periodic box",
        choices=HOLDS,
    )
    structures: str | None = setting(
        None, "folder of the ingredient structures of a cell-scale model"
    )
    strict: bool = setting(
        False, "fail where a cell-scale model's structure is missing, instead of drawing spheres"
    )
    grid_unit: str | None = setting(
        None,
        "unit of length of a reservoir's grid, instead of the file's; metres where neither says",
        choices=("metres", "feet", "cm"),
    )
    voxels: VoxelOptions = VoxelOptions()
