"""What results over an index have in common, be it the names of combinations or the factor of a load that grows."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Generic, TypeVar

from signorini.base.remade import Remade
from signorini.contact.problem import ContactProblem
from signorini.discretise import Discretisation
from signorini.model import Model
from signorini.results.envelope import Envelope
from signorini.results.rows import Column

Key = TypeVar("Key", str, float)


class States(Remade, Generic[Key]):
    """Results of one problem under several loads: a table with a row each, an envelope, and which of them govern."""

    problem: ContactProblem

    @property
    def discretisation(self) -> Discretisation:
        """Mesh, supports and loads."""
        return self.problem.discretisation

    @property
    def model(self) -> Model:
        """The model."""
        return self.discretisation.model

    @abstractmethod
    def key(self, row: int) -> Key:
        """What tells a row of the table, from 0, from the others: the combination's name, or t."""

    @property
    @abstractmethod
    def table(self) -> Mapping[str, Column]:
        """Every column by name, with a number or a text a row; docs/results.md describes them. NaN is absent."""

    @property
    @abstractmethod
    def envelope(self) -> Envelope:
        """Extremes over all rows with an equilibrium, and the numbers of the rows, from 0, that they come from."""

    @property
    def governing(self) -> tuple[Key, ...]:
        """Rows with an extreme of some field, reaction or section, in that order, some at most."""
        return tuple(map(self.key, self.envelope.rows))
