"""Volumes: times beside Tables 3.2 to 3.6 of Campagnolo's thesis (2021).

Without inputs it measures the volumes that ``scuro bench volume`` makes. Of every input there is a
second showing, marked (T): the same transfer function with a thirtieth of its opacities, the large
semi-transparent regions that the thesis calls VisMale(T).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from scuro.measure.bench import BenchOptions, label, median_seconds
from scuro.measure.compare import draw
from scuro.measure.results.page import grid
from scuro.measure.variant import Variant
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.items import VolumeItem
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera
from scuro.scene.volume import Volume

TITLE = "Volumes: times of directional occlusion and shadows"

CAMPAGNOLO = "Campagnolo 2021, fps"
THESIS: dict[str, dict[str, tuple[float | str | None, ...]]] = {
    "3.2": {
        "Synthetic": (116, 273), "VisMale": (67, 233), "VisMale(T)": (73, 49), "Engine": (52, 90),
        "Bonsai": (58, 110), "Backpack": (27, 83), "CT-Knee": (60, 22), "Foot": (59, 50),
    },
    "3.3": {
        "VisMale(T)": (49, 159, 376), "CT-Knee": (22, 51, 96), "Foot": (50, 98, 313),
    },
    "3.4": {"SyntheticBars": (89, 178, 83), "Engine": (74, 97, 63)},
    "3.5": {
        "128 × 128 × 128": (57.85,), "256 × 256 × 256": (220.97,), "512 × 512 × 512": (995.12,),
        "379 × 229 × 305": (1729.99,), "512 × 512 × 373": (3249.57,),
        "1024 × 1024 × 1024": (6737.62,),
    },
    "3.6": {
        "VisMale": (783, 376, 263), "Bonsai": (458, 155, 64), "Backpack": (235, 83, 56),
        "CT-Knee": (630, 183, 103), "Foot": (511, 163, 58), "Hazelnut": (219, 61, None),
        "Flower": (48, 28, None),
    },
}  # fmt: skip
"""Printed for 768 × 768 on an NVIDIA GeForce RTX 2080 Ti: frames a second, milliseconds in 3.5."""

TRANSPARENT = 1 / 30
"""Factor on the opacities of the showings marked (T)."""

PLAIN: dict[str, Any] = {
    "volume__occlusion__on": False,
    "volume__shadow__on": False,
    "volume__shading": "none",
    "volume__jitter": 0.0,
    "lighting__preset": "studio",
    "antialias__method": "none",
    "background": "black",
}
IMAGE = PLAIN | {"volume__occlusion__on": True, "volume__light": "image"}
OBJECT = PLAIN | {"volume__occlusion__on": True, "volume__light_resolution": 1.0}
HALF = PLAIN | {"volume__occlusion__on": True}
SLICES = IMAGE | {"volume__light": "slices"}
SEVEN = {"volume__occlusion__cones": 7}
SHADOW = PLAIN | {"volume__shadow__on": True}
TABLES: dict[str, tuple[str, dict[str, dict[str, Any]]]] = {
    "3.2": (
        "Directional occlusion beside slices, 7 cones",
        {"slices": SLICES, "ours, image space": IMAGE | SEVEN},
    ),
    "3.3": (
        "Light in image and in object space, 7 cones",
        {
            "image": IMAGE | SEVEN,
            "object, full resolution": OBJECT | SEVEN,
            "object, half": HALF | SEVEN,
        },
    ),
    "3.4": (
        "Shadows of one light",
        {
            "summed areas": SHADOW | {"volume__light": "summed-area"},
            "voxel cones": SHADOW | {"volume__light": "voxel-cones"},
            "ours, image space": SHADOW | {"volume__light": "image"},
            "ours, object space": SHADOW,
        },
    ),
    "3.6": (
        "Emission-absorption (EA), with occlusion (AO), and with a shadow (AO+SH), 3 cones",
        {
            "EA": PLAIN,
            "AO": HALF,
            "AO+SH": HALF | {"volume__shadow__on": True, "volume__shading": "phong"},
        },
    ),
}
PYRAMIDS = ((128, 128, 128), (256, 256, 256), (379, 229, 305))


def showings(options: BenchOptions) -> Iterator[tuple[str, Scene]]:
    """Every volume as the automatic transfer function shows it, and semi-transparent."""
    for name, volume in volumes(options):
        item = VolumeItem(volume)
        yield name, Scene([item])
        yield f"{name} (T)", Scene([VolumeItem(volume, transparent(volume))])


def volumes(options: BenchOptions) -> Iterator[tuple[str, Volume]]:
    """The inputs, or the volumes of the benchmark."""
    if options.inputs:
        from scuro.load import load

        for name in options.inputs:
            yield label(name).split(".")[0], load(name)
        return
    from scuro.measure.bench.volume import made_volumes

    yield from made_volumes()


def transparent(volume: Volume) -> Any:
    """The automatic transfer function with a share of its opacities."""
    from scuro.style.transfer_auto import automatic

    made = automatic(volume)
    return replace(made, opacities=tuple((x, a * TRANSPARENT) for x, a in made.opacities))


def camera_of(scene: Scene, size: tuple[int, int]) -> Camera:
    """The same oblique view of every scene."""
    return view_camera(scene, ViewSettings(azimuth=30.0, elevation=20.0), size[0] / size[1])


def section(options: BenchOptions) -> Iterator[str]:
    """The section's paragraphs, measured as they are asked for."""
    renderer = Renderer(options.device)
    width, height = options.size
    yield (
        f"Milliseconds of whole frames of {width} × {height} pixels, step 0.5, on "
        f"{renderer.gpu.info}; `fps` are the thesis's figures for 768 × 768 pixels on an NVIDIA "
        "GeForce RTX 2080 Ti. (T) are semi-transparent showings of the same volume."
    )
    named = list(showings(options))
    for number, (title, columns) in TABLES.items():
        rows = {}
        for name, scene in named:
            if number == "3.3" and not name.endswith("(T)"):
                continue
            options.say(f"table {number}, {name}")
            camera = camera_of(scene, options.size)
            base = Settings(size=options.size)
            rows[name] = tuple(
                draw(
                    renderer, scene, camera, base, Variant(column, changes), options.frames
                ).milliseconds
                for column, changes in columns.items()
            )
        yield f"### {title} (Table {number})"
        yield grid(["here", *(f"{column} [ms]" for column in columns)], rows)
        heads = list(columns)[: len(next(iter(THESIS[number].values())))]
        yield grid([CAMPAGNOLO, *heads], THESIS[number])
        if number == "3.4":
            yield from _pyramids(options, renderer)


def _pyramids(options: BenchOptions, renderer: Renderer) -> Iterator[str]:
    from scuro.measure.bench.volume import pyramid_maker

    rows: dict[str, tuple[float | str | None, ...]] = {}
    for size in PYRAMIDS:
        options.say(f"table 3.5, {size}")
        values = np.zeros(size[::-1], np.uint8)
        values[::3] = 200
        seconds = median_seconds(pyramid_maker(renderer, Volume(values)), 1)
        rows[" × ".join(map(str, size))] = (1e3 * seconds,)
    yield "### Making the extinction pyramid (Table 3.5)"
    yield grid(["here", "ms"], rows)
    yield grid(["Campagnolo 2021", "ms"], THESIS["3.5"])
