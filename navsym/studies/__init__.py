"""Studies of many jobs on one machine or a cluster."""
