"""Acceleration structures and the one tracer (wgsl/trace.wgsl)."""

from scuro.trace.accelerator import Accelerator, build_accelerator, build_in_steps

__all__ = ["Accelerator", "build_accelerator", "build_in_steps"]
