"""Naumov and Kosyachenko: a sequential search for position and velocity errors over a terrain map.

The files follow the paper: ``problem`` (1)-(5), ``crossing`` (6)-(10) for one coordinate, ``directions``
(11)-(13) for two, ``extremes`` (t_min, t_max and their middle), ``solution`` (8), (14) and what the
sequential estimate really is, ``cost`` (complexity and its numbers), ``experiment`` (noise, accuracy
measures, table 1), ``reading`` (what its figures would mean), ``degenerate`` (beyond the paper: where nothing can be
told).

**The simple form.** With the slopes g_k of the map under the track and the times k, three symmetric matrices
say everything: G = sum g g', M1 = sum k g g', M2 = sum k^2 g g'. A velocity error v moves the position fix by
C v, C = G^-1 M1. The scalar t_G of the paper is the Rayleigh quotient v'M1 v / v'G v; its extremes are the
eigenvalues of C, always real; the quadratic (12) is the condition that v be an eigenvector. Turning the
track about C instead of t_G makes the two stages together the joint least-squares solution.
"""

from navsym.claims import Paper

PAPER = Paper(
    module="terrain_search",
    title="A sequential algorithm of correction of navigation parameters in a terrain navigation system",
    authors=("A. I. Naumov", "S. A. Kosyachenko"),
    year=None,
    source="manuscript with its editors' questions",
    language="Russian",
    equations=tuple(str(number) for number in range(1, 15)),
    definitions={
        "1": "the error model of the inertial system: given, and used by 4, 6, 8 and 14",
        "3": "the estimate is defined as the grid point of the smallest criterion",
        "5": "the estimate is defined as the grid point of the smallest criterion",
        "7": "the estimate is defined as the grid point of the smallest criterion",
    },
    beside=(
        "2.c* 6.time 9.angle 9.crossing 9.sum 10.weights 10.minimum 10.equal* 10.informative 11.several 13.sign* "
        "13.same"
    ),
    remarks=(
        "1.height 6.rest 9.family 9.small 10.after 10.before 10.sufficient 10.unique 10.flat 11.beta 12.linear* "
        "bias.mirror bias.only_way bias.units cost.experiment grid.experiment cost.total middle.trace noise roots.both "
        "roots.values roots.gram roots.solvable flat mean.* interval.half interval.whole sigma.mean sigma.table "
        "sigmaV.cell sigmaV.floor table.bias* table.close.mean table.grid* table.percent table.runs* "
        "table.quantisation table.acceleration* table.real_time table.sequential"
    ),
    beyond="joint.* centre sequential.* 14.centre acceleration offset*",
    causes={"13.sign0": "13.Ay0", "9.sum": "9", "sigmaV.unit": "sigma.unit"},
    scopes={
        "1.height": "2 to 4 measurements",
        "2.cost": "half counts to 3",
        "grid.count": "half counts to 20",
        "6.time": "tracks of 2 to 4 measurements",
        "9": "heights of degree 3 across the track",
        "9.sum": "tracks of 2 to 4 measurements",
        "10": "tracks of 2 to 5 measurements",
        "10.weights": "tracks of 4 measurements",
        "10.after": "tracks of 4 measurements",
        "10.before": "tracks of 4 measurements",
        "10.minimum": "tracks of 3 measurements",
        "10.unique": "tracks of 2 measurements",
        "10.sufficient": "tracks of 2 to 4 measurements",
        "10.equal": "n = 1 to 10; 10.equal.sum for every n",
        "11": "tracks of 2 to 4 measurements",
        "11.beta": "",
        "12.linear": "tracks of 2 to 4 measurements",
        "13.same": "tracks of 2 to 4 measurements",
        "12.A*": "tracks of 2 and 3 measurements",
        "13.A*": "tracks of 2 and 3 measurements",
        "13.sign*": "tracks of 2 and 3 measurements",
        "1[23]": "tracks of 2 and 3 measurements",
        "bias.mean": "tracks of 2 and 3 measurements",
        "bias.mirror": "tracks of 3 and 5 measurements",
        "bias.only_way": "tracks of 2 measurements",
        "sigma.unit": "3 runs",
        "sigmaV.unit": "2 runs",
        "case1.value": "tracks of 2 to 4 measurements",
        "case1": "tracks of 2 and 3 measurements",
        "roots.gram": "tracks of 2 to 4 measurements",
        "flat": "tracks of 2 to 4 measurements",
        "joint.determinant": "tracks of 2 to 5 measurements",
        "joint.quadratic.second": "tracks of 4 measurements",
        "joint.four": "",
        "joint.[hfqn]*": "tracks of 5 measurements",
        "offset.centre": "tracks of 3 and 4 measurements",
        "offset": "tracks of 4 measurements",
        "acceleration": "n = 2 to 7",
    },
    typed=(
        "table.full gain run.count 6.time 10.equal.sum table.quantisation table.acceleration.white "
        "grid.experiment table.close.mean roots mean.primitives grid.count 2.cost 1.height "
        "velocity.grid offset.groups offset"
    ),
    left_out={
        "sigma over n - 1": "a convention; about a known truth n makes the mean square unbiased",
        "accuracy close to that of the joint search": "by table 1 only (table.close)",
        "the editors' questions in the manuscript": "no statements of the authors; one asks for the time of t_G: "
        "O(n) operations by 12.linear, O(n^2) by the printed double sums",
        "below the bias: joint estimation is the only way to remove it": "a judgement; bias.only_way shows the instant "
        "at which the position search is right on average",
        "below table 1: practically the same time, a considerable advantage; existing computers": "judgements",
        "below (10): the slope says how likely tracks are told apart": "no probability is given; 10.informative",
        "the hypotheses (delta x_i, delta y_i) for (delta x_i, delta y_j), solution (6) for (10), (9*) for (9), the "
        "bracket missing in (6)": "letters, nothing to compute",
        "the index of the velocity step in (8)": "illegible in the copy",
        "(3), (14): delta x*, delta y* as errors": "a convention of sign: what is added to the indicated position has "
        "the sign opposite to the error of (1)",
        "the error of a height, N(0.015 (h_abs - h_rv)) + delta h_rv": "a model of the noise, given; N has one of two "
        "arguments, and h_abs - h_rv is the height of the ground: noise takes the height above it",
        "(6): t_G as the most probable instant of crossing": "no probability is given; (10) is the least criterion",
    },
)
