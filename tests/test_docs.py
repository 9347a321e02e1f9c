"""Documents: keys of the schema, links, code on pages, cells of tables."""

import re
import runpy
from pathlib import Path

import pytest

import signorini

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "docs" / "input.md").read_text("utf-8")
SCHEMA = signorini.schema()
RUN = runpy.run_path(str(ROOT / "docs" / "pages.py"))
DOCS = [*sorted((ROOT / "docs").glob("*.md")), *RUN["RUN"]]


def anchors(text):
    """Anchors of the headings of a document, as GitHub makes them."""
    heads = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


PAGES = runpy.run_path(str(ROOT / "docs" / "tables.py"))["PAGES"]


@pytest.mark.parametrize("name", PAGES)
def test_the_generated_pages_are_up_to_date(name):
    assert (ROOT / "docs" / name).read_text("utf-8") == PAGES[name]()


def test_every_key_has_a_description():
    for table in SCHEMA["$defs"].values():
        assert all(node.get("description") for node in table.get("properties", {}).values())


@pytest.mark.parametrize("path", [*sorted(ROOT.glob("*.md")), *DOCS], ids=lambda path: path.name)
def test_links_between_documents_lead_somewhere(path):
    for target in re.findall(r"\]\(([^)\s]+)\)", path.read_text("utf-8")):
        # Sphinx checks links to pages of the site alone.
        if target.startswith(("http", "mailto")) or re.match(r"(\.\./)*(made|reference)/", target):
            continue
        name, _, anchor = target.partition("#")
        other = path.parent / name if name else path
        assert other.exists(), target
        assert not anchor or anchor in anchors(other.read_text("utf-8")), target


@pytest.mark.parametrize("page", RUN["RUN"], ids=lambda page: f"{page.parent.name}-{page.stem}")
def test_the_code_of_a_page_runs_and_writes_what_the_page_shows(page):
    RUN["run"](page)


def test_cells_of_tables_are_phrases():
    for path in DOCS:
        if path.name in ("input.md", "results.md", *PAGES):
            rows = re.findall(r"^\|(.*)\|$", path.read_text("utf-8"), re.MULTILINE)
            assert max(len(cell.split()) for row in rows for cell in row.split("|")) <= 40


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
