"""EN 1990:2002 with A1:2005: combinations of actions for buildings, with the recommended values of annex A1."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from signorini.design.combining import Factor, Rule

FULL, PSI0, PSI1, PSI2 = range(4)
"""Indices of the representative values Qk, ψ0 Qk, ψ1 Qk, ψ2 Qk of a variable action (4.1.3)."""

PSI: Mapping[str, tuple[float, float, float]] = {
    "A": (0.7, 0.5, 0.3),
    "B": (0.7, 0.5, 0.3),
    "C": (0.7, 0.7, 0.6),
    "D": (0.7, 0.7, 0.6),
    "E": (1.0, 0.9, 0.8),
    "F": (0.7, 0.7, 0.6),
    "G": (0.7, 0.5, 0.3),
    "H": (0.0, 0.0, 0.0),
    "snow low": (0.5, 0.2, 0.0),
    "snow high": (0.7, 0.5, 0.2),
    "wind": (0.6, 0.2, 0.0),
    "temperature": (0.6, 0.5, 0.0),
}
"""(ψ0, ψ1, ψ2) by category, Table A1.1; "snow high" is for sites above 1000 m and for the Nordic countries."""

Gamma = Mapping[str, tuple[float, ...]]
"""Partial factors by kind of action: unfavourable and, if it differs, favourable."""

_STR: Gamma = {"permanent": (1.35, 1.0), "variable": (1.5, 0.0), "preload": (1.0,)}
_EQU: Gamma = {"permanent": (1.1, 0.9), "variable": (1.5, 0.0), "preload": (1.0,)}
_UNIT: Gamma = {"permanent": (1.0,), "variable": (1.0, 0.0), "preload": (1.0,)}

GAMMA: Mapping[str, Gamma] = {
    "6.10": _STR,
    "6.10ab": _STR,
    "EQU": _EQU,
    "accidental": {**_UNIT, "accidental": (1.0,)},
    "seismic": {**_UNIT, "seismic": (1.0,)},
    "characteristic": _UNIT,
    "frequent": _UNIT,
    "quasi-permanent": _UNIT,
}
"""Recommended partial factors of each rule: Tables A1.2(A) for EQU, A1.2(B) for 6.10 and 6.10ab, A1.3 and A1.4."""

XI = 0.85
"""Recommended reduction factor ξ of unfavourable permanent actions in 6.10b, Table A1.2(B)."""


class Expression(NamedTuple):
    """An expression of 6.4.3 or 6.5.3: representative values of the leading and of the other variable actions.

    ``leading`` is None if no action leads. With ``reduced`` the unfavourable permanent factors are multiplied by ξ.
    """

    label: str
    leading: int | None
    others: int
    reduced: bool = False


EXPRESSIONS: Mapping[str, tuple[Expression, ...]] = {
    "6.10": (Expression("6.10", FULL, PSI0),),
    "6.10ab": (Expression("6.10a", None, PSI0), Expression("6.10b", FULL, PSI0, reduced=True)),
    "EQU": (Expression("EQU", FULL, PSI0),),
    "accidental": (Expression("accidental", PSI1, PSI2),),
    "seismic": (Expression("seismic", None, PSI2),),
    "characteristic": (Expression("characteristic", FULL, PSI0),),
    "frequent": (Expression("frequent", PSI1, PSI2),),
    "quasi-permanent": (Expression("quasi-permanent", None, PSI2),),
}
"""Expressions 6.10 to 6.12b (6.4.3) and 6.14b to 6.16b (6.5.3)."""

CLAUSES: Mapping[str, tuple[str, str]] = {
    "6.10": ("Σ γG Gk + γP P + γQ Qk,1 + Σ γQ ψ0,i Qk,i", "6.4.3.2, Eq. (6.10); Table A1.2(B)"),
    "6.10ab": (
        "a: Σ γG Gk + γP P + Σ γQ ψ0,i Qk,i; b: Σ ξ γG Gk + γP P + γQ Qk,1 + Σ γQ ψ0,i Qk,i",
        "6.4.3.2, Eq. (6.10a), (6.10b); Table A1.2(B)",
    ),
    "EQU": ("Σ γG Gk + γP P + γQ Qk,1 + Σ γQ ψ0,i Qk,i", "6.4.3.2, Eq. (6.10); Table A1.2(A)"),
    "accidental": ("Σ Gk + P + Ad + (ψ1,1 or ψ2,1) Qk,1 + Σ ψ2,i Qk,i", "6.4.3.3, Eq. (6.11b); Table A1.3"),
    "seismic": ("Σ Gk + P + AEd + Σ ψ2,i Qk,i", "6.4.3.4, Eq. (6.12b); Table A1.3"),
    "characteristic": ("Σ Gk + P + Qk,1 + Σ ψ0,i Qk,i", "6.5.3 (2)a, Eq. (6.14b); Table A1.4"),
    "frequent": ("Σ Gk + P + ψ1,1 Qk,1 + Σ ψ2,i Qk,i", "6.5.3 (2)b, Eq. (6.15b); Table A1.4"),
    "quasi-permanent": ("Σ Gk + P + Σ ψ2,i Qk,i", "6.5.3 (2)c, Eq. (6.16b); Table A1.4"),
}
"""Each rule's sum of actions, in the symbols of EN 1990, and the rule's clause."""


def rules(name: str, gamma: Gamma, xi: float = XI, accidental_leading: int = PSI1) -> Iterator[Rule]:
    """Yield the rules of ``name``, a key of `GAMMA`; the roles of actions are their kinds, such as "permanent".

    ``gamma`` are factors in place of the recommended ones. ``accidental_leading``, `PSI1` or `PSI2`, is the
    representative value of the leading variable action in 6.11b.
    """
    factors = {**GAMMA[name], **gamma}
    event = {kind: Factor(factors[kind]) for kind in ("accidental", "seismic") if kind in factors}
    for label, leading, others, reduced in EXPRESSIONS[name]:
        unfavourable, *favourable = factors["permanent"]
        permanent = (xi * unfavourable if reduced else unfavourable, *favourable)
        always = {"permanent": Factor(permanent), "preload": Factor(factors["preload"])} | event
        values, needs = factors["variable"], next(iter(event), "")
        if leading is None:
            yield Rule(label, {**always, "variable": Factor(values, others)}, needs=needs)
            continue
        value = accidental_leading if event else leading
        lead = {"variable": Factor(values[:1], value)}
        yield Rule(label, {**always, "variable": Factor(values, others)}, lead, needs=needs)
        yield Rule(label, {**always, "variable": Factor(values[1:], others)}, needs=needs)
