"""What a broken component is: a good one with a part replaced, and what a run does with it."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any, ClassVar, Literal, NamedTuple

import pellicle as pl
from pellicle.components.installed import registry


class Refused:
    """A run raises ``error``, whose message has all the words."""

    def __init__(self, *words: str, error: type[Exception] = pl.PluginError) -> None:
        self.words, self.error = words, error


RULE = Refused("breaks the rule", "required: ")
"""The rule of the kit needs no run, so that a run asks it first."""


class Marked(NamedTuple):
    """A run goes on, and the status of its last step has this code."""

    code: str


class Taken(NamedTuple):
    """A run goes on and converges; why that is accepted."""

    why: str


class Broken:
    """A component that is a good one but for its members.

    ``run`` is what a run does with it: without a guard of runs it is Marked or Taken. ``where``
    names the uses to which that applies, if not those that are usual in its family. A function
    among the members replaces a method: its first argument is the method of the good component,
    the others are those of the call. ``fields`` have an annotation and a default.
    """

    def __init__(
        self,
        fault: str,
        run: Refused | Marked | Taken,
        *where: str,
        good: Any = None,
        settings: dict[str, Any] | None = None,
        fields: dict[str, tuple[Any, Any]] | None = None,
        **members: Any,
    ) -> None:
        self.fault, self.run, self.where, self.good = fault, run, where, good
        self.settings, self.fields, self.members = settings or {}, fields or {}, members


class Family(NamedTuple):
    """The broken components of a family, and what a run does with one."""

    good: Any
    settings: dict[str, Any]
    """Fields of a good component."""
    uses: dict[str, Callable[[Any, Path], str]]
    """Ways in which a run uses a component, by name; each returns the code of the last step."""
    usual: tuple[str, ...]
    broken: dict[str, Broken | list[Broken]]
    """By the rule of the kit that refuses them."""


def subclass(good: Any, name: str, kinds: dict[str, Any], module: str, **members: Any) -> Any:
    """Return a subclass of a component with annotations; it is pickled by its name in a module."""
    made = type(name, (good,), {"__module__": module, "__annotations__": kinds, **members})
    setattr(sys.modules[module], name, made)
    return made


def base(family: str, type_: str) -> Any:
    """Return a built-in component, to be broken under a type of its own."""
    good = registry().components[family][type_].component
    own = {"__doc__": f"{good.__name__} to be broken.", "type": "broken"}
    return subclass(good, f"Broken{good.__name__}", {"type": Literal["broken"]}, __name__, **own)


def make(family: Family, broken: Broken) -> Any:
    """Return a component that is broken."""
    good = broken.good or family.good

    def method(member: str, change: Callable[..., Any]) -> Callable[..., Any]:
        def changed(self: Any, *arguments: Any) -> Any:
            return change(getattr(super(made, self), member, None), *arguments)

        changed.__name__ = member
        return changed

    namespace: dict[str, Any] = {"__doc__": "Broken."}
    kinds = {key: kind for key, (kind, _) in broken.fields.items()}
    namespace |= {key: default for key, (_, default) in broken.fields.items()}
    for key, value in broken.members.items():
        namespace[key] = method(key, value) if isinstance(value, FunctionType) else value
        if isinstance(value, (str, tuple)):
            kinds[key] = ClassVar[Any]
    name = broken.fault.title().replace(" ", "")
    made = subclass(good, name, kinds, good.__module__, **namespace)
    return made(**family.settings | broken.settings)


GRID: dict[str, Any] = {"points": [12, 10], "size": ["0.24 mm", "0.2 mm"]}
PARTS: dict[str, Any] = {
    "grid": GRID,
    "kernel": {"type": "half_space", "reduced_modulus": 1e4},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
}


def run(folder: Path | None = None, **parts: Any) -> str:
    """Solve two depths of a paraboloid on a half-space, with ``parts`` in place of these."""
    configuration: Any = PARTS | {"loading": {"depth": ["1 um", "2 um"]}} | parts
    result = pl.run(configuration, directory=folder, progress=False, threads=1)
    return "CONVERGED" if result.converged else str(result.dataset["status_code"].values[-1])


def study(folder: Path, executor: Any = None, **parts: Any) -> str:
    """Execute two runs of a paraboloid on half-spaces, with ``parts`` in place of these."""
    runs = pl.Study(
        run=PARTS | {"loading": {"depth": "2 um"}, "outputs": []} | parts,
        vary={"kernel.reduced_modulus": [1e4, 2e4]},
        executor=executor or {"type": "serial"},
    )
    table = pl.run_study(runs, folder, progress=False, threads=1)
    return "CONVERGED" if table["converged"].all() else str(table["status_code"].values[-1])
