"""The arrows of ARCHITECTURE.md, held: who may import whom, and which package is met in which file."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "python" / "signorini"

# From the ground up; a folder counts as one module. A module imports from its own layer and from those before it,
# never in a circle.
LAYERS = (
    {"errors", "_core"},
    {"base", "expression", "shapes"},
    {"design"},
    {"plot"},
    {"mesh", "model"},
    {"discretise", "formats"},
    {"equilibrium", "singularities"},
    {"contact"},
    {"results"},
    {"accuracy"},
    {"analysis"},
    {"output"},
    {"mpi"},
    {"reports"},
    {"studies"},
    {"sensitivities"},
    {"__init__"},
    {"validation"},
    {"importers"},
    {"cli"},
    {"__main__"},
)
# Modules that take arrays and know no other part of the package.
ALONE = {
    "shapes": {"errors", "_core"},
    "design": {"base", "errors", "shapes"},
    "plot": {"base", "errors", "shapes", "_core"},
}
# Packages that only these modules may import.
ONLY_IN = {
    "ezdxf": {"importers"},
    "distributed": {"studies"},
    "highspy": {"base"},
    "jinja2": {"reports", "validation"},
    "markupsafe": {"reports"},
    "PIL": {"plot"},
    "matplotlib": {"plot"},
    "meshio": {"formats", "mesh"},
    "mpi4py": {"mpi"},
    "petsc4py": {"mpi"},
    "pyarrow": {"formats"},
    "shapely": {"design", "model", "shapes"},
    "typer": {"cli"},
    "xlsxwriter": {"formats"},
    "rich": {"cli"},
    "pydantic": {"model", "formats", "expression"},
    "pydantic_core": {"model", "formats", "expression"},
}
# All that a folder's __init__ holds.
DECLARATIONS = (ast.Import, ast.ImportFrom, ast.Assign, ast.Expr)
LAYER_OF = {module: number for number, layer in enumerate(LAYERS) for module in layer}


def sources(package: Path) -> Iterator[tuple[str, str, ast.Module]]:
    """Yield each file's place, the module of the table it belongs to, and its syntax tree."""
    for path in sorted(package.rglob("*.py")):
        place = path.relative_to(package)
        yield place.as_posix(), place.parts[0].removesuffix(".py"), ast.parse(path.read_text(encoding="utf-8"))


def imported(place: str, tree: ast.Module) -> Iterator[str]:
    """Yield the full name of everything a file imports, inside functions too; relative imports made absolute."""
    folder = ("signorini", *Path(place).parts[:-1])
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            parents = folder[: len(folder) - node.level + 1] if node.level else ()
            yield from (".".join([*parents, *filter(None, [node.module]), alias.name]) for alias in node.names)


def arrows(package: Path) -> dict[str, set[str]]:
    """Return which files each file imports; of the package itself and of the core in Rust, their names."""
    files = {place.removesuffix(".py").removesuffix("/__init__"): (place, tree) for place, _, tree in sources(package)}
    graph: dict[str, set[str]] = {}
    for own, (place, tree) in files.items():
        names = (name.split(".")[1:] for name in imported(place, tree) if name.partition(".")[0] == "signorini")
        targets = set()
        for parts in names:
            known = ("/".join(parts[:count]) for count in range(len(parts), 0, -1))
            targets.add(next((name for name in known if name in {*files, "_core"}), "__init__"))
        graph[own] = targets - {own}
    return graph


