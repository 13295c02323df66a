"""A structure becomes a picture: light, occlusion and shadows come by themselves."""

import scuro

SIZE = (640, 480)


def main() -> None:
    scene = scuro.load("sample:1tii")
    scuro.render(scene, size=SIZE).save("first_picture.png", dpi=150)


if __name__ == "__main__":
    main()
