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

import ast
from importlib import import_module
from pathlib import Path
from typing import Any

_STUB = ast.parse(Path(__file__).with_suffix(".pyi").read_text("utf-8")).body
_MODULES = {alias.name: node.module for node in _STUB if isinstance(node, ast.ImportFrom) for alias in node.names}
__all__ = ast.literal_eval(_STUB[-1].value)


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'signorini' has no attribute {name!r}", name=name)
    value = globals()[name] = getattr(import_module(_MODULES.get(name, "signorini.model")), name)
    return value


def __dir__() -> list[str]:
    return list(__all__)
