"""Finite elements for Reissner-Mindlin plates on one-sided supports.

Examples
--------
>>> import signorini
>>> model = signorini.Model(
...     material={"E": 30e9, "nu": 0.2},
...     plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
...     mesh={"divisions": [20, 20]},
...     support=[{"name": "bearings", "at": [[1, 1], [9, 1], [9, 9], [1, 9]], "resists": "down"}],
...     load=[{"pressure": 2e3}, {"force": 100e3, "at": [5, 5]}],
... )
>>> result = signorini.solve(model)["all"]
>>> round(result.reactions["bearings"])
300000
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from signorini._core import LcpSolution, __version__
    from signorini.accuracy.comparison import Estimate, PathEstimate
    from signorini.analysis.estimate import Estimates, estimate
    from signorini.analysis.path import path
    from signorini.analysis.recover import recover
    from signorini.analysis.results import Results
    from signorini.analysis.solve import solve
    from signorini.analysis.tightening import tightened
    from signorini.base.progress import Progress
    from signorini.contact.certificate import Certificate
    from signorini.contact.lcp import Lcp, lemke
    from signorini.contact.own_rows import RowProblem, with_rows
    from signorini.contact.problem import ContactProblem, contact_problem
    from signorini.contact.selection import NotUnique
    from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError, SignoriniError
    from signorini.formats.inputfile import load, loads, schema
    from signorini.mesh.mesh import Mesh
    from signorini.model import *
    from signorini.output.writing import write
    from signorini.results.contact_field.area_contact import AreaContact
    from signorini.results.exact_path import ExactPath
    from signorini.results.extremes import FieldExtremes
    from signorini.results.load_path import LoadPath
    from signorini.results.local_results import ProbeResult, ProfileResult, SectionResult, StationResult, StripResult
    from signorini.results.path_events import PathEvent, Threshold
    from signorini.results.path_stop import PathStop
    from signorini.results.quantities import Catalogue
    from signorini.results.result import Result
    from signorini.results.support_result import EdgeCouples, SupportResult
    from signorini.singularities.singularity import Singularity

_MODULE_OF = {
    "_core": ("LcpSolution", "__version__"),
    "accuracy.comparison": ("Estimate", "PathEstimate"),
    "analysis.estimate": ("Estimates", "estimate"),
    "analysis.path": ("path",),
    "analysis.recover": ("recover",),
    "analysis.results": ("Results",),
    "analysis.solve": ("solve",),
    "analysis.tightening": ("tightened",),
    "base.progress": ("Progress",),
    "contact.certificate": ("Certificate",),
    "contact.lcp": ("Lcp", "lemke"),
    "contact.own_rows": ("RowProblem", "with_rows"),
    "contact.problem": ("ContactProblem", "contact_problem"),
    "contact.selection": ("NotUnique",),
    "errors": ("InputError", "NoEquilibriumError", "NotCertifiedError", "SignoriniError"),
    "formats.inputfile": ("load", "loads", "schema"),
    "mesh.mesh": ("Mesh",),
    "output.writing": ("write",),
    "results.contact_field.area_contact": ("AreaContact",),
    "results.exact_path": ("ExactPath",),
    "results.extremes": ("FieldExtremes",),
    "results.load_path": ("LoadPath",),
    "results.local_results": ("ProbeResult", "ProfileResult", "SectionResult", "StationResult", "StripResult"),
    "results.path_events": ("PathEvent", "Threshold"),
    "results.path_stop": ("PathStop",),
    "results.quantities": ("Catalogue",),
    "results.result": ("Result",),
    "results.support_result": ("EdgeCouples", "SupportResult"),
    "singularities.singularity": ("Singularity",),
}
"""Modules of the public names outside `model`; a module is imported at the first access to one of its names."""

# fmt: off
__all__ = [
    "Annulus", "AnnulusPlate", "Arc", "Area", "AreaContact", "Axes", "Catalogue", "Certificate", "Circle",
    "Combination", "Contact", "ContactProblem", "DiscPlate", "EdgeCouples", "Estimate", "Estimates", "ExactPath",
    "FieldExtremes", "FieldTable", "Form", "Hole", "InputError", "Lcp", "LcpSolution", "Load", "LoadPath",
    "Material", "Mesh", "MeshOptions", "MeshPlate", "Model", "Modifiers", "Moving", "NoEquilibriumError",
    "NotCertifiedError", "NotUnique", "Output", "PathEstimate", "PathEvent", "PathStop", "Plate", "PolygonPlate",
    "Probe", "ProbeResult", "Profile", "ProfileResult", "Progress", "RectanglePlate", "Refinement", "Result",
    "Results", "RowProblem", "Section", "SectionResult", "SignoriniError", "Singularity", "Solver", "StationResult",
    "Stiffness", "Strip", "StripResult", "Support", "SupportResult", "Threshold", "Tightening", "Units", "Zone",
    "__version__", "contact_problem", "estimate", "lemke", "load", "loads", "path", "recover", "schema", "solve",
    "tightened", "validate", "with_rows", "write",
]
# fmt: on


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'signorini' has no attribute {name!r}", name=name)
    module = next((module for module, names in _MODULE_OF.items() if name in names), "model")
    value = globals()[name] = getattr(import_module(f"signorini.{module}"), name)
    return value


def __dir__() -> list[str]:
    return list(__all__)
