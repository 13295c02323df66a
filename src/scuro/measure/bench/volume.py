"""Volumes: time of emission-absorption, occlusion, shadows and pyramid; ΔE2000 from Monte Carlo.

Without inputs, two volumes made here: a head-like one (197×233×189, step 1, at the given size) and
the Marschner-Lobb signal at 256³ (step 0.5, 768×768). Each method's picture is also drawn at a
sixth of the size and held against Monte Carlo there, with the attenuation that fits best. How many
times faster a method is, is said of Monte Carlo with 64 rays a cone.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.image import Image
from scuro.measure.bench import BenchOptions, median_seconds
from scuro.measure.memory import peak_memory_mb
from scuro.measure.metrics import delta_e
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera
from scuro.scene.volume import Volume

_PLAIN = {
    "volume__occlusion__on": False,
    "volume__shadow__on": False,
    "volume__shading": "none",
    "background": "black",
}
_OCCLUSION = _PLAIN | {"volume__occlusion__on": True}
_SHADOW = _PLAIN | {"volume__shadow__on": True}
_BOTH = _OCCLUSION | {"volume__shadow__on": True}
_METHODS: dict[str, dict[str, Any]] = {
    "emission-absorption": _PLAIN,
    "occlusion, object space": _OCCLUSION,
    "occlusion, object space 1/3": _OCCLUSION | {"volume__light_resolution": 0.34},
    "occlusion, image space": _OCCLUSION | {"volume__light": "image"},
    "occlusion, 7 cones, constant-exact": _OCCLUSION
    | {"volume__light": "image", "volume__occlusion__cones": 7, "volume__constant_exact": True},
    "shadow, object space": _SHADOW,
    "shadow, voxel cones": _SHADOW | {"volume__light": "voxel-cones"},
    "shadow, summed area": _SHADOW | {"volume__light": "summed-area"},
    "occlusion and shadow": _BOTH,
}
_ATTENUATIONS = (0.2, 0.35, 0.5, 0.7, 1.0, 1.4)
_TRUTH_RAYS = 8
"""Rays a cone: a pixel adds up many samples' cones, and ΔE2000 is that of 64 to within 0.02."""
_SPED_RAYS = 64
"""Rays a cone of the Monte Carlo that speed is compared with; its time is in proportion to them."""
_LONG = 2.0
"""Seconds of the first draw beyond which a single further one is timed."""
_TRUTH_SHARE = 6
"""Monte Carlo is drawn at one in so many pixels along each side."""


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure every method on every volume; see the module."""
    renderer = Renderer(options.device)
    rows = []
    for name, volume, size, step in _volumes(options):
        scene = Scene([]).add(volume)
        base = options.plain().replace(size=size, volume__step=step, volume__jitter=0.0)
        options.say(f"{name}: pyramid")
        timed = [_prepare(renderer, scene, base, name)]
        for method, changes in _METHODS.items():
            options.say(f"{name}: {method}")
            settings = base.replace(**changes)
            timed.append(_time(renderer, scene, settings, name, method, options.frames))
        rows += timed
        truths: dict[str, _Truth] = {}
        for row, (method, changes) in zip(timed[1:], _METHODS.items(), strict=True):
            if changes is _PLAIN:
                continue
            options.say(f"{name}: {method} against Monte Carlo")
            kind = method.split(",")[0]
            small = base.replace(**changes, size=tuple(n // _TRUTH_SHARE for n in size))
            if kind not in truths:
                truths[kind] = _truth(renderer, scene, small)
            row |= _errors(renderer, scene, small, truths[kind])
            row["times faster than Monte Carlo"] = round(1e3 * truths[kind].seconds / row["ms"])
    return {
        "adapter": str(renderer.gpu.info),
        "frames": options.frames,
        "rows": rows,
        "peak_memory_mb": peak_memory_mb(),
    }


def _volumes(options: BenchOptions) -> Iterator[tuple[str, Volume, tuple[int, int], float]]:
    if options.inputs:
        from scuro.load import load

        for name in options.inputs:
            yield name, load(name), options.size, 0.5
        return
    (head, head_volume), (signal, signal_volume) = made_volumes()
    yield head, head_volume, options.size, 1.0
    yield signal, signal_volume, (768, 768), 0.5


def made_volumes() -> Iterator[tuple[str, Volume]]:
    """Two volumes made here, by name."""
    yield "head 197×233×189", _head()
    yield "Marschner-Lobb 256³", _marschner_lobb(256)


def _head() -> Volume:
    """An ellipsoid with folds, a skull around it and soft tissue outside, as a template has."""
    nx, ny, nz = 197, 233, 189
    z, y, x = np.meshgrid(*(np.linspace(-1, 1, n, dtype=np.float32) for n in (nz, ny, nx)),
                          indexing="ij")  # fmt: skip
    r = np.sqrt(x * x + y * y + z * z)
    folds = 0.03 * np.sin(22 * x) * np.sin(20 * y) * np.sin(24 * z)
    brain = 150 * (r + folds < 0.68) + 60 * (r + folds < 0.5)
    values = np.where((r > 0.76) & (r < 0.84), 90, brain) + 40 * ((r >= 0.84) & (r < 0.9))
    return Volume(values.astype(np.uint8), name="head")


def _marschner_lobb(n: int) -> Volume:
    """The test signal of Marschner and Lobb 1994 with f_M = 6, alpha = 0.25."""
    axis = np.linspace(-1, 1, n, dtype=np.float32)
    z, y, x = axis[:, None, None], axis[None, :, None], axis[None, None, :]
    wave = np.cos(12 * np.pi * np.cos(np.pi / 2 * np.sqrt(x * x + y * y)))
    values = (1 - np.sin(np.pi * z / 2) + 0.25 * (1 + wave)) / 2.5
    return Volume((255 * values).astype(np.uint8), name="Marschner-Lobb")


def _prepare(renderer: Renderer, scene: Scene, base: Settings, name: str) -> dict[str, Any]:
    """Seconds of the pyramid alone: what a new transfer function costs."""
    maker = pyramid_maker(renderer, scene.volumes[0].volume, base)
    return _row(name, "pyramid", "", median_seconds(maker, 2))


def pyramid_maker(
    renderer: Renderer, volume: Volume, base: Settings | None = None
) -> Callable[[], Any]:
    """A function that makes a volume's extinction pyramid, for timing."""
    from scuro.passes.volume.draw import VolumePicture
    from scuro.passes.volume.pyramid import Pyramid
    from scuro.scene.clip import Clip
    from scuro.style.transfer_choose import choose_transfer

    settings = (base or Settings()).volume
    picture = VolumePicture(renderer.gpu, volume, volume.bounds.mean(axis=0))
    classified = picture.classified(choose_transfer(volume), settings)
    uniform = picture.uniform(settings, Clip(), classified)
    return lambda: Pyramid(classified, uniform)


