"""Classes of the input: the plate, its supports and its loads, with the keys of the input file.

``Model`` is the whole input; the other classes are its tables. All these classes are immutable. One ``InputError``
lists every problem of an input. ``validate`` makes a ``Model`` from a mapping.
"""

from signorini.model.cases import Case, Gamma
from signorini.model.check import Check
from signorini.model.combination import Combination, Combinations, Factors
from signorini.model.field import FieldTable
from signorini.model.load import Axes, Load, Moving, Probe
from signorini.model.material import Material, Modifiers, Stiffness, Zone
from signorini.model.output import ENVELOPED, Output, Profile, Section, Strip
from signorini.model.places import Annulus, Arc, Area, Circle, Form, Hole
from signorini.model.plate import (
    AnnulusPlate,
    DiscPlate,
    MeshOptions,
    MeshPlate,
    OutlinedPlate,
    Plate,
    PolygonPlate,
    RectanglePlate,
    Refinement,
)
from signorini.model.punching import Punching
from signorini.model.reinforcement import Cover, Reinforcement
from signorini.model.report import Report
from signorini.model.support import Contact, Support
from signorini.model.tightening import Tightening
from signorini.model.whole import Model, Solver, Units, validate

# fmt: off
__all__ = [
    "ENVELOPED", "Annulus", "AnnulusPlate", "Arc", "Area", "Axes", "Case", "Check", "Circle", "Combination",
    "Combinations", "Contact", "Cover", "DiscPlate", "Factors", "FieldTable", "Form", "Gamma", "Hole", "Load",
    "Material", "MeshOptions", "MeshPlate", "Model", "Modifiers", "Moving", "OutlinedPlate", "Output", "Plate",
    "PolygonPlate", "Probe", "Profile", "Punching", "RectanglePlate", "Refinement", "Reinforcement", "Report",
    "Section", "Solver", "Stiffness", "Strip", "Support", "Tightening", "Units", "Zone", "validate",
]
# fmt: on
