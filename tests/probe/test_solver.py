"""The probe against closed forms, and random walks that must never end inside an atom."""

import math
import time

import numpy as np
import pytest

pytest.importorskip("numba", reason="needs the viewer extra")

from scuro.probe.solver import SLACK, Constraint

PROBE = 1.4
TOLERANCE = 2e-5


def constraint(centers, radii, probe=PROBE):
    return Constraint(np.array(centers, float), np.array(radii, float), probe)


def settled(c, position, target, updates=60):
    for _ in range(updates):
        position = c.moved(position, target)
    return position


def test_without_atoms_the_probe_is_where_the_hand_is():
    c = Constraint(np.zeros((0, 3)), np.zeros(0), PROBE)
    assert c.moved((0, 0, 0), (3, 4, 5)) == pytest.approx((3, 4, 5))


def test_on_one_sphere_it_rests_at_the_point_nearest_to_the_hand():
    c = constraint([(1, 2, 3)], [1.7])
    center, reach = np.array([1, 2, 3]), 1.7 + PROBE
    for start, target in (((10, 2, 3), (2, 2.5, 3)), ((1, 9, 3), (1.5, 2.5, 3.5))):
        direction = np.subtract(target, center) / np.linalg.norm(np.subtract(target, center))
        assert settled(c, start, target) == pytest.approx(center + reach * direction, abs=TOLERANCE)


def test_in_the_crevice_of_two_spheres_it_rests_on_their_circle():
    # equal spheres at x = ±1.5: contact circle of radius sqrt(reach² - 1.5²) in the plane x = 0
    c = constraint([(-1.5, 0, 0), (1.5, 0, 0)], [1.7, 1.7])
    circle = math.sqrt((1.7 + PROBE) ** 2 - 1.5**2)
    assert settled(c, (0.4, 9, 0), (0.05, 0, 0)) == pytest.approx((0, circle, 0), abs=1e-3)
    assert settled(c, (0, 9, 0), (0, 0.5, 0.5)) == pytest.approx(
        (0, circle / math.sqrt(2), circle / math.sqrt(2)), abs=1e-3
    )


def test_in_the_crevice_of_three_spheres_it_rests_on_the_closed_form_point():
    # an equilateral triangle of centres at distance d from the axis
    d = 2.0
    angles = np.radians([90, 210, 330])
    c = constraint(np.stack([d * np.cos(angles), d * np.sin(angles), 0 * angles], 1), [1.7] * 3)
    height = math.sqrt((1.7 + PROBE) ** 2 - d**2)
    rest = settled(c, (0.3, -0.2, 8), (0.02, 0.01, 0))
    assert rest == pytest.approx((0, 0, height), abs=TOLERANCE)


@pytest.mark.parametrize("gap", [-1e-3, 1e-3])
def test_a_gap_just_too_small_stops_it_and_one_just_wide_enough_does_not(gap):
    half = 1.7 + PROBE + gap / 2
    c = constraint([(-half, 0, 0), (half, 0, 0), (0, half, 0), (0, -half, 0)], [1.7] * 4)
    end = settled(c, (0, 0, 8), (0, 0, -8))
    assert (end[2] < -7.9) == (gap > 0)
    assert c.depth(end) < 0


def test_no_speed_carries_it_through_a_wall():
    # spheres that overlap: no way through for the probe
    y, z = (a.ravel() for a in np.meshgrid(np.arange(-20, 21, 1.5), np.arange(-20, 21, 1.5)))
    c = constraint(np.stack([0 * y, y, z], 1), np.full(len(y), 1.7))
    for far in (5, 500, 5e6):
        end = c.moved((6, 0.3, 0.2), (-far, 0.3, 0.2))
        assert end[0] > 1.7 and c.depth(end) < 0


def test_it_slides_past_a_lone_sphere():
    c = constraint([(0, 0, 0)], [1.7])
    assert settled(c, (8, 0.5, 0), (-8, 0.5, 0)) == pytest.approx((-8, 0.5, 0), abs=1e-6)


def random_atoms(count, seed):
    generator = np.random.default_rng(seed)
    edge = np.cbrt(count * 12.0)
    return generator.uniform(0, edge, (count, 3)), generator.uniform(1.2, 2.0, count), edge


@pytest.mark.parametrize("seed", range(4))
def test_random_walks_never_end_inside_an_atom(seed):
    centers, radii, edge = random_atoms(2000, seed)
    c = constraint(centers, radii, 0.9)
    generator = np.random.default_rng(seed + 100)
    position = c.freed(np.full(3, edge / 2))
    assert c.depth(position) < 0
    wandered = 0.0
    for _ in range(1500):
        scale = 10 ** generator.uniform(-3, 2.5)
        before = position
        position = c.moved(position, position + generator.normal(0, scale, 3))
        wandered += np.linalg.norm(position - before)
        if not -edge < position[0] < 2 * edge:
            position = c.freed(generator.uniform(0, edge, 3))
        assert c.depth(position) < 0.0
    assert wandered > edge


def test_it_never_ends_farther_from_the_hand():
    centers, radii, edge = random_atoms(500, 7)
    c = constraint(centers, radii, 0.5)
    generator = np.random.default_rng(1)
    for _ in range(300):
        start = c.freed(generator.uniform(0, edge, 3))
        target = start + generator.normal(0, 4, 3)
        end = c.moved(start, target)
        assert np.linalg.norm(target - end) <= np.linalg.norm(target - start) + 10 * SLACK


def test_sixty_thousand_atoms_leave_time_for_a_thousand_updates_a_second():
    centers, radii, edge = random_atoms(60_000, 3)
    c = constraint(centers, radii)
    position = c.freed((edge / 2, edge / 2, edge))
    generator = np.random.default_rng(5)
    targets = generator.normal(0, 2, (300, 3)) + np.array([edge / 2, edge / 2, edge - 8])
    c.moved(position, targets[0])
    start = time.process_time()
    for target in targets:
        position = c.moved(position, target)
    assert time.process_time() - start < 0.3


def test_a_ray_meets_the_accessible_surface_where_it_enters_the_first_sphere():
    c = Constraint(np.array([[0.0, 0, 0], [0, 0, -5]]), np.array([1.6, 1.6]), 1.4)
    assert c.met((0.0, 0, 20), (0, 0, -1)) == pytest.approx([0, 0, 3], abs=1e-3)
    assert c.met((1.8, 0, 20), (0, 0, -2)) == pytest.approx([1.8, 0, 2.4], abs=1e-3)
    assert c.depth(c.met((1.8, 0, 20), (0, 0, -1))) < 0
    assert c.met((4.0, 0, 20), (0, 0, -1)) is None
    assert c.met((0.0, 0, 20), (0, 0, 1)) is None
    assert c.met((0.0, 0, 1), (0, 0, 1)) is None, "begins inside"
