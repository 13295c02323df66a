"""Occlusion as a measurement: how open is each residue to the outside, seen from six sides?"""

import numpy as np

import scuro
from scuro.scene.view import ViewSettings, view_camera

SIZE = (320, 240)


def main() -> None:
    scene = scuro.load("sample:1hpv", waters=False)
    molecule = scene.molecules[0].molecule
    settings = scuro.Settings(size=SIZE).replace(occlusion__technique="ray")
    renderer = scuro.Renderer()
    open_sum, seen = np.zeros(len(molecule.residue_name)), np.zeros(len(molecule.residue_name))
    for view in ("front", "back", "left", "right", "top", "bottom"):
        camera = view_camera(scene, ViewSettings(view=view), SIZE[0] / SIZE[1])
        image = renderer.render(scene, camera, settings)
        atom, visibility = image.buffer("atom"), image.buffer("visibility")
        residue = molecule.residue[atom[atom >= 0]]
        np.add.at(open_sum, residue, visibility[atom >= 0])
        np.add.at(seen, residue, 1)
    openness = open_sum[seen > 0] / seen[seen > 0]
    names = molecule.residue_name[seen > 0]
    for i in np.argsort(openness)[-5:][::-1]:
        print(f"{names[i]}: {openness[i]:.2f} of the sky")


if __name__ == "__main__":
    main()
