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

from signorini._core import __version__
from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError, SignoriniError
from signorini.inputfile import load, schema
from signorini.model import Model, validate
from signorini.path import path
from signorini.path_result import Path
from signorini.probe_result import ProbeResult
from signorini.problem import ContactProblem, contact_problem
from signorini.progress import Progress
from signorini.result import Result
from signorini.solve import Results, solve
from signorini.support_result import SupportResult

__all__ = [
    "ContactProblem",
    "InputError",
    "Model",
    "NoEquilibriumError",
    "NotCertifiedError",
    "Path",
    "ProbeResult",
    "Progress",
    "Result",
    "Results",
    "SignoriniError",
    "SupportResult",
    "__version__",
    "contact_problem",
    "load",
    "path",
    "schema",
    "solve",
    "validate",
]
