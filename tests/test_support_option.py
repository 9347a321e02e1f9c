"""A new option of a support touches few files: its keys are read in the model and in its law only."""

import ast
import inspect
from collections.abc import Iterator
from pathlib import Path

from signorini.model import Support

PACKAGE = Path(__file__).parents[1] / "python" / "signorini"
LAW_KEYS = {"fix", "resists", "gap", "stiffness", "limit", "law", "settlement", "preload", "order"}
LAW_KEYS |= {"rotational_stiffness", "rotation"}


def assigned(target: ast.expr, value: ast.expr) -> Iterator[tuple[str, ast.expr]]:
    """Names in the target of an assignment or a loop, each with the expression that it is or runs through."""
    if isinstance(target, ast.Name):
        yield target.id, value
    elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        for name, own in zip(target.elts, value.elts, strict=False):
            yield from assigned(name, own)
    elif isinstance(target, ast.Tuple) and isinstance(value, ast.Call) and isinstance(value.func, ast.Name):
        columns = {"zip": value.args, "enumerate": [ast.Constant(0), *value.args[:1]]}.get(value.func.id, [])
        for name, own in zip(target.elts, columns, strict=False):
            yield from assigned(name, own)


def bindings(tree: ast.AST) -> Iterator[tuple[str, ast.expr]]:
    """Names with their annotations, and with the expressions that they are or run through."""
    for node in ast.walk(tree):
        match node:
            case ast.arg(arg=name, annotation=ast.expr() as kind):
                yield name, kind
            case ast.AnnAssign(target=ast.Name(id=name), annotation=kind):
                yield name, kind
            case ast.Assign(targets=[target], value=value) | ast.NamedExpr(target=target, value=value):
                yield from assigned(target, value)
            case ast.For(target=target, iter=value) | ast.comprehension(target=target, iter=value):
                yield from assigned(target, value)


def is_support(value: ast.expr, names: set[str]) -> bool:
    """Whether an expression is a support, supports, or their class."""
    match value:
        case ast.Name(id=name):
            return name in names
        case ast.Attribute(attr=name):
            return name == "support"
        case ast.Subscript(value=whole, slice=part):
            return is_support(whole, names) or is_support(part, names & {"Support"})
    return False


def reads(tree: ast.Module) -> Iterator[str]:
    """Names of attributes of supports that a module reads; * where the name is computed."""
    for scope in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.ClassDef)):
        names, before = {"Support"}, set[str]()
        while names != before:
            before = set(names)
            names |= {name for name, value in bindings(scope) if is_support(value, names)}
        for node in ast.walk(scope):
            match node:
                case ast.Attribute(value=value, attr=name) if is_support(value, names):
                    yield name
                case ast.Call(func=ast.Name(id="getattr"), args=[value, *_]) if is_support(value, names):
                    yield "*"


READS = {
    file.relative_to(PACKAGE).as_posix(): set(reads(ast.parse(file.read_text("utf-8"))))
    for file in sorted(PACKAGE.rglob("*.py"))
}


def test_only_the_model_and_the_laws_read_the_keys_of_a_law() -> None:
    assert set(Support.model_fields) >= LAW_KEYS
    readers = {file for file, names in READS.items() if names & {*LAW_KEYS, "*"}}
    assert {file for file in readers if not file.startswith("model/")} == {"discretise/laws.py"}


def test_the_limit_of_a_support_is_known_in_at_most_eight_product_files() -> None:
    """Files that read the key `limit` or a property of the model's support that follows from it."""
    getters = {name: value.fget for name, value in vars(Support).items() if isinstance(value, property)}
    named = {name for name, getter in getters.items() if "self.limit" in inspect.getsource(getter)}
    readers = {file for file, names in READS.items() if names & {"limit", *named}}
    assert "discretise/laws.py" in readers
    assert len(readers | {"model/support.py"}) <= 8
