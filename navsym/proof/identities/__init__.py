"""Is it equal? Normal form, radicals, logarithms, inverse functions, cases."""
