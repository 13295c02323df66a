"""Water rises in a faulted reservoir: a picture for each date, nothing but the values uploaded."""

import scuro
from scuro.scene.cornerpoint_synthetic import faulted_dome
from scuro.scene.view import ViewSettings, view_camera

SIZE = (640, 480)


def main() -> None:
    scene = scuro.Scene().add(faulted_dome())
    renderer = scuro.Renderer()
    settings = scuro.Settings(size=SIZE).replace(
        reservoir__show="volume", reservoir__property="SWAT"
    )
    camera = view_camera(scene, ViewSettings(), SIZE[0] / SIZE[1])
    for step in range(4):
        image = renderer.render(scene, camera, settings.replace(reservoir__time=step))
        image.save(f"reservoir_through_time-{step}.png")


if __name__ == "__main__":
    main()
