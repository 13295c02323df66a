"""The scene's own scale, from which distances and tolerances follow."""

import scuro


def test_a_cartoon_takes_its_scale_from_what_has_a_radius():
    scene = scuro.load("sample:1hpv").show("cartoon").show("licorice", select="organic")
    image = scuro.render(scene, size=(96, 64), occlusion__technique="ray")
    renderer_scale = image._frame.accelerator.primitive_radius
    assert renderer_scale > 0.1
    visibility = image.buffer("visibility")[image.buffer("object") >= 0]
    assert visibility.min() >= 0 and visibility.max() <= 1, "smoothing made it no number"
