"""What the engineer said: the plate, its supports and its loads, under the names of the input file.

``Model`` is the whole; the other classes are its tables. All are immutable. What is wrong with them is said in an
``InputError``, everything at once; ``validate`` makes a ``Model`` of a mapping that was read somewhere.
"""

from signorini.model.area import Area, Circle
from signorini.model.load import Combination, Factors, Load, Probe
from signorini.model.plate import AnnulusPlate, DiscPlate, Material, MeshOptions, MeshPlate, RectanglePlate
from signorini.model.problems import validate
from signorini.model.support import Support
from signorini.model.whole import Model, Solver, Units

Plate = RectanglePlate | DiscPlate | AnnulusPlate | MeshPlate

__all__ = [
    "AnnulusPlate",
    "Area",
    "Circle",
    "Combination",
    "DiscPlate",
    "Factors",
    "Load",
    "Material",
    "MeshOptions",
    "MeshPlate",
    "Model",
    "Plate",
    "Probe",
    "RectanglePlate",
    "Solver",
    "Support",
    "Units",
    "validate",
]
