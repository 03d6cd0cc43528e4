"""Kalman's two steps, plain and on factors of the covariance."""
