"""Public interface of `signorini`: names, signatures and members, all of them in docs/python.md."""

import inspect
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import get_args

import pytest

import signorini
from signorini.model.base import Table

ROOT = Path(__file__).parents[1]
SNAPSHOT = Path(__file__).with_name("public_api.txt")
DOCUMENT = (ROOT / "docs" / "python.md").read_text("utf-8")


def _signature(thing: Callable[..., object]) -> str:
    return str(inspect.signature(thing)).replace("'", "")


def described() -> Iterator[str]:
    """Every public name with its signature, and every public member of the classes."""
    for name in signorini.__all__:
        thing = getattr(signorini, name)
        if not callable(thing):
            yield f"{name}: {type(thing).__name__}"
        elif not inspect.isclass(thing):
            yield f"{name}{_signature(thing)}"
        else:
            yield f"class {name}({', '.join(base.__name__ for base in thing.__mro__[1:-1])})"
            for member, value in sorted(inspect.getmembers_static(thing)):
                inherited = not any(member in kind.__dict__ for kind in thing.__mro__ if "signorini" in kind.__module__)
                if member.startswith("_") or inherited:
                    continue
                called = value.__func__ if isinstance(value, classmethod | staticmethod) else value
                yield f"    {name}.{member}" + (_signature(called) if inspect.isfunction(called) else "")
            fields = getattr(thing, "__dataclass_fields__", None) or getattr(thing, "model_fields", {})
            yield from (f"    {name}.{field}" for field in fields if not field.startswith("_"))


def test_the_public_names_are_those_of_the_snapshot() -> None:
    """Where this fails on purpose: `python tests/test_public_api.py` writes the snapshot anew."""
    assert list(described()) == SNAPSHOT.read_text("utf-8").splitlines()


@pytest.mark.parametrize("name", signorini.__all__)
def test_every_public_name_is_documented(name: str) -> None:
    assert re.search(rf"`{name}\b", DOCUMENT)


@pytest.mark.parametrize("name", ["ContactProblem", "RowProblem", "Result", "SupportResult", "ProbeResult"])
def test_every_array_of_problems_and_results_is_documented(name: str) -> None:
    kind = getattr(signorini, name)
    types = {field.name: field.type for field in kind.__dataclass_fields__.values()}
    own = [vars(base) for base in kind.__mro__ if "signorini.results" in base.__module__ or base is kind]
    for member, value in (item for members in own for item in members.items()):
        function = getattr(value, "fget", None) or getattr(value, "func", None) or value
        if inspect.isfunction(function):
            types[member] = inspect.signature(function).return_annotation
    arrays = [
        one for one, of in types.items() if one[0] != "_" and re.search(r"Floats|Bools|Ints|cs[rc]_array", str(of))
    ]
    assert arrays or name == "ProbeResult"
    assert [one for one in arrays if not re.search(rf"`{one}\b", DOCUMENT)] == []


def test_names_are_found_without_reading_what_is_not_asked_for() -> None:
    assert dir(signorini) == sorted(signorini.__all__)
    assert all(hasattr(signorini, name) for name in signorini.__all__)


def test_the_code_of_the_document_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    first, *others = re.findall(r"```python\n(.*?)```", DOCUMENT, re.DOTALL)
    exec(compile(first.replace("slab.toml", "examples/disc_on_ring.toml").replace("all", "weight alone"), "1", "exec"))
    space: dict[str, object] = {}
    for block in others:
        exec(compile(block, "docs/python.md", "exec"), space)
    printed = capsys.readouterr().out.splitlines()
    assert printed[1].endswith("True") and len(printed) == 7
    centre = [float(line.split("[")[1].rstrip("]")) for line in printed[2:]]
    assert centre == sorted(centre, reverse=True) and centre[-1] >= 0


def _tables(annotation: object) -> Iterator[type]:
    """Every table that may stand in a key, and those in it."""
    if inspect.isclass(annotation) and issubclass(annotation, Table):
        yield annotation
        for field in annotation.model_fields.values():
            yield from _tables(field.annotation)
    for part in get_args(annotation):
        yield from _tables(part)


def test_every_table_of_the_input_is_a_public_class() -> None:
    assert {table.__name__ for table in _tables(signorini.Model)} <= set(signorini.__all__)


if __name__ == "__main__":
    SNAPSHOT.write_text("\n".join(described()) + "\n", "utf-8")
