"""Forces through sections, in equilibrium with loads and reactions to rounding."""

from signorini.discretise.sections.sections import Sections

__all__ = ["Sections"]
