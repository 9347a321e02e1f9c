"""Contact of an area, from the deflection field rather than from its quadrature points: pressure, extent, edge."""

from signorini.results.contact_field.area_contact import AreaContact

__all__ = ["AreaContact"]
