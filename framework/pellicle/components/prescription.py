"""The contract of prescriptions: what a load step prescribes."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np

from pellicle.arrays import Array
from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.initial_guess import overlap_pressure
from pellicle.contact.law import Law
from pellicle.contact.load_step import FinishedStep
from pellicle.contact.problem import Adhesive, Depth, Force, Problem
from pellicle.contact.solution import State
from pellicle.errors import PluginError, excerpt
from pellicle.grid import Grid
from pellicle.plugins.component import Component
from pellicle.surface.operators import Operator
from pellicle.units import Quantity
from pellicle.variables import COORDINATES, VARIABLES, Variable

from .indenter import Footprint

OPTIONS: Final = frozenset({"stiffness", "time"})
"""Keys of ``[loading]`` other than a prescription and its fields."""


@dataclass(frozen=True)
class Setting:
    """The data that a prescription may use: the run and the last step."""

    grid: Grid
    operator: Operator
    """The map from pressure [Pa] to displacement [m]."""
    profile: Array
    """Indenter profile f ≤ 0 [m] of the grid's shape; −inf where there is no indenter."""
    footprint: Footprint
    state: State | None = None
    """The state at the end of the step before; None at the first step."""
    law: Law | None = None
    """The traction that acts across the gap; None for hard contact that does not stick."""
    left: Array | None = None
    """Displacement left behind by earlier load steps [m]; None if there is none."""
    path: tuple[FinishedStep, ...] = ()
    """The last two load steps, the earlier one first; fewer if there are no more."""

    @property
    def sticks(self) -> bool:
        """Whether a traction acts across the gap."""
        return self.law is not None

    @property
    def mean_height(self) -> float:
        """Height [m] of the indenter's mean plane over its lowest point, ≤ 0.

        −inf where the indenter does not fill its domain.
        """
        return float(self.profile.mean())

    def problem(self, control: Depth | Force) -> Problem:
        """Return the problem of a load step."""
        profile = self.profile if self.left is None else self.profile - self.left
        posed = self.grid, self.operator, profile, control, self.left
        return Problem(*posed) if self.law is None else Adhesive(*posed, law=self.law)

    def force_at(self, depth: float) -> float:
        """Return an estimate of the force [N] at a depth [m], by one application of the operator.

        The pressure is the multiple of the overlap of indenter and undeformed surface whose
        displacement comes nearest to the overlap in energy.
        """
        overlap = np.maximum(self.problem(Depth(depth)).profile + depth, 0.0)
        return self.grid.cell_area * float(overlap_pressure(self.operator, overlap).sum())


@dataclass(frozen=True)
class Search:
    """The control at which a measured quantity has a given value."""

    goal: float
    measure: Callable[[Equilibrium], float]
    """The quantity; it has to grow with the control, or to fall if not `increasing`."""
    control: type[Depth] | type[Force] = Force
    resolution: float = 0.0
    """Difference from the goal up to which the goal counts as met."""
    width: float = 1e-9
    """Relative width of the interval of controls to which a jump is located."""
    guess: float | None = None
    """Control of the first trial [m or N]; None to start from that of the last step."""
    in_cells: bool = False
    """Whether the quantity is that of a whole number of cells."""
    quantity: str = "quantity"
    """Name of the quantity in messages."""
    unit: str = ""
    """SI unit of the quantity in messages."""
    increasing: bool = True
    """Whether the quantity grows with the control; False if it falls."""


class Prescription(Component):
    """Converts a prescribed value to a depth, a force or a search for one of them."""

    family: ClassVar[str] = "prescription"
    place: ClassVar[str] = "loading"
    unit: ClassVar[str]
    """SI unit of its values."""
    at_least: ClassVar[float | None] = None
    """Least allowed value; None if there is no bound."""
    may_pull: ClassVar[bool] = False
    """Whether values below `at_least` are allowed where there is an interaction."""
    needs_period: ClassVar[bool] = False
    """Whether it is defined on periodic grids only."""
    is_zero_at_rest: ClassVar[bool] = True
    """Whether 0, from which a path in legs begins, is its value before the indenter presses."""
    variables: ClassVar[tuple[Variable, ...]] = ()
    """Variables that it adds to a result; kind ``residual`` is the relative error of its search."""

    @classmethod
    def check_class(cls) -> None:
        """Refuse a class that ``[loading]`` cannot hold, or whose variables a result cannot."""
        name, type_ = cls.__name__, str(cls.model_fields["type"].default)
        if not isinstance(getattr(cls, "unit", None), str):
            raise PluginError(f"{name} lacks the class variable unit: the SI unit of its values")
        if not cls.quantity().has_known_unit:
            raise PluginError(f"{name}.unit is {cls.unit!r}, which is not a known unit")
        if reserved := {type_, *cls.model_fields} & OPTIONS:
            raise PluginError(
                f"{name}: {min(reserved)!r} is an option of [loading]; choose another name"
            )
        if type_ in cls.model_fields:
            raise PluginError(f"{name} has a field with the name of its type; choose another name")
        for variable in cls.variables:
            is_taken = variable.name in {*VARIABLES, *COORDINATES}
            if is_taken or not variable.name.isidentifier():
                reason = "the name of another variable" if is_taken else "not a name"
                raise PluginError(
                    f"{name}: variables has {excerpt(variable.name)}, which is {reason}; choose "
                    "one of letters, digits and _ that no result has yet"
                )

    @classmethod
    def quantity(cls, interaction: bool = False) -> Quantity:
        """Return unit and range of its values, without or with an interaction."""
        if interaction and cls.may_pull:
            return Quantity(cls.unit)
        hint = "; with an [interaction] it may be negative" * cls.may_pull
        return Quantity(cls.unit, at_least=cls.at_least, hint=hint)

    @abstractmethod
    def target(self, setting: Setting, value: float) -> Depth | Force | Search:
        """Return the depth, the force or the search that a prescribed ``value`` stands for."""

    def check(self, setting: Setting, value: float) -> None:
        """Refuse a value that cannot be reached, by a ConfigError; nothing is solved yet."""

    def report(self, setting: Setting, step: Equilibrium) -> dict[str, float]:
        """Return the `variables` of a solved step, except that of kind ``residual``."""
        return {}
