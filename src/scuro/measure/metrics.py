"""How far one picture is from another, in the field's measures.

Pictures are display-referred (sRGB encoded) arrays with values from 0 to 1: (h, w, 3) colour or
(h, w) grey, such as a visibility buffer. ``mask`` (h, w) restricts a measure to some pixels, as a
rule the object's; without it the whole picture counts, of which an equal background flatters.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scuro.errors import MissingExtraError, SettingsError

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Rec. 709 luminance of linear RGB (ITU-R BT.709-6, item 3.2)."""
_SSIM_WINDOW = 11
"""Pixels: Wang et al. 2004 use an 11 x 11 Gaussian of 1.5 pixels."""


@dataclass(frozen=True)
class Scores:
    """All measures of one picture against its reference over one set of pixels."""

    rmse: float
    psnr: float
    """dB; infinite for equal pictures."""
    ssim: float
    delta_e: float
    """Mean CIE ΔE2000; about 1 is just visible."""
    flip: float
    """Mean FLIP error, 0 to 1."""
    gain: float
    """By what factor the picture's linear light must be scaled to fit the reference best."""
    mean_luminance: float
    """Of the picture, linear."""
    mean_luminance_reference: float
    local_contrast: float
    """Of the picture."""
    local_contrast_reference: float

    def as_dict(self) -> dict[str, float | None]:
        """Plain numbers; an infinite PSNR becomes None, which JSON can hold."""
        return {k: v if math.isfinite(v) else None for k, v in asdict(self).items()}


def score(image: ArrayLike, reference: ArrayLike, mask: NDArray | None = None) -> Scores:
    """All measures at once."""
    return Scores(
        rmse=rmse(image, reference, mask),
        psnr=psnr(image, reference, mask),
        ssim=ssim(image, reference, mask),
        delta_e=delta_e(image, reference, mask),
        flip=flip(image, reference, mask),
        gain=gain(image, reference, mask),
        mean_luminance=mean_luminance(image, mask),
        mean_luminance_reference=mean_luminance(reference, mask),
        local_contrast=local_contrast(image, mask),
        local_contrast_reference=local_contrast(reference, mask),
    )


def rmse(image: ArrayLike, reference: ArrayLike, mask: NDArray | None = None) -> float:
    """Root of the mean squared difference over pixels and channels."""
    a, b = _pair(image, reference)
    return float(np.sqrt(np.mean((_chosen(a, mask) - _chosen(b, mask)) ** 2)))


def psnr(image: ArrayLike, reference: ArrayLike, mask: NDArray | None = None) -> float:
    """Peak signal-to-noise ratio in dB for a peak of 1; infinite for equal pictures."""
    error = rmse(image, reference, mask)
    return -20 * math.log10(error) if error > 0 else math.inf


def ssim(image: ArrayLike, reference: ArrayLike, mask: NDArray | None = None) -> float:
    """Mean structural similarity (Wang et al. 2004, Gaussian window), 1 for equal pictures.

    The similarity is computed on the whole picture and averaged over the masked pixels, so a
    window at the object's rim does see the background.
    """
    try:
        from skimage.metrics import structural_similarity
    except ImportError:
        raise MissingExtraError("picture measures", "measure") from None
    a, b = _pair(image, reference)
    if min(a.shape[:2]) < _SSIM_WINDOW:
        raise SettingsError(
            f"structural similarity needs pictures of at least {_SSIM_WINDOW} x {_SSIM_WINDOW} "
            f"pixels, not {a.shape[1]} x {a.shape[0]}"
        )
    _, similarity = structural_similarity(
        a,
        b,
        data_range=1.0,
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
        channel_axis=-1 if a.ndim == 3 else None,
        full=True,
    )
    return float(np.mean(_chosen(similarity, mask)))


def delta_e(image: ArrayLike, reference: ArrayLike, mask: NDArray | None = None) -> float:
    """Mean CIE ΔE2000 colour difference (D65)."""
    try:
        from skimage.color import deltaE_ciede2000, rgb2lab
    except ImportError:
        raise MissingExtraError("picture measures", "measure") from None
    a, b = (_chosen(_rgb(x), mask).reshape(-1, 1, 3) for x in _pair(image, reference))
    return float(np.mean(deltaE_ciede2000(rgb2lab(a), rgb2lab(b))))


