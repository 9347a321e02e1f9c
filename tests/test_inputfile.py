import json
import tomllib
import warnings

import jsonschema
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from signorini.errors import InputError
from signorini.formats.inputfile import load, schema
from signorini.formats.toml import Lines
from signorini.model import Model

EXAMPLE = """\
title = "Slab on bearings"
[units]                        # labels only
length = "m"
force = "N"

[material]
E = 30e9
nu = 0.2
unit_weight = 25e3

[plate]
shape = "rectangle"
size = [10.0, 10.0]
thickness = 0.3
element = "mitc9"
shear_factor = 0.8333333333

[mesh]
divisions = [40, 40]

[[support]]
name = "walls"
edge = ["left", "right"]
fix = "simple"
[[support]]
name = "bearings"
at = [[2.5, 5.0], [7.5, 5.0]]
resists = "down"
gap = 0.001
stiffness = 5e8
[[support]]
name = "soil"
area = "all"
resists = "down"
stiffness = 30e6

[[load]]
case = "G"
pressure = 2e3
[[load]]
case = "Q"
force = 20e3
at = [5.5, 3.5]

[[combination]]
name = "ULS"
factors = { G = 1.35, Q = 1.5 }

[[probe]]
at = [5.0, 5.0]

[solver]
method = "auto"
"""

OTHER_FORMS = """\
material = { E = 1, nu = 0, unit_weight = 1 }
mesh = { size = 0.25 }
support = [
  { edge = "start", fix = ["w", "slope"] },
  { line = [[0.0, 1.0], [0.5, 1.0]], resists = "up", settlement = "0.001*x" },
  { circle = { center = [1, 1], radius = 1.5 }, resists = "both", gap = "0.01*x**2", stiffness = "1e6*(1 + y**2)" },
  { area = { circle = { center = [0, 0], radius = 0.5 } } },
  { area = { polygon = [[0, 0], [1, 0], [0, 1]] } },
]
load = [
  { pressure = "5*(y-2)**2", area = { rectangle = [0, 0, 1, 1] } },
  { line_load = 1e3, edge = ["outer", "end"] },
  { moment = [1, 2], at = [[0, 0], [1, 1]] },
  { self_weight = true },
  { curvature = [1e-3, 0, 0] },
]
[plate]
shape = "annulus"
inner = 1
outer = 2
center = [1, 1]
sector = 135.5
thickness = "0.1 + x*x"
"""

MATERIAL = "[material]\nE = 1\nnu = 0.3\n"
PLATE = '[plate]\nshape = "rectangle"\nsize = [1, 1]\nthickness = 0.1\n'
LOAD = "[[load]]\npressure = 1\n"
BASE = MATERIAL + PLATE + LOAD


@pytest.fixture
def written(tmp_path):
    def write(text):
        path = tmp_path / "slab.toml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def message(path):
    with pytest.raises(InputError) as caught:
        load(path)
    return str(caught.value)


def one_line(path):
    """The message about a file in one line, after its name."""
    said = message(path)
    assert said.startswith("slab.toml:") and len(said.splitlines()) == 1
    return said


def test_the_example_of_the_contract_is_read_key_by_key(written):
    model = load(written(EXAMPLE))
    assert isinstance(model, Model)
    assert (model.title, model.units.length, model.units.force) == ("Slab on bearings", "m", "N")
    assert (model.material.E, model.material.nu, model.material.unit_weight) == (30e9, 0.2, 25e3)
    assert (model.plate.shape, model.plate.size, model.plate.origin) == ("rectangle", (10, 10), (0, 0))
    assert (model.plate.thickness.value, model.plate.element, model.plate.shear_factor) == (0.3, "mitc9", 0.8333333333)
    assert model.mesh.divisions == (40, 40)
    walls, bearings, soil = model.support
    assert (walls.name, walls.edge, walls.fix) == ("walls", ("left", "right"), "simple")
    assert (bearings.at, bearings.resists, bearings.gap.value) == (((2.5, 5), (7.5, 5)), "down", 0.001)
    assert bearings.stiffness.value == 5e8
    assert (soil.area, soil.stiffness.value) == ("all", 30e6)
    assert [(each.case, each.kind) for each in model.load] == [("G", "pressure"), ("Q", "force")]
    assert (model.combination[0].name, dict(model.combination[0].factors)) == ("ULS", {"G": 1.35, "Q": 1.5})
    assert model.probe[0].at == ((5, 5),)
    assert model.solver.method == "auto"


