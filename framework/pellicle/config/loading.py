"""The load steps of a run: what is prescribed, and with which options."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from functools import cache, cached_property
from itertools import filterfalse
from typing import Annotated, Any

from pydantic import ConfigDict, Field, create_model, model_validator
from pydantic.fields import FieldInfo

from pellicle.components import Prescription
from pellicle.errors import ConfigError, Problem
from pellicle.loading import OPTIONS, LoadSteps
from pellicle.model.base import Model
from pellicle.model.messages import nearest
from pellicle.plugins import registry

# Messages name these first.
_USUAL = "depth", "force", "mean_pressure"


class Loading(Model):
    """The load steps: exactly one quantity is prescribed, in the order of its path.

    The key is the type of a prescription; its value is one value, a list, or a ramp
    ``{start, stop, num}``, with ``spacing = "log"`` if need be; with ``back = true`` the ramp goes
    back to its start by the same values. The fields of the prescription are further keys.
    """

    model_config = ConfigDict(extra="allow")

    stiffness: Annotated[
        bool,
        Field(
            description="whether each step has its contact stiffness dF/dδ; costs one more linear "
            "solve a step"
        ),
    ] = False

    @model_validator(mode="before")
    @classmethod
    def _read(cls, given: Any) -> Any:
        if not isinstance(given, Mapping):
            return given
        data = {key: value for key, value in given.items() if value is not None}
        return dict(model_of(data)(**data))

    @cached_property
    def prescription(self) -> Prescription:
        """What is prescribed."""
        fields = self.__pydantic_extra__ or {}
        type_ = self.prescribed
        others = {name: value for name, value in fields.items() if name != type_}
        return registry().make(Prescription, {"type": type_, **others})

    @property
    def prescribed(self) -> str:
        """The type of what is prescribed."""
        return prescribed_in(self.__pydantic_extra__ or {})

    @property
    def described_fields(self) -> Mapping[str, FieldInfo]:
        """The options, what is prescribed and the fields of that."""
        return loading_model(self.prescribed).model_fields

    @property
    def values(self) -> tuple[float, ...]:
        """The load steps in order, SI."""
        values: tuple[float, ...] = getattr(self, self.prescribed)
        return values

    @property
    def variables(self) -> set[str]:
        """The names of the result variables that only this loading has."""
        names = {variable.name for variable in self.prescription.variables}
        return names | ({"stiffness"} if self.stiffness else set())


def model_of(loading: Mapping[str, Any]) -> type[Model]:
    """Return the model of the keys of a table ``[loading]``.

    Raises
    ------
    ConfigError, PluginError
        It does not name exactly one prescription that is installed.
    """
    return loading_model(prescribed_in(loading))


@cache
def loading_model(type_: str) -> type[Model]:
    """Return the model of the keys of ``[loading]`` where ``type_`` is prescribed."""
    component = registry().find("prescription", type_)
    assert issubclass(component, Prescription)
    options = {name: Loading.model_fields[name] for name in OPTIONS}
    fields = {n: info for n, info in component.model_fields.items() if n != "type"} | options
    meaning = (inspect.getdoc(component) or "").partition("\n")[0]
    steps: Any = Annotated[
        tuple[float, ...], LoadSteps(component.quantity()), Field(description=meaning)
    ]
    definitions: dict[str, Any] = {type_: (steps, ...)}
    definitions |= {name: (info.annotation, info) for name, info in fields.items()}
    return create_model(f"Loading_{type_}", __base__=Model, **definitions)


def prescribed_in(data: Mapping[str, Any]) -> str:
    """Return which key of a table names its prescription, or refuse the table."""
    families = registry().components["prescription"]
    known = [*_USUAL, *sorted(families.keys() - {*_USUAL})]
    given = [name for name in known if name in data]
    if len(given) == 1:
        return given[0]
    if given:
        what = f"prescribes {' and '.join(given)}"
    else:
        problems = []
        for key in filterfalse(OPTIONS.__contains__, data):
            try:
                registry().find("prescription", key)
            except ConfigError:
                message = f"is not a field here; {nearest(key, [*known, *OPTIONS])}"
                problems.append(Problem(key, message))
        if problems:
            raise ConfigError(problems)
        what = "prescribes nothing"
    raise ConfigError(f"{what}; give exactly one of {', '.join(known)}")
