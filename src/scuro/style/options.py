"""The settings of the representations."""

from __future__ import annotations

from scuro.settings import SettingsGroup, setting


class Representation(SettingsGroup):
    """Sizes of what molecules are drawn with."""

    sphere_scale: float = setting(
        1.0, "size of space-filling spheres, in van der Waals radii", low=0.05, high=5.0
    )
    ball_scale: float = setting(
        0.25, "size of the balls of ball-and-stick, in van der Waals radii", low=0.0, high=2.0
    )
    stick_radius: float = setting(
        0.15, "radius of the sticks of ball-and-stick", low=0.01, high=2.0, unit="Å"
    )
    bond_orders: bool = setting(True, "show double and triple bonds as two and three sticks")
    licorice_radius: float = setting(
        0.25, "radius of licorice sticks", low=0.01, high=2.0, unit="Å"
    )
    backbone_radius: float = setting(
        0.35, "radius of the backbone trace", low=0.01, high=5.0, unit="Å"
    )
    ribbon_width: float = setting(
        2.6, "width of cartoon helices and strands", low=0.2, high=10.0, unit="Å"
    )
    ribbon_thickness: float = setting(
        0.5, "thickness of cartoon helices and strands", low=0.05, high=5.0, unit="Å"
    )
    arrow_width: float = setting(
        1.6, "width of a strand's arrow head, in ribbon widths", low=1.0, high=4.0
    )
    tube_radius: float = setting(0.28, "radius of cartoon coils", low=0.05, high=5.0, unit="Å")
    nucleic_radius: float = setting(
        0.7, "radius of the tube through a nucleic acid's phosphates", low=0.05, high=5.0, unit="Å"
    )
    surface_probe: float = setting(
        1.4, "radius of the solvent whose ball rolls over the surface", low=0.0, high=20, unit="Å"
    )
    surface_spacing: float | None = setting(
        None, "spacing of the surface's grid (default: wider for large molecules)", low=0.05,
        high=20, unit="Å",
    )  # fmt: skip
    segments: int | None = setting(
        None, "cartoon pieces per residue (default: fewer for large molecules)", low=2, high=32
    )
    sides: int | None = setting(
        None, "sides of the cartoon's cross-section (default: as for segments)", low=4, high=64
    )
