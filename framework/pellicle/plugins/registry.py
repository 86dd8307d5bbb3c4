"""The registry of components, by family and type, and how it is loaded from plugins.

pluggy's own loader stops at the first broken plugin, silently drops the second of two equal names
and leaves a failing plugin half registered. So each entry point is loaded separately here, and its
error is recorded instead of raised.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, cached_property, partial
from importlib.metadata import EntryPoint, PackageNotFoundError, version
from typing import TYPE_CHECKING, Any, Literal, TypeVar, get_args, get_origin

from pellicle.errors import ConfigError, PellicleError, PluginError, excerpt
from pellicle.schema.messages import nearest
from pellicle.units import quantity_of

from .component import Component
from .hooks import manager_of
from .origins import (
    COMMAND,
    DISABLE,
    REMEDY,
    BrokenPlugin,
    Origin,
    call_isolated,
    claimed_by,
    in_order,
)

if TYPE_CHECKING:
    from pellicle.components import Suite

AnyComponent = TypeVar("AnyComponent", bound=Component)
_version = cache(version)


@dataclass(frozen=True)
class InstalledComponent:
    """An installed component."""

    component: type[Component]
    type: str
    origin: Origin

    @property
    def summary(self) -> str:
        """The first line of the component's documentation."""
        return (inspect.getdoc(self.component) or "").partition("\n")[0]

    @property
    def examples(self) -> tuple[Mapping[str, Any], ...]:
        """The `examples` of the class itself; those of a base class may lack fields."""
        return tuple(vars(self.component).get("examples", ()))


@dataclass(frozen=True)
class Registry:
    """All components by family and type, all validation suites, and broken plugins."""

    components: Mapping[str, Mapping[str, InstalledComponent]]
    families: Mapping[str, type[Component]]
    """The base class of each family, by name: pellicle's own, then those that plugins bring."""
    suites: tuple[Suite, ...] = ()
    broken: tuple[BrokenPlugin, ...] = ()
    clashes: Mapping[tuple[str, str], tuple[Origin, ...]] = field(default_factory=dict)
    """Types claimed by more than one plugin; none of the claimants is in `components`."""
    disabled: tuple[Origin, ...] = ()

    @cached_property
    def own(self) -> frozenset[type[Component]]:
        """The classes of the components that pellicle ships."""
        entries = (entry for family in self.components.values() for entry in family.values())
        return frozenset(entry.component for entry in entries if entry.origin.is_built_in)

    def find(self, family: str, type_: object) -> type[Component]:
        """Return the class of a component, or raise an error that says why there is none."""
        types = self.components.get(family, {})
        if isinstance(type_, str) and type_ in types:
            return types[type_].component
        if owners := self.clashes.get((family, str(type_))):
            raise PluginError(f"{family} {type_!r} is {claimed_by(owners)}; {REMEDY}")
        for broken in self.broken:
            if broken.origin.entry_point == f"{family}.{type_}":
                raise PluginError(f"{family} {type_!r} is broken: {broken}")
        for origin in self.disabled:
            if origin.entry_point == f"{family}.{type_}":
                raise PluginError(f"{family} {type_!r} of {origin} is switched off by {DISABLE}")
        hint = f"; {len(self.broken)} broken: see `pellicle plugins`" if self.broken else ""
        if family not in self.components:
            raise PluginError(
                f"no installed plugin brings the family {family!r}; "
                f"{nearest(family, self.components)}{hint}"
            )
        article = "an" if family[0] in "aeiou" else "a"
        word = re.sub("[^a-z0-9]", "", str(type_).lower())
        near = [name for name, known in types.items() if word in known.component.also]
        synonyms = f"what comes nearest is {' or '.join(map(repr, near))}. " if near else ""
        raise ConfigError(
            f"{excerpt(type_)} is not {article} {family}; {synonyms}{nearest(type_, types)}{hint}",
            "type",
        )

    def versions(self, used: Collection[type[Component]]) -> dict[str, str]:
        """Return the versions of the distributions of components, by name."""
        return {
            registered.origin.distribution: registered.origin.version
            for family in self.components.values()
            for registered in family.values()
            if registered.component in used
        }

    def all_versions(
        self, used: Collection[type[Component]], others: Iterable[str] = ()
    ) -> dict[str, str]:
        """Return the version of pellicle, of the owners of components, and of libraries."""
        numbers = {name: _version(name) for name in ("pellicle", "numpy", "scipy")}
        numbers |= self.versions(used)
        for name in sorted({*others, *(name for kind in used for name in kind.libraries)}):
            # A worker may receive data that a library has read without having the library itself.
            with suppress(PackageNotFoundError):
                numbers[name] = _version(name)
        return numbers

    def make(self, base: type[AnyComponent], value: object) -> AnyComponent:
        """Return the component of ``base``'s family that ``value`` describes.

        ``value`` is a table with ``type`` and the component's fields, or the component itself.
        """
        if isinstance(value, base):
            return value
        table = value if isinstance(value, Mapping) else {}
        if "type" not in table and base.family in self.components:
            listing = ", ".join(sorted(self.components[base.family]))
            is_table = isinstance(value, Mapping)
            reason = "has no type" if is_table else f"{excerpt(value)} is not a table"
            raise ConfigError(f"{reason}; give a table with type = one of: {listing}")
        component = self.find(base.family, table.get("type"))
        if not issubclass(component, base):
            raise ConfigError(
                f"{table['type']!r} is a {_full_name(component)}, not a {_full_name(base)}", "type"
            )
        try:
            return component(**table)
        except (PellicleError, MemoryError):
            raise
        except Exception as error:
            error.add_note(f"{base.family} {table['type']!r} failed")
            raise


