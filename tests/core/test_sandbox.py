"""Children with limits: what does not end is ended, what only waits for the processor is not."""

from __future__ import annotations

import mmap
import multiprocessing
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from navsym.core import sandbox
from navsym.core.errors import DomainError
from navsym.core.sandbox import Exhausted, Failed, run_limited, run_many

ROOT = Path(__file__).parents[2]


def spin(seconds):
    """Use the processor for so many seconds of its own clock."""
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass
    return seconds


def refuse(_):
    raise DomainError("expected something else")


def test_every_item_has_its_outcome_whatever_became_of_the_others():
    found = {outcome.place: outcome.value for outcome in run_many(spin, [0.01, 60, 0.02], 2, seconds=1)}
    assert found[0] == 0.01 and found[2] == 0.02
    assert found[1] == Exhausted("more than 1 s")


def meet(fate):
    """Come back with the number of this process, or do not."""
    if fate == "late":
        spin(60)
    if fate == "dead":
        os._exit(3)
    if fate == "wrong":
        raise ValueError("nobody expected this")
    return refuse(fate) if fate == "refused" else os.getpid()


def test_items_of_one_child_have_their_own_outcomes_whatever_became_of_those_before():
    fates = ["fine", "refused", "fine", "late", "fine", "dead", "fine", "wrong", "fine"]
    outcomes = list(run_many(meet, fates, 1, seconds=1, share=9))
    assert [outcome.place for outcome in outcomes] == [*range(9)]
    first, refused, second, late, third, dead, fourth, wrong, last = (outcome.value for outcome in outcomes)
    assert first == second and len({second, third, fourth, last, os.getpid()}) == 5
    assert isinstance(refused, Failed) and late == Exhausted("more than 1 s")
    assert dead == Exhausted("the child ended without a result (exit 3)")
    assert wrong == Exhausted("ValueError: nobody expected this")


def test_the_seconds_are_those_of_one_item_and_not_of_its_child(monkeypatch):
    monkeypatch.setattr(sandbox, "PATIENCE", 100)
    assert [outcome.value for outcome in run_many(spin, [0.1] * 8, 1, seconds=0.5, share=8)] == [0.1] * 8


HELD = []


def hold(megabytes):
    HELD.append(bytearray(megabytes * 2**20))
    return megabytes


def test_what_has_too_little_memory_beside_those_before_it_is_decided_alone():
    outcomes = list(run_many(hold, [200] * 5 + [900], 1, megabytes=700, share=6))
    assert [outcome.value for outcome in outcomes] == [200] * 5 + [Exhausted("more than 700 MB of memory")]


@pytest.mark.parametrize("share", [1, 2, 3, 7, 50])
def test_every_item_has_one_outcome_however_many_a_child_has(share):
    outcomes = {outcome.place: outcome.value for outcome in run_many(str, range(7), 2, share=share)}
    assert outcomes == {place: str(place) for place in range(7)}


def test_what_sleeps_is_ended_by_the_clock(monkeypatch):
    monkeypatch.setattr(sandbox, "PATIENCE", 2)
    began = time.monotonic()
    assert run_limited(time.sleep, (60,), seconds=0.5) == Exhausted("more than 0.5 s")
    assert 1 <= time.monotonic() - began < 20


@pytest.mark.long
def test_a_busy_machine_does_not_use_up_the_time_of_a_child(monkeypatch):
    """Eight children at once on few cores: by the clock each takes longer than its limit, by its own time none does."""
    monkeypatch.setattr(sandbox, "PATIENCE", 100)  # the machine may be busy with others too
    outcomes = list(run_many(spin, [0.5] * 8, 8, seconds=0.9))
    assert [outcome.value for outcome in outcomes] == [0.5] * 8


def test_an_error_of_the_user_comes_back_as_itself():
    (outcome,) = run_many(refuse, [0], 1)
    assert isinstance(outcome.value, Failed)
    with pytest.raises(DomainError):
        run_limited(refuse, (0,))


class Unsendable(ValueError):
    """An error with something that no pipe carries."""

    def __init__(self):
        super().__init__("inside")
        self.held = (x for x in ())


def refuse_after_another(_):
    try:
        raise Unsendable
    except Unsendable as error:
        raise DomainError("expected something else") from error


def test_an_error_comes_back_where_errors_are_sent_with_all_that_led_to_them():
    program = (
        "from tests.core.test_sandbox import refuse_after_another, run_limited, DomainError\n"
        "from tblib import pickling_support; pickling_support.install()\n"
        "try: print(run_limited(refuse_after_another, (0,)))\n"
        "except DomainError as error: print('refused', error)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert done.stdout == "refused expected something else\n", done.stderr


def test_no_child_is_left():
    list(run_many(spin, [0.01, 60], 2, seconds=0.2))
    assert multiprocessing.active_children() == []


@pytest.mark.parametrize("seconds", [0, -1, float("nan"), float("inf"), 1e308])
def test_a_limit_that_no_child_can_have_is_refused(seconds):
    with pytest.raises(DomainError, match="expected seconds above 0"):
        list(run_many(spin, [0.01], 1, seconds=seconds))


def shout(_):
    """What a C library does when it gives up: it writes to the descriptor itself."""
    os.write(1, b"no memory")


def test_what_a_child_writes_does_not_reach_standard_output(capfd):
    assert run_limited(shout, (0,)) is None
    assert capfd.readouterr() == ("", "no memory")


def test_a_child_has_its_memory_whatever_its_parent_holds() -> None:
    held = mmap.mmap(-1, 3 * 2**30)
    assert run_limited(lambda size: len(bytes(size)), (2**28,), 60.0, 2048) == 2**28
    assert isinstance(run_limited(lambda size: len(bytes(size)), (2**31,), 60.0, 1024), Exhausted)
    held.close()
