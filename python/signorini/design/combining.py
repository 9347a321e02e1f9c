"""Combinations of actions: a design code's rule gives factors by role; each choice of load cases is a combination."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, product
from math import prod
from typing import NamedTuple

Terms = tuple[tuple[str, float], ...]
"""Load cases with their nonzero factors."""


class Factor(NamedTuple):
    """Partial factors γ that a rule gives an action, and the index of the value that they multiply.

    The value is one of the representative values of a load case, relative to its characteristic value: (1, ψ0, ψ1, ψ2)
    in EN 1990. A factor 0 means that the action may be absent.
    """

    values: tuple[float, ...]
    of: int = 0


@dataclass(frozen=True)
class Action:
    """An action with its role in the rules of a code, such as "permanent"; one of its alternatives acts at a time.

    An alternative maps the load cases that act to their representative values.
    """

    role: str
    alternatives: tuple[Mapping[str, tuple[float, ...]], ...]

    def choices(self, factor: Factor) -> tuple[Terms, ...]:
        """Distinct choices of the terms by which this action enters a combination; an absent action has no terms."""
        values = product(factor.values, self.alternatives)
        return tuple(dict.fromkeys(_terms(value, cases, factor.of) for value, cases in values))


@dataclass(frozen=True)
class Rule:
    """A combination rule of a design code: factors by role, in the order in which combinations list their terms.

    An action whose role is missing does not act. If ``leading`` has roles, one action of these roles leads, and has its
    factor from ``leading``. Only one role of each tuple of ``one_of`` acts. Without an action of the role ``needs``,
    if given, the rule has no combinations.
    """

    label: str
    factors: Mapping[str, Factor]
    leading: Mapping[str, Factor] = field(default_factory=dict)
    one_of: tuple[tuple[str, ...], ...] = ()
    needs: str = ""

    def choices(self, actions: Sequence[Action]) -> Iterator[list[tuple[Terms, ...]]]:
        """Yield, for each leading action and each choice from ``one_of``, the possible terms of every acting action."""
        if self.needs and all(action.role != self.needs for action in actions):
            return
        roles = list(self.factors)
        for chosen in product(*self.one_of):
            out = set(chain.from_iterable(self.one_of)) - set(chosen)
            acting = [action for action in actions if action.role in self.factors and action.role not in out]
            for lead in [action for action in acting if action.role in self.leading] if self.leading else [None]:
                order = sorted(acting, key=lambda action: (roles.index(action.role), action is not lead))
                yield [
                    action.choices((self.leading if action is lead else self.factors)[action.role]) for action in order
                ]


def count(rules: Sequence[Rule], actions: Sequence[Action]) -> int:
    """Return the number of combinations before equal ones are removed."""
    return sum(prod(map(len, choices)) for rule in rules for choices in rule.choices(actions))


def combine(rules: Sequence[Rule], actions: Sequence[Action]) -> list[tuple[str, Terms]]:
    """Return the names and terms of all distinct combinations; equal combinations are listed once, by the first name.

    Examples
    --------
    >>> dead, live = (Action(role, ({case: (1.0,)},)) for role, case in (("D", "G"), ("L", "Q")))
    >>> combine([Rule("2a", {"D": Factor((1.2,)), "L": Factor((1.6, 0.0))})], [dead, live])
    [('2a: 1.2 G + 1.6 Q', (('G', 1.2), ('Q', 1.6))), ('2a: 1.2 G', (('G', 1.2),))]
    """
    rows: dict[frozenset[tuple[str, float]], tuple[str, Terms]] = {}
    for rule in rules:
        for choices in rule.choices(actions):
            for chosen in product(*choices):
                terms = tuple(chain.from_iterable(chosen))
                if terms:
                    rows.setdefault(frozenset(terms), (rule.label, terms))
    sums = (summed([term(factor, case) for case, factor in terms]) for _, terms in rows.values())
    return [(f"{label}: {text}", terms) for text, (label, terms) in zip(sums, rows.values(), strict=True)]


def term(factor: float, case: str) -> str:
    """Write a factor and a load case, such as "1.35 G"."""
    return case if factor == 1 else f"-{case}" if factor == -1 else f"{factor:.12g} {case}"


def summed(terms: Sequence[str]) -> str:
    """Write terms as a sum, such as "1.35 G - W"."""
    first, *others = terms or [""]
    return first + "".join(f" - {term[1:]}" if term.startswith("-") else f" + {term}" for term in others)


def _terms(value: float, cases: Mapping[str, tuple[float, ...]], of: int) -> Terms:
    """Nonzero terms ``value`` · ψ by load case; factors are rounded to 12 digits, so that 1.5 · 0.6 is 0.9."""
    factors = ((case, float(f"{value * values[of]:.12g}")) for case, values in cases.items())
    return tuple((case, factor) for case, factor in factors if factor)
