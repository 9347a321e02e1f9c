"""What kind a support is, in words and as a symbol."""

from __future__ import annotations

from signorini.model import Support

MEANINGS = {
    "down": "pushes up only",
    "up": "holds down only",
    "both": "holds both ways",
    "fixed": "fixed",
    "elastic": "elastic",
}
SYMBOLS = {"down": "▲", "up": "▼", "both": "◆", "fixed": "▬", "elastic": "~"}


def kinds(support: Support) -> list[str]:
    """Give the kinds of a support, keys of `MEANINGS` and `SYMBOLS`: how it acts, and whether it is elastic.

    Examples
    --------
    >>> kinds(Support(at=[1, 1], resists="down", stiffness=1e6))
    ['down', 'elastic']
    """
    how = "fixed" if support.fix is not None else support.resists or "both"
    return [how] if support.stiffness is None else [how, "elastic"]


def symbol(support: Support) -> str:
    """Give the symbol of a support.

    Examples
    --------
    >>> symbol(Support(at=[1, 1], resists="down", stiffness=1e6))
    '▲~'
    """
    return "".join(SYMBOLS[kind] for kind in kinds(support))


def describe(support: Support) -> str:
    """Say in words where a support is and which way it holds.

    Examples
    --------
    >>> describe(Support(at=[1, 1], resists="down", gap=0.001))
    'points, pushes up only, rigid, with gap'
    >>> describe(Support(edge="left", fix="clamped"))
    'edge, clamped'
    """
    where = {"at": "points"}.get(support.place, support.place)
    if support.fix is not None:
        how = support.fix if isinstance(support.fix, str) else " ".join(support.fix) + " held"
        return f"{where}, {how}" + (", elastic" if support.stiffness is not None else "")
    parts = [where, MEANINGS[support.resists or "both"], "rigid" if support.stiffness is None else "elastic"]
    if not (support.gap.is_constant and support.gap.value == 0):
        parts.append("with gap")
    return ", ".join(parts)
