"""Measuring pictures and techniques: how far from the reference, and how long."""

from scuro.measure.metrics import (
    Scores,
    delta_e,
    flip,
    gain,
    local_contrast,
    mean_luminance,
    psnr,
    rmse,
    score,
    ssim,
)
from scuro.measure.sheet import contact_sheet

__all__ = [
    "Scores",
    "contact_sheet",
    "delta_e",
    "flip",
    "gain",
    "local_contrast",
    "mean_luminance",
    "psnr",
    "rmse",
    "score",
    "ssim",
]
