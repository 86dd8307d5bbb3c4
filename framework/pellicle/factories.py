"""Components by the name of their type, for programs and notebooks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from .components.base import Component
from .components.indenter import Indenter
from .components.interaction import Interaction
from .components.kernel import Kernel
from .components.solver import Solver
from .plugins import registry

AnyComponent = TypeVar("AnyComponent", bound=Component)


def _factory(family: type[AnyComponent], example: str) -> Callable[..., AnyComponent]:
    def make(type: str, /, **fields: Any) -> AnyComponent:  # noqa: A002 - name of the field
        return registry().make(family, {"type": type, **fields})

    name = family.__name__.lower()
    make.__name__ = make.__qualname__ = name
    make.__doc__ = f"""Return the {name} of a type with its fields, such as ``{name}({example})``.

    Raises
    ------
    ConfigError
        No such type, or fields that it does not allow.
    """
    return make


kernel = _factory(Kernel, '"half_space", reduced_modulus="10 kPa"')
indenter = _factory(Indenter, '"sphere", radius="5 um"')
interaction = _factory(Interaction, '"jkr", work_of_adhesion="50 mJ/m2"')
solver = _factory(Solver, '"conjugate_gradient", tolerance=1e-6')
