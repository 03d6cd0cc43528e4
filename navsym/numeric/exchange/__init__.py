"""Exchange searches for the guaranteed estimator, in double and in twofold precision."""
