"""Discretisation of a model: mesh, plate, held dofs, springs, contact points and loads."""

from signorini.discretise.discretisation import CaseLoad, ContactPoints, Discretisation, Rows
from signorini.discretise.plates import discretise

__all__ = ["CaseLoad", "ContactPoints", "Discretisation", "Rows", "discretise"]
