# ---
# jupyter:
#   jupytext:
#     formats: py:percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Which convention is this filter?
#
# **Question.** A filter came without a word about its conventions. Its error model has position, velocity, attitude and
# biases of both sensors. Is the attitude error in the body or in the world? Is an error estimate minus truth? May
# its code be joined with that of another filter?

# %%
import tomllib
from pathlib import Path

import navsym as nav

MODEL = tomllib.loads(Path("examples/filter.toml").read_text())
answer = nav.conventions(MODEL)
for card in answer.cards:
    print(card.error, "| attitude error in the", card.attitude_error, card.rotation_sign, "| biases", card.bias_sign)
assert answer.complete and {card.attitude_error for card in answer.cards} == {"body"}

# %% [markdown]
# Two cards, which differ in the sign of every state: F alone cannot tell them apart. Each neighbour is excluded by an
# entry of F at a point.

# %%
for line in dict.fromkeys(f"{exclusion.field}: {exclusion.why}" for exclusion in answer.excluded):
    print(line)

# %% [markdown]
# The feedback tells the rest: this filter adds its corrections to the estimate, so an error is truth minus estimate.

# %%
(card,) = nav.conventions(MODEL, known={"frame": "inertial", "error": "truth - estimate"}).cards
print(card.words())

# %% [markdown]
# **A sign that is wrong.** The same filter with $+[\omega \times]$, as a public one once had it: no card is right, and
# the answer names the block.

# %%
opposite = {"w1": "-w1", "w2": "-w2", "w3": "-w3", "-w1": "w1", "-w2": "w2", "-w3": "w3"}
spoiled = [[opposite.get(entry, entry) for entry in row] for row in MODEL["model"]["F"]]
conflict = nav.conventions({**MODEL, "model": {**MODEL["model"], "F": spoiled}}).conflicts[0]
print(" by ".join(conflict.block), conflict.status, conflict.change)
assert conflict.block == ("attitude", "attitude") and conflict.status == "PROVED"

# %% [markdown]
# **Joined with another filter.** That one has its attitude error in the world. T leads from one to the other, and it is
# proved that $F_{to} T = T F + T'$.

# %%
conversion = answer.convert(attitude_error="frame")
print(conversion)
print("attitude rows of T:", *conversion.T[6:9], sep="\n  ")
assert conversion.proved

# %% [markdown]
# **From a card.** A file with a table `[card]` and no F asks for the model. All cards that mean the same model are the
# answer: in a flat world without rotation the frames and the axes do not matter.

# %%
derived = nav.conventions("examples/card.toml")
print(len(derived.cards), "cards:", sorted({(card.frame, card.axes or "any axes") for card in derived.cards}))
print(derived.model()["F"][0])
assert derived.complete

# %% [markdown]
# **Hamilton or JPL?** A filter as it is printed, in vectors, with a quaternion whose convention nobody wrote down. Two
# conventions are left, and they are the same rotation: the conjugate belongs to the other algebra.

# %%
ROTATION = "(eye(3) - 2*q[4]*skew([q[1], q[2], q[3]]) + 2*skew([q[1], q[2], q[3]]) @ skew([q[1], q[2], q[3]])).T"
PRINTED = {
    "model": {
        "states": ["dv[3]", "p[3]", "bg[3]", "ba[3]"],
        "dynamics": [f"-{ROTATION} @ (cross(f, p) + ba)", "-cross(w, p) - bg", "0", "0"],
    },
    "parameters": {"q": {"quaternion": "unit"}, "f": {"vector": 3}, "w": {"vector": 3}},
    "roles": {"velocity": "dv", "attitude": "p", "gyro_bias": "bg", "accelerometer_bias": "ba"},
    "quantities": {"quaternion": "q", "specific_force_body": "f", "angular_rate": "w"},
    "known": {"frame": "inertial", "error": "estimate - truth"},
}
found = nav.conventions(PRINTED)
for card in found.cards:
    print(card.quaternion_algebra, "|", card.quaternion_direction, "|", card.quaternion_order)
assert found.complete and {card.quaternion_algebra for card in found.cards} == {"Hamilton", "JPL"}
