"""Occlusion: frame time and error of each technique by number of atoms; rays a second of ``ray``.

Inputs as for ``visibility``. ``occlusion_s`` is what the technique adds to the frame without
occlusion; ``million_rays_a_second`` counts the rays of ``ray`` over that; errors are of visibility
over the object's pixels, and SSIM over the picture too, against 1,024 unfiltered rays a pixel.
"""

from __future__ import annotations

from typing import Any

from scuro.measure.bench import BenchOptions, median_seconds
from scuro.measure.bench.visibility import scenes
from scuro.measure.metrics import rmse, ssim
from scuro.passes.occlusion.occlusion import TECHNIQUES
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera

_TRUTH = {"technique": "ray", "samples": 1024, "filter": "none"}

_RAYS: dict[str, dict[str, Any]] = {
    "ray 1 + filter": {"technique": "ray", "samples": 1, "filter": "bilateral"},
    "ray 4 + filter": {"technique": "ray", "samples": 4, "filter": "bilateral"},
    "ray 16": {"technique": "ray", "samples": 16, "filter": "none"},
}
"""``ray`` by what it costs; the other techniques run by their own defaults."""


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure every technique on every scene; see the module."""
    renderer = Renderer(options.device)
    rows = []
    for name, scene in scenes(options):
        rows += _measure(renderer, name, scene, options)
    return {
        "adapter": str(renderer.gpu.info),
        "size": list(options.size),
        "frames": options.frames,
        "rows": rows,
    }


def _measure(
    renderer: Renderer, name: str, scene: Scene, options: BenchOptions
) -> list[dict[str, Any]]:
    plain = options.plain()
    camera = view_camera(scene, ViewSettings(), options.size[0] / options.size[1])
    options.say(f"{name}, truth")
    image = renderer.render(scene, camera, _with(plain, _TRUTH))
    truth, seen = image.buffer("visibility"), image.buffer("object") >= 0
    spheres = renderer.accelerator(scene).spheres
    full = plain.replace(
        lighting__preset="full", occlusion__technique="auto", shadows__technique="auto"
    )
    ways = {"none": plain} | {k: _with(plain, v) for k, v in _RAYS.items()}
    ways |= {t: _with(plain, {"technique": t}) for t in TECHNIQUES if t != "ray"}
    rows: list[dict[str, Any]] = []
    bare = 0.0
    for way, settings in (*ways.items(), ("lighting full", full)):
        options.say(f"{name}, {way}")

        def frame(settings: Settings = settings) -> None:
            renderer.frame(scene, camera, settings).recorder.submit()
            renderer.gpu.finish()

        seconds = median_seconds(frame, options.frames)
        bare = bare or seconds
        rays = _RAYS.get(way, {}).get("samples", 0) * int(seen.sum())
        row = {
            "scene": name,
            "spheres": spheres,
            "occlusion": way,
            "frame_s": round(seconds, 4),
            "occlusion_s": round(seconds - bare, 4),
            "million_rays_a_second": round(rays / (seconds - bare) / 1e6, 2)
            if rays and seconds > bare
            else None,
        }
        rows.append(row | _errors(renderer, scene, camera, settings, truth, seen, way))
    return rows


def _errors(
    renderer: Renderer, scene: Scene, camera: Any, settings: Settings, truth: Any, seen: Any,
    way: str,
) -> dict[str, Any]:  # fmt: skip
    if way == "none":
        return {"rmse": None, "ssim_object": None, "ssim_picture": None, "mean": None}
    visibility = renderer.render(scene, camera, settings).buffer("visibility")
    return {
        "rmse": round(rmse(visibility, truth, seen), 4),
        "ssim_object": round(ssim(visibility, truth, seen), 4),
        "ssim_picture": round(ssim(visibility, truth), 4),
        "mean": round(float(visibility[seen].mean() / truth[seen].mean()), 4),
    }


def _with(settings: Settings, occlusion: dict[str, Any]) -> Settings:
    return settings.replace(**{f"occlusion__{key}": value for key, value in occlusion.items()})
