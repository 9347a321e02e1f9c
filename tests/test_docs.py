"""docs/input.md against the JSON schema: every key is in both; the program of docs/certificate.md; CITATION.cff."""

import re
from pathlib import Path

import pytest

import signorini

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "docs" / "input.md").read_text("utf-8")
SCHEMA = signorini.schema()
# Tables of the schema that are values of a key, with the section that tells theirs.
WITHIN = {"Area": "support", "Circle": "support", "Modifiers": "plate", "Stiffness": "plate"}


def keys_of(node):
    """Keys of a table of the schema, or of any of its alternatives."""
    if "$ref" in node:
        return keys_of(SCHEMA["$defs"][node["$ref"].rpartition("/")[2]])
    if "items" in node:
        return keys_of(node["items"])
    found = set(node.get("properties", {}))
    for branch in [*node.get("anyOf", []), *node.get("oneOf", [])]:
        found |= keys_of(branch)
    return found


def sections():
    """The headings with the keys of the file in them, as the names of tables, and the text under each."""
    parts = re.split(r"^## (.*)$", TEXT, flags=re.MULTILINE)[1:]
    return [(set(re.findall(r"`\[*(\w+)\]*`", head)), body) for head, body in zip(parts[::2], parts[1::2], strict=True)]


def told(name):
    """Text of the section of a table."""
    return next(body for tables, body in sections() if name in tables)


TABLES = {name: keys_of(node) for name, node in SCHEMA["properties"].items() if keys_of(node)}


@pytest.mark.parametrize(("table", "key"), [(table, key) for table, keys in TABLES.items() for key in sorted(keys)])
def test_every_key_of_the_schema_is_in_its_section(table, key):
    assert re.search(rf"`(?:{table}\.)?{key}\b", told(table))


@pytest.mark.parametrize("table", TABLES)
def test_every_key_of_a_section_is_in_the_schema(table):
    first_cells = re.findall(r"^\| (`[^|]*) \|", told(table), re.MULTILINE)
    written = {key for cell in first_cells for key in re.findall(r"`((?:\w+\.)?\w+)`", cell)}
    names = {tuple(key.rpartition(".")[::2]) for key in written}
    own = {key for owner, key in names if owner in ("", table)}
    shared = set().union(*(TABLES.get(owner, set()) for owner in next(t for t, _ in sections() if table in t)))
    shapes = {"rectangle", "disc", "annulus", "polygon", "mesh"} if table == "plate" else set()
    inner = set().union(*(keys_of(SCHEMA["$defs"][name]) for name, owner in WITHIN.items() if owner == table))
    assert own - shared - inner - shapes - set(SCHEMA["properties"]) == set()


def test_keys_of_areas_and_circles_are_told():
    for name, section in WITHIN.items():
        for key in SCHEMA["$defs"][name]["properties"]:
            assert re.search(rf"\b{key}\b", told(section))


def test_the_example_is_a_model(tmp_path):
    example = re.search(r"```toml\n(.*?)```", TEXT, re.DOTALL)[1]
    (tmp_path / "slab.toml").write_text(example, encoding="utf-8")
    assert signorini.load(tmp_path / "slab.toml").support[0].name == "bearings"


def test_the_program_of_the_certificates_page_shows_what_it_says(capsys):
    (program,) = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "certificate.md").read_text("utf-8"), re.DOTALL)
    assert not re.search(r"signorini\.\w+\.|from signorini\.", program)
    exec(compile(program, "certificate.md", "exec"), {})
    certificate, equilibrium, penetration, passed, refused = capsys.readouterr().out.splitlines()
    assert certificate.startswith("passed") and passed == "True"
    assert float(equilibrium) < 1e-9 and float(penetration) < 1e-9
    assert refused.startswith("These reactions are not the answer")


def test_the_version_to_cite_is_the_projects():
    cited = re.search(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text("utf-8"), re.MULTILINE)
    assert cited[1] == signorini.__version__
