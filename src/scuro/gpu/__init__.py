"""The GPU layer: the only package that calls wgpu."""

from scuro.gpu.device import AdapterInfo, list_adapters
from scuro.gpu.gpu import Gpu
from scuro.gpu.recorder import Recorder, Timings

__all__ = ["AdapterInfo", "Gpu", "Recorder", "Timings", "list_adapters"]
