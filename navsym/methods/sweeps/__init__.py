"""Studies of many independent jobs."""
