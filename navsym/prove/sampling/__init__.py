"""Points at which a statement may fail, and a second look where none was found."""
