"""A molecule in the density of its electrons, which is cut open; each shades the other."""

import numpy as np
from scipy.ndimage import gaussian_filter

import scuro
from scuro.scene.molecule import Molecule
from scuro.scene.view import ViewSettings, view_camera
from scuro.scene.volume import Volume

SIZE = (640, 480)
SPACING = 0.6
"""Å between the samples of the map."""
BLUR = 1.2
"""Å, standard deviation: what a map of medium resolution shows."""


def electron_density(molecule: Molecule) -> Volume:
    """Electrons per Å³, blurred, on a grid around the atoms."""
    lowest = molecule.positions.min(axis=0) - 4 * BLUR
    cells = np.round((molecule.positions - lowest) / SPACING).astype(int)
    values = np.zeros(cells.max(axis=0)[::-1] + int(4 * BLUR / SPACING) + 1, np.float32)
    np.add.at(values, tuple(cells.T[::-1]), molecule.element)
    values = gaussian_filter(values, BLUR / SPACING) / SPACING**3
    world_from_index = np.diag([SPACING, SPACING, SPACING, 1.0])
    world_from_index[:3, 3] = lowest
    return Volume(values, world_from_index, name="density", unit="Å")


def main() -> None:
    scene = scuro.load("sample:1hpv")
    scene.add(electron_density(scene.molecules[0].molecule))
    scene.show("licorice", color="chain+element", clipped=False)
    middle = tuple(scene.bounds().mean(axis=0).tolist())
    scene.clip = scuro.Clip((scuro.Plane(middle, (0, 0, -1)),))
    camera = view_camera(scene, ViewSettings(azimuth=25), SIZE[0] / SIZE[1])
    settings = scuro.Settings(size=SIZE).replace(volume__iso=0.45)
    image = scuro.render(scene, camera=camera, settings=settings)
    image.save("density_around_a_molecule.png")


if __name__ == "__main__":
    main()
