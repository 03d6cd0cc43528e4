"""navsym: derive, decide, solve and export the theory of inertial-navigation aiding."""

__version__ = "0.1.0"
