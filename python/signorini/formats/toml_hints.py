"""What to write instead of what is not TOML, for the slips that newcomers make."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection

_NUMBER = r"(?>[+-]?\d[\d_]*(?:\.\d+)?(?:[eE][+-]?\d+)?)"
_ENDS = r"\s*(?:[,}\]#].*)?$"

# Slips that show in the line where reading stopped, by a pattern and what to say of its match. The first one that is
# found is told.
_SLIPS: tuple[tuple[str, Callable[[re.Match[str]], str]], ...] = (
    (r"^(?://|;|%|--)", lambda result: "A comment begins with #."),
    (r"[“”„‘’«»]", lambda result: "Quotes are straight: \" or '."),
    (r'=\s*"[^"]*\\', lambda result: "Write a path with / in place of \\, or in single quotes."),
    (r"=\s*\(", lambda result: "A list stands in square brackets: [1, 2]."),
    (
        rf"=\s*([+-]?\d{{1,3}}(?:,\d{{3}}){{2,}}){_ENDS}",
        lambda result: f"Write a number without commas: {result[1].replace(',', '')}.",
    ),
    (
        rf"=\s*([+-]?\d+),(\d+(?:[eE][+-]?\d+)?){_ENDS}",
        lambda result: f"The decimal sign is a point: {result[1]}.{result[2]}.{_thousands(result[1], result[2])}",
    ),
    (r",\s*\}", lambda result: "No comma stands before the closing brace."),
    (
        r"\{[^}]*$",
        lambda result: "A table in braces stands on one line, from { to }; a longer one under a header of its own.",
    ),
    (r"[=,\[]\s*([+-]?)(\.\d+)", lambda result: f"A digit stands before the point: {result[1]}0{result[2]}."),
    (
        r"[=,\[]\s*([+-]?\d+)\.(?!\d)((?:[eE][+-]?\d+)?)",
        lambda result: f"A digit stands behind the point: {result[1]}.0{result[2]}.",
    ),
    (r"=\s*[+-]?0+(\d[\d.]*)", lambda result: f"A number has no zeros before it: {result[1]}."),
    (rf"=\s*({_NUMBER})\s*[*^/]", lambda result: "Write a power of ten as 30e9, and a formula in quotes."),
    (r"=\s*(\d+(?: \d{3})+)\b", lambda result: f"Write a number without spaces: {result[1].replace(' ', '')}."),
    (
        rf"=\s*({_NUMBER})\s*[^\W\d_]",
        lambda result: f"A number stands without its unit: {result[1]}. Units have labels in [units].",
    ),
    (rf"=\s*{_NUMBER}\s*;", lambda result: "A line ends without a semicolon."),
    (r"=\s*(True|False|TRUE|FALSE)\b", lambda result: f"Write {result[1].lower()} in small letters."),
    (r"=\s*([^\W\d]\w*)", lambda result: f'Text stands in quotes: "{result[1]}".'),
    (r"=\s*(?:#.*)?$", lambda result: "The value is missing behind the =."),
    (r"^[\w.\- ]+:", lambda result: "Between a key and its value stands =."),
    (r"[{,]\s*\w+\s*:", lambda result: "Between a key and its value stands =."),
    (r"^\[\[[^\]]*\](?!\])", lambda result: "A header in double brackets ends in ]]."),
    (r"^\[[^\]]*$", lambda result: "A header in brackets ends in ]."),
    (r"""=\s*(["'])(?:(?!\1).)*$""", lambda result: f"The closing quote {result[1]} is missing."),
    (r"^\{", lambda result: "This looks like JSON; docs/input.md shows the same in TOML."),
    (r"^[^=\[]+$", lambda result: "A line is [a header], key = value, or # a comment."),
    (r"^[^\x00-\x7f]", lambda result: "Keys are written in plain letters, such as nu."),
)


def _thousands(before: str, behind: str) -> str:
    """Three digits behind a comma may as well be thousands."""
    whole = re.fullmatch(r"\d{3}", behind)
    return f" If {before},{behind} is meant in thousands, write {before}{behind}." if whole else ""


def hint(says: str, line: str, lists: Collection[str]) -> str:
    """Say what to write, or nothing.

    Parameters
    ----------
    says : str
        What the parser of TOML says.
    line : str
        The line where it stopped.
    lists : collection of str
        Tables that stand in double brackets.

    Examples
    --------
    >>> hint("Expected newline or end of document after a statement", "nu = 0,3", ["support"])
    'The decimal sign is a point: 0.3.'
    >>> hint("Cannot declare ('support',) twice", "[support]", ["support"])
    'Each of several such tables has double brackets: [[support]].'
    """
    line = line.strip()
    header = re.match(r"\[\[?\s*(\w+)\s*\]", line)
    if header and ("twice" in says or "overwrite" in says or "mutate" in says):
        if header[1] in lists:
            return f"Each of several such tables has double brackets: [[{header[1]}]]."
        return "A table stands once; put all its keys under one header."
    if "overwrite" in says:
        return "A key stands once in a table."
    return next((say(result) for slip, say in _SLIPS if (result := re.search(slip, line))), "")
