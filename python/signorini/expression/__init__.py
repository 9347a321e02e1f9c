"""Values that may vary over the plate: formulas in x and y, parsed and never executed, and fields of values."""

from signorini.expression.expression import LARGEST, LEAST, Expression
from signorini.expression.field import Field, PointValues

__all__ = ["LARGEST", "LEAST", "Expression", "Field", "PointValues"]
