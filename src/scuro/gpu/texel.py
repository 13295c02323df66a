"""Texture formats as numpy sees them."""

import numpy as np

TEXEL = {
    "r8unorm": (np.uint8, 1),
    "r8uint": (np.uint8, 1),
    "rgba8unorm": (np.uint8, 4),
    "rgba8unorm-srgb": (np.uint8, 4),
    "r16float": (np.float16, 1),
    "rg16float": (np.float16, 2),
    "rgba16float": (np.float16, 4),
    "r32float": (np.float32, 1),
    "rg32float": (np.float32, 2),
    "rgba32float": (np.float32, 4),
    "r16uint": (np.uint16, 1),
    "rgba16uint": (np.uint16, 4),
    "r32uint": (np.uint32, 1),
    "rg32uint": (np.uint32, 2),
    "rgba32uint": (np.uint32, 4),
    "r32sint": (np.int32, 1),
    "depth32float": (np.float32, 1),
}
"""Type of a channel and number of channels, by WebGPU format."""
