"""The configuration of a run: a frozen model whose components come from the registry.

The components of the configuration also do the computation. TOML, JSON and keyword arguments all
give the same `Run`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from pydantic import (
    ConfigDict,
    Field,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    field_validator,
    model_validator,
)

from pellicle.checks import errors_attributed_to
from pellicle.components import (
    AreaCorrection,
    Branch,
    FromRegistry,
    Indenter,
    Interaction,
    Kernel,
    Load,
    Output,
    Solver,
)
from pellicle.components.installed import registry
from pellicle.components.kernel import branches_of
from pellicle.errors import ConfigError, all_problems, excerpt, problems_within
from pellicle.grid import Grid, grid_of_run
from pellicle.plugins.component import words_of_type
from pellicle.schema.from_file import FromFile
from pellicle.surface import along_axes
from pellicle.variables import OF_LOAD, VARIABLES, Variable, corrected_area, corrected_fraction

from .describe import inputs, table_of
from .file_names import refuse_shared_files
from .gradient import derivatives_of, refuse_undefined
from .loading import Loading, Times, check_times, fields_from, times_from
from .provenance import identity_of

DEFAULT_SOLVER = "active_set"
_MISSING = "is missing; give it: {}"
# Length 2τ₀/E* of the instantaneous solid, in cells, from which on the pull-off force of an
# interaction without a range changes by less than 2 % if the cells are halved.
_TENSED_CELLS = 3.0


class Indentation(NamedTuple):
    """What is pressed in, and how."""

    indenter: Indenter
    loading: Loading


class Run(FromFile):
    """One contact problem, or one known load, with its load steps."""

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": ["indenter", "loading"]}, {"required": ["load"]}]}
    )

    title: str = Field("", max_length=1000, description="a line for figures and listings")
    grid: Grid = Field(description="the domain and its cells")
    kernel: Annotated[Kernel, FromRegistry()] = Field(description="how the surface yields")
    load: Annotated[Load, FromRegistry()] | None = Field(
        None, description="a known traction on the surface, in place of an indenter"
    )
    indenter: Annotated[Indenter, FromRegistry()] | None = Field(
        None, validate_default=True, description="what is pressed in"
    )
    interaction: Annotated[Interaction, FromRegistry()] | None = Field(
        None, description="what acts across the gap; without it contact is hard and does not stick"
    )
    loading: Loading | Times = Field(None, validate_default=True, description="the load steps")
    solver: Annotated[Solver, FromRegistry()] = Field(
        default_factory=lambda: registry().make(Solver, {"type": DEFAULT_SOLVER}),
        description="how it is solved",
    )
    corrections: tuple[Annotated[AreaCorrection, FromRegistry()], ...] = Field(
        (), description="corrections of the contact area"
    )
    gradient: tuple[str, ...] | None = Field(
        None,
        min_length=1,
        description='what force and depth are differentiated by: "heights", and paths of numbers '
        'of kernel and indenter, such as "kernel.tension"',
    )
    outputs: tuple[Annotated[Output, FromRegistry()], ...] | None = Field(
        None,
        description="what is written besides the result file: csv and figures if not given, "
        "nothing if []",
    )

    @field_validator("load", "indenter", mode="wrap")
    @classmethod
    def _for_the_grid(
        cls, value: object, make: ValidatorFunctionWrapHandler, info: ValidationInfo
    ) -> Any:
        with grid_of_run(info.data.get("grid")):
            made = make(value)
        if info.field_name == "indenter" and "load" in info.data:
            if made is None and info.data["load"] is None:
                raise ConfigError(_MISSING.format(cls.model_fields["indenter"].description))
            if made is not None and info.data["load"] is not None:
                raise ConfigError("stands beside a load; a run has one of both: leave one out")
        return made

    @field_validator("loading", mode="wrap")
    @classmethod
    def _of_what_presses(
        cls, value: object, make: ValidatorFunctionWrapHandler, info: ValidationInfo
    ) -> Any:
        if info.data.get("load", "not valid") is not None:
            return times_from(value) if "load" in info.data else Times()
        if value is None:
            raise ConfigError(_MISSING.format(cls.model_fields["loading"].description))
        pulls = info.data.get("interaction", "not valid") is not None
        if isinstance(value, Mapping):
            return Loading(**fields_from(value, interaction=pulls))
        if not isinstance(value, Loading):
            raise ConfigError(f"{excerpt(value)} is not allowed; give a table (the load steps)")
        if not pulls:
            value.refuse_pulls()
        return value

    @model_validator(mode="after")
    def _load_needs_no_contact(self) -> Self:
        if self.load is None:
            return self
        for name in ("interaction", "corrections", "gradient"):
            if getattr(self, name):
                reason = "needs a contact, and this run has a load in place of an indenter"
                raise ConfigError(f"{reason}; leave it out", name)
        for index, output in enumerate(self.outputs or ()):
            if output.of_contact:
                raise ConfigError(
                    f"{output.type_name!r} shows a contact, and this run has a load in place of an "
                    "indenter; leave it out",
                    f"outputs.{index}.type",
                )
        if self.loading.times is not None:
            with problems_within("loading"):
                check_times(self.loading.times, self.steps)
        return self

    @model_validator(mode="after")
    def _prescription_has_a_period(self) -> Self:
        if isinstance(self.loading, Times):
            return self
        if self.loading.prescription.needs_period and self.grid.boundary == "free":
            raise ConfigError(
                'is not defined on an infinite surface (grid.boundary = "free"); prescribe force '
                'or depth, or set grid.boundary = "periodic"',
                f"loading.{self.loading.prescribed}",
            )
        return self

    @model_validator(mode="after")
    def _relaxes_in_time(self) -> Self:
        if not self.branches:
            return self
        name = self.kernel.type_name
        if self.loading.times is None:
            raise ConfigError(
                f"is missing, and {name!r} relaxes in time; give one time for each load step"
                + f", or legs of {self.prescribed}" * (self.load is None),
                "loading.time",
            )
        shortest, longest = self.kernel.time_span()
        duration = math.fsum(self.loading.durations)
        least = min((t for t in self.loading.durations if t > 0), default=math.inf)
        if least < shortest or duration > longest:
            reason = f"has a step of {least:g}" if least < shortest else f"lasts {duration:g}"
            raise ConfigError(
                f"{reason} s, and the relaxation of {name!r} holds from {shortest:g} to "
                f"{longest:g} s; give it a wider span, or other times",
                f"loading.{self.prescribed if self.loading.samples else 'time'}",
            )
        return self

    @model_validator(mode="after")
    def _legs_begin_at_rest(self) -> Self:
        loading = self.loading
        if isinstance(loading, Times):
            return self
        begins = loading.prescription.is_zero_at_rest or not loading.samples
        if begins or not (self.interaction or self.branches):
            return self
        if loading.durations[0] > 0 or (len(loading.values) > 1 and loading.samples[1].leg == 0):
            raise ConfigError(
                "begins at 0, which is not the value before the indenter presses, and the solid or "
                "the interaction remembers the way; begin with a jump to a first value, "
                '{ to, time = "0 s", num = 1 }',
                loading.field_of(0),
            )
        return self

    @model_validator(mode="after")
    def _range_where_it_relaxes(self) -> Self:
        """Refuse an interaction without a range on a solid that relaxes without a tense skin.

        The solid in the zone relaxes at a rate that depends on the width of the zone, so the force
        has no limit as the cells shrink, unless an elastic skin is much stiffer than it there.
        """
        kernel, interaction = self.kernel, self.interaction
        if interaction is None or not self.branches or interaction.cutoff() > 0:
            return self
        q = np.array([np.pi / self.grid.cell_size])
        with errors_attributed_to(kernel):
            solid = along_axes(kernel.without_skin().symbol, q).item()
            cells = (solid / along_axes(kernel.symbol, q).item() - 1) / np.pi
        if cells < _TENSED_CELLS:
            raise ConfigError(
                f"{interaction.type_name!r} takes its range from the cells, and where the solid "
                "relaxes the force depends on the range; give linear or dugdale with a range, or a "
                f"tension τ₀ whose length 2τ₀/E* is {_TENSED_CELLS:g} cells or more: here it is "
                f"{cells:.2g}",
                "interaction.type",
            )
        return self

    @model_validator(mode="after")
    def _gradient_is_defined(self) -> Self:
        with all_problems() as within:
            for index, path in enumerate(self.gradient or ()):
                with within(f"gradient.{index}"):
                    refuse_undefined(self, path, self.gradient[:index] if self.gradient else ())
        return self

    @model_validator(mode="after")
    def _each_correction_and_file_once(self) -> Self:
        types = [correction.type_name for correction in self.corrections]
        for index, type_ in enumerate(types):
            if type_ in types[:index]:
                raise ConfigError(
                    f"{type_!r} is given twice, and both would be contact_area_{type_}; leave one "
                    "out",
                    f"corrections.{index}.type",
                )
        if self.outputs:
            refuse_shared_files(self.outputs)
        return self

    @classmethod
    def from_mapping(cls, data: Mapping[str, Any]) -> Self:
        """Return the run that a mapping of the form of a run file describes; refuse a study."""
        if "study" in data:
            raise ConfigError(
                "makes this a study: use run_study, or Study, in place of run (`pellicle run` in a "
                "shell), or leave the table out",
                "study",
            )
        return cls(**data)

    def _repr_html_(self) -> str:
        """Return HTML for a notebook: every value with its unit and meaning."""
        from pellicle.show.notebook import summary

        values = list(inputs(self.to_table(), Run))
        types = {row.name: row.value for row in values}
        sentence = f"{types.get('indenter') or types['load']} on {types['kernel']}"
        return summary(self.title or "Run", sentence, table_of(values))

    @cached_property
    def branches(self) -> tuple[Branch, ...]:
        """The branches of a solid that relaxes; none of one that is elastic."""
        return branches_of(self.kernel)

    @property
    def indentation(self) -> Indentation:
        """Indenter and load steps; a ConfigError where there is a load instead."""
        if self.indenter is None or isinstance(self.loading, Times):
            raise ConfigError(
                "stands in place of an indenter, and this is about contacts; give an indenter",
                "load",
            )
        return Indentation(self.indenter, self.loading)

    @property
    def prescribed(self) -> str:
        """The variable that names its load steps: what is prescribed, or varies of a load."""
        if self.load is None:
            return self.indentation.loading.prescribed
        path = self.load.varying_field
        return path.variable.name if path else "force"

    @property
    def steps(self) -> int:
        """The number of load steps; of a load that of its path or its times, or 1."""
        if isinstance(self.loading, Loading):
            return len(self.loading.values)
        path = self.load.varying_field if self.load else None
        return len(path.values if path else self.loading.times or (0.0,))

    @property
    def variables(self) -> list[Variable]:
        """The variables that its steps and its path will have, without fields and texts."""
        if self.load is not None:
            return self._variables_of_load
        kinds = {"main", "other", "contact", "effort", "residual", "status"}
        kinds |= {"interaction", "path"} if self.interaction else set()
        kinds |= {"oscillation"} if self.loading.oscillates else set()
        requested = {
            "stiffness": self.loading.stiffness,
            "time": self.loading.times is not None,
            "cycle": self.loading.oscillates,
        }
        listed = [v for v in VARIABLES.values() if v.kind in kinds or requested.get(v.name)]
        listed += self.indentation.loading.prescription.variables
        for correction in self.corrections:
            type_ = correction.type_name
            area = corrected_area(type_, words_of_type(type(correction), type_))
            listed += [area, corrected_fraction(area)]
        if self.gradient:
            listed += [variable for variable in derivatives_of(self) if variable.kind != "field"]
        return [variable for variable in listed if variable.type != "text"]

    @property
    def _variables_of_load(self) -> list[Variable]:
        path = self.load.varying_field if self.load else None
        listed = [path.variable] if path else []
        listed += [*OF_LOAD, *[VARIABLES["time"]] * (self.loading.times is not None)]
        return [variable for variable in listed if variable.type != "text"]

    @property
    def identity(self) -> str:
        """Hash of everything on which the numbers of the result depend.

        It covers the configuration with its defaults, without `title` and `outputs`; input files
        enter by their content, components of other packages also by the version of the package.
        """
        return identity_of(self)
