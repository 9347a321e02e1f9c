"""ASCE/SEI 7-22, chapter 2: combinations of loads for strength design (LRFD) and allowable stress design (ASD).

Snow loads of this edition are at strength level: 1.0 S, 0.3 S and, in rule 6, 0.15 S. ASCE/SEI 7-16 has 1.6, 0.5, 0.2.
"""

import re
from collections.abc import Iterator, Mapping

from signorini.design.combining import Factor, Rule

LOADS = ("D", "L", "Lr", "S", "R", "W", "E", "Ev", "P")
"""Symbols of loads in ASCE 7-22, 2.2; E is the horizontal and Ev the vertical seismic effect of 12.4.2, P a preload of
factor 1."""

_ALWAYS = ("D", "Ev", "P")
"""Loads that a rule never leaves out; others may be absent (2.3 and 2.4)."""

RULES: Mapping[str, tuple[tuple[str, str, str], ...]] = {
    "LRFD": (
        ("1a", "D", "1.4D"),
        ("2a", "L", "1.2D + 1.6L + (0.5Lr or 0.3S or 0.5R)"),
        ("3a", "Lr S R", "1.2D + (1.6Lr or 1.0S or 1.6R) + (1.0L or 0.5W)"),
        ("4a", "W", "1.2D + 1.0W + 1.0L + (0.5Lr or 0.3S or 0.5R)"),
        ("5a", "W", "0.9D + 1.0W"),
        ("6", "E", "1.2D + 1.0Ev + 1.0E + 1.0L + 0.15S"),
        ("7", "E", "0.9D - 1.0Ev + 1.0E"),
    ),
    "ASD": (
        ("1a", "D", "1.0D"),
        ("2a", "L", "1.0D + 1.0L"),
        ("3a", "Lr S R", "1.0D + (1.0Lr or 0.7S or 1.0R)"),
        ("4a", "L", "1.0D + 0.75L + (0.75Lr or 0.525S or 0.75R)"),
        ("5a", "W", "1.0D + 0.6W"),
        ("6a", "W", "1.0D + 0.45W + 0.75L + (0.75Lr or 0.525S or 0.75R)"),
        ("7a", "W", "0.6D + 0.6W"),
        ("8", "E", "1.0D + 0.7Ev + 0.7E"),
        ("9", "E", "1.0D + 0.525Ev + 0.525E + 0.75L + 0.1S"),
        ("10", "E", "0.6D - 0.7Ev + 0.7E"),
    ),
}
"""Number, principal loads and factors of each rule: 2.3.1 and 2.3.6 (LRFD), 2.4.1 and 2.4.5 (ASD)."""


def section(name: str, text: str) -> str:
    """Section of ASCE 7-22 that contains a rule of `RULES`; rules with seismic loads have a section of their own."""
    basic, seismic = ("2.3.1", "2.3.6") if name == "LRFD" else ("2.4.1", "2.4.5")
    return f"ASCE 7-22, {seismic if 'Ev' in text else basic}"


def rules(name: str) -> Iterator[Rule]:
    """Yield the rules of "LRFD" or "ASD"; the roles of actions are the symbols in `LOADS`.

    Each combination of a rule contains one of the rule's principal loads in full.
    """
    for number, principal, text in RULES[name]:
        terms = re.findall(r"(-?) ?([\d.]+)([A-Z][a-z]?)", text)
        value = {symbol: float(sign + factor) for sign, factor, symbol in terms}
        factors = {symbol: Factor((one,) if symbol in _ALWAYS else (one, 0.0)) for symbol, one in value.items()}
        leading = {symbol: Factor((value[symbol],)) for symbol in principal.split()}
        one_of = tuple(tuple(re.findall(r"[A-Z][a-z]?", part)) for part in re.findall(r"\((.*?)\)", text))
        yield Rule(f"{name} {number}", {**factors, "P": Factor((1.0,))}, leading, one_of)
