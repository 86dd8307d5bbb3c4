"""Write the package of a plugin, for ``pellicle new --plugin``."""

from __future__ import annotations

import re
import sys
from importlib.resources import files
from importlib.util import find_spec
from keyword import iskeyword
from pathlib import Path
from string import Template

from pellicle.errors import ConfigError, StorageError
from pellicle.files import storage_errors
from pellicle.plugins import registry

_NAME = re.compile(r"[a-z][a-z0-9]*([-_][a-z0-9]+)*")


def write_plugin(family: str, name: str, parent: Path) -> Path:
    """Write a complete package that adds a component, and return its folder.

    Parameters
    ----------
    family
        A family whose base class is in a package with a folder ``templates/FAMILY``.
    name
        The component's type, such as ``graded`` or ``graded-solid``.
    parent
        Folder in which the folder of the package is created.

    Raises
    ------
    ConfigError
        The family or its template does not exist, or the name cannot be used.
    StorageError
        The folder exists already, or cannot be written.
    """
    template = _template(family)
    names = _names(family, name)
    folder = parent / names["distribution"]
    package = files("pellicle") / "templates" / "package"
    sources = {
        "pyproject.toml": package / "pyproject.toml",
        "README.md": package / "README.md",
        f"{names['module']}.py": template / "module",
        f"test_{names['module']}.py": template / "test",
        f"{names['type']}.toml": template / "example",
    }
    with storage_errors(folder):
        try:
            folder.mkdir()
        except FileExistsError:
            raise StorageError(f"{folder} exists already; give another name") from None
        for file, source in sources.items():
            text = Template(source.read_text(encoding="utf-8")).substitute(names)
            (folder / file).write_text(text, encoding="utf-8")
    return folder


def _template(family: str) -> Path:
    """Return the folder of a family's template.

    Raises
    ------
    ConfigError
        The family does not exist, or the package of its base class has no template of it.
    """
    families = registry().families
    if family not in families:
        raise ConfigError(
            f"{family!r} is not a family; give one of {', '.join(families)}", "--plugin"
        )
    package = families[family].__module__.partition(".")[0]
    for path in getattr(sys.modules[package], "__path__", ()):
        if (template := Path(path, "templates", family)).is_dir():
            return template
    raise ConfigError(f"{package} has no template of the family {family!r}", "--plugin")


def _names(family: str, name: str) -> dict[str, str]:
    """Return the names that derive from that of the component."""
    type_ = name.replace("-", "_")
    class_name = "".join(word.capitalize() for word in type_.split("_"))
    if not _NAME.fullmatch(name) or iskeyword(type_) or iskeyword(class_name):
        raise ConfigError(
            f"{name!r} cannot be the name of a component; give lower-case words of letters a to z "
            "and digits, joined by - or _, such as 'graded-solid'",
            "NAME",
        )
    if owner := registry().components[family].get(type_):
        noun = f"{'an' if family[0] in 'aeiou' else 'a'} {family}"
        raise ConfigError(
            f"{type_!r} is already the type of {noun} from {owner.origin}; give another", "NAME"
        )
    module = f"pellicle_{type_}"
    if find_spec(module):
        raise ConfigError(f"a module {module} is installed already; give another name", "NAME")
    return {
        "family": family,
        "type": type_,
        "class_name": class_name,
        "module": module,
        "distribution": module.replace("_", "-"),
    }
