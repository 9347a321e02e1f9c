import contextlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from signorini.errors import InputError
from signorini.expression import Expression

X = np.array([[0.5, 1.0, 2.0], [-1.0, 3.0, 0.25]])
Y = np.array([[2.0, 0.5, -1.0], [4.0, 1.0, 0.75]])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("5*(y-2)**2", 5 * (Y - 2) ** 2),
        ("-x + +y/2", -X + Y / 2),
        ("hypot(x, y) + atan2(y, x)", np.hypot(X, Y) + np.arctan2(Y, X)),
        ("min(x, y, 1) * max(x, 0)", np.minimum(np.minimum(X, Y), 1) * np.maximum(X, 0)),
        ("where(x > 1, x, -y)", np.where(X > 1, X, -Y)),
        ("(0 < x <= 2) and y > 0", ((X > 0) & (X <= 2) & (Y > 0)).astype(float)),
        ("x < 0 or not y > 0", ((X < 0) | (Y <= 0)).astype(float)),
        ("sin(pi*x) + exp(-y) + log(e)", np.sin(np.pi * X) + np.exp(-Y) + 1),
        ("floor(x) + ceil(y) + abs(x) + sqrt(x*x) + sign(y)", np.floor(X) + np.ceil(Y) + 2 * np.abs(X) + np.sign(Y)),
    ],
)
def test_formula_has_the_value_numpy_gives(text, expected):
    np.testing.assert_allclose(Expression(text)(X, Y), expected, rtol=1e-15)


def _binary(parts):
    return st.tuples(st.sampled_from(["+", "-", "*"]), parts, parts).map(lambda p: f"({p[1]} {p[0]} {p[2]})")


def _call(parts):
    one = st.tuples(st.sampled_from(["sin", "cos", "atan", "abs", "floor"]), parts).map(lambda p: f"{p[0]}({p[1]})")
    condition = st.tuples(parts, st.sampled_from(["<", ">=", "=="]), parts).map(" ".join)
    choice = st.tuples(condition, parts, parts).map(lambda p: f"where({p[0]}, {p[1]}, {p[2]})")
    return one | choice


_leaves = st.sampled_from(["x", "y", "pi"]) | st.floats(-9, 9, allow_subnormal=False).map(lambda v: f"({v!r})")
_formulas = st.recursive(_leaves, lambda parts: _binary(parts) | _call(parts), max_leaves=8)


@given(_formulas)
def test_random_formulas_agree_with_numpy(text):
    names = {"sin": np.sin, "cos": np.cos, "atan": np.arctan, "abs": np.abs, "floor": np.floor, "where": np.where}
    expected = eval(text, {"__builtins__": {}}, {**names, "x": X, "y": Y, "pi": np.pi})
    np.testing.assert_array_equal(Expression(text)(X, Y), np.broadcast_to(expected, X.shape))


@given(st.text(alphabet="xy0123456789.+-*/() ,<>=!eabsinpow_^[]'\n", max_size=60))
def test_any_text_is_an_expression_or_an_input_error(text):
    with contextlib.suppress(InputError):
        Expression(text)(X, Y)


def test_constant_keeps_its_value_and_fills_the_shape():
    constant = Expression("2*3 + 0.5")
    assert constant.is_constant
    assert constant.value == 6.5
    assert constant(X, Y).shape == X.shape
    assert Expression(np.float64(0.25)).value == 0.25


def test_where_evaluates_each_branch_only_where_it_is_chosen():
    np.testing.assert_array_equal(Expression("where(x > 0, 1/x, 0)")([0.0, 2.0], [0.0, 0.0]), [0.0, 0.5])
    np.testing.assert_array_equal(Expression("x != 0 and 1/x > 0.1")([0.0, 2.0], [0.0, 0.0]), [0.0, 1.0])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("1/x", "'1 / x' divides by zero at [0, 3]"),
        ("1/(1/x)", "'1 / x' divides by zero at [0, 3]"),
        ("log(x - 1)", "'log(x - 1)' is not a finite number at [0, 3]"),
        ("(x - 1)**0.5", "is not a finite number at [0, 3]"),
        ("exp(1000*(2 - x))", "is not a finite number at [0, 3]"),
        ("10**(60 + 5*(2 - x))", "is 1e+70 at [0, 3], but must be finite and at most 1e+60"),
    ],
)
def test_value_that_is_no_number_names_the_point(text, says):
    with pytest.raises(InputError) as caught:
        Expression(text)([2.0, 0.0], [3.0, 3.0])
    assert says in str(caught.value)


def test_bounds_name_the_point_and_the_place():
    with pytest.raises(InputError, match=r"^plate.thickness: 'x - 1' is -1 at \[0, 5\], but must be greater than 0"):
        Expression("x - 1")([2.0, 0.0], [5.0, 5.0], above=0, place="plate.thickness")
    with pytest.raises(InputError, match="must be at least 0"):
        Expression(-1)(0.0, 0.0, at_least=0)


@pytest.mark.parametrize(
    ("source", "says"),
    [
        ("", "is empty"),
        ("x +", "cannot be read"),
        ("x^2", "write '**'"),
        ("0,3", "decimal sign is a point"),
        ("z + 1", "Unknown name 'z'"),
        ("sine(x)", "Did you mean 'sin'?"),
        ("sin", "is a function"),
        ("sin(x, y)", "sin takes 1 argument(s), not 2"),
        ("__import__('os')", 'character "\'"'),
        ("x.real", "is not arithmetic"),
        ("(lambda: 1)()", "character ':'"),
        ("x if y else 1", "is not arithmetic"),
        ("max(*x)", "max takes 2 to 20"),
        ("9**9**9", "is not a finite number"),
        ("1/0 + x", "divides by zero"),
        ("1e999", "must be finite"),
        ("1" + "0" * 400, "too large"),
        ("+".join("x" * 900), "nested too deeply"),
        ("x" * 3000, "3000 characters"),
        ("ｘ", "character"),
        (float("nan"), "must be finite"),
        (True, "a number or an expression"),
    ],
)
def test_what_is_not_an_expression_is_refused_with_the_reason(source, says):
    with pytest.raises(InputError) as caught:
        Expression(source)
    assert says in str(caught.value)
