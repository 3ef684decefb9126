"""Maps of a machine as polynomials, and what they give at a point."""
