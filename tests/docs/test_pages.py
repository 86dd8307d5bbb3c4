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
    "index": 36,
    "install": 240,
    "first-contact": 1065,
    "first-fit": 1205,
    "notebook": 235,
    "grid": 675,
    "kernels": 1065,
    "indenters": 1133,
    "loads": 730,
    "loading": 1170,
    "adhesion": 1290,
    "time": 895,
    "flow-or-drain": 1005,
    "sines": 795,
    "results": 875,
    "outputs": 1170,
    "gradients": 559,
    "studies": 1125,
    "parts": 500,
    "fits": 1554,
    "curves": 1668,
    "gallery": 500,
    "explore": 180,
    "howdoi": 160,
    "theory": 1375,
    "solids": 1500,
    "adhesion-theory": 680,
    "solver": 2144,
    "fit-method": 1360,
    "validation": 930,
    "performance": 865,
    "paper": 580,
    "compare": 645,
    "plugin": 1385,
    "families": 1821,
    "architecture": 890,
    "decisions": 1220,
    "run-file": 115,
    "commands": 340,
    "library": 155,
    "library-run": 25,
    "library-results": 31,
    "library-fit": 40,
    "library-extend": 26,
    "glossary": 410,
    "citing": 175,
    "sources": 1515,
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
