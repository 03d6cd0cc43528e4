"""The atlas of observability: error models of navigation by aiding and manoeuvre, computed cell by cell."""
