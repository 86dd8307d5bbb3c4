"""Finds the fenced code blocks of the documentation and the comments that steer their test.

A comment directly above a block says what its test needs to know and no reader does:

- ``<!-- file: name -->`` the block is this file of the reader's folder;
- ``<!-- run: a.b=value -->`` commands ``pellicle run`` in the block get ``--set a.b=value``;
- ``<!-- exit: code -->`` the last command of the block ends with this exit code, not 0;
- ``<!-- untested: reason -->`` the block is only compiled, and its page says that.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]

_COMMENT = re.compile(r"<!-- (\w+): (.+) -->")
_COMMENTS = {"file", "run", "exit", "untested"}


@dataclass(frozen=True)
class Block:
    """A fenced code block."""

    page: Path
    line: int
    language: str
    text: str
    comments: dict[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def blocks(page: Path) -> Iterator[Block]:
    """Yield the blocks of a page in order."""
    lines = page.read_text(encoding="utf-8").splitlines()
    comments: dict[str, str] = {}
    opened: int | None = None
    for number, line in enumerate(lines):
        if opened is not None:
            if line.strip() == "```":
                text = "\n".join(lines[opened + 1 : number]) + "\n"
                language = lines[opened].strip().removeprefix("```").strip()
                yield Block(page, opened + 1, language, text, comments)
                opened, comments = None, {}
        elif line.lstrip().startswith("```"):
            opened = number
        elif match := _COMMENT.fullmatch(line.strip()):
            if match[1] in _COMMENTS:
                comments[match[1]] = match[2]
        elif line.strip():
            assert not comments, f"{page}:{number + 1}: a comment stands above no block"
    assert opened is None, f"{page}:{opened}: the block does not end"
