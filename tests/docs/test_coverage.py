"""Nothing public is without documentation."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

import generated
import pytest

import pellicle as pl
from pellicle.commands import commands, typer_command
from tests.docs.blocks import DOCS, PAGES, ROOT

COMMANDS: dict[str, Any] = {name: typer_command(name) for name in commands()}
REFERENCE = "\n".join(page.read_text(encoding="utf-8") for page in DOCS.glob("reference*.md"))


def _page(name: str) -> str:
    return (DOCS / name).read_text(encoding="utf-8")


def _section(page: str, heading: str) -> str:
    """Return the text under a heading, up to the next one of its level or above."""
    title = re.search(rf"^(##+) {re.escape(heading)}$", page, re.MULTILINE)
    assert title, f"no section {heading!r}"
    text = page[title.end() :]
    return re.split(rf"^#{{1,{len(title[1])}}} ", text, maxsplit=1, flags=re.MULTILINE)[0]


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


@pytest.mark.parametrize("command", COMMANDS)
def test_command_is_documented(command: str) -> None:
    """Every command has a section in docs/commands.md with an example and all its options."""
    section = _section(_page("commands.md"), f"`pellicle {command}`")
    if command != "validate":
        assert f"$ pellicle {command}" in section or f" pellicle {command}\n" in section
    for parameter in COMMANDS[command].params:
        for option in parameter.opts if parameter.param_type_name == "option" else ():
            if option != "--help":
                assert f"`{option}" in section, f"{option} of {command}"


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


def _links() -> Iterator[tuple[Path, str]]:
    for page in [*PAGES, ROOT / "CHANGELOG.md"]:
        for target in re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8")):
            if not target.startswith("http"):
                yield page, target


def test_links_lead_somewhere() -> None:
    """Every relative link of a page is a file of the repository."""
    assert not [(page.name, to) for page, to in _links() if not (page.parent / to).is_file()]
