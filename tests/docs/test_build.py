"""The HTML of the documentation builds."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tests.docs.blocks import DOCS


def test_sphinx_builds_without_a_warning(tmp_path: Path) -> None:
    """Sphinx makes every page, and any warning of it is an error."""
    done = subprocess.run(
        [
            *(sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q"),
            *("-d", tmp_path / "doctrees", DOCS, tmp_path / "html"),
        ],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "NO_COLOR": "1"},
    )
    assert done.returncode == 0, done.stderr
    html = tmp_path / "html"
    for page in DOCS.glob("*.md"):
        assert (html / f"{page.stem}.html").is_file()
    assert 'id="pellicle.run"' in (html / "reference.html").read_text(encoding="utf-8")
