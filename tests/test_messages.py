"""Messages for wrong input: value found, allowed values, remedy, and place."""

import re

import numpy as np
import pytest
from models import tables

import signorini
from signorini import InputError, Model, load, solve
from signorini.discretise import discretise
from signorini.formats.inputfile import with_line
from signorini.mesh import Mesh

HEAD = """[material]
E = 30e9
nu = 0.2
[plate]
shape = "rectangle"
size = [10, 10]
thickness = 0.3
[mesh]
divisions = [4, 4]
"""
SUPPORT = '[[support]]\nat = [[1, 1], [9, 1], [1, 9], [9, 9]]\nresists = "down"\n'
LOAD = "[[load]]\npressure = 2e3\n"
MODEL = tables(
    support=[{"at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}], load=[{"case": "G", "pressure": 5e3}]
)


def told(tmp_path, text):
    """Return the message of the command line about an input file."""
    file = tmp_path / "slab.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        discretise(load(file))
    found = str(with_line(caught.value, file))
    assert re.search(r"(slab\.toml:\d+: )\1", found) is None
    return found


@pytest.mark.parametrize(
    ("wrong", "right", "line", "says"),
    [
        ("nu = 0,2", "nu = 0.2", 3, "The decimal sign is a point: 0.2."),
        ("E = 30,000,000", "E = 30e9", 2, "Write a number without commas: 30000000."),
        ("E = 30 000", "E = 30e9", 2, "Write a number without spaces: 30000."),
        ("E = 30e9 Pa", "E = 30e9", 2, "Write a number without a unit: 30e9."),
        ("E = 30e9;", "E = 30e9", 2, "Remove the semicolon."),
        ("E = 30*10^9", "E = 30e9", 2, "Write a power of ten as 30e9, and a formula in quotes."),
        ("E = 30.e9", "E = 30e9", 2, "Write a digit after the point: 30.0e9."),
        ("nu = .2", "nu = 0.2", 3, "Write a digit before the point: 0.2."),
        ("nu = 00.2", "nu = 0.2", 3, "Remove the leading zeros: 0.2."),
        ("nu =", "nu = 0.2", 3, "The value after = is missing."),
        ("nu: 0.2", "nu = 0.2", 3, "Write = between a key and its value."),
        ("ν = 0.2", "nu = 0.2", 3, "Write keys in letters a to z, such as nu."),
        ("nu = 0.2\nnu = 0.3", "nu = 0.2", 4, "This key occurs twice in its table"),
        ("[material", "[material]", 1, "Close a header in brackets with ]."),
        ("// by me\n[material]", "[material]", 1, "A comment begins with #."),
        ("Slab of the hall\n[material]", "[material]", 1, "A line must be [a header], key = value, or # a comment."),
        ("[material]\n[material]", "[material]", 2, "This table occurs twice; put all its keys under one header."),
        ("shape = rectangle", 'shape = "rectangle"', 5, 'Write text in quotes: "rectangle".'),
        ("shape = “rectangle”", 'shape = "rectangle"', 5, "Quotes are straight: \" or '."),
        ('shape = "rectangle', 'shape = "rectangle"', 5, 'The closing quote " is missing.'),
        (r'shape = "C:\users"', 'shape = "rectangle"', 5, "Write a path with / in place of \\, or in single quotes."),
        ("size = (10, 10)", "size = [10, 10]", 6, "Write a list in square brackets: [1, 2]."),
        ("size = [10, 10", "size = [10, 10]", 6, "this list has no closing ]"),
        ("[[support]", "[[support]]", 10, "Close a header in double brackets with ]]."),
        ("[support]\n[support]", "[[support]]", 11, "Write this table in double brackets, once for each: [[support]]."),
    ],
)
def test_a_slip_in_toml_is_told_what_to_write(tmp_path, wrong, right, line, says):
    text = HEAD + SUPPORT + LOAD
    assert text.count(right) >= 1
    found = told(tmp_path, text.replace(right, wrong, 1))
    assert found.startswith(f"slab.toml:{line}: ") and says in found


@pytest.mark.parametrize(
    ("written", "says"),
    [
        ("factors = { load = 1,35 }", "The decimal sign is a point: 1.35."),
        ("factors = { load = 1, }", "Remove the comma before the closing brace."),
        ("factors = {\n  load = 1\n}", "Write a table in braces on one line"),
        ("factors = { load: 1 }", "Write = between a key and its value."),
    ],
)
def test_a_slip_in_braces_is_told_what_to_write(tmp_path, written, says):
    found = told(tmp_path, HEAD + SUPPORT + LOAD + "[[combination]]\n" + written)
    assert found.startswith("slab.toml:16: ") and says in found


@pytest.mark.parametrize(
    ("wrong", "right", "says"),
    [
        ("size = [10,5, 10,5]", "size = [10, 10]", "plate.size: found [10, 5, 10, 5]; it must be two lengths"),
        ("size = [10,5, 10,5]", "size = [10, 10]", "The decimal sign is a point."),
        ("size = 10", "size = [10, 10]", "plate.size: found 10; it must be two lengths [a, b], along x and y."),
        ('nu = "0,2"', "nu = 0.2", "The decimal sign is a point, and there are no quotes: 0.2."),
        ('E = "30*10^9"', "E = 30e9", "Write digits without quotes, such as 30e9."),
        ('shape = "disc"', 'shape = "rectangle"', "unknown key 'size'. It needs shape = \"rectangle\"."),
        ("[[loads]]", "[[load]]", "Did you mean [[load]]?"),
        ("factors = { load = 1 }\n[material]", "[material]", "It belongs in [[combination]]."),
        ("rectangle = [0, 0, 1, 1]\nresists", "resists", "area: area = { rectangle = ... }."),
        ("moment = 5\nat = [1, 1]", "pressure = 2e3", "load[1].moment: found 5; it must be [mx, my]"),
        ('force = 1\nedge = "left"', "pressure = 2e3", "edge is not allowed with force"),
        (LOAD, LOAD + "[x]\n", "'load' is missing. The loads, at least one. Write it under [[load]]."),
    ],
)
def test_a_slip_in_the_model_is_told_what_is_allowed(tmp_path, wrong, right, says):
    text = HEAD + SUPPORT + LOAD
    text = text.replace(wrong, "", 1) if wrong == LOAD else text.replace(right, wrong, 1)
    assert says in told(tmp_path, text)


def test_all_that_meshing_finds_is_told_at_once_with_its_line(tmp_path):
    found = told(
        tmp_path,
        HEAD.replace("0.3", '"0.3 - x"')
        + SUPPORT
        + '[[support]]\nat = [[1, 2], [20, 3], [30, 3]]\n[[support]]\narea = "all"\nstiffness = "x - 5"\n'
        + "[[load]]\nforce = 1\nat = [11, 1]\n[[load]]\nline_load = 1\nline = [[0, 5], [20, 5]]\n"
        + "[[load]]\npressure = 1\narea.rectangle = [5, 5, 12, 12]\n[[probe]]\nat = [-1, 0]\n",
    ).splitlines()
    assert found[0] == "slab.toml: 8 problems:"
    assert [line.split(": ")[:2] for line in found[1:]] == [
        ["  slab.toml:7", "plate.thickness"],
        ["  slab.toml:14", "support[2].at[2]"],
        ["  slab.toml:14", "support[2].at[3]"],
        ["  slab.toml:17", "support[3].stiffness"],
        ["  slab.toml:20", "load[1].at"],
        ["  slab.toml:23", "load[2].line"],
        ["  slab.toml:26", "load[3].area"],
        ["  slab.toml:28", "probe[1].at"],
    ]


def test_an_unknown_edge_of_a_mesh_is_told_with_what_else_is_wrong(tmp_path):
    plate = Mesh(
        np.array([[0, 0], [4, 0], [4, 2], [0, 2], [2, 0], [4, 1], [2, 2], [0, 1]], float), np.arange(8)[None], {}
    )
    import meshio

    meshio.Mesh(plate.points, [("quad8", plate.elements)]).write(tmp_path / "plate.vtu")
    text = HEAD[: HEAD.index("[mesh]")].replace('"rectangle"\nsize = [10, 10]', '"mesh"\nfile = "plate.vtu"')
    found = told(tmp_path, text + '[[support]]\nedge = ["boundry", "boundary"]\n[[load]]\nforce = 1\nat = [5, 1]\n')
    assert "slab.toml:9: support[1].edge[1]: Unknown edge 'boundry'. This mesh has: boundary." in found
    assert "slab.toml:12: load[1].at: The point [5, 1] is not on the plate" in found


def test_what_is_wrong_with_a_mesh_file_has_the_line_that_names_it(tmp_path):
    text = HEAD[: HEAD.index("[mesh]")].replace('"rectangle"\nsize = [10, 10]', '"mesh"\nfile = "plate.msh"')
    found = told(tmp_path, text + SUPPORT.replace("9", "5") + LOAD)
    assert found == f"slab.toml:6: plate.file: {tmp_path / 'plate.msh'}: The mesh file does not exist."


def test_no_load_is_a_combination():
    results = solve(Model(**MODEL, combination=[{"name": "none", "factors": {}}, {"name": "all", "factors": {"G": 1}}]))
    assert results["none"].supports[0].reaction == 0.0 and not results["none"].deflection.any()
    assert results["all"].supports[0].reaction == pytest.approx(80e3)


def test_a_name_among_thousands_is_told_the_nearest():
    moving = {"case": "truck", "line": [[0, 2], [4, 2]], "step": 0.01, "axles": [0, 1e3]}
    with pytest.raises(InputError) as caught:
        signorini.path(Model(**MODEL, moving=[moving]), start=None, add="truck@2,5")
    assert "This model has 402, such as: truck@2.5, " in str(caught.value) and len(str(caught.value)) < 250


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ("slab.toml", "model: found 'slab.toml'; it must be a Model. Load the file first: signorini.load(file)."),
        ({}, "model: found {}; it must be a Model. Make a Model from the mapping first: signorini.validate(mapping)."),
        (None, "model: found None; it must be a Model. Make one with signorini.Model(...) or signorini.load(file)."),
    ],
)
@pytest.mark.parametrize("ask", [solve, signorini.contact_problem, lambda model: signorini.path(model, None, "G")])
def test_what_is_no_model_is_told_how_to_become_one(ask, given, says):
    with pytest.raises(InputError) as caught:
        ask(given)
    assert str(caught.value) == says
