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
# # What a turn makes observable
#
# **Question.** A camera sees three landmarks whose places are unknown, beside gyroscopes and accelerometers. Which
# errors of the navigator can it correct, and which motion does that take?
#
# The atlas holds the answer for ten manoeuvres: exact ranks over an interval, for generic parameters.

# %%
import navsym as nav

for name, cell in nav.atlas.items():
    model, manoeuvre, aiding = name.split(": ")
    if (model, aiding) == ("VIO", "three landmarks"):
        print(f"{manoeuvre:32} {cell.rank} of {cell.size}")

# %% [markdown]
# In general motion four directions stay open: a turn about gravity and a shift of everything. A turn at constant
# speed hides more, among it the scale of the scene.

# %%
turn = nav.atlas["VIO: level turn: three landmarks"]
general = nav.atlas["VIO: figure eight with changing bank: three landmarks"]
print(*turn.unobservable, sep="\n")
assert "scale" in turn.unobservable and "scale" not in general.unobservable
assert general.rank == general.size - 4

# %% [markdown]
# Each cell has its error model, so that the question can be asked again, with other measurements or with numbers. At
# rest a position shows the tilts and the heading only together with biases; at the poles (`uN = 0`) one direction
# more is lost.

# %%
cell = nav.atlas["INS: rest: position"]
answer = nav.observe(cell.model)
print(answer.rank, cell.drops)
assert answer.rank == cell.rank
print(nav.observe(cell.model, uN=0).rank)
assert nav.observe(cell.model, uN=0).rank == cell.drops["uN = 0"]
