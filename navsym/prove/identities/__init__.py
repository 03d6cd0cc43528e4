"""Equal or not: normal forms of quotients, exponentials, angles and roots."""
