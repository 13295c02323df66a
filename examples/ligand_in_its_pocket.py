"""A drug in the pocket of its protein, through a transparent surface that dims the light."""

import scuro
from scuro.scene.view import ViewSettings, view_camera

SIZE = (640, 480)


def main() -> None:
    scene = scuro.load("sample:1hpv")
    scene.show("cartoon", select="polymer", color="chain")
    scene.show("licorice", select="organic")
    scene.show("spacefill", select="polymer within 5 of organic", color="white", opacity=0.25)
    camera = view_camera(scene, ViewSettings(focus="organic", zoom=0.7), SIZE[0] / SIZE[1])
    scuro.render(scene, size=SIZE, camera=camera).save("ligand_in_its_pocket.png")


if __name__ == "__main__":
    main()
