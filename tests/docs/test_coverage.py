"""Nothing public is without documentation."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from pkgutil import iter_modules

import generated
import pytest

import pellicle as pl
from tests.docs.blocks import DOCS, ROOT

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
