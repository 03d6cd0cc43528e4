"""Why a candidate is the optimum, in balls: at one value and on ranges of a parameter."""