def test_every_other_form_is_read(written):
    model = load(written(OTHER_FORMS))
    assert [support.place for support in model.support] == ["edge", "line", "circle", "area", "area"]
    assert [each.kind for each in model.load] == ["pressure", "line_load", "moment", "self_weight", "curvature"]
    assert model.support[2].circle.radius == 1.5


def test_windows_line_ends_and_byte_order_mark_are_read(written):
    example = load(str(written(EXAMPLE)))
    assert load(written(b"\xef\xbb\xbf" + EXAMPLE.replace("\n", "\r\n").encode())) == example


def test_the_mesh_file_is_looked_for_beside_the_input_file(written):
    path = written(MATERIAL + '[plate]\nshape = "mesh"\nthickness = 1\nfile = "meshes/plate.msh"\n' + LOAD)
    assert load(path).plate.file == path.parent / "meshes" / "plate.msh"


WRONG = {
    "": [
        ("[suport]", ":10: suport: unknown key 'suport'. Did you mean [[support]]?"),
        ("mesh = 3", "load[1].mesh: unknown key 'mesh'. It is a top-level table: write [mesh]"),
        ("[[support]]", ":10: support[1]: found none; exactly one of at, nodes, edge, line, circle, area"),
        (f"[[support]]\nat = [1, 1]\nname = '{'a' * 201}'", "found text of 201 characters; at most 200 are allowed."),
        ("[[support]]\nat = [1, 1]\nname = 'a'\n" * 2, ':15: support[2].name ("a"): the name "a" is taken by s'),
        ("[[load]]", ":10: load[2]: found none; a load is exactly one of pressure, force, line_load, moment"),
        ("[[combination]]\nname = 'a'\nfactors.load = 1\n" * 2, ':14: combination[2].name ("a"): the name "a" is'),
        ("[[probe]]", "probe[1].at: 'at' is missing."),
        ("[support]\nat = [1, 2]", ":10: support: found a single table"),
        ("[units]\nlength = 3", ":11: units.length: found 3; it must be text in quotes."),
        ("[[combination]]\nfactors = { load = 1, Q = 2 }", ":11: combination[1].factors.Q: Unknown case 'Q'. This"),
        ("[[combination]]\nname = 'a'", "combination[1].factors (\"a\"): 'factors' is missing."),
    ],
    "[solver]\n": [
        ("thickness = 3", ":11: solver.thickness: unknown key 'thickness'. It belongs in [plate] or [[zone]]."),
        ("title = 'x'", "unknown key 'title'. It belongs above the first header of a table."),
        ("method = 'lemk'", 'solver.method: found "lemk"; it must be one of auto, lemke, active_set.'),
    ],
    "[[support]]\n": [
        ("at = [[1, 1], [2, 2], [1, 1.0]]", "support[1].at[3]: point 3 equals point 1."),
        ("line = [[0, 0]]", "support[1].line: found [[0, 0]]; it must be a list of at least 2 points"),
        ("line = [[0, 0], [0, 0]]", "support[1].line: points 1 and 2 are the same."),
        ("area.polygon = [[0,0],[1,1],[1,0],[0,1]]", "support[1].area.polygon: The polygon crosses or touches itself"),
        ("at = [0, 0]\nname = 'soil'\nstifness = 3", ':13: support[1].stifness ("soil"): unknown'),
        ("at = [1, 1]\nedge = 'left'", "support[1]: found at and edge; exactly one of"),
        ("at = 3", ":11: support[1].at: found 3; it must be a point [x, y] or a list of points."),
        ("at = [\n[1, 2],\n[3]]", ":13: support[1].at[2]: found [3]; it must be a point [x, y]."),
        ("at = [\n[1, 2],\n[3,\nnan]]", ":14: support[1].at[2][2]: found nan; it must be finite"),
        ("edge = 'lft'", "support[1].edge: Unknown edge 'lft'. This rectangle has: bottom, left, right, t"),
        ("edge = ['left', 'left']", 'support[1].edge: "left" is listed twice.'),
        ("edge = 3", "it must be the name of an edge or a list of names."),
        ("circle = { radius = 0 }", "support[1].circle.radius: found 0; it must be greater than 0."),
        ("area = 'al'", 'support[1].area: found "al"; it must be "all" or a table with one of rectangle,'),
        ("area = {}", "support[1].area: found none; exactly one of rectangle, circle, polygon, annulus is needed."),
        ("area.rectangle = [1, 0, 0, 1]", "[x0, y0, x1, y1] needs x0 < x1 and y0 < y1."),
        ("area = 'all'\nfix = 'simple'", "support[1].fix: fix is not allowed with area; use resists."),
        ("at = [1, 1]\nfix = 'clampd'", 'support[1].fix: found "clampd"; it must be one of clamped, hard'),
        ("at = [1, 1]\nfix = ['w', 'w']", "each of w, slope, twist"),
        ("at = [1, 1]\nfix = 'hard'", 'support[1].fix: found "hard";'),
        ("edge = 'left'\nfix = 'hard'\nresists = 'down'", "support[1].resists: found both fix and resists"),
        ("edge = 'left'\nfix = 'hard'\ngap = 1", "support[1].gap: a gap is not allowed with fix; use resists."),
        (
            "edge = 'left'\nfix = 'hard'\nstiffness = 1",
            "support[1].stiffness: a stiffness needs fix = simple",
        ),
        (
            "edge = 'left'\nfix = 'symmetry'\nsettlement = 1",
            'support[1].settlement: "symmetry" does not hold the deflection',
        ),
        ("at = [1, 1]\nresists = 'dwn'", 'found "dwn"; it must be one of down, up, both. Did you mean \'down'),
        ("at = [1, 1]\ngap = -1", "support[1].gap: found -1; it must not be less than 0."),
        ("at = [1, 1]\nstiffness = 0", "support[1].stiffness: found 0; it must be greater than 0."),
        ("at = [1, 1]\nstiffness = '1/0'", "support[1].stiffness: '1 / 0' divides by zero."),
        ("area = 'all'\nstiffness = [[1]]", "found [1]; it must be a point [x, y, value]."),
        ("at = [1, 1]\nsettlement = inf", "support[1].settlement: found inf; it must be finite"),
        ("at = [1, 1]\nname = 'a\tb'", "line breaks and control characters are not allowed."),
    ],
    "[mesh]\n": [
        ("size = -1", "mesh.size: found -1; it must be greater than 0."),
        ("size = 1\ndivisions = [1, 1]", "mesh.size: found both divisions and size; give one of them."),
        ("divisions = [1, 1.5]", "mesh.divisions[2]: found 1.5; it must be a whole number."),
        ("divisions = [0, 1]", "mesh.divisions[1]: found 0; it must not be less than 1."),
        ("size = 1e-9", "mesh.size: found 1e+09 by 1e+09 elements; at most 1e+07 are allowed."),
    ],
    "[[load]]\n": [
        ("force = 1\npressure = 1", "load[2]: found pressure and force; a load is exactly one of"),
        ("force = 1", "load[2]: found no place; force needs exactly one of at, nodes"),
        (
            "force = 1\nat = [0, 0]\narea = 'all'",
            "load[2].area: area is not allowed with force, which takes at or nodes.",
        ),
        ("force = '1'\nat = [0, 0]", 'load[2].force: found "1"; it must be a number. Write it without quotes.'),
        ("force = 1e400\nat = [0, 0]", "load[2].force: found inf; it must be finite"),
        ("pressure = 2024-01-01", "load[2].pressure: found the date or time 2024-01-01; it must be a number or"),
        ("case = ''\npressure = 1", "load[2].case: found an empty value."),
        ("self_weight = false", "load[2].self_weight: found false; write true, or leave the key out."),
        ("self_weight = true", "load[2].self_weight: self_weight needs unit_weight"),
        ("self_weight = true\nat = [0, 0]", "load[2].at: at is not allowed with self_weight"),
        ("curvature = [1, 2]", "load[2].curvature: found [1, 2]; it must be three curvatures [kx, ky, kxy]."),
        ("moment = 1\nat = [0, 0]", "load[2].moment: found 1; it must be [mx, my], couples about two axes."),
        ("line_load = 1", "line_load needs exactly one of edge, line, circle"),
    ],
}


