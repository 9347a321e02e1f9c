"""The least of equal answers, certified like any other."""

from __future__ import annotations

from dataclasses import replace

from signorini.answer import Answer
from signorini.certificate import Certificate, certify
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats


def certified(
    found: Discretisation, load: CaseLoad, answer: Answer, beside: Floats | None = None
) -> tuple[Answer, Certificate]:
    """Judge a chosen answer; where arithmetic does not carry the choice, what the solver came to stands in its place.

    See `certify` for ``beside``.
    """
    certificate = certify(found, load, answer.hi, answer.lo, answer.reaction, beside=beside)
    if certificate.passed or answer.somehow is None:
        return answer, certificate
    first = replace(answer.somehow, not_unique=answer.not_unique)
    return first, certify(found, load, first.hi, first.lo, first.reaction, beside=beside)
