"""Where volumes show."""

import numpy as np

from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction
from scuro.style.volume_extent import visible_corners


def test_cameras_are_fitted_to_what_shows():
    values = np.zeros((20, 30, 40), np.uint8)
    values[5:9, 10:12, 30:33] = 200
    world = np.diag([2.0, 1, 1, 1])
    volume = Volume(values, world)
    transfer = TransferFunction(((0.0, 1, 1, 1),), ((100.0, 0.0), (150.0, 0.5)))
    box = visible_corners(volume, transfer)
    # one voxel more on every side
    assert (box.min(axis=0) == [57, 8.5, 3.5]).all() and (box.max(axis=0) == [67, 12.5, 9.5]).all()
    assert (visible_corners(volume, transfer, iso=150.0) == box).all()
    nothing = visible_corners(volume, transfer, iso=250.0)
    assert (nothing.min(axis=0) == volume.bounds[0]).all()
    assert (nothing.max(axis=0) == volume.bounds[1]).all()
