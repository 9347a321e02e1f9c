"""Contact of areas, from the deflection field rather than from quadrature points: pressure, extent, edge."""

from signorini.results.contact_field.area_contact import AreaContact
from signorini.results.contact_field.pressures import Pressures
from signorini.results.contact_field.shared_borders import without_shared_borders

__all__ = ["AreaContact", "Pressures", "without_shared_borders"]
