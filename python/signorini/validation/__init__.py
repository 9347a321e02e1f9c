"""Validation: published cases, solved on several meshes and compared with their references."""

from signorini.validation.case import Case, Number
from signorini.validation.catalogue import cases
from signorini.validation.pages import names_of, write_pages
from signorini.validation.runner import Outcome, outcomes

__all__ = ["Case", "Number", "Outcome", "cases", "names_of", "outcomes", "write_pages"]
