"""The probe of a scene: its place, the force on the hand, its light, its clip plane, its path."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scuro.errors import SettingsError
from scuro.export.files import replacing
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip, Plane
from scuro.scene.geometry import rotation_matrices
from scuro.scene.items import MoleculeItem
from scuro.scene.lights import POINT, Light, Lighting
from scuro.scene.scene import Scene
from scuro.settings import SettingsGroup, setting
from scuro.style.radii import atom_radii
from scuro.style.selection import select

if TYPE_CHECKING:
    from scuro.render_settings import Settings

MOST_ATOMS = 5_000_000
"""Placed atoms beyond which the grid would not fit."""
_WARM = (1.0, 0.82, 0.58)
"""Linear colour of the probe's light: told from the others."""
_RECORD_STEP = 0.05
"""Å between recorded places."""
MOST_PLACES = 50_000
"""Places of a path, at which recording ends: more would slow every picture that shows it."""


class ProbeSettings(SettingsGroup):
    """The probe sphere."""

    radius: float = setting(1.4, "its radius; a water's is 1.4", low=0.0, high=20, unit="Å")
    select: str = setting("not solvent", "which atoms it cannot enter, in PyMOL's words")
    stiffness: float = setting(
        1.0, "force for each Å that the hand is inside", low=0, high=1000, unit="pN/Å"
    )
    light: bool = setting(True, "a point light at the probe's centre; it casts shadows")
    brightness: float = setting(1.5, "strength of its light", low=0, high=20)
    reach: float = setting(25.0, "how far its light goes", low=0.1, high=1000, unit="Å")
    clip: bool = setting(False, "cut away what lies between the eye and the probe")
    margin: float = setting(0.5, "gap between the probe and that plane", low=0, high=50, unit="Å")
    focus: bool = setting(True, "depth of field, where there is some, is focused on it")

    @property
    def atoms(self) -> tuple[float, str]:
        """What the spheres that it meets depend on."""
        return self.radius, self.select


