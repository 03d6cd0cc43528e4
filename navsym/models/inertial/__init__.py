"""Error equations of an inertial navigation system."""
