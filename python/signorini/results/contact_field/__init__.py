"""Contact of area supports, computed from the deflection field: pressure, contact area, edge of contact."""
