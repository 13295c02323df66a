"""A generated cell of a million atoms, cut open; occlusion knows its compartments."""

import scuro
from scuro.load.mesoscale_structures import structure_of_molecule
from scuro.scene.generate import GenerateSettings, generate

SIZE = (640, 480)
ATOMS = 1e6


def main() -> None:
    names = ("sample:1tii", "sample:1hpv")
    molecules = [scuro.load(name, waters=False).molecules[0].molecule for name in names]
    structures = [structure_of_molecule(m) for m in molecules]
    scene = scuro.Scene().add(generate(structures, GenerateSettings(atoms=ATOMS)))
    scene.clip = scuro.Clip((scuro.Plane((0.0, 0.0, 0.0), (-0.4, -0.3, -1.0)),))
    scuro.render(scene, size=SIZE, semantic__mode="screen").save("cell.png")


if __name__ == "__main__":
    main()
