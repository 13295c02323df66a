"""A warm lamp beside a protein casts shadows; what it misses lies in a cool, dim sky."""

import scuro

SIZE = (640, 480)


def main() -> None:
    scene = scuro.load("sample:1tii").show(color="white")
    (left, _, _), (_, _, front) = scene.bounds()
    height = float(scene.bounds()[:, 1].mean())
    lamp = scuro.Light(
        kind="point",
        position=(float(left), height, float(front)),
        relative_to="world",
        color=(1.0, 0.7, 0.4),
        intensity=6.0,
        attenuation=(1.0, 0.0, 0.001),
    )
    scene.lighting = scuro.Lighting((lamp,), ambient=0.35, ambient_color=(0.8, 0.9, 1.0))
    image = scuro.render(scene, size=SIZE, occlusion__technique="hybrid", shadows__technique="soft")
    image.save("own_light.png")


if __name__ == "__main__":
    main()
