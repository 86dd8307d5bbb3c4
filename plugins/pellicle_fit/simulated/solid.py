"""The solid of a fit: a kernel without reduced modulus and tension, which the fit determines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic.fields import FieldInfo

from pellicle import registry
from pellicle.components import Kernel
from pellicle.errors import ConfigError, excerpt, problems_within
from pellicle.schema import get, replace_at, walk
from pellicle.units import Quantity, quantity_of


@dataclass(frozen=True)
class UnitKernel:
    """A kernel with E* = 1 Pa and no tension."""

    kernel: Kernel
    tension: str
    """Dotted path of the tension in the kernel."""
    poissons_ratio: float | None

    @property
    def is_half_space(self) -> bool:
        """Whether the kernel without tension is G(q) = 2/q m/Pa."""
        q = np.geomspace(1e-3, 1e9, 13)
        return bool(np.allclose(q * self.kernel.compliance(q), 2.0, rtol=1e-9, atol=0))


def solid(spec: str | Mapping[str, Any], poissons_ratio: float | None = None) -> UnitKernel:
    """Return the solid that the type or the table of a kernel describes.

    ``poissons_ratio`` is used if the kernel needs one and its table has none.

    Raises
    ------
    ConfigError, PluginError
        The kernel is not valid, has no field for the reduced modulus or the tension, has a value
        for one of them or for what scales with the modulus, or another Poisson's ratio.
    """
    table: Any = {"type": spec} if isinstance(spec, str) else dict(spec)
    with problems_within("kernel"):
        modulus, _ = _field(table, "reduced_modulus")
        tension, _ = _field(table, "tension")
        for path in (modulus, tension, f"{modulus.rpartition('.')[0]}.youngs_modulus".lstrip(".")):
            if get(table, path) is not None:
                raise ConfigError(
                    "is determined by the fit; leave it out of the kernel, or fix it with fix", path
                )
        path, info = _field(table, "poissons_ratio", or_none=True)
        ratio = get(table, path)
        if ratio is None and poissons_ratio is not None and info and info.is_required():
            ratio, table = poissons_ratio, replace_at(table, path, poissons_ratio)
        kernel = registry().make(Kernel, replace_at(replace_at(table, modulus, 1.0), tension, 0.0))
        for field, quantity, value in quantities_of(kernel):
            if value and field not in (modulus, tension) and quantity.powers()[0]:
                raise ConfigError(
                    f"{excerpt(value)} {quantity.unit} scales with the modulus, which is not known "
                    "yet; a fit allows only lengths and plain numbers, so leave it out",
                    field,
                )
        own = get(kernel.model_dump(), path)
        if None not in (own, poissons_ratio) and own != poissons_ratio:
            raise ConfigError(
                f"is {own:g}, and poissons_ratio of the fit is {poissons_ratio:g}; give it once",
                path,
            )
    return UnitKernel(kernel, tension, poissons_ratio if ratio is None else ratio)


def quantities_of(kernel: Kernel) -> Iterator[tuple[str, Quantity, float]]:
    """Yield path, quantity and value [SI] of each quantity of a kernel that has a value."""
    for path, value, info in walk(kernel):
        if info is not None and isinstance(value, float) and (quantity := quantity_of(info)):
            yield path, quantity, value


def _field(
    table: Mapping[str, Any], name: str, *, or_none: bool = False
) -> tuple[str, FieldInfo | None]:
    """Return path and definition of the first field ``name`` in a kernel or a kernel inside it."""
    for path, inner, _ in [("", table, None), *walk(table)]:
        # A table without a type is not a component, such as one of the layers of a kernel.
        if isinstance(inner, Mapping) and (not path or "type" in inner):
            fields = registry().find("kernel", inner.get("type")).model_fields
            if name in fields:
                return f"{path}.{name}".lstrip("."), fields[name]
    if or_none:
        return name, None
    remedy = "a fit needs one that has it"
    if name == "tension":
        remedy = 'put it under a skin: type = "coated", with this kernel as its substrate'
    raise ConfigError(f"{table.get('type')!r} has no field {name}; {remedy}")