def delta_e_map(image: ArrayLike, reference: ArrayLike) -> NDArray[np.float64]:
    """CIE ΔE2000 of every pixel, (h, w)."""
    try:
        from skimage.color import deltaE_ciede2000, rgb2lab
    except ImportError:
        raise MissingExtraError("picture measures", "measure") from None
    a, b = (rgb2lab(_rgb(x)) for x in _pair(image, reference))
    return np.asarray(deltaE_ciede2000(a, b), np.float64)


def flip(image: ArrayLike, reference: ArrayLike, mask: NDArray | None = None) -> float:
    """Mean FLIP error (Andersson et al. 2020) at 67 pixels per degree, 0 to 1."""
    try:
        import flip_evaluator
    except ImportError:
        raise MissingExtraError("picture measures", "measure") from None
    a, b = (np.ascontiguousarray(_rgb(x), np.float32) for x in _pair(image, reference))
    error, _, _ = flip_evaluator.evaluate(b, a, "LDR", applyMagma=False, computeMeanError=False)
    return float(np.mean(_chosen(np.asarray(error)[..., 0], mask)))


def gain(image: ArrayLike, reference: ArrayLike, mask: NDArray | None = None) -> float:
    """The factor g that makes g x image nearest to the reference in linear light.

    Least squares: g = Σ a b / Σ a². A picture that is merely too dark has a gain above 1.
    """
    a, b = (_chosen(_linear(x), mask) for x in _pair(image, reference))
    power = float(np.sum(a * a))
    return float(np.sum(a * b)) / power if power > 0 else 1.0


def mean_luminance(image: ArrayLike, mask: NDArray | None = None) -> float:
    """Mean linear luminance, 0 to 1."""
    return float(np.mean(_chosen(_luminance(image), mask)))


def local_contrast(image: ArrayLike, mask: NDArray | None = None, size: int = 15) -> float:
    """Mean RMS contrast of small windows: how much the creases stand out.

    In each ``size`` x ``size`` window the standard deviation of luminance over its mean, of the
    masked pixels only (so that a silhouette against the background does not count as a crease).
    """
    luminance = _luminance(image)
    weight = np.ones(luminance.shape) if mask is None else np.asarray(mask, np.float64)
    if not weight.any():
        raise SettingsError("there are no pixels to measure: the mask is empty")
    count = _box_sum(weight, size)
    mean = _box_sum(luminance * weight, size) / np.maximum(count, 1)
    square = _box_sum(luminance**2 * weight, size) / np.maximum(count, 1)
    deviation = np.sqrt(np.maximum(square - mean**2, 0))
    contrast = np.divide(deviation, mean, out=np.zeros_like(mean), where=mean > 1e-6)
    return float(np.mean(contrast[weight > 0]))


def _pair(image: ArrayLike, reference: ArrayLike) -> tuple[NDArray, NDArray]:
    a, b = np.asarray(image, np.float64), np.asarray(reference, np.float64)
    if a.shape != b.shape:
        raise SettingsError(
            f"pictures of different shape cannot be compared: {a.shape} and {b.shape}"
        )
    return a, b


def _chosen(values: NDArray, mask: NDArray | None) -> NDArray:
    if mask is None:
        return values
    if mask.shape != values.shape[:2]:
        raise SettingsError(f"a mask of {mask.shape} does not fit a picture of {values.shape[:2]}")
    if not mask.any():
        raise SettingsError("there are no pixels to measure: the mask is empty")
    return values[np.asarray(mask, bool)]


def _rgb(image: NDArray) -> NDArray:
    return np.repeat(image[..., None], 3, axis=-1) if image.ndim == 2 else image


def _linear(image: NDArray) -> NDArray:
    """Inverse of the sRGB transfer function (IEC 61966-2-1)."""
    return np.where(
        image <= 0.04045, image / 12.92, ((np.maximum(image, 0) + 0.055) / 1.055) ** 2.4
    )


def _luminance(image: ArrayLike) -> NDArray:
    linear = _linear(np.asarray(image, np.float64))
    return linear if linear.ndim == 2 else linear @ _LUMINANCE


def _box_sum(values: NDArray, size: int) -> NDArray:
    """Sum over the size x size window around each pixel; nothing lies beyond the border."""
    before, after = size // 2, size - size // 2 - 1
    for axis in (0, 1):
        padding = [(0, 0), (0, 0)]
        padding[axis] = (before + 1, after)
        total = np.cumsum(np.pad(values, padding), axis=axis)
        n = values.shape[axis]
        values = np.take(total, np.arange(size, size + n), axis) - np.take(
            total, np.arange(n), axis
        )
    return values
