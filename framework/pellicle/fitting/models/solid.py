"""What is pressed: a kernel without its modulus and its tension, which a fit is to find."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic.fields import FieldInfo

from pellicle.components import Component, Kernel
from pellicle.errors import ConfigError, shown
from pellicle.model.base import Model
from pellicle.model.paths import replaced
from pellicle.plugins import registry
from pellicle.units import Quantity, quantity_of

DEFAULT_KERNEL = "tensed_membrane"
_DIGITS = 12


@dataclass(frozen=True)
class Solid:
    """A kernel of E* = 1 Pa and no tension, and where it has the two."""

    kernel: Kernel
    modulus: str
    """Dotted path of the reduced modulus in the kernel."""
    tension: str
    """Dotted path of the tension in the kernel."""
    poissons_ratio: float | None

    @property
    def given(self) -> dict[str, Any]:
        """What is known of the kernel: its table without modulus and tension."""
        table: dict[str, Any] = self.kernel.model_dump(mode="json", exclude_none=True)
        for path in (self.modulus, self.tension):
            at = table
            *parents, name = path.split(".")
            for parent in parents:
                at = at[parent]
            del at[name]
        return table


def solid(given: str | Mapping[str, Any], poissons_ratio: float | None = None) -> Solid:
    """Return the solid that a kernel describes, all but its reduced modulus and its tension.

    ``poissons_ratio`` is that of the kernel if it needs one and has none of its own.

    Raises
    ------
    ConfigError, PluginError
        The kernel cannot be made, has no reduced modulus or no tension, or has them given.
    """
    table: Any = {"type": given} if isinstance(given, str) else dict(given)
    try:
        modulus, _ = _owner(table, "reduced_modulus")
        tension, _ = _owner(table, "tension")
        for path in (modulus, tension, f"{modulus.rpartition('.')[0]}.youngs_modulus".lstrip(".")):
            if _reach(table, path) is not None:
                raise ConfigError(
                    "is what the fit finds; leave it out of the kernel, or hold it with fix", path
                )
        ratio, info = _owner(table, "poissons_ratio")
        stated = _reach(table, ratio)
        if stated is None and poissons_ratio is not None and info.is_required():
            stated, table = poissons_ratio, replaced(table, ratio, poissons_ratio)
        kernel = registry().make(Kernel, replaced(replaced(table, modulus, 1.0), tension, 0.0))
    except ConfigError as error:
        raise error.within("kernel") from None
    return Solid(kernel, modulus, tension, poissons_ratio if stated is None else stated)


def _owner(table: Mapping[str, Any], name: str) -> tuple[str, FieldInfo]:
    """Return the dotted path of a field in a kernel or in those it is made of, and the field."""
    found = next(_owners(table, name, ""), None)
    if found is None:
        remedy = (
            '; put it under a skin: type = "coated", with this kernel as its substrate'
            if name == "tension"
            else "; a fit needs one that has it"
        )
        raise ConfigError(f"{table.get('type')!r} has no field {name}{remedy}")
    return found


def _owners(table: Mapping[str, Any], name: str, at: str) -> Iterator[tuple[str, FieldInfo]]:
    kind = registry().find("kernel", table.get("type"))
    if name in kind.model_fields:
        yield f"{at}{name}", kind.model_fields[name]
    for key, inner in table.items():
        if isinstance(inner, Mapping):
            yield from _owners(inner, name, f"{at}{key}.")


def _reach(table: Any, path: str) -> Any:
    for name in path.split("."):
        table = table.get(name) if isinstance(table, Mapping) else None
    return table


def lengths(component: Component) -> list[float]:
    """Return the lengths [m] among the fields of a component and those it is made of."""
    return [
        value
        for _, quantity, value in _fields(component)
        if quantity is not None and quantity.powers() == (0, 1)
    ]


def scales(component: Component) -> bool:
    """Return whether all that decides a component's lengths is known to be lengths."""
    return all(
        quantity is not None or isinstance(value, (str, int))
        for _, quantity, value in _fields(component)
    )


def scaled(component: Component, unit: float, free: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return the table of a component with every length over ``unit`` [m].

    Raises
    ------
    ConfigError
        A field that is not in ``free`` has to be seen against the modulus, which is not known.
    """
    table: Any = component.model_dump(exclude_none=True)
    for path, quantity, value in _fields(component):
        if quantity is None or path in free:
            continue
        pressure, length = quantity.powers()
        if pressure and value:
            raise ConfigError(
                f"{shown(value)} {quantity.unit} counts against the modulus, which is not known "
                "yet; a fit can hold lengths and plain numbers only, so leave it out",
                path,
            )
        table = replaced(table, path, float(f"{value / unit**length:.{_DIGITS}g}"))
    made: dict[str, Any] = table
    return made


def _fields(component: Model, at: str = "") -> Iterator[tuple[str, Quantity | None, Any]]:
    """Yield dotted path, quantity and value of each field that has a value."""
    for name, info in type(component).model_fields.items():
        value = getattr(component, name)
        if isinstance(value, Model):
            yield from _fields(value, f"{at}{name}.")
        elif value is not None and name != "type":
            quantity = quantity_of(info) if isinstance(value, float) else None
            yield f"{at}{name}", quantity, value
