from __future__ import annotations

import sys
from importlib.metadata import version as installed_version
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

import generated

project = "pellicle"
author = "the authors of pellicle"
copyright = author
version = release = installed_version("pellicle")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
]
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3
default_role = "code"
exclude_patterns = ["_build", "joss"]
html_theme = "furo"
html_title = f"pellicle {release}"

autodoc_member_order = "bysource"
autodoc_typehints = "none"
napoleon_use_rtype = False
napoleon_use_ivar = True


_COLON = "\ue000"


def _fill_in(app: Any, docname: str, source: list[str]) -> None:
    """Replace ``<!-- generated: name -->`` by what the installed package says."""
    source[0] = generated.fill_in(source[0])


def _model_signature(
    app: Any, what: str, name: str, obj: Any, options: Any, signature: str, returned: str
) -> tuple[str, str] | None:
    """Show the fields of a model instead of ``(**data)``."""
    fields = getattr(obj, "model_fields", None) if what == "class" else None
    if fields is None:
        return None
    shown = [
        field if info.is_required() else f"{field}={generated.default(info)}"
        for field, info in fields.items()
    ]
    return f"(*, {', '.join(shown)})" if shown else "()", ""


def _hide(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Hide the colons of properties: napoleon takes what stands before one for a type."""
    lines[:] = [line.replace("|", r"\|") for line in lines]
    if what in ("attribute", "property"):
        lines[:] = [line.replace(": ", _COLON) for line in lines]


def _show(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    lines[:] = [line.replace(_COLON, ": ") for line in lines]


def setup(app: Any) -> None:
    """Connect the functions above."""
    app.connect("source-read", _fill_in)
    app.connect("autodoc-process-signature", _model_signature)
    app.connect("autodoc-process-docstring", _hide, priority=100)
    app.connect("autodoc-process-docstring", _show, priority=900)
