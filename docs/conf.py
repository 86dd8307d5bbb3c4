from __future__ import annotations

import re
from importlib.metadata import version as installed_version
from typing import Any

from numpy.typing import ArrayLike
from sphinx.util.typing import stringify_annotation

from pellicle.arrays import Array, Mask

project = "pellicle"
author = "the authors of pellicle"
copyright = author
version = release = installed_version("pellicle")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx-mathjax-offline",
    "sphinx_copybutton",
]
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3
default_role = "code"
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = f"pellicle {release}"
html_static_path = ["static"]
html_css_files = ["pellicle.css"]

copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True
copybutton_copy_empty_lines = False

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88
napoleon_use_rtype = False
napoleon_use_ivar = True
nitpicky = True
# Names in signatures that the reference does not describe: those of other packages, as their
# authors import them, and types that users only hand on.
nitpick_ignore_regex = [
    ("py:class", r"(xarray|xr|numpy|np|matplotlib|pathlib|collections|pydantic|pellicle\w*)\..*"),
    ("py:class", r"[A-Z]\w*"),
]

_ALIASES = {
    stringify_annotation(alias, "smart"): name
    for name, alias in (("Array", Array), ("Mask", Mask), ("ArrayLike", ArrayLike))
}
_COLON = "\ue000"


def _signature(
    app: Any, what: str, name: str, obj: Any, options: Any, signature: str, returned: str
) -> tuple[str, str]:
    """Show the fields of a model instead of ``(**data)``, and array types by their short names."""
    fields = getattr(obj, "model_fields", None) if what == "class" else None
    if fields is not None:
        shown = []
        for field, info in fields.items():
            value = info.get_default(call_default_factory=True)
            default = getattr(value, "type", None) or repr(value)
            shown.append(field if info.is_required() else f"{field}={default}")
        return f"(*, {', '.join(shown)})" if shown else "()", ""
    return _short(signature), _short(returned)


def _short(text: str | None) -> str | None:
    for long, short in _ALIASES.items():
        text = text and text.replace(long, short)
    return text and re.sub(r"<object object at \w+>|<factory>", "...", text)


def _hide(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Hide the colons of properties: napoleon takes what stands before one for a type."""
    lines[:] = [line.replace("|", r"\|") for line in lines]
    if what in ("attribute", "property"):
        lines[:] = [line.replace(": ", _COLON) for line in lines]


def _show(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    lines[:] = [line.replace(_COLON, ": ") for line in lines]


def setup(app: Any) -> None:
    """Connect the functions above."""
    app.connect("autodoc-process-signature", _signature)
    app.connect("autodoc-process-docstring", _hide, priority=100)
    app.connect("autodoc-process-docstring", _show, priority=900)
