"""A validation case as data: problem, source, model by number of elements, numbers with their references."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

Tables = Mapping[str, Any]
"""Tables of an input file, by key."""


def given(function: Callable[..., Tables], *values: Any) -> Callable[[int], Tables]:
    """Return the function of n that calls ``function(n, *values)``; in a loop, lambdas would share the last values."""
    return lambda n: function(n, *values)


@dataclass(frozen=True)
class Number:
    """A number of the results with its reference value.

    Parameters
    ----------
    name : str
        Name in the catalogue of results, such as ``"probe[1].deflection"``.
    label : str
        Description with the symbol, such as "w of the middle · D/qa⁴".
    reference : float
    tolerance : float
        Largest relative error on the finest mesh.
    factor : float
        Factor from the model's number to the reference, such as D/qa⁴.
    uncertainty : float
        Error of the reference for the modelled plate: half a unit of the last printed digit, or the effect of a
        simplification of the reference, such as the neglect of shear strain.
    size : float
        Magnitude that errors are relative to; 0 for that of the reference.
    differs : str
        Reason why the program does not reproduce a printed value; empty for a value to reproduce.
    """

    name: str
    label: str
    reference: float
    tolerance: float
    factor: float = 1.0
    uncertainty: float = 0.0
    size: float = 0.0
    differs: str = ""

    def error(self, value: float) -> float:
        """Relative error of a value; infinite for NaN, so that NaN never agrees with a reference."""
        return math.inf if math.isnan(value) else abs(value - self.reference) / self.magnitude

    @property
    def magnitude(self) -> float:
        """Magnitude to which the errors of this number are relative."""
        return self.size or abs(self.reference)


@dataclass(frozen=True)
class Case:
    """A validation case: a problem with a published or recomputed answer.

    Parameters
    ----------
    name, title : str
        Name of the page's file, and its heading.
    features : tuple of str
        Features of the program that the case uses, for the index.
    problem : str
        Geometry, material, supports and loads.
    source : str
        Author, title, year, and page or equation of the reference.
    kind : {"analytical", "numerical", "experimental"}
        Origin of the reference values.
    tables : function of n
        Returns the tables of the input file for n elements along a side; for a problem without a plate, the numbers.
    meshes : tuple of int
        Values of n, coarse to fine.
    numbers : tuple of Number
    remark : str
        Assumptions of the comparison, and errors in print.
    direct : bool
        Whether ``tables`` returns numbers by name, because the problem has no plate.
    """

    name: str
    title: str
    features: tuple[str, ...]
    problem: str
    source: str
    kind: Literal["analytical", "numerical", "experimental"]
    tables: Callable[[int], Tables]
    meshes: tuple[int, ...]
    numbers: tuple[Number, ...]
    remark: str = ""
    direct: bool = False
