"""Input values that may vary over the plate: formulas in x and y, tables of values at points, Python functions."""

from signorini.expression.expression import LARGEST, LEAST, Expression
from signorini.expression.field import Field, PointValues

__all__ = ["LARGEST", "LEAST", "Expression", "Field", "PointValues"]
