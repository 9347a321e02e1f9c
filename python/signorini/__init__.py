"""Reissner-Mindlin plates on supports that may hold one way only.

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
    from signorini.contact.lcp import lemke
    from signorini.contact.own_rows import RowProblem, with_rows
    from signorini.contact.problem import ContactProblem, contact_problem
    from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError, SignoriniError
    from signorini.formats.inputfile import load, schema
    from signorini.model import Model, validate
    from signorini.output.writing import write
    from signorini.results.exact_path import ExactPath
    from signorini.results.load_path import LoadPath
    from signorini.results.local_results import ProbeResult, ProfileResult, SectionResult, StationResult, StripResult
    from signorini.results.result import Result
    from signorini.results.support_result import SupportResult

_HOME = {
    "_core": ("LcpSolution", "__version__"),
    "accuracy.comparison": ("Estimate", "PathEstimate"),
    "analysis.estimate": ("Estimates", "estimate"),
    "analysis.path": ("path",),
    "analysis.recover": ("recover",),
    "analysis.results": ("Results",),
    "analysis.solve": ("solve",),
    "analysis.tightening": ("tightened",),
    "base.progress": ("Progress",),
    "contact.lcp": ("lemke",),
    "contact.own_rows": ("RowProblem", "with_rows"),
    "contact.problem": ("ContactProblem", "contact_problem"),
    "errors": ("InputError", "NoEquilibriumError", "NotCertifiedError", "SignoriniError"),
    "formats.inputfile": ("load", "schema"),
    "model": ("Model", "validate"),
    "output.writing": ("write",),
    "results.exact_path": ("ExactPath",),
    "results.load_path": ("LoadPath",),
    "results.local_results": ("ProbeResult", "ProfileResult", "SectionResult", "StationResult", "StripResult"),
    "results.result": ("Result",),
    "results.support_result": ("SupportResult",),
}
"""Where public names are; each is read when it is first asked for, as some take long."""

__all__ = [
    "ContactProblem",
    "Estimate",
    "Estimates",
    "ExactPath",
    "InputError",
    "LcpSolution",
    "LoadPath",
    "Model",
    "NoEquilibriumError",
    "NotCertifiedError",
    "PathEstimate",
    "ProbeResult",
    "ProfileResult",
    "Progress",
    "Result",
    "Results",
    "RowProblem",
    "SectionResult",
    "SignoriniError",
    "StationResult",
    "StripResult",
    "SupportResult",
    "__version__",
    "contact_problem",
    "estimate",
    "lemke",
    "load",
    "path",
    "recover",
    "schema",
    "solve",
    "tightened",
    "validate",
    "with_rows",
    "write",
]


def __getattr__(name: str) -> Any:
    for module, names in _HOME.items():
        if name in names:
            value = globals()[name] = getattr(import_module(f"signorini.{module}"), name)
            return value
    raise AttributeError(f"module 'signorini' has no attribute {name!r}", name=name)


def __dir__() -> list[str]:
    return list(__all__)
