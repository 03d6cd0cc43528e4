"""What every subject needs: errors, exact numbers, balls, arrays, compiled loops, child processes, the store."""
