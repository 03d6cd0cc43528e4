"""Where the optimum lies, in doubles: the exchange over contacts."""
