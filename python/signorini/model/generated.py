"""The combinations that a model asks for, made one at a time: their number costs no memory."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import overload

from signorini.model.combination import Combination, Factors

Positions = Mapping[str, Sequence[str]]
"""The cases that a moving load becomes, by its own case."""


@dataclass(frozen=True)
class Choice:
    """One way to fill a place of a pattern: a term of the name, and the factor of one case; or nothing."""

    term: str = ""
    case: str = ""
    factor: float = 0.0


@dataclass(frozen=True)
class Product:
    """Every way to fill each place with one of its choices, the last place changing first."""

    name: str
    fixed: tuple[tuple[str, float], ...]
    places: tuple[tuple[Choice, ...], ...]
    group: str = ""

    def __len__(self) -> int:
        """Count the combinations."""
        return math.prod(len(choices) for choices in self.places)

    def __getitem__(self, index: int) -> tuple[str, Factors]:
        """Return the name and the factors of one combination."""
        chosen = []
        for choices in reversed(self.places):
            index, which = divmod(index, len(choices))
            chosen.append(choices[which])
        chosen.reverse()
        factors = dict(self.fixed)
        for choice in chosen:
            if choice.case:
                factors[choice.case] = choice.factor
        terms = _sum([choice.term for choice in chosen if choice.term])
        return ": ".join(part for part in (self.name, terms) if part), Factors(factors)

    @property
    def cases(self) -> set[str]:
        """Every case that occurs."""
        return {case for case, _ in self.fixed} | {c.case for choices in self.places for c in choices if c.case}


@dataclass(frozen=True)
class Listing:
    """Combinations written out in a table, one a row."""

    columns: tuple[str, ...]
    names: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]
    group: str = ""

    def __len__(self) -> int:
        """Count the combinations."""
        return len(self.names)

    def __getitem__(self, index: int) -> tuple[str, Factors]:
        """Return the name and the factors of one combination."""
        row = zip(self.columns, self.rows[index], strict=True)
        return self.names[index], Factors({case: factor for case, factor in row if factor})

    @property
    def cases(self) -> set[str]:
        """Every case that occurs."""
        return set(self.columns)


@dataclass(frozen=True, eq=False)
class Combinations(Sequence[Combination]):
    """Combinations in the order of the input, generated ones where their table stands."""

    products: tuple[Product | Listing, ...]

    def __post_init__(self) -> None:
        """Find where each product begins."""
        object.__setattr__(self, "_ends", list(accumulate(len(product) for product in self.products)))

    def __len__(self) -> int:
        """Count the combinations."""
        return int(self._ends[-1]) if self.products else 0  # type: ignore[attr-defined]

    @property
    def cases(self) -> set[str]:
        """Every case that occurs in some combination."""
        return {case for product in self.products for case in product.cases}

    @overload
    def __getitem__(self, index: int) -> Combination: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Combination]: ...
    def __getitem__(self, index: int | slice) -> Combination | Sequence[Combination]:
        """Make one combination, or those of a slice."""
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"there are {len(self)} combinations; found {index}")
        index %= len(self)
        which = bisect_right(self._ends, index)  # type: ignore[attr-defined]
        name, factors = self.products[which][index - (self._ends[which - 1] if which else 0)]  # type: ignore[attr-defined]
        return Combination.model_construct(name=name, group=self.products[which].group, factors=factors)

    @property
    def groups(self) -> dict[str, int]:
        """How many combinations each group with a name has, in the order of the input."""
        counts: dict[str, int] = {}
        for product in self.products:
            if product.group:
                counts[product.group] = counts.get(product.group, 0) + len(product)
        return counts

    def names(self) -> Iterator[str]:
        """Yield every name."""
        for product in self.products:
            for index in range(len(product)):
                yield product[index][0]


def products(combination: Combination, positions: Positions) -> Iterator[Product | Listing]:
    """What a table of the input stands for."""
    group = combination.group
    match combination.generate:
        case None:
            yield Product(combination.name, tuple(_factors(combination).items()), (), group)
        case "positions":
            yield _of_factors(combination.name, _factors(combination), positions, group)
        case "table":
            listing = _listing(combination)
            if not positions.keys() & listing.cases:
                yield listing
                return
            for index in range(len(listing)):
                yield _of_factors(*listing[index], positions, group)
        case "patterns":
            yield Product(combination.name, (), tuple(_patterns(combination, positions)), group)


def _factors(combination: Combination) -> Mapping[str, float]:
    assert combination.factors is not None  # a combination without factors is refused
    return combination.factors


def _listing(combination: Combination) -> Listing:
    if combination.file is not None:
        file = combination.file
        return Listing(file.columns, file.names, file.rows, combination.group)
    assert combination.columns is not None and combination.rows is not None  # one or the other is given
    return Listing(combination.columns, tuple(combination.rows), tuple(combination.rows.values()), combination.group)


def _of_factors(name: str, factors: Mapping[str, float], positions: Positions, group: str) -> Product:
    fixed = tuple((case, factor) for case, factor in factors.items() if case not in positions)
    moving = ((case, factor) for case, factor in factors.items() if case in positions)
    places = tuple(tuple(Choice(at, at, factor) for at in positions[case]) for case, factor in moving)
    return Product(name, fixed, places, group)


def _patterns(combination: Combination, positions: Positions) -> Iterator[tuple[Choice, ...]]:
    def choices(case: str, values: Sequence[float]) -> tuple[Choice, ...]:
        places = positions.get(case, (case,))
        return tuple(Choice(_term(factor, at), at, factor) for factor in values for at in places)

    assert combination.variable is not None  # patterns without variable cases are refused
    for case, values in (combination.permanent or {}).items():
        yield choices(case, values)
    grouped = {case: group for group in combination.exclusive for case in group}
    for case in combination.variable:
        group = grouped.get(case, (case,))
        if case == group[0] or case not in grouped:
            members = (case,) if case not in grouped else group
            yield (Choice(), *(choice for name in members for choice in choices(name, combination.variable[name])))


def _term(factor: float, case: str) -> str:
    return case if factor == 1 else f"-{case}" if factor == -1 else f"{factor:.12g} {case}"


def _sum(terms: Sequence[str]) -> str:
    """Join terms the way a sum is written.

    Examples
    --------
    >>> _sum(["1.35 G", "1.5 Q", "-1.5 W"])
    '1.35 G + 1.5 Q - 1.5 W'
    """
    first, *others = terms or [""]
    return first + "".join(f" - {term[1:]}" if term.startswith("-") else f" + {term}" for term in others)
