"""Numbers that may vary over the plate: an expression in x and y, parsed and never executed."""

from signorini.expression.expression import LARGEST, LEAST, Expression

__all__ = ["LARGEST", "LEAST", "Expression"]
