"""Public names; `signorini/__init__.py` imports the module of a name at its first access."""

from signorini._core import LcpSolution, __version__
from signorini.accuracy.comparison import Estimate, PathEstimate
from signorini.analysis.checks import CheckResult, check_results
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
from signorini.output.explain import Explanation, explain
from signorini.output.schema import results_schema
from signorini.output.verification import Difference, Verification, verify
from signorini.output.writing import write
from signorini.reports.page import report
from signorini.results.contact_field.area_contact import AreaContact
from signorini.results.exact_path import ExactPath
from signorini.results.extremes import FieldExtremes
from signorini.results.load_path import LoadPath
from signorini.results.local_results import ProbeResult, ProfileResult, SectionResult, StationResult, StripResult
from signorini.results.path_events import PathEvent, Threshold
from signorini.results.path_stop import PathStop
from signorini.results.punching import ColumnResult
from signorini.results.quantities import Catalogue
from signorini.results.result import Result
from signorini.results.sensitivity import Derivative, Sensitivity
from signorini.results.support_result import EdgeCouples, SupportResult
from signorini.singularities.singularity import Singularity
from signorini.studies.study import study
from signorini.studies.summary import Study

# fmt: off
__all__ = [
    "Annulus", "AnnulusPlate", "Arc", "Area", "AreaContact", "Axes", "Case", "Catalogue", "Certificate", "Check",
    "CheckResult", "Circle", "ColumnResult", "Combination", "Contact", "ContactProblem", "Cover", "Derivative",
    "Difference", "DiscPlate", "EdgeCouples", "Estimate", "Estimates", "ExactPath", "Explanation", "FieldExtremes",
    "FieldTable", "Form", "Gamma", "Hole", "InputError", "Lcp", "LcpSolution", "Load", "LoadPath", "Material", "Mesh",
    "MeshOptions", "MeshPlate", "Model", "Modifiers", "Moving", "NoEquilibriumError", "NotCertifiedError", "NotUnique",
    "Output", "PathEstimate", "PathEvent", "PathStop", "Plate", "PolygonPlate", "Probe", "ProbeResult", "Profile",
    "ProfileResult", "Progress", "Punching", "RectanglePlate", "Refinement", "Reinforcement", "Report", "Result",
    "Results", "RowProblem", "Section", "SectionResult", "Sensitivity", "SignoriniError", "Singularity", "Solver",
    "StationResult", "Stiffness", "Strip", "StripResult", "Study", "Support", "SupportResult", "Threshold",
    "Tightening", "Units", "Verification", "Zone", "__version__", "check_results", "contact_problem", "estimate",
    "explain", "lemke", "load", "loads", "path", "recover", "report", "results_schema", "schema", "solve", "study",
    "tightened", "validate", "verify", "with_rows", "write",
]
# fmt: on