def _time(
    renderer: Renderer, scene: Scene, settings: Settings, name: str, method: str, frames: int
) -> dict[str, Any]:
    width, height = settings.size
    camera = _camera(scene, settings)

    def draw() -> None:
        renderer.frame(scene, camera, settings).recorder.submit()
        renderer.gpu.finish()

    return _row(name, method, f"{width}×{height}", median_seconds(draw, frames, long=_LONG))


def _camera(scene: Scene, settings: Settings) -> Camera:
    width, height = settings.size
    return view_camera(scene, ViewSettings(azimuth=30.0, elevation=20.0), width / height)


@dataclass
class _Truth:
    """A picture by Monte Carlo."""

    pixels: NDArray[np.float64]
    """sRGB (h, w, 3), 0 to 1."""
    mask: NDArray[np.bool_]
    """(h, w) where the volume shows."""
    seconds: float
    """What it would take with :data:`_SPED_RAYS` at the full size."""


def _truth(renderer: Renderer, scene: Scene, small: Settings) -> _Truth:
    settings = small.replace(volume__light="monte-carlo", volume__samples=_TRUTH_RAYS)
    start = time.perf_counter()
    picture = renderer.render(scene, _camera(scene, small), settings)
    seconds = (time.perf_counter() - start) * _TRUTH_SHARE**2 * _SPED_RAYS / _TRUTH_RAYS
    return _Truth(_rgb(picture), picture.buffer("volume_opacity") > 0.02, seconds)


def _errors(
    renderer: Renderer, scene: Scene, small: Settings, truth: _Truth
) -> dict[str, float | None]:
    """The least ΔE2000 of a small picture, and the attenuation that has it."""
    found = []
    for alpha in _ATTENUATIONS:
        fitted = small.replace(
            volume__occlusion__attenuation=alpha, volume__shadow__attenuation=alpha
        )
        drawn = _rgb(renderer.render(scene, _camera(scene, small), fitted))
        found.append((delta_e(drawn, truth.pixels, truth.mask), alpha))
    error, alpha = min(found)
    return {"ΔE2000": round(error, 2), "attenuation": alpha}


def _rgb(image: Image) -> NDArray[np.float64]:
    """sRGB (h, w, 3), 0 to 1."""
    return image.pixels[..., :3] / 255.0


def _row(name: str, method: str, size: str, seconds: float) -> dict[str, Any]:
    return {
        "volume": name,
        "method": method,
        "size": size,
        "ms": round(1e3 * seconds, 1),
        "ΔE2000": None,
        "attenuation": None,
        "times faster than Monte Carlo": None,
    }
