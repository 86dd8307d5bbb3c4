"""The base class of all components."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from pydantic.fields import FieldInfo

from pellicle.schema.model import Model, walk
from pellicle.variables import ROLE, words_of_name


class Component(Model):
    """A frozen model with a field ``type: Literal["…"]``, by which configurations name it."""

    family: ClassVar[str]
    """Name of its family, which the base class of the family alone gives."""
    place: ClassVar[str]
    """Where a file has components of the family; ``[]`` stands for an entry of a list."""
    libraries: ClassVar[tuple[str, ...]] = ()
    """Distributions that it uses besides numpy and scipy; results record their versions."""

    also: ClassVar[tuple[str, ...]] = ()
    """Other words for it, or for what it comes nearest to, with which a message leads to it."""

    @property
    def type_name(self) -> str:
        """The component's type, such as ``half_space``."""
        # A base class with a field ``type: str`` would not let components narrow it to a literal.
        return str(getattr(self, "type", type(self).__name__))

    @classmethod
    def check_class(cls) -> None:
        """Refuse, by a PluginError, a class that breaks a rule of its family.

        A family's base class overrides this; it is called when a plugin is loaded.
        """


def components_in(parts: Iterable[object]) -> list[Component]:
    """Return the components in parts of a configuration, those inside others too."""
    return [value for _, value, _ in walk([*parts]) if isinstance(value, Component)]


def words_of_type(component: type[Component], type_: str) -> str:
    """Return the words of a component for figures and tables.

    These are the ``title`` of its own ``model_config``, or its type without underscores.
    """
    title = component.model_config.get("title")
    inherited = {getattr(base, "model_config", {}).get("title") for base in component.__mro__[1:]}
    return title if title and title not in inherited else words_of_name(type_)


def role_of(field: FieldInfo) -> str:
    """Return the role of a component's field, such as `pellicle.variables.SEED`; "" without one."""
    extra = field.json_schema_extra
    return str(extra.get(ROLE, "")) if isinstance(extra, dict) else ""
