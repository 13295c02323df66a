"""What is written over pictures: marks, legends, scale bars."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from scuro.export.formats import display
from scuro.load import load
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.cornerpoint_synthetic import faulted_dome
from scuro.scene.reservoir import ReservoirItem
from scuro.scene.scene import Scene
from scuro.scene.volume import Volume
from scuro.style.color import atom_colors
from scuro.style.gauges import axis_cross, inks, nice_length, scale_bar
from scuro.style.legend import Legend, legend_marks, tick_text, ticks
from scuro.style.legends import molecule_legends, reservoir_legend, scene_legends, volume_legend
from scuro.style.marks import Box, Line, Strip, Text, paint, paint_linear, text_width
from scuro.style.reservoir_options import ReservoirSettings

INK, HALO = (20, 20, 24, 255), (255, 255, 255, 205)
MARKS = [
    Text("Åµ² labels", 60.3, 41.7, 18, INK, HALO, "m"),
    Box((10, 60, 70, 90), (255, 255, 255, 128)),
    Line(((12, 70), (40, 61), (68, 88)), INK, 2),
    Strip((10, 92, 70, 99), ((255, 0, 0), (0, 0, 255))),
    Text("cut off", 112, 12, 14, INK),
]


def noise(height: int = 100, width: int = 120) -> np.ndarray:
    return np.random.default_rng(1).integers(0, 256, (height, width, 4), dtype=np.uint8)


def test_bands_make_the_same_picture_as_the_whole():
    picture = noise()
    whole = paint(picture, MARKS)
    assert (whole != picture).any(axis=-1).mean() > 0.1
    cuts = [0, 7, 41, 62, 100]
    bands = [paint(picture[a:b], MARKS, a) for a, b in itertools.pairwise(cuts)]
    np.testing.assert_array_equal(np.concatenate(bands), whole)


def test_linear_light_encodes_to_the_same_picture():
    picture = noise()
    picture[..., 3] = np.where(np.arange(120) < 60, 255, picture[..., 3])
    encoded = picture / 255
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    alpha = encoded[..., 3:]
    premultiplied = np.concatenate([linear[..., :3] * alpha, alpha], -1).astype(np.float32)
    found = 255 * display(paint_linear(premultiplied, MARKS))
    wanted = paint(picture, MARKS)
    seen = wanted[..., 3] > 64  # colours of nearly clear pixels are rounded coarsely
    assert np.abs(found - wanted)[seen].max() < 3
    untouched = (wanted == picture).all(axis=-1) & (picture[..., 3] > 0)
    np.testing.assert_allclose(found[untouched], picture[untouched], atol=0.01)


def test_words_for_one_eye_change_its_channels_alone():
    picture = np.full((40, 90, 4), 255, np.uint8)
    linear = np.ones((40, 90, 4), np.float32)
    for eye, seen in ((-1, [0]), (1, [1, 2]), (0, [0, 1, 2])):
        words = [Text("depth", 45, 28, 24, INK, (250, 250, 250, 255), "m", eye)]
        made = paint(picture, words)
        lit = 255 * display(paint_linear(linear, words))
        changed = [n for n in range(3) if (made[..., n] < 128).any()]
        assert changed == seen
        assert np.abs(lit - made).max() < 1.5


def test_a_legend_is_as_wide_as_its_words():
    def width(*legends: Legend, size: tuple[int, int] = (900, 600)) -> float:
        marks = legend_marks(legends, size, 12, "lower left", INK, HALO)
        assert size[0] < 400 or not any("…" in m.text for m in marks if isinstance(m, Text))
        return max(mark.box[2] - mark.box[0] for mark in marks if isinstance(mark, Box))

    red = (200, 60, 60)
    short = Legend("chain", swatches=((red, "A"),))
    long = Legend("chain", swatches=((red, "HIV-1 envelope glycoprotein gp160"),))
    assert width(short) < 110 < text_width(long.swatches[0][1], 12) < width(long) <= 26 * 12
    assert width(short, long) == width(long), "one over the other they are alike"
    strip = Legend("B-factor (Å²)", low=0, high=80, strip=((0, 0, 0), red))
    assert width(strip) == 17 * 12
    # a name more or less changes nothing most of the time
    widths = {width(Legend("x" * n)) for n in range(5, 40)}
    assert len(widths) < 9
    assert width(long, size=(300, 300)) <= 17 * 12


def test_every_letter_that_units_need_is_there():
    missing = text_width("\uffff", 20)
    for letter in "Åµ°²³×−·–°":
        image = paint(np.zeros((40, 40, 4), np.uint8), [Text(letter, 10, 30, 24, INK)])
        blank = paint(np.zeros((40, 40, 4), np.uint8), [Text("\uffff", 10, 30, 24, INK)])
        assert image.any() and not np.array_equal(image, blank), letter
    assert missing > 0


def test_ticks_are_round_few_and_within():
    assert ticks(-4.5, 4.5) == [-4, -2, 0, 2, 4]
    assert ticks(0, 1) == [0, 0.5, 1]
    for low, high in ((0, 1), (3.2, 97), (-1000, 3071), (1e-5, 3e-5), (173.2, 173.9)):
        found = ticks(low, high)
        assert 2 <= len(found) <= 5
        assert low - 1e-9 <= found[0] and found[-1] <= high * (1 + 1e-9)
        words = [tick_text(v, found) for v in found]
        assert len(set(words)) == len(words)
    assert [tick_text(v, [0, 0.5, 1]) for v in (0, 0.5, 1)] == ["0.0", "0.5", "1.0"]


@pytest.mark.parametrize(
    ("most", "unit", "text"),
    [
        (7.3, "Å", "5 Å"), (36, "Å", "2 nm"), (0.13, "Å", "0.1 Å"), (4.2e4, "Å", "2 µm"),
        (1500, "mm", "1 m"), (0.3, "mm", "200 µm"), (72, "mm", "50 mm"), (2400, "m", "2 km"),
        (300, "m", "200 m"), (0.9, "m", "500 mm"), (2400, "ft", "2000 ft"), (99, "", "50"),
        (640, "um", "500 µm"), (30, "nm", "20 nm"),
    ],
)  # fmt: skip
def test_lengths_are_told_in_the_unit_that_suits_them(most, unit, text):
    assert nice_length(most, unit)[1] == text


def test_a_scale_bar_is_as_long_as_it_says():
    camera = Camera((0, 0, 100), (0, 0, 0), (0, 1, 0), 30)
    marks = scale_bar(camera, "Å", (640, 360), 12, INK, HALO)
    bar = next(m for m in marks if isinstance(m, Line) and m.color == INK)
    text = next(m for m in marks if isinstance(m, Text))
    assert text.text == "1 nm"
    pixels = bar.points[1][0] - bar.points[0][0]
    assert pixels == pytest.approx(10 * 360 / (2 * 100 * np.tan(np.radians(15))))
    assert all(m.box[0] >= 0 and m.box[2] <= 640 and m.box[3] <= 360 for m in marks)


def test_the_axis_cross_shows_where_axes_go():
    camera = Camera((10, 0, 0), (0, 0, 0), (0, 0, 1), 30)  # along -x: y to the right, z up
    names = {m.text: m for m in axis_cross(camera, (100, 100), 20, HALO) if isinstance(m, Text)}
    assert set(names) == {"y", "z"}, "x comes toward the eye"
    assert names["y"].x > 120 and names["z"].y < 80


def test_ink_suits_the_background():
    assert inks((1, 1, 1, 1))[0][0] < 60 < inks((0, 0, 0, 1))[0][0]
    assert inks((0, 0, 0, 0))[0][0] < 60, "clear pictures lie on paper"


def test_a_reservoirs_legend():
    grid = faulted_dome(8, 7, 6)
    settings = ReservoirSettings(show="volume", property="PRESSURE", time=1, exaggeration=3.0)
    legend = reservoir_legend(ReservoirItem(grid, settings))
    assert legend.title == "PRESSURE (barsa)"
    assert legend.lines == ("faulted dome, 2020-12-31", "heights × 3")
    assert max(legend.bars) == 1 and max(legend.curve) == 1
    blank = np.full((240, 320, 4), 255, np.uint8)
    marks = legend_marks([legend], (320, 240), 10, "lower left", INK, (255, 255, 255, 228))
    drawn = paint(blank, marks)
    corner = drawn[120:, :190].reshape(-1, 4)[:, :3].astype(int)
    # the color map's two ends
    assert (np.abs(corner - (64, 64, 162)).max(axis=1) < 30).any()
    assert (np.abs(corner - (170, 25, 1)).max(axis=1) < 30).any()
    assert (drawn[:90] == 255).all() and (drawn[:, 200:] == 255).all()
    right = legend_marks([legend], (320, 240), 10, "upper right", INK, (255, 255, 255, 228))
    assert min(m.box[0] for m in right) > 130 and max(m.box[3] for m in right) < 150


def test_molecules_legends_say_what_colors_mean():
    scene = Scene().add(load("sample:1hpv"))

    def legends(**shown):
        scene.hide().show(**shown)
        return list(molecule_legends(scene.molecules[0]))

    (legend,) = legends(color="bfactor:viridis:10:60")
    assert (legend.title, legend.low, legend.high) == ("B-factor (Å²)", 10, 60)
    assert np.abs(np.subtract(legend.strip[0], (68, 1, 84))).max() < 6, "viridis begins violet"
    (legend,) = legends(color="chain", select="polymer")
    assert [name for _, name in legend.swatches] == ["A", "B"]
    painted = atom_colors(scene.molecules[0].molecule, "chain")[:, :3].tolist()
    assert [list(color) for color, _ in legend.swatches] == [painted[0], painted[1500]]
    (legend,) = legends(color="secondary", select="polymer")
    assert {name for _, name in legend.swatches} == {"helix", "strand", "coil"}
    (legend,) = legends(color="element")
    assert legend.swatches[0][1] == "C" and legend.more == 0
    assert legends(color="tomato") == []
    (legend,) = legends(select="organic")
    assert legend.title == "element" and {n for _, n in legend.swatches} == {"C", "N", "O", "S"}
    (legend,) = legends()
    assert legend.title == "chain"
    (legend,) = legends(color="hydrophobicity")
    assert legend.title.startswith("hydropathy") and (legend.low, legend.high) == (-4.5, 4.5)


def test_volumes_legends():
    values = np.linspace(0, 10, 1000, dtype=np.float32).reshape(10, 10, 10)
    scene = Scene().add(Volume(values, name="ramp", value_name="density", unit="Å"))
    settings = Settings().replace(volume__opacity="2:0 10:0.5", volume__transfer="gray")
    (legend,) = scene_legends(scene, settings)
    assert (legend.title, legend.lines, legend.low, legend.high) == ("density", ("ramp",), 0, 10)
    assert legend.curve[0] == 0 and legend.curve[-1] == 1
    item = scene.volumes[0]
    iso = volume_legend(item, settings.volume.replace(iso=5.0))
    assert iso.swatches[0][1] == "5"
    labels = np.repeat(np.array([0, 0, 3, 7], np.uint8), 16).reshape(4, 4, 4)
    item = Scene().add(Volume(labels, labels=True)).volumes[0]
    assert [n for _, n in volume_legend(item, Settings().volume).swatches] == ["3", "7"]