@pytest.mark.parametrize(
    ("text", "says"), [(table + keys, says) for table, rows in WRONG.items() for keys, says in rows]
)
def test_bad_input_gives_one_message_with_its_place(written, text, says):
    assert says in one_line(written(BASE + text))


PLATES = {
    "": [
        (
            "shape = 'ellipse'",
            ':5: plate.shape: found "ellipse"; it must be one of rectangle, disc, annulus, polygon, mesh.',
        ),
        ("shape = 'disk'", "Did you mean 'disc'?"),
        ("size = [1, 1]", ":4: plate.shape: 'shape' is missing. Shape of the plate: one of rectangle, disc,"),
        ("shape = 'rectangle'\nsize = [1, 1]", ":4: plate.thickness: 'thickness' is missing. Thickness: a number"),
        ("shape = 'rectangle'\nsize = [1, 0]\nthickness = 1", "plate.size[2]: found 0; it must be greater than 0."),
        (
            "shape = 'rectangle'\nsize = 3\nthickness = 1",
            "plate.size: found 3; it must be two lengths [a, b], along x and y.",
        ),
        (
            "shape = 'mesh'\nthickness = 1\nfile = 'a.msh'\n[mesh]\nsize = 1",
            "mesh.size: size is not allowed with a mesh file",
        ),
    ],
    "shape = 'rectangle'\nsize = [1, 1]\n": [
        ("thickness = -0.1", "plate.thickness: found -0.1; it must be greater than 0."),
        ("thickness = 'x+'", "'x+' is not an expression in x and y: it cannot be read"),
        ("thickness = 1\norigin = [1e9, 0]", "Move the plate to the origin."),
    ],
    "shape = 'disc'\nradius = 1\nthickness = 1\n": [
        ("sector = 45", "plate.sector: found 45; a disc can be 90, 180 or 360"),
        ("element = 'mitc4'", "it must be one of mitc9, q8r. Did you mean 'mitc9'?"),
        ("size = [1, 1]", "plate.size: unknown key 'size'. It needs shape = \"rectangle\"."),
    ],
    "shape = 'annulus'\ninner = 1\n": [
        ("outer = 1.000000001\nthickness = 1", "plate.outer: found 1.000000001; it must exceed inner, which is 1."),
        ("outer = 2\nthickness = 1\nsector = 1e-9", "plate.sector: found 1e-09"),
        (
            "outer = 2\nthickness = 1\nsector = 359.9999999",
            "plate.sector: found 359.9999999",
        ),
    ],
}


