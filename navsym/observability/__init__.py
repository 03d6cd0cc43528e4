"""What a measurement observes, where that breaks, and how a system splits."""
