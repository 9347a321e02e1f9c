"""Values that may vary over the plate: expressions in x and y, parsed and never executed, and fields."""

from signorini.expression.expression import LARGEST, LEAST, Expression
from signorini.expression.field import Field, PointValues

__all__ = ["LARGEST", "LEAST", "Expression", "Field", "PointValues"]
