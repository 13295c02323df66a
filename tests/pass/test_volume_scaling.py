"""Scaling of the volume's picture, against what the filters are known to do."""

from __future__ import annotations

import numpy as np
import pytest
from test_volume import PLAIN, ball, draw, ramp

from scuro.passes.volume.scaling import FILTERS, Scaler, sampling, scaled_size, steps
from scuro.render import Renderer


@pytest.fixture(scope="module")
def gpu():
    return Renderer().gpu


def matrix(name: str, before: int, after: int) -> np.ndarray:
    made = np.eye(before)
    for step in steps(name, before, after):
        made = step.dense(len(made)) @ made
    return made


@pytest.mark.parametrize("name", FILTERS)
def test_every_filter_keeps_constants_and_samples(name):
    for after in (10, 24, 37, 48):
        np.testing.assert_allclose(matrix(name, 24, after).sum(axis=1), 1.0, atol=1e-9)
    np.testing.assert_allclose(matrix(name, 24, 24), np.eye(24), atol=5e-4)


def test_o_moms_reproduces_cubic_polynomials():
    """Approximation order 4 (Blu, Thévenaz and Unser 2001); Catmull-Rom has order 3."""
    x = np.arange(40.0)
    fine = (np.arange(100) + 0.5) * 0.4 - 0.5
    middle = (fine > 12) & (fine < 28)

    def wrong(name: str, power: int) -> float:
        polynomial = ((x - 20) / 8) ** power
        found = matrix(name, 40, 100) @ polynomial
        return float(np.abs(found - ((fine - 20) / 8) ** power)[middle].max())

    assert max(wrong("o-moms", p) for p in (1, 2, 3)) < 1e-3
    assert wrong("cubic", 2) < 1e-9
    assert wrong("linear", 2) > 1e-3


def test_o_moms_scales_waves_with_less_error_than_the_others():
    x, fine = np.arange(64.0), (np.arange(192) + 0.5) / 3 - 0.5
    middle = (fine > 12) & (fine < 50)

    def wrong(name: str) -> float:
        found = matrix(name, 64, 192) @ np.sin(0.9 * x)
        return float(np.sqrt(np.mean((found - np.sin(0.9 * fine))[middle] ** 2)))

    errors = {name: wrong(name) for name in ("o-moms", "cubic", "linear", "nearest")}
    assert sorted(errors, key=errors.__getitem__) == ["o-moms", "cubic", "linear", "nearest"]


def test_scaling_down_is_scaling_up_transposed():
    """The kernel as a prefilter (Nehab and Hoppe 2014): the adjoint, but for the step's factor."""
    down, up = matrix("o-moms", 60, 30), matrix("o-moms", 30, 60)
    np.testing.assert_allclose(down[8:22], up.T[8:22] / 2, atol=2e-3)


@pytest.mark.parametrize("after", [(20, 9), (31, 50)])
def test_the_gpu_scales_as_the_matrices_do(gpu, after):
    rng = np.random.default_rng(3)
    picture = rng.random((18, 26, 4)).astype(np.float16)
    scaler = Scaler(gpu, "o-moms", (26, 18), after)
    gpu.write_texture(scaler.color, picture)
    color, depth = gpu.texture(after, "rgba16float"), gpu.texture(after, "r32float")
    record = gpu.recorder()
    scaler.scale(record, color, depth)
    record.submit()
    expected = np.einsum(
        "yj,xi,jic->yxc", matrix("o-moms", 18, after[1]), matrix("o-moms", 26, after[0]), picture
    )
    expected[..., :3] = expected[..., :3].clip(0)
    expected[..., 3] = expected[..., 3].clip(0, 1)
    np.testing.assert_allclose(gpu.read_texture(color).astype(float), expected, atol=0.01)


def test_a_volume_drawn_small_is_shown_at_full_size(gpu):
    settings = PLAIN.replace(shading="phong")
    full, depth, _ = draw(gpu, ball(), settings, ramp(0.5), size=(64, 48))
    small, near, _ = draw(gpu, ball(), settings.replace(scale=0.5), ramp(0.5), size=(64, 48))
    large, _, _ = draw(gpu, ball(), settings.replace(scale=2.0), ramp(0.5), size=(64, 48))
    assert small.shape == full.shape and np.abs(small - full).mean() < 0.02
    assert np.abs(large - full).mean() < 0.01
    both = (depth > 0) & (near > 0)
    assert both.sum() > 100 and np.median(np.abs(depth - near)[both]) <= 0.5


def test_sizes_and_rows():
    assert scaled_size((5, 3), 0.1) == (1, 1)
    assert (sampling("nearest", 10, 5).weights == 1).all()
