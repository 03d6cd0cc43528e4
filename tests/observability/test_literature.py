"""Published examples of identifiability and observability, with the answers of their authors.

Unknown constants are states with the derivative zero; n is the number of states, the second number the rank.
"""

from __future__ import annotations

import pytest

import navsym as nav
from navsym.observability.certificates import Certifier

REAL = "real"
QUATERNION = [
    "(-q1*(w1 - b1) - q2*(w2 - b2) - q3*(w3 - b3))/2",
    "(q0*(w1 - b1) + q2*(w3 - b3) - q3*(w2 - b2))/2",
    "(q0*(w2 - b2) - q1*(w3 - b3) + q3*(w1 - b1))/2",
    "(q0*(w3 - b3) + q1*(w2 - b2) - q2*(w1 - b1))/2",
    *["0"] * 3,
]
GRAVITY = ["2*(q1*q3 - q0*q2)", "2*(q2*q3 + q0*q1)", "q0**2 - q1**2 - q2**2 + q3**2"]
NORTH = ["q0**2 + q1**2 - q2**2 - q3**2", "2*(q1*q2 - q0*q3)", "2*(q1*q3 + q0*q2)"]
RATES = {"w1": REAL, "w2": REAL, "w3": REAL}
UNIT = {"relations": ["q0**2 + q1**2 + q2**2 + q3**2 = 1"]}

