"""The HTML of the documentation builds, and reads without a network."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.docs.blocks import DOCS

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def html(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the pages; any warning of sphinx, of missing references too, fails."""
    folder = tmp_path_factory.mktemp("docs")
    done = subprocess.run(
        [
            *(sys.executable, "-m", "sphinx", "-n", "-W", "--keep-going", "-q"),
            *("-d", folder / "doctrees", DOCS, folder / "html"),
        ],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "NO_COLOR": "1"},
    )
    assert done.returncode == 0, done.stderr
    return folder / "html"


def test_sphinx_builds_without_a_warning(html: Path) -> None:
    """Sphinx makes every page, with the reference."""
    for page in DOCS.glob("*.md"):
        assert (html / f"{page.stem}.html").is_file()
    solve = (html / "library-run.html").read_text(encoding="utf-8")
    assert 'id="pellicle.run"' in solve
    signature = solve[solve.index('id="pellicle.displacement"') :].partition("</dt>")[0]
    words = re.sub(r"<[^>]+>|\s", "", signature)
    assert "pressure:Array" in words
    assert "grid:Grid" in words


def test_no_page_needs_a_network(html: Path) -> None:
    """Scripts, styles, fonts and pictures of every page are files beside it."""
    for page in html.glob("*.html"):
        text = page.read_text(encoding="utf-8")
        loaded = re.findall(r"<(?:script|img)\b[^>]*?\bsrc=\"([^\"]+)\"", text)
        loaded += re.findall(r"<link\b[^>]*?\brel=\"stylesheet\"[^>]*?\bhref=\"([^\"]+)\"", text)
        assert loaded
        for address in loaded:
            assert (html / address.partition("?")[0]).is_file(), (page.name, address)


def test_every_formula_is_one(html: Path) -> None:
    """No dollar sign is left of a formula outside code."""
    for page in html.glob("*.html"):
        text = page.read_text(encoding="utf-8")
        article = text.partition("<article")[2].partition("</article>")[0]
        prose = re.sub(r"<(pre|code)\b.*?</\1>", "", article, flags=re.DOTALL)
        assert "$" not in prose, page.name


def test_formulas_are_set_without_a_network(html: Path, browser: Chrome) -> None:
    """The browser sets every formula of the page on solids from local files, none with an error."""
    browser.get((html / "solids.html").as_uri())
    count = browser.execute_async_script("""
        const done = arguments[0];
        const wait = () => window.MathJax?.startup?.promise
            ? MathJax.startup.promise.then(() => done([
                document.querySelectorAll(".math").length,
                document.querySelectorAll(".math mjx-container").length,
                document.querySelectorAll("mjx-merror").length]))
            : setTimeout(wait, 50);
        wait();
    """)
    formulas, rendered, errors = count
    assert formulas > 100
    assert (rendered, errors) == (formulas, 0)