def load(
    entries: Iterable[EntryPoint], disable: str = "", *, known: Mapping[str, type[Component]]
) -> Registry:
    """Load each plugin separately, and return the registry.

    Entry points name component classes, or modules with hooks of `pellicle.plugins.hooks`; those of
    commands are skipped. ``disable`` is the value of the environment variable `DISABLE`. No plugin
    can take the name of a ``known`` family, of which the base class is given.
    """
    claims: dict[tuple[str, str], list[InstalledComponent]] = {}
    families = dict(known)
    suites: list[Suite] = []
    broken: list[BrokenPlugin] = []
    disabled: list[Origin] = []
    for entry, is_off in in_order(entries, disable):
        if is_off:
            disabled.append(Origin.of(entry))
            continue
        if entry.name.startswith(COMMAND):
            continue
        registration = call_isolated(entry, partial(_call_hooks, entry, families))
        if isinstance(registration, BrokenPlugin):
            broken.append(registration)
            continue
        components, its_suites = registration
        suites.extend(suite for suite in its_suites if suite not in suites)
        for registered in components:
            owners = claims.setdefault((registered.component.family, registered.type), [])
            # Two entry points of a package may name the same module.
            if not any(owner.component is registered.component for owner in owners):
                owners.append(registered)
    registered_by_family: dict[str, dict[str, InstalledComponent]] = {f: {} for f in families}
    clashes: dict[tuple[str, str], tuple[Origin, ...]] = {}
    for (family, type_), owners in claims.items():
        if len(owners) == 1:
            registered_by_family[family][type_] = owners[0]
        else:
            clashes[family, type_] = tuple(owner.origin for owner in owners)
    return Registry(
        registered_by_family, families, tuple(suites), tuple(broken), clashes, tuple(disabled)
    )


def _call_hooks(
    entry: EntryPoint, families: dict[str, type[Component]]
) -> tuple[list[InstalledComponent], list[Suite]]:
    """Return the components and suites that one plugin registers, and add its families."""
    components: list[InstalledComponent] = []
    suites: list[Suite] = []

    def register(component: type[Component]) -> None:
        components.append(InstalledComponent(component, checked_type(component), Origin.of(entry)))

    def register_suite(suite: Suite) -> None:
        if not callable(suite):
            raise PluginError(f"{suite!r} is not a function that yields cases")
        suites.append(suite)

    plugin = entry.load()
    if isinstance(plugin, type):
        register(plugin)
    else:
        manager = manager_of(plugin)
        hooks = ["register_components", "register_validations", "register_commands"]
        implemented = [caller.name for caller in manager.get_hookcallers(plugin) or ()]
        if not implemented:
            raise PluginError(
                f"implements no hook; decorate with @pellicle.hookimpl one of {', '.join(hooks)}, "
                'or name a class in the entry point: "module:Class"'
            )
        for name in implemented:
            if name not in hooks:
                raise PluginError(f"implements the unknown hook {name!r}; {nearest(name, hooks)}")
        manager.hook.register_components(register=register)
        manager.hook.register_validations(register=register_suite)
    bases = dict(families)
    for registered in components:
        base = family_of(registered.component)
        if (first := bases.setdefault(base.family, base)) is not base:
            raise PluginError(
                f"{_full_name(base)} and {_full_name(first)} both declare the family "
                f"{base.family!r}; derive from the latter, or give another name"
            )
    families.update(bases)
    return components, suites


def _full_name(component: type[Component]) -> str:
    return f"{component.__module__}.{component.__qualname__}"


def family_of(component: type[Component]) -> type[Component]:
    """Return the one base class of a component that declares its family."""
    mro = component.__mro__
    declaring = [c for c in mro if issubclass(c, Component) and "family" in vars(c)]
    if not declaring:
        raise PluginError(f"{component.__name__} is of no family; derive it from a base with one")
    first, base = declaring[0], declaring[-1]
    if first is not base:
        raise PluginError(
            f"{first.__name__}.family is {first.family!r}; leave it to {base.__name__}"
        )
    if base is component:
        raise PluginError(f"{base.__name__} is the base class of a family; derive from it")
    return base


def checked_type(component: Any) -> str:
    """Return the type of a component class; raise PluginError if it breaks a rule for all."""
    if not (isinstance(component, type) and issubclass(component, Component)):
        raise PluginError(f"{component!r} is not a subclass of pellicle.components.Component")
    name, base = component.__name__, family_of(component)
    if not isinstance(getattr(base, "place", None), str):
        raise PluginError(
            f"{base.__name__} lacks the class variable place: where files have its components, "
            'such as "rivals[]"'
        )
    info = component.model_fields.get("type")
    names = get_args(info.annotation) if info else ()
    one_text = len(names) == 1 and isinstance(names[0], str)
    if info is None or get_origin(info.annotation) is not Literal or not one_text:
        raise PluginError(f'{name} needs a field: type: Literal["…"] = "…"')
    if info.default != names[0]:
        raise PluginError(f'{name}.type needs the default "{names[0]}"')
    if missing := sorted(component.__abstractmethods__):
        raise PluginError(f"{name} lacks the method {', '.join(missing)}")
    if not (component.__doc__ or "").strip():
        raise PluginError(f"{name} lacks a docstring: its first line is shown to users")
    for field_, its in component.model_fields.items():
        if field_ != "type" and not its.description:
            raise PluginError(f"{name}.{field_} lacks Field(description=…) with its unit")
        if (quantity := quantity_of(its)) and not quantity.has_known_unit:
            raise PluginError(f"{name}.{field_}: Quantity({quantity.unit!r}) has an unknown unit")
    component.check_class()
    # Raises if JSON cannot represent the type of a field, which would break the whole schema.
    component.model_json_schema()
    return str(names[0])
