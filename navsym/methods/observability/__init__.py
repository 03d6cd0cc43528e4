"""What each measurement observes, exactly and for symbols, and the splits that follow."""
