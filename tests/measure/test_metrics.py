"""Picture measures against closed forms."""

import math

import numpy as np
import pytest

from scuro import measure
from scuro.errors import SettingsError
from scuro.measure.metrics import _box_sum


def encode(linear: float) -> float:
    return 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055


def flat(value: float, shape: tuple[int, ...] = (24, 32, 3)) -> np.ndarray:
    return np.full(shape, value)


def test_rmse_and_psnr_of_a_constant_difference():
    a, b = flat(0.3), flat(0.55)
    assert measure.rmse(a, b) == pytest.approx(0.25)
    assert measure.psnr(a, b) == pytest.approx(-20 * math.log10(0.25))


def test_equal_pictures_are_equal_in_every_measure():
    a = np.random.default_rng(1).random((24, 32, 3))
    assert measure.rmse(a, a) == 0
    assert measure.psnr(a, a) == math.inf
    assert measure.ssim(a, a) == pytest.approx(1)
    assert measure.delta_e(a, a) == 0
    assert measure.flip(a, a) == 0
    assert measure.gain(a, a) == pytest.approx(1)


def test_ssim_of_two_constants_is_its_luminance_term():
    a, b, c1 = 0.4, 0.7, 0.01**2
    expected = (2 * a * b + c1) / (a * a + b * b + c1)
    assert measure.ssim(flat(a), flat(b)) == pytest.approx(expected, abs=1e-6)
    assert measure.ssim(flat(a, (24, 32)), flat(b, (24, 32))) == pytest.approx(expected, abs=1e-6)


def test_delta_e_of_two_greys_is_the_weighted_lightness_difference():
    y = np.array([0.18, 0.4])
    lightness = 116 * np.cbrt(y) - 16
    mean = lightness.mean()
    weight = 1 + 0.015 * (mean - 50) ** 2 / math.sqrt(20 + (mean - 50) ** 2)
    expected = (lightness[1] - lightness[0]) / weight
    assert measure.delta_e(flat(encode(y[0])), flat(encode(y[1]))) == pytest.approx(
        expected, abs=5e-3
    )


def test_flip_tells_black_from_white_and_a_shade_from_its_neighbour():
    assert measure.flip(flat(0.0), flat(1.0)) > 0.9
    assert 0 < measure.flip(flat(0.50), flat(0.52)) < 0.1


def test_gain_is_the_ratio_of_linear_light():
    assert measure.gain(flat(encode(0.1)), flat(encode(0.25))) == pytest.approx(2.5)


def test_mean_luminance_weighs_the_primaries():
    green = np.zeros((4, 4, 3))
    green[..., 1] = 1
    assert measure.mean_luminance(green) == pytest.approx(0.7152)


def test_local_contrast_of_a_checkerboard():
    low, high, n = 0.2, 0.6, 16
    board = np.where(np.indices((n, n)).sum(axis=0) % 2, encode(high), encode(low))
    contrast = (high - low) / (high + low)
    # every 2 x 2 window holds two of each, except the one that the corner cuts to one pixel
    expected = contrast * (n * n - 1) / (n * n)
    assert measure.local_contrast(board, size=2) == pytest.approx(expected)


def test_local_contrast_ignores_the_silhouette():
    picture, mask = np.ones((32, 32)), np.zeros((32, 32), bool)
    mask[8:24, 8:24] = True
    picture[mask] = 0.25
    assert measure.local_contrast(picture, mask) == pytest.approx(0, abs=1e-6)
    assert measure.local_contrast(picture) > 0.1


def test_box_sum_against_a_plain_loop():
    values = np.random.default_rng(2).random((9, 7))
    for size in (1, 2, 5):
        padded = np.pad(values, ((size // 2, size - size // 2 - 1),) * 2)
        expected = [[padded[y : y + size, x : x + size].sum() for x in range(7)] for y in range(9)]
        assert np.allclose(_box_sum(values, size), expected)


def test_the_mask_leaves_the_rest_out():
    a = np.random.default_rng(3).random((24, 32, 3))
    b = a.copy()
    b[:, 16:] = 1 - b[:, 16:]
    mask = np.zeros((24, 32), bool)
    mask[:, :8] = True
    scores = measure.score(b, a, mask)
    assert scores.rmse == 0 and scores.delta_e == 0 and scores.ssim == pytest.approx(1)
    assert scores.as_dict()["psnr"] is None
    assert measure.rmse(b, a) > 0.1


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: measure.rmse(flat(0), flat(0, (5, 5, 3))), "different shape"),
        (lambda: measure.rmse(flat(0), flat(0), np.zeros((24, 32), bool)), "mask is empty"),
        (lambda: measure.rmse(flat(0), flat(0), np.ones((3, 3), bool)), "does not fit"),
        (lambda: measure.ssim(flat(0, (8, 8)), flat(0, (8, 8))), "at least 11"),
    ],
)
def test_what_cannot_be_measured_is_said(call, words):
    with pytest.raises(SettingsError, match=words):
        call()
