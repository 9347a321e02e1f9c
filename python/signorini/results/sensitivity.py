"""Derivatives of one number of a result with respect to parameters of the input."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from signorini.base.on_demand import OnDemand
from signorini.base.packages import package
from signorini.errors import InputError


@dataclass(frozen=True)
class Derivative:
    """Derivative dy/dp of a number y with respect to a parameter p.

    Parameters
    ----------
    path : str
        Path of the parameter in the input, such as "support.soil.stiffness".
    value : float
        Value of the parameter, in ``unit``; ``unit`` is empty if the model does not name units.
    derivative : float
        dy/dp in ``derivative_unit``; NaN if it does not exist, for the reason ``why``.
    elasticity : float
        (p/y) dy/dp: percent of y per percent of p. NaN if y = 0.
    valid : (float, float)
        Least and largest value of the parameter at which every contact point is on its present piece of its law; to
        first order in the parameter.
    """

    path: str
    value: float
    unit: str
    derivative: float
    derivative_unit: str
    elasticity: float
    valid: tuple[float, float]
    why: str = ""


class Sensitivity(Mapping[str, float]):
    """Derivatives dy/dp of one number y, by path of the parameter p; each is computed on first access.

    Iteration yields the paths of all numbers of the input that do not move the mesh, and ``case.NAME.factor`` for the
    factors of load cases. Other paths are accepted too, such as "support.soil.gap" if the input gives no gap.

    Attributes
    ----------
    name, value, unit : str, float, str
        The number, its value, and its unit.
    combination : str
        Name of the combination.
    """

    def __init__(
        self,
        name: str,
        value: float,
        unit: str,
        combination: str,
        paths: Callable[[], Collection[str]],
        compute: Callable[[str], Derivative],
    ) -> None:
        self.name, self.value, self.unit, self.combination = name, value, unit, combination
        self._paths, self._compute = paths, compute
        self._known = dict[str, Derivative]()

    def derivative(self, path: str) -> Derivative:
        """Derivative with respect to the parameter at a path, with its unit, elasticity and range.

        Raises
        ------
        InputError
            If the input has no such number, or the number moves the mesh or changes the kind of a support.
        """
        if path not in self._known:
            self._known[path] = self._compute(path)
        return self._known[path]

    def __getitem__(self, path: str) -> float:
        """Return dy/dp.

        Raises
        ------
        InputError
            As for `derivative`; also if the derivative does not exist.
        """
        found = self.derivative(path)
        if found.why:
            raise InputError(found.why, path)
        return found.derivative

    def __contains__(self, path: object) -> bool:
        """Whether iteration yields the path, without computing a derivative."""
        return path in self.paths

    def __iter__(self) -> Iterator[str]:
        """Iterate over the paths of the parameters."""
        return iter(self.paths)

    def __len__(self) -> int:
        """Count the parameters."""
        return len(self.paths)

    def __repr__(self) -> str:
        """Text with the number's name and the count of parameters; no derivative is computed."""
        return f"Sensitivity({self.name!r}, {self.combination!r}: {len(self)} parameters)"

    @cached_property
    def paths(self) -> tuple[str, ...]:
        """Paths of the parameters in the order of the input."""
        return tuple(self._paths())

    @cached_property
    def valid(self) -> Mapping[str, tuple[float, float]]:
        """Range of each parameter in which all contact points stay on their pieces: `Derivative.valid` by path."""
        return OnDemand(self.paths, lambda path: self.derivative(path).valid, None, "parameter", "This sensitivity")

    @property
    def derivatives(self) -> tuple[Derivative, ...]:
        """`Derivative` of every parameter; a derivative that does not exist is NaN and has a reason."""
        return tuple(self.derivative(path) for path in self.paths)

    def to_dataframe(self) -> Any:
        """Return a `pandas.DataFrame` with a row for each parameter; pandas must be installed."""
        rows = [
            {
                **{"value": one.value, "unit": one.unit, "derivative": one.derivative},
                **{"derivative_unit": one.derivative_unit, "elasticity": one.elasticity},
                **{"from": one.valid[0], "to": one.valid[1], "why": one.why},
            }
            for one in self.derivatives
        ]
        return package("pandas").DataFrame(rows, package("pandas").Index(self.paths, name=self.name))
