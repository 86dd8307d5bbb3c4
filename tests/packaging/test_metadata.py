"""Files that registries and journals read say the same as the package."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
OWNER = "https://example.org/OWNER/pellicle"
CONDA_NAMES = {"matplotlib": "matplotlib-base"}


@pytest.fixture(scope="module")
def project() -> dict[str, Any]:
    """Return the table ``project`` of pyproject.toml."""
    data = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    return dict(data["project"])


def text(name: str) -> str:
    """Return the content of a file of the repository."""
    return (ROOT / name).read_text(encoding="utf-8")


def test_versions_agree(project: dict[str, Any]) -> None:
    """The citation, codemeta.json and the conda recipe have the version of the package."""
    version = project["version"]
    assert re.search(rf"^version: {re.escape(version)}$", text("CITATION.cff"), re.MULTILINE)
    assert json.loads(text("codemeta.json"))["version"] == version
    assert f'  version: "{version}"\n' in text(".conda/recipe.yaml")


def test_keywords_and_licence_agree(project: dict[str, Any]) -> None:
    """The licence is named alike, and every keyword of the package is one of codemeta.json."""
    meta = json.loads(text("codemeta.json"))
    assert meta["license"].endswith(f"/{project['license']}")
    assert f"\nlicense: {project['license']}\n" in text("CITATION.cff")
    assert {*project["keywords"]} <= {*meta["keywords"]}


def test_conda_recipe_has_the_dependencies(project: dict[str, Any]) -> None:
    """The recipe runs with exactly what the package needs."""
    run = text(".conda/recipe.yaml").partition("  run:\n")[2].partition("\n\n")[0]
    recipe = {line.strip().removeprefix("- ").replace(" ", "") for line in run.splitlines()}
    expected = {f"python{project['requires-python']}"}
    for dependency in project["dependencies"]:
        name, limit = re.fullmatch(r"([\w-]+)(.*)", dependency).groups()  # type: ignore[union-attr]
        expected.add(CONDA_NAMES.get(name, name) + limit)
    assert recipe == expected


def test_the_files_that_tests_begin_with_exist() -> None:
    """A file that is renamed or split keeps its place among the longest."""
    listed = re.findall(r'^    "(tests/.*\.py)",$', text("tests/conftest.py"), re.MULTILINE)
    assert len(listed) > 9
    assert [name for name in listed if not (ROOT / name).exists()] == []
