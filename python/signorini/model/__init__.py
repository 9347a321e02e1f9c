"""What the engineer said: the plate, its supports and its loads, under the names of the input file.

``Model`` is the whole; the other classes are its tables. All are immutable. What is wrong with them is said in an
``InputError``, everything at once; ``validate`` makes a ``Model`` of a mapping that was read somewhere.
"""

from signorini.model.combination import Combination, Combinations, Factors
from signorini.model.load import Load, Moving, Probe
from signorini.model.material import Material, Zone
from signorini.model.output import ENVELOPED, Output, Section, Strip
from signorini.model.places import Area, Circle
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
from signorini.model.support import Support
from signorini.model.tightening import Tightening
from signorini.model.whole import Model, Solver, Units, validate

__all__ = [
    "ENVELOPED",
    "AnnulusPlate",
    "Area",
    "Circle",
    "Combination",
    "Combinations",
    "DiscPlate",
    "Factors",
    "Load",
    "Material",
    "MeshOptions",
    "MeshPlate",
    "Model",
    "Moving",
    "OutlinedPlate",
    "Output",
    "Plate",
    "PolygonPlate",
    "Probe",
    "RectanglePlate",
    "Refinement",
    "Section",
    "Solver",
    "Strip",
    "Support",
    "Tightening",
    "Units",
    "Zone",
    "validate",
]
