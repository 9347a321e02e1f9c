"""Contact of areas from the deflection field instead of quadrature points: pressure, contact area, edge of contact."""
