"""What may be written over a picture: names, legends, a scale bar, the directions of the axes."""

from __future__ import annotations

from scuro.settings import SettingsGroup, setting


class LabelSettings(SettingsGroup):
    """Names on the picture: of compartments, ingredients, chains, residues, atoms."""

    show: str = setting(
        "none",
        "what is named: regions are those of the level in view (compartments, ingredients, chains "
        "…)",
        choices=("none", "regions", "chains", "residues", "atoms"),
        main=True,
    )
    most: int = setting(12, "names in one picture, at most", low=1, high=200)
    select: str = setting("all", "which atoms of molecules get names, in PyMOL's words")


class LegendSettings(SettingsGroup):
    """What colours mean: of atoms by a property, cell-scale models, volumes and reservoirs."""

    show: bool = setting(
        False, "add colours, opacity over the histogram, units and dates", main=True
    )
    corner: str = setting(
        "lower left",
        "where it stands",
        choices=("lower left", "lower right", "upper left", "upper right"),
    )


class ScaleBarSettings(SettingsGroup):
    """A length to measure by."""

    show: bool = setting(
        False, "add a bar of a round length, true at the distance of what is looked at", main=True
    )


class AxesSettings(SettingsGroup):
    """The directions of the world's axes."""

    show: bool = setting(False, "add a cross of the x, y and z axes", main=True)
