"""Components by the name of their type, for programs and notebooks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from .components.base import Component
from .components.indenter import Indenter
from .components.interaction import Interaction
from .components.kernel import Kernel
from .components.solver import Solver
from .plugins import registry

AnyComponent = TypeVar("AnyComponent", bound=Component)


def kernel(type: str, /, **fields: Any) -> Kernel:  # noqa: A002 - name of the field
    """Return a kernel by its type, e.g. ``kernel("half_space", reduced_modulus="10 kPa")``.

    Raises
    ------
    ConfigError
        No such type, or fields that it does not allow.
    """
    return _component(Kernel, type, fields)


def indenter(type: str, /, **fields: Any) -> Indenter:  # noqa: A002 - name of the field
    """Return an indenter by its type, e.g. ``indenter("sphere", radius="5 um")``.

    Raises
    ------
    ConfigError
        No such type, or fields that it does not allow.
    """
    return _component(Indenter, type, fields)


def interaction(type: str, /, **fields: Any) -> Interaction:  # noqa: A002 - name of the field
    """Return an interaction by its type: ``interaction("jkr", work_of_adhesion="50 mJ/m^2")``.

    Raises
    ------
    ConfigError
        No such type, or fields that it does not allow.
    """
    return _component(Interaction, type, fields)


def solver(type: str, /, **fields: Any) -> Solver:  # noqa: A002 - name of the field
    """Return a solver by its type, e.g. ``solver("conjugate_gradient", tolerance=1e-6)``.

    Raises
    ------
    ConfigError
        No such type, or fields that it does not allow.
    """
    return _component(Solver, type, fields)


def _component(family: type[AnyComponent], type_: str, fields: Mapping[str, Any]) -> AnyComponent:
    return registry().make(family, {"type": type_, **fields})
