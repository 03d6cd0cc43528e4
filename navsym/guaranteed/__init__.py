"""The estimator with the least guaranteed error: its problem, its search, its certificate, its phases."""
