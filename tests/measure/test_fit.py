"""Fitting a technique's number to a reference finds the number that made it."""

import math

import numpy as np
import pytest

from scuro.measure.fit import Fitter, numbers_to_fit, search
from scuro.measure.metrics import delta_e, delta_e_map
from scuro.measure.sheet import difference_picture
from scuro.measure.variant import Variant
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.scene import Scene
from scuro.scene.volume import Volume


def test_search_finds_the_least_error_with_few_trials():
    asked = []

    def error(x: float) -> float:
        asked.append(x)
        return abs(math.log(x / 0.37))

    assert search(error, 0.02, 2.0, 14) == pytest.approx(0.37, rel=0.02)
    assert len(asked) == 14 and min(asked) >= 0.02 and max(asked) <= 2.0


def test_attenuation_is_found_again():
    z, y, x = np.indices((24, 24, 24)) - 11.5
    volume = Volume((255 * (np.hypot(np.hypot(x, y), z) > 8)).astype(np.uint8))
    scene = Scene([]).add(volume)
    settings = Settings(size=(96, 96), background="black").replace(
        lighting__preset="studio",
        volume__jitter=0.0,
        volume__opacity="0:0 255:0.05",
        volume__occlusion__gap=1.0,
    )
    renderer = Renderer()
    made = Variant("made", {"volume__occlusion__attenuation": 0.6})
    camera = renderer.fitted(scene, settings)
    fitter = Fitter(renderer, scene, camera, settings, made)
    found = fitter.fitted(Variant("object", {"volume__light": "object"}))
    assert found.changes["volume__occlusion__attenuation"] == pytest.approx(0.6, rel=0.05)


def test_what_is_fitted_depends_on_the_technique():
    def paths(**changes):
        changed = {f"volume__{name}": value for name, value in changes.items()}
        found = numbers_to_fit(Settings().replace(lighting__preset="studio", **changed))
        return [n.path.removeprefix("volume__") for n in found]

    assert paths() == ["occlusion__attenuation"]
    assert paths(light="slices")[0] == "occlusion__slice_angle"
    assert paths(light="monte-carlo") == []
    assert paths(occlusion__on=False, shadow__on=True) == ["shadow__attenuation"]
    implied = numbers_to_fit(Settings().replace(lighting__preset="full"))
    assert [n.path for n in implied][1:] == ["volume__shadow__attenuation"]


def test_difference_maps_show_where_pictures_differ():
    a, b = np.zeros((4, 5, 3)), np.zeros((4, 5, 3))
    b[1, 2] = 1.0
    found = delta_e_map(a, b)
    assert found[1, 2] == pytest.approx(100, rel=0.01) and found.sum() == found[1, 2]
    assert found.mean() == pytest.approx(delta_e(a, b))
    shown = difference_picture(found, 20.0)
    assert shown.dtype == np.uint8 and shown[1, 2].sum() > 600 > 10 > shown[0, 0].sum()
