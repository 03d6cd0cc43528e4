"""The guaranteed estimator epoch by epoch: discrete measurements, exact times, an enclosed radius at every one."""
