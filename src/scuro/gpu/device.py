"""Opening a GPU: adapters, limits and features. Only this package imports wgpu."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from functools import cache
from typing import Any

from scuro.errors import GpuError, SettingsError
from scuro.gpu.ffi import quicken

_FEATURES = ("timestamp-query", "float32-filterable")
# WebGPU's default limits where they are lower than what desktop adapters offer (specification,
# section "Limits"): everything scuro draws must fit in them; larger ones only hold larger data.
DEFAULT_LIMITS = {
    "max-bind-groups": 4,
    "max-buffer-size": 1 << 28,
    "max-storage-buffer-binding-size": 1 << 27,
    "max-storage-buffers-per-shader-stage": 8,
    "max-storage-textures-per-shader-stage": 4,
    "max-sampled-textures-per-shader-stage": 16,
    "max-samplers-per-shader-stage": 16,
    "max-uniform-buffers-per-shader-stage": 12,
    "max-uniform-buffer-binding-size": 1 << 16,
    "max-texture-dimension-2d": 8192,
    "max-texture-dimension-3d": 2048,
    "max-texture-array-layers": 256,
    "max-color-attachments": 8,
    "max-color-attachment-bytes-per-sample": 32,
    "max-compute-workgroup-storage-size": 16384,
    "max-compute-invocations-per-workgroup": 256,
    "max-compute-workgroup-size-x": 256,
    "max-compute-workgroup-size-y": 256,
    "max-compute-workgroup-size-z": 64,
}
NO_ADAPTER = (
    "no GPU adapter found: install a Vulkan driver, e.g. the software one with "
    "'apt-get install mesa-vulkan-drivers libvulkan1'"
)
_GROWING = (
    "max-storage-buffer-binding-size",
    "max-buffer-size",
    "max-texture-dimension-2d",
    "max-texture-dimension-3d",
)


@dataclass(frozen=True)
class AdapterInfo:
    """What an adapter says of itself."""

    name: str
    kind: str
    """``DiscreteGPU``, ``IntegratedGPU``, ``CPU`` …"""
    backend: str
    driver: str

    @property
    def software(self) -> bool:
        """Whether it runs shaders on the CPU (lavapipe, WARP, SwiftShader)."""
        return self.kind == "CPU"

    def __str__(self) -> str:
        return f"{self.name} ({self.kind}, {self.backend})"


@cache
def _wgpu() -> Any:
    """wgpu, with the native back end limited to what we want it to probe.

    Probing OpenGL costs 0.7 s on a machine with no display and never wins over Vulkan, Metal or
    DirectX; it is tried only where those find nothing.
    """
    # Vulkan's window-system probe complains on standard error without it
    os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())
    import wgpu
    import wgpu.backends.wgpu_native.extras as extras
    from wgpu.backends.wgpu_native import ffi

    quicken(ffi)
    backends = os.environ.get("SCURO_BACKENDS", "Vulkan,Metal,DX12").split(",")
    extras.set_instance_extras(backends=backends)
    return wgpu


def _adapters() -> list[Any]:
    found: list[Any] = _wgpu().gpu.enumerate_adapters_sync()
    return found


def _describe(adapter: Any) -> AdapterInfo:
    info = adapter.info
    return AdapterInfo(
        info["device"], info["adapter_type"], info["backend_type"], info["description"]
    )


def list_adapters() -> list[AdapterInfo]:
    """Every adapter that could be opened, the default one first."""
    return [_describe(a) for a in sorted(_adapters(), key=_preference)]


def _preference(adapter: Any) -> int:
    order = ("DiscreteGPU", "IntegratedGPU", "VirtualGPU", "Unknown", "CPU")
    kind = adapter.info["adapter_type"]
    return order.index(kind) if kind in order else len(order)


def open_device(
    choice: str | None = None, *, default_limits: bool = False
) -> tuple[Any, AdapterInfo]:
    """Open a device.

    Args:
        choice: Number in :func:`list_adapters` or part of an adapter's name; ``None`` for the best.
        default_limits: Ask for no more than WebGPU's default sizes and for no features, as a
            browser on any machine would.

    Raises:
        GpuError: There is no adapter, or it gives no device.
        SettingsError: ``choice`` names no adapter.
    """
    adapters = sorted(_adapters(), key=_preference)
    if not adapters:
        raise GpuError(NO_ADAPTER)
    adapter = adapters[0]
    choice = choice or os.environ.get("SCURO_DEVICE")
    if choice:
        names = [str(_describe(a)) for a in adapters]
        if choice.isdigit() and int(choice) < len(adapters):
            adapter = adapters[int(choice)]
        else:
            match = [a for a, n in zip(adapters, names, strict=True) if choice.lower() in n.lower()]
            if not match:
                listed = "; ".join(f"{i}: {n}" for i, n in enumerate(names))
                raise SettingsError(f"no adapter matches --device '{choice}': known: {listed}")
            adapter = match[0]
    features: list[str] = []
    limits = dict(DEFAULT_LIMITS)
    if not default_limits:
        features = [f for f in _FEATURES if f in adapter.features]
        limits |= {name: adapter.limits[name] for name in _GROWING}
    try:
        device = adapter.request_device_sync(required_features=features, required_limits=limits)
    except Exception as error:
        raise GpuError(f"{_describe(adapter)} gives no device: {error}") from None
    return device, _describe(adapter)