#: name and source, states, dynamics, measurements, rank, further arguments of the model
EXAMPLES = [
    # Bellman and Astrom 1970; Godfrey 1983: elimination and exchange, seen and driven in the first compartment
    ("two compartments", "x1 x2 a b c", "c*x2 - (a + b)*x1 + u; a*x1 - c*x2; 0; 0; 0", "x1", 5, {"u": "nonzero"}),
    ("two compartments, no input", "x1 x2 a b c", "c*x2 - (a + b)*x1; a*x1 - c*x2; 0; 0; 0", "x1", 4, {}),
    # Bellman and Astrom 1970: a second elimination cannot be told from the first
    ("two eliminations", "x1 x2 a b c d", "c*x2 - (a + b)*x1 + u; a*x1 - (c + d)*x2; 0; 0; 0; 0", "x1", 5, {"u": REAL}),
    # Michaelis and Menten's elimination, concentration seen or scaled by an unknown volume (Godfrey 1983)
    ("Michaelis-Menten", "x V K", "-V*x/(K + x); 0; 0", "x", 3, {}),
    ("Michaelis-Menten, scaled", "x V K k", "-V*x/(K + x); 0; 0; 0", "k*x", 3, {}),
    # Lotka and Volterra with the prey seen: the unit of the predator is free (SIAN, Hong et al. 2020)
    ("predator and prey", "x y a b c d", "a*x - b*x*y; -c*y + d*x*y; 0; 0; 0; 0", "x", 5, {}),
    # Perelson's HIV model (Miao et al. 2011): the virus alone leaves the unit of the cells free
    ("HIV, virus", "T U V l r n d c N", "l - r*T - n*T*V; n*T*V - d*U; N*d*U - c*V; 0; 0; 0; 0; 0; 0", "V", 8, {}),
    (
        "HIV, both",
        "T U V l r n d c N",
        "l - r*T - n*T*V; n*T*V - d*U; N*d*U - c*V; 0; 0; 0; 0; 0; 0",
        "V; T + U",
        9,
        {},
    ),
    # Tuncer and Le 2018: prevalence with a known population; with an unknown reported share
    ("SIR, prevalence", "S I b g", "-b*S*I; b*S*I - g*I; 0; 0", "I", 4, {}),
    ("SIR, reported share", "S I b g k", "-b*S*I; b*S*I - g*I; 0; 0; 0", "k*I", 4, {}),
    # Saccomani et al. 2003 (DAISY) and others
    ("FitzHugh-Nagumo", "V R a b c", "c*(V - V**3/3 + R); -(V - a + b*R)/c; 0; 0; 0", "V", 5, {}),
    ("Lorenz", "x y z s r b", "s*(y - x); r*x - y - x*z; x*y - b*z; 0; 0; 0", "x", 6, {}),
    ("Goodwin", "x y z a b c d e f", "a/(1 + z) - b*x; c*x - d*y; e*y - f*z; 0; 0; 0; 0; 0; 0", "x", 8, {}),
    # Vajda and Rabitz 1994: two reactions in a row, the middle substance seen; the rates may be exchanged, no more
    ("two reactions", "x y k l", "-k*x; k*x - l*y; 0; 0", "y", 4, {}),
    # Tuncer and Le 2018: a latent class; again with an unknown reported share
    ("SEIR, prevalence", "S E I b n g", "-b*S*I; b*S*I - n*E; n*E - g*I; 0; 0; 0", "I", 6, {}),
    ("SEIR, reported share", "S E I b n g k", "-b*S*I; b*S*I - n*E; n*E - g*I; 0; 0; 0; 0", "k*I", 6, {}),
    # Holmberg 1982: Monod's growth; without the substrate its unit is free
    ("Monod, both", "x s m K d Y", "m*x*s/(K + s) - d*x; -m*x*s/(Y*(K + s)); 0; 0; 0; 0", "x; s", 6, {}),
    ("Monod, biomass", "x s m K d Y", "m*x*s/(K + s) - d*x; -m*x*s/(Y*(K + s)); 0; 0; 0; 0", "x", 5, {}),
    # Bergman et al. 1979: the minimal model of glucose, with insulin known; at a steady level p + X is all that is seen
    (
        "minimal model",
        "G X p q r B",
        "-(p + X)*G + p*B; -q*X + r*u; 0; 0; 0; 0",
        "G",
        6,
        {"u": "nonzero", "k": "positive", "rates": {"u": "-k*u"}},
    ),
    ("minimal model, steady", "G X p q r B", "-(p + X)*G + p*B; -q*X + r*u; 0; 0; 0; 0", "G", 5, {"u": "nonzero"}),
    # Godfrey 1983: a constant supply into an unknown volume
    ("supply and volume", "x a k V", "a - k*x; 0; 0; 0", "x/V", 3, {}),
    # Ljung and Glad 1994: a pendulum shows gravity over length only
    ("pendulum", "p w g l", "w; -g/l*sin(p); 0; 0", "p", 3, {}),
    # Song 1996: ranges of a target that turns away from a straight line show all but a reflection
    ("ranges, manoeuvre", "x y u v", "u; v; a; c", "sqrt(x**2 + y**2)", 4, {"a": REAL, "c": REAL}),
    # Nardone and Aidala 1981: bearings of a target that flies straight leave its range open; a manoeuvre shows it
    ("bearings, straight", "x y u v", "u; v; 0; 0", "atan2(y, x)", 3, {}),
    ("bearings, manoeuvre", "x y u v", "u; v; a; c", "atan2(y, x)", 4, {"a": REAL, "c": REAL}),
    ("ranges, straight", "x y u v", "u; v; 0; 0", "sqrt(x**2 + y**2)", 3, {}),
    # Martinelli and Siegwart 2006: a robot that sees one mark from an unknown heading may be turned about it
    ("one bearing", "x y p", "v*cos(p); v*sin(p); w", "atan2(-y, -x) - p", 2, {"v": "nonzero", "w": "nonzero"}),
    # Huang, Mourikis and Roumeliotis 2010: position and heading of the whole map stay open
    ("planar SLAM", "x y p a b", "v*cos(p); v*sin(p); w; 0; 0", "atan2(b - y, a - x) - p", 2, {"v": REAL, "w": REAL}),
    # Mahony, Hamel and Pflimlin 2008: gravity leaves the heading open, two directions show attitude and drifts
    ("attitude from gravity", "q0 q1 q2 q3 b1 b2 b3", QUATERNION, GRAVITY, 6, UNIT | RATES),
    ("attitude from both", "q0 q1 q2 q3 b1 b2 b3", QUATERNION, [*GRAVITY, *NORTH], 7, UNIT | RATES),
]


#: Every other one in every run, the rest in the long ones.
SOME = [pytest.param(row, id=row[0], marks=[pytest.mark.long] * (k % 2)) for k, row in enumerate(EXAMPLES)]


@pytest.mark.parametrize("example", SOME)
def test_a_published_answer_is_found(example):
    _, states, dynamics, z, rank, further = example
    parts = (text.split(";") if isinstance(text, str) else text for text in (dynamics, z))
    f, h = ([part.strip() for part in listed] for listed in parts)
    answer = nav.observe(nav.Model(states, dynamics=f, H=h, **further))
    assert (answer.rank, answer.joint.proved) == (rank, True)
    assert Certifier.of(answer.model).certify_rank(answer.joint)["kind"] == "observability"
