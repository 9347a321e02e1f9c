"""The model as a whole: what the engineer said, checked against itself; no arrays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal, TypeVar

from pydantic import AfterValidator, Field

from signorini.errors import unknown
from signorini.model.base import Complaint, Table, Text
from signorini.model.load import Combination, Factors, Load, Probe
from signorini.model.plate import AnyPlate, Material, MeshOptions, MeshPlate
from signorini.model.support import Support

_MOST_ELEMENTS = 10_000_000

Named = TypeVar("Named", Support, Combination)


class Units(Table):
    """Labels of the consistent units used; they appear in the output and change no number."""

    length: Text = Field(default="", description='Label of the unit of length, such as "m".')
    force: Text = Field(default="", description='Label of the unit of force, such as "N".')


class Solver(Table):
    """Choice of the method that solves the contact problem."""

    method: Literal["auto", "lemke", "active_set", "interior_point"] = Field(
        default="auto", description="auto picks the method, and falls back without asking."
    )


def _named(tables: tuple[Named, ...]) -> tuple[Named, ...]:
    """Give every table that has no name its default one."""
    return tuple(
        table if table.name else table.model_copy(update={"name": f"{type(table).__name__.lower()} {position}"})
        for position, table in enumerate(tables, start=1)
    )


class Model(Table):
    """A plate, its supports and its loads: what the input file says, under the same names.

    Examples
    --------
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
    ...     support=[{"at": [[1, 1], [9, 1], [5, 9]], "resists": "down"}],
    ...     load=[{"pressure": 2e3}],
    ... )
    >>> model.support[0].name, model.cases
    ('support 1', ('load',))
    """

    title: Text = Field(default="", description="Title of the calculation.")
    units: Units = Field(default=Units(), description="Labels of the units, for the output.")
    material: Material = Field(description="The plate's material.")
    plate: AnyPlate = Field(description="The plate's outline, thickness and element.")
    mesh: MeshOptions = Field(default=MeshOptions(), description="How finely the plate is meshed.")
    support: Annotated[tuple[Support, ...], AfterValidator(_named)] = Field(default=(), description="The supports.")
    load: tuple[Load, ...] = Field(min_length=1, description="The loads, at least one.")
    combination: Annotated[tuple[Combination, ...], AfterValidator(_named)] = Field(
        default=(), description='Combinations of load cases; none given: one named "all", every case at factor 1.'
    )
    probe: tuple[Probe, ...] = Field(default=(), description="Points where results are written out.")
    solver: Solver = Field(default=Solver(), description="How the contact problem is solved.")

    @property
    def cases(self) -> tuple[str, ...]:
        """Names of the load cases, in the order in which they first appear."""
        return tuple(dict.fromkeys(load.case for load in self.load))

    @property
    def effective_combinations(self) -> tuple[Combination, ...]:
        """The combinations, or, where none is given, every case at factor 1 under the name "all"."""
        return self.combination or (Combination(name="all", factors=Factors(dict.fromkeys(self.cases, 1.0))),)

    def _complaints(self) -> Iterator[Complaint]:
        yield from self._mesh_complaints()
        yield from _repeated("support", [support.name for support in self.support])
        yield from _repeated("combination", [combination.name for combination in self.combination])
        yield from self._edge_complaints()
        for index, load in enumerate(self.load):
            if load.self_weight and self.material.unit_weight is None:
                yield (
                    ("load", index, "self_weight"),
                    "self_weight needs the material's unit_weight, which is not given.",
                )
        for index, combination in enumerate(self.combination):
            for case in combination.factors:
                if case not in self.cases:
                    yield ("combination", index, "factors", case), unknown("case", case, self.cases)

    def _mesh_complaints(self) -> Iterator[Complaint]:
        if isinstance(self.plate, MeshPlate):
            for key in self.mesh.given(("divisions", "size")):
                yield ("mesh", key), f"{key} does not go with a plate read from a mesh file, which is meshed already."
            return
        first, second = self.plate.divisions(self.mesh)
        fewest = self.plate.fewest[1]
        if second < fewest:
            yield ("mesh", "divisions"), f"found {second} elements around; this plate needs at least {fewest}."
        if first * second > _MOST_ELEMENTS:
            key = "size" if self.mesh.size is not None else "divisions"
            yield (
                ("mesh", key),
                f"found {first:.3g} by {second:.3g} elements; at most {_MOST_ELEMENTS:.0e} are allowed.",
            )

    def _edge_complaints(self) -> Iterator[Complaint]:
        names = self.plate.edge_names
        if names is None:
            return
        edges = [("support", index, support.edge or ()) for index, support in enumerate(self.support)]
        edges += [("load", index, load.edge or ()) for index, load in enumerate(self.load)]
        for key, index, listed in edges:
            for position, edge in enumerate(listed):
                if edge not in names:
                    yield (key, index, "edge", position), unknown("edge", edge, names, f"This {self.plate.shape}")


def _repeated(key: str, names: list[str]) -> Iterator[Complaint]:
    first: dict[str, int] = {}
    for index, name in enumerate(names):
        if first.setdefault(name, index) != index:
            yield (
                (key, index, "name"),
                f'the name "{name}" is taken by {key}[{first[name] + 1}]; each name may stand once.',
            )