@pytest.mark.parametrize(
    ("plate", "says"), [(head + keys, says) for head, rows in PLATES.items() for keys, says in rows]
)
def test_bad_plate_gives_one_message_with_its_place(written, plate, says):
    assert says in one_line(written(f"{MATERIAL}[plate]\n{plate}\n{LOAD}"))


@pytest.mark.parametrize(
    ("material", "says"),
    [
        ("E = 0\nnu = 0.3", ":2: material.E: found 0; it must be greater than 0."),
        ("E = 1", "material.nu: 'nu' is missing. Poisson's ratio"),
        ("Ex = 1\nE = 1", "material.E: found E beside Ex; a material is isotropic (E, nu) or orthotropic (Ex, Ey,"),
        ("Ex = 1\nEy = 2\nnu_xy = 0", "material.Gxy: 'Gxy' is missing"),
        (
            "Ex = 1\nEy = 4\nnu_xy = 0.5\nGxy = 1",
            "material.nu_xy: found 0.5;",
        ),
        ("E = 1\nnu = 0.5", ":3: material.nu: found 0.5; it must be less than 0.5."),
        ("E = 1\nnu = -1", "material.nu: found -1; it must be greater than -1."),
        ("E = 1e-99\nnu = 0", "material.E: found 1e-99; it must be at least 1e-60. Choose other units."),
        (f"E = 1{'0' * 99}\nnu = 0", "material.E: found an integer of more than 20 digits; it must be finite"),
        ("E = 1\nnu = 0\nunit_weight = -1", "material.unit_weight: found -1; it must not be less than 0."),
    ],
)
def test_bad_material_gives_one_message_with_its_place(written, material, says):
    assert says in one_line(written(f"[material]\n{material}\n{PLATE}{LOAD}"))


def test_several_problems_are_one_error_in_the_order_of_the_file(written):
    text = BASE.replace("nu = 0.3", "nu = 0.7") + "[[support]]\nat = [0, 0]\ngap = -1\n[slver]\n"
    assert message(written(text)).splitlines() == [
        "slab.toml: 3 problems:",
        "  slab.toml:3: material.nu: found 0.7; it must be less than 0.5.",
        "  slab.toml:12: support[1].gap: found -1; it must not be less than 0.",
        "  slab.toml:13: slver: unknown key 'slver'. Did you mean [solver]? Allowed here: title, units, material, "
        "plates, plate, zone, mesh, support, contact, load, cases, combination, tightening, moving, probe, section, "
        "strip, profile, punching, check, reinforcement, output, solver, report.",
    ]


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (
            b"title = 'a'\nE 3\n",
            "slab.toml:2: invalid TOML. A line must be [a header], key = value, or # a comment. Found (column 3): E 3",
        ),
        (b"a = 1\n\nb = [1,\n", "slab.toml:3: invalid TOML: invalid value at the end of the file in: b = [1,"),
        (b"a = 1\na = 2\n", "slab.toml:2: invalid TOML. This key occurs twice in its table"),
        (b"a = 1\nb = '\xff'\n", "slab.toml:2: byte 0xff is not UTF-8 text."),
        (b"\xff\xfea\x00", "slab.toml:1: byte 0xff is not UTF-8 text. Save the file in the encoding UTF-8."),
        (b"a = " + b"9" * 5000, "slab.toml: a number has too many digits."),
        (b"a = " + b"[" * 100_000, "slab.toml: lists or tables are nested too deeply."),
        (b"a." * 100_000 + b"a = 1", "slab.toml:1: a dotted key has more than 16 parts."),
        (b"# comment\n" * 500_000, "the file is larger than 4 MB"),
        (b"", "slab.toml: 2 problems:"),
        (b"".join(b"k%d = 1\n" % i for i in range(20_000)), "20002 problems:"),
    ],
)
def test_file_that_is_no_input_file_says_why(written, content, says):
    assert says in message(written(content))


