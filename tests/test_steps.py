"""Long work in steps: shared by those who want it, left by those who are cancelled."""

import gc
import weakref

import pytest

from scuro.steps import Sharing, finished
from scuro.viewer.jobs import in_turns


def counting(taken, count=4, made="made"):
    for step in range(count):
        taken.append(step)
        yield (step + 1) / count
    return made


def rest(steps):
    """All shares that are left, and what was made."""
    shares = []
    while True:
        try:
            shares.append(next(steps))
        except StopIteration as end:
            return shares, end.value


def test_steps_of_one_work_are_taken_in_turn():
    sharing, taken = Sharing(), []
    one, other = (sharing.steps("a", lambda: counting(taken)) for _ in range(2))
    assert [next(one), next(other), next(one), next(other)] == [0.25, 0.5, 0.75, 1.0]
    assert rest(one) == ([], "made")
    assert rest(other) == ([], "made")
    assert taken == [0, 1, 2, 3]


def test_another_work_has_its_own_steps():
    sharing, taken = Sharing(), []
    one = sharing.steps("a", lambda: counting(taken))
    next(one)
    assert finished(sharing.steps("b", lambda: counting([], made="b"))) == "b"
    assert rest(one) == ([0.5, 0.75, 1.0], "made")


def test_work_goes_on_when_one_of_its_takers_leaves_and_goes_with_the_last():
    sharing, taken = Sharing(), []
    work = counting(taken)
    gone = weakref.ref(work)
    steps = [work]
    del work
    one, other = (sharing.steps("a", lambda: steps.pop()) for _ in range(2))
    next(one), next(other)
    one.close()
    del one
    assert next(other) == 0.75
    other.close()
    del other
    gc.collect()
    assert gone() is None, "work that nobody wants holds what it has made so far"


def test_a_fault_reaches_all_who_take_the_steps():
    def failing():
        yield 0.5
        raise ValueError("no")

    sharing = Sharing()
    one, other = (sharing.steps("a", failing) for _ in range(2))
    next(one)
    for steps in (other, one):
        with pytest.raises(ValueError, match="no"):
            next(steps)
    assert finished(sharing.steps("a", lambda: counting([]))) == "made", "faults are not kept"


def test_a_taker_waits_while_another_has_given_way_within_a_step():
    sharing = Sharing()

    def draw(pause):
        def steps():
            pause(0.3)  # such as for a pipeline
            yield 0.5
            return "made"

        for share in sharing.steps("a", steps):
            pause(share)

    turns = in_turns(draw)
    next(turns)
    assert next(turns) == 0.3
    other = sharing.steps("a", lambda: counting([], made="twice"))
    assert [next(other) for _ in range(3)] == [0.0, 0.0, 0.0]
    assert next(turns) == 0.5
    assert rest(other) == ([], "made")
    turns.close()


def test_a_taker_who_is_cancelled_within_a_step_leaves_the_others_to_begin_anew():
    sharing = Sharing()

    def draw(pause):
        def steps():
            pause(0.3)
            yield 0.5

        for share in sharing.steps("a", steps):
            pause(share)

    turns = in_turns(draw)
    next(turns), next(turns)
    other = sharing.steps("a", lambda: counting([], made="anew"))
    next(other)
    turns.close()
    assert rest(other) == ([0.25, 0.5, 0.75, 1.0], "anew")
