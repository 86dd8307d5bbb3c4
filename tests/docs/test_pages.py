"""A reader finds: pages are short and linked, nothing stands twice, all that is public is told."""

import re
import tomllib
from collections import defaultdict
from pathlib import Path
from pkgutil import iter_modules

import generated
import pytest

import pellicle as pl
from tests.docs.blocks import DOCS, PAGES, ROOT, blocks

CEILINGS = {
    "README": 800,
    "index": 115,
    "install": 280,
    "first-contact": 1400,
    "first-fit": 1270,
    "notebook": 260,
    "grid": 760,
    "kernels": 1120,
    "indenters": 1220,
    "loads": 750,
    "loading": 1250,
    "adhesion": 1370,
    "time": 950,
    "flow-or-drain": 995,
    "sines": 800,
    "results": 930,
    "outputs": 1200,
    "gradients": 580,
    "studies": 1200,
    "parts": 500,
    "fits": 1700,
    "curves": 1665,
    "gallery": 550,
    "explore": 230,
    "howdoi": 550,
    "theory": 1500,
    "solids": 1530,
    "adhesion-theory": 690,
    "solver": 2300,
    "fit-method": 1360,
    "validation": 1050,
    "performance": 870,
    "paper": 650,
    "compare": 645,
    "plugin": 1405,
    "families": 1915,
    "architecture": 890,
    "decisions": 1500,
    "run-file": 150,
    "commands": 450,
    "library": 170,
    "library-run": 40,
    "library-results": 50,
    "library-fit": 60,
    "library-extend": 40,
    "glossary": 420,
    "citing": 180,
    "sources": 1530,
    "changelog": 5,
}
"""Words of each page that are written by hand."""
_GENERATED = re.compile(
    r"<!-- generated: .*?<!-- end -->|```\{(?:eval-rst|toctree)\}.*?```", re.DOTALL
)
_LONG = 60
"""Characters of a line of code that stands on one page only."""


def words(page: Path) -> int:
    """Return the number of words of a page outside its generated parts."""
    return len(_GENERATED.sub("", page.read_text(encoding="utf-8")).split())


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_page_is_short(page: Path) -> None:
    """No page is longer than its ceiling, and each has one."""
    assert words(page) <= CEILINGS[page.stem]


def test_no_line_of_code_stands_on_two_pages() -> None:
    """A second page links to the example of the first; README shows what two of them begin with."""
    found = defaultdict(set)
    for page in PAGES[1:]:
        for block in blocks(page):
            for line in block.text.splitlines():
                # What a program prints is no code.
                printed = block.language == "console" and not line.startswith("$")
                if len(line.strip()) >= _LONG and not printed:
                    found[line.strip()].add(page.name)
    assert not {line: pages for line, pages in found.items() if len(pages) > 1}


def anchors(page: Path) -> set[str]:
    """Return the anchors of the headings of a page, as repositories and MyST make them."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    heads = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).strip().replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CHANGELOG.md"], ids=lambda page: page.stem)
def test_links_lead_somewhere(page: Path) -> None:
    """Every relative link of a page is a file of the repository, and its anchor a heading there."""
    text = page.read_text(encoding="utf-8")
    assert not re.findall(r"\{(?:doc|ref)\}`", text), "links are written [words](page.md#heading)"
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith("http"):
            continue
        name, _, anchor = target.partition("#")
        to = (page.parent / name) if name else page
        assert to.exists(), target
        if anchor:
            assert anchor in anchors(to), target


REFERENCE = "\n".join(page.read_text(encoding="utf-8") for page in DOCS.glob("library*.md"))


def _page(name: str) -> str:
    return (DOCS / name).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "page",
    [
        # The page of validation has closed theories to compute.
        pytest.param(page, id=page.name, marks=[pytest.mark.slow] * (page.stem == "validation"))
        for page in sorted(DOCS.glob("*.md"))
    ],
)
def test_generated_parts_are_those_of_the_package(page: Path) -> None:
    """Tables of fields, variables, statuses and cases say what the installed package says."""
    text = page.read_text(encoding="utf-8")
    assert text == generated.fill_in(text), "run python docs/generated.py"


@pytest.mark.parametrize("name", pl.__all__)
def test_public_name_is_documented(name: str) -> None:
    """Every name of ``pellicle.__all__`` is on a page of the reference, and has a docstring."""
    assert re.search(rf":: pellicle\.{name}$", REFERENCE, re.MULTILINE)
    if name != "__version__":
        assert getattr(pl, name).__doc__


def test_what_is_public_is_what_the_linter_lets_pass() -> None:
    """Each module of the framework is in the table of public packages, or protected."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    (protected,) = (c["protected_modules"] for c in contracts if c["type"] == "protected")
    rows = re.findall(r"^\| (`pellicle[`.].*?) \|", _page("plugin.md"), re.MULTILINE)
    public = [name for row in rows for name in re.findall(r"`([\w.]+)`", row)]
    modules = [f"pellicle.{module.name}" for module in iter_modules(pl.__path__)]
    assert sorted([*protected, *public]) == sorted(["pellicle", "pellicle.*.*", *modules])
