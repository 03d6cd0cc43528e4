"""The Kalman filter, one step at a time, in covariance and square-root forms."""
