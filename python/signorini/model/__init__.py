"""What the engineer said: the plate, its supports and its loads, under the names of the input file.

``Model`` is the whole; the other classes are its tables. All are immutable. What is wrong with them is said in an
``InputError``, everything at once; ``validate`` makes a ``Model`` of a mapping that was read somewhere.
"""

from signorini.model.area import Area, Circle
from signorini.model.combination import Combination, Factors
from signorini.model.generated import Combinations
from signorini.model.load import Load, Probe
from signorini.model.material import Material
from signorini.model.meshoptions import MeshOptions, Refinement
from signorini.model.moving import Moving
from signorini.model.output import ENVELOPED, Output
from signorini.model.plate import (
    AnnulusPlate,
    DiscPlate,
    MeshPlate,
    OutlinedPlate,
    PolygonPlate,
    RectanglePlate,
)
from signorini.model.section import Section, Strip
from signorini.model.support import Support
from signorini.model.validation import validate
from signorini.model.whole import Model, Solver, Units
from signorini.model.zone import Zone

Plate = RectanglePlate | DiscPlate | AnnulusPlate | PolygonPlate | MeshPlate

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
    "Units",
    "Zone",
    "validate",
]
