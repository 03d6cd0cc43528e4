"""Is it optimal? Certificates of the guaranteed estimator, at one value and over a range of a parameter."""
