"""The configuration of a fit: one frozen model for TOML files, keyword arguments and commands."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    PlainSerializer,
    PlainValidator,
    ValidationInfo,
    field_validator,
    model_validator,
)

from pellicle import registry
from pellicle.components import Executor, FromRegistry, HasForceCurve, Indenter
from pellicle.errors import ConfigError, PellicleError, all_problems, problems_within
from pellicle.schema import (
    FromFile,
    InputPath,
    nearest,
    overridden,
    paths_relative_to,
    read_toml,
    replace_at,
)
from pellicle.units import PoissonsRatio, Quantity

from .config_input import (
    as_list,
    component_table,
    config_of_record,
    describe_indenter,
    effect_list,
    fields_of,
    indenter_or_table,
    list_or_entry,
    share_of,
    with_radius,
)
from .effect import Effect, Fitted, Solid, quantities
from .files.columns import Calibration
from .files.measurement import Segment
from .files.missing import OPTIONS, MissingInputError
from .files.sources import PLACE, Curves, Source, expand_pattern, gather
from .population.judgement import Rule
from .simulated.bead import constants_of
from .simulated.simulation import GRID_POINTS
from .simulated.solid import solid

DEFAULT_RIVALS: tuple[str | list[str], ...] = (
    *("offset", ["offset", "slope"], ["offset", "drift"], "drag"),
    *("power_law", "standard_linear", "poroelastic", "adhesion"),
    *("layer", "sphere", "cone", "worn_tip", "stiff_surface", "softening"),
    *("brush", "compliance", "rough_toe"),
)
"""What bends a curve as a tension does, and is compared unless a configuration says otherwise."""


_Effects = list[str | dict[str, Any]]
_OneEffect = Annotated[Effect, FromRegistry(), BeforeValidator(component_table)]


class FitConfig(FromFile, Calibration):
    """Configuration of a fit: curves, indenter, solid, and options.

    The options of `fit`, `fit_many`, `fit_pooled` and ``pellicle fit``, and the keys of a TOML file
    have the names of these fields.
    """

    examples = (
        {
            "curves": ["beads/*.csv"],
            "indenter": {"type": "sphere", "radius": "5 um"},
            "poissons_ratio": 0.5,
        },
    )

    curves: Annotated[tuple[Path, ...], list_or_entry(tuple[Path, ...] | Path)] = Field(
        (), description="files, folders, patterns such as beads/*.csv, or tables of files"
    )
    indenter: Annotated[
        Indenter | HasForceCurve | dict[str, Any],
        PlainValidator(indenter_or_table, json_schema_input_type=dict[str, Any] | str),
        PlainSerializer(describe_indenter),
    ] = Field(description="the indenter: its type and fields")
    poissons_ratio: PoissonsRatio | None = Field(
        None, description="of the solid, to get Young's modulus as well, or if the kernel needs it"
    )
    kernel: Annotated[
        dict[str, Any] | None,
        BeforeValidator(component_table, json_schema_input_type=dict[str, Any] | str | None),
    ] = Field(
        None, description="the solid without its modulus and tension; a half-space if not given"
    )
    thickness: Annotated[float, Quantity("m", above=0)] | Literal["free"] | None = Field(
        None,
        description="of a layer bonded to a rigid base, in place of a half-space; "
        '"free" fits it. It needs poissons_ratio',
    )
    bead: dict[str, Any] | None = Field(
        None,
        description="modulus and tension of an indenter that yields too: youngs_modulus, or "
        "reduced_modulus, poissons_ratio if it is not that of the solid, tension",
    )
    model: Annotated[tuple[_OneEffect, ...], effect_list(_Effects)] = Field(
        ("tension",),
        description="effects that the force has; whether the first is needed is the question. "
        "Without any, whether a curve shows more than an elastic half-space",
        validate_default=True,
    )
    rivals: Annotated[
        tuple[Annotated[tuple[_OneEffect, ...], BeforeValidator(as_list)], ...],
        effect_list(list[str | dict[str, Any] | _Effects]),
    ] = Field(
        DEFAULT_RIVALS,
        description="effects, or lists of effects that act together, that are compared with "
        "the model, each alone and beside it",
        validate_default=True,
    )
    fix: dict[str, float] = Field(
        default_factory=dict,
        description="values of quantities of the solid, of the model and of rivals that are not "
        "fitted, such as tension = 0",
    )
    uncertainty: dict[
        Literal["spring_constant", "sensitivity", "radius"],
        Annotated[float, BeforeValidator(share_of, json_schema_input_type=float | str)],
    ] = Field(
        default_factory=dict,
        description="standard deviations of spring_constant, sensitivity and radius, each a share "
        "such as 5 %; without any, the calibration counts as exact",
    )
    baseline: Literal["none", "offset", "slope"] = Field(
        "none",
        description="force before contact that is fitted: offset, or offset and slope; with none, "
        "what the curve shows",
    )
    segment: Segment = Field(
        "approach", description="what is fitted: a pass, the approach and its hold, or both passes"
    )
    frequencies: Annotated[
        tuple[Annotated[float, Quantity("Hz", above=0)], ...],
        list_or_entry(list[float | str] | float | str),
    ] = Field(
        (), description="frequencies at which the indenter oscillates in a hold; told as K′ and K″"
    )
    lag: Annotated[float, Quantity("s")] = Field(
        0.0, description="time by which the force is read after the position"
    )
    per_file: dict[str, tuple[Any, ...]] = Field(
        default_factory=dict,
        description="fields of the indenter, spring_constant or sensitivity, each with a list of "
        "one value for each file",
    )
    pool: bool = Field(False, description="whether all curves share one modulus and one tension")
    every_rival: bool = Field(
        False,
        description="whether every curve of a population is compared with all rivals, those too "
        "that curves beside it rule out",
    )
    accept: Annotated[
        tuple[str, ...],
        list_or_entry(tuple[str, ...] | str),
        AfterValidator(lambda texts: tuple(Rule(text).text for text in texts)),
    ] = Field((), description="rules for the curves of a population, such as r_squared > 0.95")
    rejected: InputPath | None = Field(
        None, description="file that names curves that are rejected, one on each line, and why"
    )
    group_by: str = Field(
        "",
        description="column of a table of files, or a pattern of file names such as {group}_*.csv",
    )
    executor: Annotated[Executor, FromRegistry(), BeforeValidator(component_table)] = Field(
        default_factory=lambda: registry().make(Executor, {"type": "serial"}),
        description="executor of many fits and of simulations",
    )
    cache: InputPath | None = Field(None, description="folder that keeps simulated force curves")
    grid_points: int = Field(
        GRID_POINTS,
        ge=16,
        multiple_of=2,
        description="cells along each edge of the grids of a simulation",
    )

    @field_validator("fix", mode="before")
    @classmethod
    def _fixed(cls, value: object, info: ValidationInfo) -> object:
        """Return values in SI of quantities of the solid, of the model and of rivals."""
        effects = [*info.data.get("model", ()), *chain(*info.data.get("rivals", ()))]
        known: dict[str, Fitted] = {}
        for component in (Solid, *map(type, effects)):
            known |= quantities(component)
        if not isinstance(value, Mapping):
            return value
        values: dict[str, float] = {}
        with all_problems() as within:
            for name, entry in value.items():
                with within(str(name)):
                    if name not in known:
                        hint = nearest(name, known)
                        raise ConfigError(f"is no quantity of the model or of a rival; {hint}")
                    values[name] = known[name](entry)
        if {"reduced_modulus", "tension"} <= values.keys():
            raise ConfigError("fixes both modulus and tension; leave one of them to the fit")
        return values

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.thickness is not None and self.kernel is not None:
            raise ConfigError("cannot be given with a kernel; leave out one of them", "thickness")
        if self.thickness is not None and self.poissons_ratio is None:
            raise ConfigError(
                "is missing: the force on a layer depends on it as well as on the thickness; give "
                "it, such as 0.5 for a gel",
                "poissons_ratio",
            )
        if len({*self.frequencies}) < len(self.frequencies):
            raise ConfigError("names a frequency twice; give each once", "frequencies")
        if self.lag and not self.frequencies:
            raise ConfigError("is that of sines; give their frequencies, or leave it out", "lag")
        if self.kernel is not None:
            solid(self.kernel, self.poissons_ratio)
        if self.bead is not None:
            constants_of(self.bead, self.poissons_ratio)
            for name in ("kernel", "thickness", "frequencies"):
                if getattr(self, name):
                    reason = "a bead that yields is fitted on a half-space, without sines"
                    raise ConfigError(f"{reason}; leave out {name} or bead", "bead")
            if "radius" in self.uncertainty:
                reason = "of a bead that yields is taken as exact; leave it out"
                raise ConfigError(reason, "uncertainty.radius")
        return self

    @classmethod
    def from_toml(cls, path: str | Path, overrides: Iterable[str] = ()) -> Self:
        """Return the configuration in a TOML file; patterns in it start from its folder."""
        return cls.merged(path, overrides)

    @classmethod
    def merged(
        cls,
        base: FitConfig | Mapping[str, Any] | str | Path | None = None,
        overrides: Iterable[str] = (),
        **options: Any,
    ) -> Self:
        """Return a configuration with options in place of the values of another or of a TOML file.

        The JSON of a fit is one, too: its curves are sought from the current folder, as they were.
        An option that is None keeps the value of ``base``.  An option that is not a field of the
        configuration is a field of the indenter; a list for such a field, for spring_constant or
        for sensitivity has one value for each file.  Overrides replace values and options.

        Raises
        ------
        ConfigError, PluginError
            A value is not allowed, or the file cannot be read.
        """
        options = {name: value for name, value in options.items() if value is not None}
        if isinstance(base, (str, Path)) and Path(base).suffix.lower() == ".json":
            base = config_of_record(Path(base))
        if isinstance(base, (str, Path)):
            folder, data = Path(base).parent, read_toml(Path(base))
            if "curves" in data.keys() - options.keys():
                paths = map(str, as_list(data["curves"]))
                data["curves"] = [file for path in paths for file in expand_pattern(path, folder)]
            with paths_relative_to(folder):
                return cls.merged(data, overrides, **options)
        if isinstance(base, FitConfig):
            base = {name: getattr(base, name) for name in base.model_fields_set}
        own = cls.model_fields.keys() - Calibration.model_fields.keys()
        # What the indenter lacks is told with what its curve lacks.
        data = {"indenter": {}, **(base or {})}
        data |= {name: options.pop(name) for name in own & options.keys()}
        for name in data.keys() & {"indenter", "kernel", "executor"}:
            data[name] = component_table(data[name])
        if isinstance(data["indenter"], Mapping):
            data["indenter"] = with_radius(data["indenter"])
        for name, value in with_radius(options).items():
            if isinstance(value, (list, tuple)):
                data = replace_at(data, f"per_file.{name}", value)
                continue
            if isinstance(per_file := data.get("per_file"), Mapping):
                data["per_file"] = {k: v for k, v in per_file.items() if k != name}
            key = name if name in cls.model_fields else f"indenter.{name}"
            data = replace_at(data, key, value)
        return cls(**overridden(data, overrides))

    def to_dict(self) -> dict[str, Any]:
        """Return the whole configuration as JSON data, defaults included, in SI."""
        return self.model_dump(mode="json", exclude_none=True, fallback=str)

    def sources(self, curves: Curves | None = None) -> Iterator[Source]:
        """Return ``curves``, or those of the configuration if None, each read as it is taken."""
        return gather(self.curves if curves is None else curves, self, self.per_file)

    def indenter_of(self, source: Source) -> Indenter | HasForceCurve:
        """Return the indenter of one curve, with its own fields; an error names all it lacks."""
        indenter: Indenter | HasForceCurve | Mapping[str, Any] = self.indenter
        others = {*PLACE, *Calibration.model_fields}
        if self.group_by.lower() not in {"diameter", *fields_of(indenter)}:
            others.add(self.group_by.lower())
        for name, value in with_radius(source.fields).items():
            if name not in others:
                indenter = replace_at(indenter, name, value)
        if not isinstance(indenter, Mapping):
            return indenter
        lacks = {} if "type" in indenter else {"indenter": "-i sphere"}
        for name, field in fields_of(indenter).items():
            if field.is_required() and name not in indenter:
                lacks[f"indenter.{name}"] = OPTIONS.get(name, f'--set indenter.{name}="…"')
        if not lacks:
            with problems_within("indenter"):
                return registry().make(Indenter, indenter)
        curve, where = source.curve, f"{source.name}: " if source.name else ""
        if isinstance(curve, MissingInputError):
            where, lacks = curve.where, {**curve.options, **lacks}
        elif isinstance(curve, PellicleError):
            raise curve
        raise MissingInputError(where, lacks)
