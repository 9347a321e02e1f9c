"""Contact of areas, from the deflection field rather than from quadrature points: pressure, extent, edge."""
