"""The worst-correlation estimator of a linear model, with a certificate."""
