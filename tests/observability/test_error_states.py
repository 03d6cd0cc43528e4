"""A nonlinear model and its error equations in other coordinates: one rank, the same drops, directions mapped.

A vehicle in the plane: position, velocity and heading in the frame, a gyro bias. Its errors are resolved in the body.
"""

from __future__ import annotations

import itertools

import pytest
import sympy as sp

import navsym as nav

#: What the frame shows, and the same as rows of the errors in the body.
AIDINGS = {
    "position": (["N", "E"], ["p", "q"]),
    "heading": (["h"], ["e"]),
    "speed over ground": (["u*cos(h) + v*sin(h)"], ["s + l*e"]),
    "both speeds": (["u*cos(h) + v*sin(h)", "v*cos(h) - u*sin(h)"], ["s + l*e", "r - m*e"]),
    "speed and heading": (["u*cos(h) + v*sin(h)", "h"], ["s + l*e", "e"]),
}


def vehicle(H):
    """The motion itself: f is the force along the vehicle, w what the gyro shows."""
    f = ["u", "v", "f*cos(h)", "f*sin(h)", "w - b", "0"]
    return nav.observe(nav.Model("N E u v h b", dynamics=f, H=H, f="real", w="real", a="real", rates={"f": "a"}))


def errors(H):
    """Errors (p, q) of position and (s, r) of velocity in the body, which turns with k and moves with (m, l)."""
    F = [[0, "k", 1, 0, 0, 0], ["-k", 0, 0, 1, 0, 0], [0, 0, 0, "k", 0, 0], [0, 0, "-k", 0, "f", 0], [0] * 5 + [-1]]
    symbols = dict.fromkeys("fkaml", "real")
    rates = {"f": "a", "m": "f + k*l", "l": "-k*m"}
    return nav.observe(nav.Model("p q s r e d", F=[*F, [0] * 6], H=H, rates=rates, **symbols))


def ranks_at(answer, at):
    """Ranks that the lasting conditions leave which hold at a point."""
    drops = [drop for drop in answer.rank_drops if drop.subspace == "joint" and drop.lasting]
    return sorted(drop.rank for drop in drops if all(zero.subs(at) == 0 for zero in drop.zeros))


@pytest.mark.parametrize("aiding", AIDINGS)
def test_the_nonlinear_answer_is_that_of_its_error_equations(aiding):
    frame, body = AIDINGS[aiding]
    whole, small = vehicle(frame), errors(body)
    assert whole.rank == small.rank and whole.joint.proved and small.joint.proved
    complete = whole.rank_drops_complete["joint"] and small.rank_drops_complete["joint"]
    assert complete or aiding == "speed over ground"
    T = sp.diag(TURN, TURN, 1, 1)
    for values in itertools.product((0, 3), (0, -2), (0, 1), (0, 2), (4, 5)):
        frame_at, body_at = points(*values)
        assert not complete or ranks_at(whole, frame_at) == ranks_at(small, body_at), values
    frame_at, body_at = points(3, -2, 1, 2, 5)
    mapped = (T * whole.unobservable_basis.T).T.subs(frame_at)
    own = small.unobservable_basis.subs(body_at)
    assert mapped.rank() == own.rank() == 6 - whole.rank == sp.Matrix.vstack(mapped, own).rank()


COSINE, SINE = sp.Rational(3, 5), sp.Rational(4, 5)
TURN = sp.Matrix([[COSINE, SINE], [-SINE, COSINE]])


def points(u, v, f, a, w, b=4):
    """A point of the motion in the frame, and the same in the body."""
    m, l = TURN * sp.Matrix([u, v])
    named = lambda **values: {sp.Symbol(name, real=True): x for name, x in values.items()}  # noqa: E731
    h = sp.Symbol("h", real=True)
    turn = {sp.cos(h): COSINE, sp.sin(h): SINE}
    return turn | named(u=u, v=v, f=f, a=a, w=w, b=b), named(m=m, l=l, f=f, a=a, k=w - b)
