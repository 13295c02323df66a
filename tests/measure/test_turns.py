"""Views that turn about the axes, and means over them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scuro.measure.metrics import Scores
from scuro.measure.report import Row
from scuro.measure.turns import Turned, centered, means, table, turned, views
from scuro.scene.camera import Camera

CAMERA = Camera((10.0, -20.0, 7.0), (1.0, 2.0, 3.0), (0.0, 0.0, 1.0))


@pytest.mark.parametrize(
    ("axis", "point", "where"),
    # a quarter turn takes x to y, y to z, z to x
    [("Z", (1, 0, 0), (0, 1, 0)), ("X", (0, 1, 0), (0, 0, 1)), ("Y", (0, 0, 1), (1, 0, 0))],
)
def test_a_turned_camera_sees_what_turned_things_show(axis, point, where) -> None:
    camera = Camera((10.0, -20.0, 7.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    seen = turned(camera, axis, 90).view_from_world() @ [*point, 1]
    assert np.allclose(seen, camera.view_from_world() @ [*where, 1])


def test_views_begin_alike_and_fit() -> None:
    bounds = np.array([[-5, -50, 0], [3, 10, 9.0]])
    start = centered(CAMERA, bounds, 0.5)
    found = list(views(start, 3))
    assert [(axis, angle) for axis, angle, _ in found[:4]] == [
        ("X", 0), ("X", 90), ("X", 180), ("Y", 0),
    ]  # fmt: skip
    corners = np.array(
        [[bounds[a][0], bounds[b][1], bounds[c][2], 1] for a, b, c in np.ndindex(2, 2, 2)]
    )
    for _, _, camera in found:
        x, y, z, _ = camera.view_from_world() @ corners.T
        high = camera.half_height()
        assert (np.abs(y) <= -z * high * 1.001).all() and (np.abs(x) <= -z * high * 0.501).all()


def test_means() -> None:
    def row(psnr: float, milliseconds: float) -> Row:
        return Row(
            "a",
            {},
            milliseconds,
            Scores(0.1, psnr, 0.9, 1, 0, 1, 1, 1, 1, 1),
            notes={"megabytes": 2.0},
        )

    found = [Turned("X", 0, [row(40, 10)]), Turned("X", 180, [row(math.inf, 30)])]
    (mean,) = means(found)
    assert mean.milliseconds == 20 and mean.object and mean.object.psnr == (40 + 99) / 2
    assert mean.notes == {"megabytes": 2.0}
    assert table(found).row_count == 2