def test_file_that_cannot_be_read_says_why(tmp_path):
    assert "the file does not exist" in message(tmp_path / "none.toml")
    assert "this is a directory" in message(tmp_path)
    assert "cannot be read" in message("a\0b")


def test_lines_are_right_for_every_way_of_writing_toml():
    text = '''# first
a."b.c" . 'd' = """
[not.a.table]
x = 1 ""\\"" # = ["""
e = [ # ]
  1, "]", [2,
    3], { k = "#", l.m = [
  ] },
]
["t a"]
f = \'\'\'
'\'\'\'
[t.u]
g = 2024-01-01 10:00:00
[[t.v]]
[t.v.w]
h = 1
[[t.v]]
[[t.v.x]]
i = { j = 1 }
'''
    tomllib.loads(text)
    lines = Lines(text)
    expected = {
        ("a", "b.c", "d"): 2,
        ("e",): 5,
        ("e", 1): 6,
        ("e", 2, 1): 7,
        ("e", 3, "k"): 7,
        ("e", 3, "l", "m"): 7,
        ("t a", "f"): 11,
        ("t", "u", "g"): 14,
        ("t", "v", 0): 15,
        ("t", "v", 0, "w", "h"): 17,
        ("t", "v", 1): 18,
        ("t", "v", 1, "x", 0, "i", "j"): 20,
        ("t", "v", 1, "x", 0, "missing", 3): 19,
        ("nowhere",): 1,
    }
    assert {path: lines.of(path) for path in expected} == expected


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_garbled_files_are_models_or_input_errors(data, written):
    text = data.draw(st.sampled_from([EXAMPLE, OTHER_FORMS]))
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        end = min(len(text), start + data.draw(st.integers(0, 12)))
        insert = st.text(alphabet="[]{}=\"'.,#\n \\-0123456789eE_aginfxy\x00é", max_size=6)
        text = text[:start] + data.draw(insert) + text[end:]
    try:
        load(written(text))
    except InputError as error:
        assert str(error).startswith("slab.toml")


def test_schema_is_draft_2020_12_and_describes_every_key():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = schema()
    jsonschema.Draft202012Validator.check_schema(found)
    assert found["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert '"null"' not in json.dumps(found)
    for table in (found, *found["$defs"].values()):
        assert table["description"]
        assert table["additionalProperties"] is False
        for key, field in table["properties"].items():
            assert field.get("description"), key


@pytest.mark.parametrize("text", [EXAMPLE, OTHER_FORMS, BASE])
def test_schema_accepts_what_is_right(text):
    jsonschema.validate(tomllib.loads(text), schema())


@pytest.mark.parametrize(
    "text",
    [
        "[[support]]\nat = [0, 0]\nstifness = 1",
        "[[support]]\nat = [0, 0]\nedge = 'left'",
        "[[support]]\nedge = 'left'\nfix = 'simple'\nresists = 'down'",
        "[[support]]\nat = [0, 0]\nstiffness = 0",
        "[[load]]\nforce = 1",
        "[[load]]\nforce = 1\nat = [0, 0]\npressure = 1",
        "[[load]]\nline_load = 1\nedge = 'left'\nline = [[0, 0], [1, 1]]",
        "[mesh]\nsize = 1\ndivisions = [1, 1]",
        "[solver]\nmethod = 'x'",
        "[[combination]]\nname = 'a'",
    ],
)
def test_schema_refuses_what_is_wrong(text):
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(tomllib.loads(BASE + text), schema())