def circle_of(graph: dict[str, set[str]]) -> list[str]:
    """Return a circle of the graph, or an empty list."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def faults(package: Path) -> list[str]:
    """Say every way in which a package breaks the rules above."""
    files, found = arrows(package), []
    graph: dict[str, set[str]] = {"_core": set()}
    for place, targets in files.items():
        module = place.partition("/")[0]
        graph.setdefault(module, set()).update({target.partition("/")[0] for target in targets} - {module})
    for module in sorted(graph.keys() - LAYER_OF.keys()):
        found.append(f"{module} has no layer: place it in LAYERS of tests/test_architecture.py.")
    for module in sorted(graph.keys() & LAYER_OF.keys()):
        for target in sorted(graph[module] & LAYER_OF.keys()):
            if LAYER_OF[target] > LAYER_OF[module]:
                found.append(f"{module} imports {target}, which stands above it: the arrow runs back.")
            elif module in ALONE and target not in ALONE[module]:
                found.append(f"{module} imports {target}, but it takes arrays and may know only {ALONE[module]}.")
    for circle in filter(None, (circle_of(graph), circle_of(files))):
        found.append(f"These modules import each other in a circle: {' <- '.join(circle)}.")
        break
    for place, module, tree in sources(package):
        if place.endswith("/__init__.py") and any(not isinstance(node, DECLARATIONS) for node in tree.body):
            found.append(f"{place} holds code; a folder's __init__ only hands on names.")
        for name in sorted({name.partition(".")[0] for name in imported(place, tree)}):
            if module not in ONLY_IN.get(name, {module}):
                found.append(f"{place} imports {name}, which belongs in {' and '.join(sorted(ONLY_IN[name]))} alone.")
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print":
                found.append(f"{place}:{node.lineno} prints; only the console of cli speaks to the terminal.")
    return found


def test_imports_run_one_way() -> None:
    assert faults(PACKAGE) == []


# The same of the core's files, from the ground up; a file's arrows within a group are free, but never in a circle.
CORE_LAYERS = (
    ("dense", "double_double", "bodies", "components", "fields", "superposition", "vectorized"),
    ("lcp",),
    ("element",),
    ("plate",),
    ("cholesky",),
    ("displacement",),
    ("rows",),
    ("ordering", "assembly", "residual", "stress"),
    ("contact/tolerances", "contact/error", "contact/scale", "contact/graph", "contact/points", "contact/rigid"),
    ("contact/rigid_body_space", "contact/system", "contact/interface"),
    ("contact/backend",),
    ("contact/problem", "contact/solution", "contact/load"),
    ("contact/residual",),
    ("contact/kkt", "contact/responses"),
    ("contact/refine",),
    ("contact/fixed_state",),
    ("contact/finders",),
    ("contact/solve",),
    ("contact/combine", "contact/path"),
    ("contact",),
)


def used(tree: str) -> Iterator[list[str]]:
    """Yield the path of everything that the tree of a use declaration names."""
    head, brace, rest = tree.partition("{")
    path = [part.strip() for part in head.split("::") if part.strip()]
    if not brace:
        yield [re.sub(r"\s+as\s+\w+", "", part) for part in path]
        return
    depth, part = 0, ""
    for letter in rest.rstrip().removesuffix("}") + ",":
        if letter == "," and depth == 0:
            if part.strip():
                yield from (path + inner for inner in used(part.strip()))
            part = ""
            continue
        depth += (letter == "{") - (letter == "}")
        part += letter


def rust_arrows(source: Path) -> dict[str, set[str]]:
    """Return which files of a crate each file uses, by its use declarations and by paths in its code."""
    files: dict[tuple[str, ...], str] = {}
    for path in sorted(source.rglob("*.rs")):
        parts = path.relative_to(source).with_suffix("").parts
        text = re.sub(r"//.*|\bpub\(in [\w:]+\)", "", path.read_text(encoding="utf-8"))
        files[parts[:-1] if parts[-1] in ("mod", "lib") else parts] = text.partition("#[cfg(test)]")[0]
    graph: dict[str, set[str]] = {}
    for place, text in files.items():
        declared = re.findall(r"\buse\s+([^;]+);", text)
        rest = re.sub(r"\buse\s+[^;]+;", "", text)
        paths = [path for tree in declared for path in used(tree)]
        paths += [path.split("::") for path in re.findall(r"\b[a-z]\w*(?:::\w+)+", rest)]
        targets = set()
        for path in paths:
            at = list(place)
            if path[0] == "crate":
                at, path = [], path[1:]
            elif path[0] not in ("self", "super") and (*place, path[0]) not in files:
                continue
            while path and path[0] in ("self", "super"):
                at, path = (at[:-1] if path[0] == "super" else at), path[1:]
            full = (*at, *path)
            while full and full not in files:
                full = full[:-1]
            targets.add(full)
        graph["/".join(place)] = {"/".join(target) for target in targets if target and target != place}
    return graph


def rust_faults(source: Path) -> list[str]:
    """Say every circle of a crate's files, and every arrow that runs back."""
    graph, found = rust_arrows(source), []
    if circle := circle_of(graph):
        found.append(f"These files use each other in a circle: {' <- '.join(circle)}.")

    def layer(place: str) -> int:
        of = [
            (len(group), number)
            for number, groups in enumerate(CORE_LAYERS)
            for group in groups
            if f"{place}/".startswith(f"{group}/")
        ]
        return max(of)[1] if of else -1

    for place in sorted(graph.keys() - {""}):
        if layer(place) < 0:
            found.append(f"{place} has no layer: place it in CORE_LAYERS of tests/test_architecture.py.")
        back = sorted(target for target in graph[place] if layer(target) > layer(place) >= 0)
        found += [f"{place} uses {target}, which stands above it: the arrow runs back." for target in back]
    return found


