"""The scene: what was loaded, how it is shown, its light and its clipping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.clip import Clip, drop_outside
from scuro.scene.cornerpoint import CornerPointGrid
from scuro.scene.geometry import Body, Material
from scuro.scene.items import MesoscaleItem, MoleculeItem, Shown, VolumeItem
from scuro.scene.lights import Lighting
from scuro.scene.model import MesoscaleModel
from scuro.scene.molecule import Molecule
from scuro.scene.regions import Divided, Hierarchy, hierarchy_of
from scuro.scene.reservoir import ReservoirItem
from scuro.scene.track import Track, TrackItem
from scuro.scene.volume import Volume
from scuro.style.reservoir_options import ReservoirSettings


class Scene:
    """What a picture shows.

    A scene holds items (molecules, volumes, models, reservoirs) in the order they were added. The
    verbs that change how items are shown return the scene, so that they can be chained.
    """

    def __init__(self, items: Sequence[Any] = ()) -> None:
        self.items: list[Any] = list(items)
        self.lighting: Lighting | None = None
        """The scene's own lights; ``None`` for the lighting preset of the settings."""
        self.clip: Clip = Clip()
        self._left: dict[tuple[Body, Clip], Body] = {}
        self.extra_bodies: list[Body] = []
        """Bodies that belong to no item (a probe, markers)."""
        self._hierarchy: tuple[tuple[Any, ...], Hierarchy] | None = None

    def add(self, item: Any) -> Scene:
        """Add a molecule, a cell-scale model, a volume or another loaded item."""
        if isinstance(item, Molecule):
            item = MoleculeItem(item)
        elif isinstance(item, MesoscaleModel):
            item = MesoscaleItem(item)
        elif isinstance(item, Volume):
            item = VolumeItem(item)
        elif isinstance(item, CornerPointGrid):
            item = ReservoirItem(item)
        elif isinstance(item, Track):
            item = TrackItem(item)
        self.items.append(item)
        return self

    def show(
        self,
        style: str = "auto",
        *,
        select: str = "auto",
        color: str = "auto",
        material: Material | None = None,
        opacity: float | None = None,
        clipped: bool = True,
        context: bool = False,
        molecule: int | None = None,
        **options: Any,
    ) -> Scene:
        """Show atoms in a style; the first call replaces the default picture, later ones add.

        Args:
            style: ``spacefill``, ``ball+stick``, ``licorice``, ``backbone``, ``cartoon``,
                ``surface``, ``auto``.
            select: Which atoms, in PyMOL's words; by default all but the water about it.
            color: Colour scheme, colour name or hex.
            material: How the surface answers light.
            opacity: 1 is solid; the material's own by default.
            clipped: Whether clipping planes cut it.
            context: Whether it is drawn in simple light, as the surroundings of all else: it
                neither occludes nor casts shadows, and nothing darkens it.
            molecule: Index among the scene's molecules; all of them by default.
            options: Settings of :class:`scuro.style.representation.Representation`.

        Raises:
            SettingsError: A word is unknown, or nothing is selected in any molecule.
        """
        molecules = self.molecules
        chosen = molecules if molecule is None else [molecules[molecule]]
        if not chosen:
            raise SettingsError("there is no molecule in the scene to show in a style")
        from scuro.style.selection import select as chosen_atoms

        if not any(chosen_atoms(item.molecule, select).any() for item in chosen):
            raise SettingsError(f"the selection '{select}' matches no atoms")
        material = material or Material()
        if opacity is not None:
            if not 0 <= opacity <= 1:
                raise SettingsError(f"opacity must lie between 0 and 1, not {opacity!r}")
            material = replace(material, opacity=float(opacity))
        shown = Shown(
            style, select, color, material, clipped, tuple(sorted(options.items())), context
        )
        for item in chosen:
            item.shown.append(shown)
        return self

    def hide(self) -> Scene:
        """Forget all representations."""
        for item in self.molecules:
            item.shown.clear()
        return self

    @property
    def molecules(self) -> list[MoleculeItem]:
        return [item for item in self.items if isinstance(item, MoleculeItem)]

    @property
    def volumes(self) -> list[VolumeItem]:
        return [item for item in self.items if isinstance(item, VolumeItem)]

    @property
    def tracks(self) -> list[TrackItem]:
        return [item for item in self.items if isinstance(item, TrackItem)]

    @property
    def reservoirs(self) -> list[ReservoirItem]:
        return [item for item in self.items if isinstance(item, ReservoirItem)]

    def show_reservoirs(self, settings: ReservoirSettings) -> Scene:
        """Show all reservoirs as the settings say."""
        for item in self.reservoirs:
            item.settings = settings
        return self

    def bodies(self) -> list[Body]:
        """All surfaces of the scene; bodies that did not change are the same objects as before.

        Their order is that of the ids in the G-buffer: see :meth:`owners`.
        """
        return [self._kept(body) for _, _, body in self.owners()]

    def owners(self) -> list[tuple[Any, int, Body]]:
        """Every body before clipping, in the order of :meth:`bodies`: context comes last.

        With its item (``None`` for one of no item) and its number among the item's bodies.
        """
        groups = [(item, item.bodies()) for item in self.items if hasattr(item, "bodies")]
        groups.append((None, self.extra_bodies))
        found = [(item, part, body) for item, bodies in groups for part, body in enumerate(bodies)]
        return sorted(found, key=lambda owned: owned[2].context)

    def occluders(self) -> list[Body]:
        """The surfaces that occlude and cast shadows: all but those shown as context."""
        return [body for body in self.bodies() if not body.context]

    def context(self) -> list[Body]:
        """The surfaces shown as context, in simple light."""
        return [body for body in self.bodies() if body.context]

    def _kept(self, body: Body) -> Body:
        """The body, or what is left of it where clipping drops whole atoms."""
        if not self.clip.whole:
            self._left.clear()
            return body
        key = (body, self.clip)
        if key not in self._left:
            if len(self._left) > 64:  # a plane on its way through leaves many behind
                self._left.clear()
            self._left[key] = drop_outside(body, self.clip)
        return self._left[key]

    def hierarchy(self, parts: str = "") -> Hierarchy:
        """The levels of everything in the scene; the same object while the bodies are.

        Args:
            parts: How molecules are divided above their chains: see ``scene/selection_tree.py``.

        Raises:
            SettingsError: The parts are not understood.
        """
        bodies = (parts, *self.bodies())
        if self._hierarchy is not None and self._hierarchy[0] == bodies:
            return self._hierarchy[1]
        found: list[Divided] = []
        for item in self.items:
            if hasattr(item, "divided"):
                found += item.divided(parts)
            elif hasattr(item, "bodies"):
                found += [Divided(body) for body in item.bodies()]
        found += [Divided(body) for body in self.extra_bodies]
        found.sort(key=lambda divided: divided.body.context)
        found = [replace(d, body=self._kept(d.body)) for d in found]
        made = hierarchy_of(found)
        self._hierarchy = bodies, made
        return made

    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) world box around everything."""
        boxes = [b.bounds for b in self.bodies() if len(b.geometry) and len(b.positions)]
        boxes += [item.volume.bounds for item in self.volumes]
        boxes += [item.bounds for item in self.items if hasattr(item, "bounds")]
        if not boxes:
            return np.array([[-1.0, -1, -1], [1, 1, 1]])
        return np.stack([np.min([b[0] for b in boxes], 0), np.max([b[1] for b in boxes], 0)])