class Probe:
    """A probe among the atoms of a scene.

    Args:
        scene: Whose molecules it touches, assemblies' copies included.
        settings: Its size and manners.
        start: Where to begin; moved out of the atoms if it must be.
        eye: Where a place is looked for that is seen: if ``start`` is among atoms, the probe
            begins on their accessible surface, on the way from here to there.

    Raises:
        SettingsError: There are no atoms, or too many.
    """

    def __init__(
        self,
        scene: Scene,
        settings: ProbeSettings,
        start: ArrayLike,
        eye: ArrayLike | None = None,
    ) -> None:
        from scuro.probe.solver import Constraint

        centers, radii = placed_atoms(scene, settings.select)
        self.settings = settings
        self.constraint = Constraint(centers, radii, settings.radius)
        seen = None
        if eye is not None and self.constraint.depth(start) >= 0:
            seen = self.constraint.met(eye, np.subtract(start, eye))
        self.position = self.constraint.freed(start) if seen is None else seen
        self.target = self.position.copy()
        self.path: list[list[float]] = []
        self.recording = False

    def follow(self, scene: Scene) -> None:
        """The atoms moved: sort them anew and get out of their way."""
        from scuro.probe.solver import Constraint

        centers, radii = placed_atoms(scene, self.settings.select)
        self.constraint = Constraint(centers, radii, self.settings.radius)
        self.position = self.constraint.freed(self.position)
        self.target = self.position.copy()

    def move(self, target: ArrayLike) -> None:
        """Follow the hand to a target, world Å."""
        self.target = np.array(target, np.float64)
        self.position = self.constraint.moved(self.position, self.target)
        if self.recording:
            self._record()

    def rest(self) -> None:
        """The hand lets go: its place is the probe's."""
        self.target = self.position.copy()

    @property
    def force(self) -> NDArray[np.float64]:
        """(3,) on the hand: stiffness times the way from it back to the probe."""
        return self.settings.stiffness * (self.position - self.target)

    def state(self) -> dict[str, Any]:
        """For other programs: position (Å), force, and whether it touches anything."""
        force = self.force
        return {
            "position": self.position.tolist(),
            "target": self.target.tolist(),
            "force": force.tolist(),
            "contact": bool(np.linalg.norm(self.position - self.target) > 1e-6),
        }

    def _record(self) -> None:
        if len(self.path) >= MOST_PLACES:
            self.recording = False
            return
        place = self.position.tolist()
        if not self.path or np.linalg.norm(np.subtract(place, self.path[-1])) >= _RECORD_STEP:
            self.path.append(place)

    def save_path(self, path: str | Path) -> None:
        """Write the recorded path as JSON, which is read as a :class:`scuro.scene.track.Track`.

        Raises:
            SaveError: It cannot be written.
        """
        values = {"unit": "Å", "radius": self.settings.radius, "points": self.path}
        with replacing(path) as file:
            file.write(json.dumps(values).encode())

    # --- what it does to a scene ---------------------------------------------------------------

    def lit(self, lighting: Lighting) -> Lighting:
        """The lighting with the probe's light."""
        if not self.settings.light:
            return lighting
        x, y, z = self.position.tolist()
        light = Light(
            kind=POINT,
            position=(x, y, z),
            intensity=self.settings.brightness,
            reach=self.settings.reach,
            # a twenty-fifth is left where it ends, so that no edge shows
            attenuation=(1.0, 0.0, 24.0 / self.settings.reach**2),
            color=_WARM,
            relative_to="world",
            name="probe",
        )
        return replace(lighting, lights=(*lighting.lights, light))

    def clipped(self, clip: Clip, camera: Camera) -> Clip:
        """The clipping with a plane in front of the probe, as seen by a camera."""
        if not self.settings.clip:
            return clip
        forward = -camera.view_from_world()[2, :3]
        point = self.position - forward * (self.settings.radius + self.settings.margin)
        plane = Plane(tuple(point.tolist()), tuple(forward.tolist()))
        return Clip((*clip.planes, plane))

    def focused(self, settings: Settings, camera: Camera) -> Settings:
        """The settings with the probe in focus, where they ask for depth of field at the target."""
        field = settings.depth_of_field
        if not (self.settings.focus and field.blur) or field.on or field.distance is not None:
            return settings
        forward = -camera.view_from_world()[2, :3]
        distance = float((self.position - np.asarray(camera.position)) @ forward)
        return settings.replace(depth_of_field__distance=max(distance, 0.0))


def placed_atoms(scene: Scene, selection: str) -> tuple[NDArray, NDArray]:
    """World centres (n, 3) and van der Waals radii (n,) of the chosen atoms of all molecules.

    Raises:
        SettingsError: There are none, or too many.
    """
    centers, radii = [np.zeros((0, 3))], [np.zeros(0)]
    for item in scene.molecules:
        for chosen, rotations, positions in _placements(item, selection):
            local = item.molecule.positions[chosen].astype(np.float64)
            turned = np.einsum("kij,nj->kni", rotation_matrices(rotations), local)
            centers.append((turned + positions[:, None]).reshape(-1, 3))
            radii.append(np.tile(atom_radii(item.molecule)[chosen], len(positions)))
    count = sum(map(len, radii))
    if count == 0:
        raise SettingsError(f"there are no atoms for a probe: '{selection}' selects none")
    if count > MOST_ATOMS:
        raise SettingsError(f"a probe takes at most {MOST_ATOMS:,} atoms, not {count:,}")
    return np.concatenate(centers), np.concatenate(radii)


def _placements(item: MoleculeItem, selection: str) -> list[tuple[NDArray, NDArray, NDArray]]:
    """Mask of atoms, and the rotations and positions of their copies."""
    molecule = item.molecule
    mask = select(molecule, selection)
    if item.assembly is None:
        return [(mask, np.array([[0.0, 0, 0, 1]]), np.zeros((1, 3)))]
    return [
        (mask & np.isin(molecule.chain, part.chains), part.rotations, part.positions)
        for part in molecule.assembly(item.assembly)
    ]