def test_a_module_assigns_each_name_once() -> None:
    """A second assignment would change the meaning of all uses of the first one."""
    for path in PACKAGE.rglob("*.py"):
        body = ast.parse(path.read_text(encoding="utf-8")).body
        plain = [target for one in body if isinstance(one, ast.Assign) for target in one.targets]
        targets = plain + [one.target for one in body if isinstance(one, ast.AnnAssign)]
        names = [target.id for target in targets if isinstance(target, ast.Name)]
        assert len(names) == len(set(names)), path


def test_uses_of_the_core_run_one_way() -> None:
    assert rust_faults(ROOT / "core" / "src") == []


def rust(crate: str) -> dict[str, str]:
    """Return a crate's manifest and sources without their comments."""
    files = [ROOT / crate / "Cargo.toml", *sorted((ROOT / crate / "src").rglob("*.rs"))]
    assert len(files) > 1
    return {str(f.relative_to(ROOT)): re.sub(r"(//|#\s).*", "", f.read_text(encoding="utf-8")) for f in files}


@pytest.mark.parametrize(
    ("crate", "forbidden", "why"),
    [
        ("core", r"\b(pyo3|numpy|PyResult)\b", "the core knows no Python"),
        ("core", r"\be?print(ln)?!|std::fs|File::open", "the core does not print and opens no files"),
        ("mesher", r"\b(pyo3|numpy|signorini_core)\b|\be?print(ln)?!|std::fs", "the mesher knows outlines alone"),
        ("bindings", r"\b(faer|clarabel)\b", "the bindings convert and compute nothing"),
    ],
)
def test_the_border_between_rust_and_python(crate: str, forbidden: str, why: str) -> None:
    assert [place for place, text in rust(crate).items() if re.search(forbidden, text)] == [], why


def test_every_entry_into_the_core_works_on_the_threads_of_its_process() -> None:
    """An entry that released the interpreter by itself would wait, in a fork, for threads of its parent's."""
    bindings = {place: text for place, text in rust("bindings").items() if place.endswith(".rs")}
    assert [place for place, text in bindings.items() if re.search(r"\brayon\b|\bdetach\b", text)] == [
        "bindings/src/threads.rs"
    ]


SLOW_TO_READ = {
    *("scipy.linalg", "scipy.optimize", "scipy.spatial", "scipy.sparse.csgraph", "scipy.sparse.linalg"),
    *("matplotlib", "meshio", "pyarrow", "ezdxf", "typer", "rich", "signorini.sensitivities"),
}


@pytest.mark.parametrize(
    "support",
    [
        {"at": [[1, 1], [3, 1], [1, 3], [3, 3]], "resists": "down"},
        {"area": "all", "resists": "down", "stiffness": 1e7},
        {"edge": ["left", "right"], "fix": "simple"},
        {"edge": ["left", "right"], "fix": "clamped"},
    ],
)
def test_a_plain_solve_reads_no_module_that_it_can_do_without(support: dict[str, object]) -> None:
    code = f"""
import sys, signorini
plate = {{"shape": "rectangle", "size": [4, 4], "thickness": 0.2}}
load = [{{"pressure": 2e3}}, {{"force": 1e3, "at": [2, 2]}}]
model = signorini.Model(material={{"E": 30e9, "nu": 0.2}}, plate=plate, support=[{support}], load=load)
assert signorini.estimate(signorini.solve(model)["all"]).plus_minus
print(*sys.modules)
"""
    read = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert SLOW_TO_READ & set(read) == set()
