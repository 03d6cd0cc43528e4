"""Is it positive? Exact signs, polynomials on cones, derivatives, balls on a divided box."""
