"""The contracts of the six families of components.

A component is a frozen model: its fields are its parameters in SI, each with a description, its
methods are pure. The same object is configuration, code, JSON schema and provenance, and it
pickles to workers. A concrete component declares ``type: Literal["name"] = "name"``.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from operator import lt
from pathlib import Path
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    ClassVar,
    Literal,
    NamedTuple,
    Protocol,
    TypeVar,
    runtime_checkable,
)

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field

from . import storage
from .checks import whole_number
from .grid import Grid
from .model import Model
from .operators import Array
from .problem import Problem, round_off
from .result import Result, Solution, Stop
from .units import Quantity

if TYPE_CHECKING:
    import xarray as xr

Monitor = Callable[[int, float], None]
"""Called by a solver with its iteration and its residual over the tolerance, to show progress."""

_Count = Annotated[int, Field(ge=1)]
Threads = Annotated[
    int,
    BeforeValidator(partial(whole_number, unit="threads"), json_schema_input_type=_Count),
]
"""A number of threads ≥ 1; text, fractions and true are refused."""
Workers = Annotated[
    int,
    BeforeValidator(partial(whole_number, unit="workers"), json_schema_input_type=_Count),
]
"""A number of workers ≥ 1, likewise."""
# Residuals of an iteration that has gone as far as rounding lets it, over that of an application.
_ROUNDINGS = 30.0

Outcome = TypeVar("Outcome")
Footprint = Literal["unbounded", "domain"]


class Component(Model):
    """What all families share."""

    family: ClassVar[str]
    libraries: ClassVar[tuple[str, ...]] = ()
    """Distributions that it computes with, beside numpy and scipy; results say their versions."""


class Kernel(Component):
    """How the surface yields to pressure: û(q) = G(q) p̂(q).

    That is all it needs to give. On free boundaries its closed form, ``greens_function(r)`` [m/N]
    and ``radial_primitive(r)`` [m²/N] as in `pellicle.operators.HasClosedForm`, is used if it has
    one, and is otherwise tabulated from G(q) by `pellicle.hankel`. On periodic ones a uniform
    pressure has no displacement unless it also has `pellicle.operators.HasMeanCompliance`.
    """

    family: ClassVar[str] = "kernel"

    @abstractmethod
    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa], of the shape of ``q`` > 0 [rad/m]."""


class Indenter(Component):
    """The rigid body that is pressed in.

    One that knows its force on a half-space under tension, as `HasForceCurve` says, is fitted to
    measured curves at once; for any other the force is simulated first.
    """

    family: ClassVar[str] = "indenter"

    @property
    def footprint(self) -> Footprint:
        """``"domain"`` if the indenter ends where the domain does, so that contact may reach there.

        A class whose answer is always the same says ``footprint: ClassVar[Footprint] = "domain"``.
        """
        return "unbounded"

    @abstractmethod
    def profile(self, x: Array, y: Array) -> Array:
        """Return f(x, y) [m]: 0 at the lowest point, negative elsewhere, −inf where there is none.

        ``x`` of shape (nx, 1) and ``y`` of shape (1, ny) are cell centres [m] seen from the centre
        of the domain; the result is of shape (nx, ny). An unbounded indenter that is turned is
        asked for points ``x`` and ``y`` that are both of shape (nx, ny).

        Raises
        ------
        ConfigError
            The indenter cannot be put on these points.
        """


class ForceCurve(NamedTuple):
    """Force over reduced modulus against depth, and its sensitivities, each of shape (n,)."""

    force: Array
    """P/E* [m²]."""
    by_depth: Array
    """∂(P/E*)/∂δ [m]."""
    by_length: Array
    """∂(P/E*)/∂s [m]."""


@runtime_checkable
class HasForceCurve(Protocol):
    """An indenter that knows its force on a half-space under tension; `pellicle.fit` uses it."""

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the curve holds; infinite if there is none."""
        ...

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return force and sensitivities; 0 where there is no contact, at ``depth`` ≤ 0.

        Smooth and rising in depth and length.  ``depth`` [m] is of shape (n,), ``length`` ≥ 0 is
        the elastocapillary length s = 2τ₀/E* [m].
        """
        ...


@runtime_checkable
class HasMemory(Protocol):
    """A solver that states its memory; the estimate before a run uses it."""

    def arrays(self, grid: Grid) -> float:
        """Return the number of arrays of the grid's shape that a solve holds at its peak.

        Arrays of eight bytes a cell, beside operator and indenter.
        """
        ...


@runtime_checkable
class IsShallowLimit(Protocol):
    """An indenter that stands for another shape as long as it is pressed in little."""

    @property
    def radius(self) -> float:
        """Radius of curvature at the tip [m], against which the depth is little."""
        ...

    def whole_shape(self) -> HasForceCurve:
        """Return the shape that it stands for."""
        ...


class Solver(Component):
    """Finds the pressure of one load step."""

    family: ClassVar[str] = "solver"

    tolerance: Annotated[
        float,
        Quantity("1", at_least=1e-13, below=1),
        Field(description="bound on every residual, relative to the indenter's height range"),
    ] = 1e-8

    @abstractmethod
    def solve(self, problem: Problem, start: Array | None, monitor: Monitor) -> Solution:
        """Return the pressure that solves ``problem``.

        ``start`` is the pressure [Pa] of the step before, or None. The framework measures the
        result afresh; what a solver believes of its accuracy is not used.
        """

    def punch_pressure(
        self, problem: Problem, contact: NDArray[np.bool_], monitor: Monitor
    ) -> Array:
        """Return the pressure per depth [Pa/m] under a flat punch whose footprint is ``contact``.

        It displaces the surface there by 1, to `tolerance`, and is of either sign; elsewhere it is
        0. What else ``problem`` says of indenter and load does not matter. The framework makes the
        contact stiffness of it. Here by conjugate gradients (`scipy.sparse.linalg.cg`); a solver
        that has a preconditioner overrides this.
        """
        from scipy.sparse.linalg import LinearOperator, cg

        cells = np.flatnonzero(contact)
        whole = np.zeros(problem.grid.shape)
        done = 0

        def displaced(pressure: Array) -> Array:
            whole.ravel()[cells] = pressure
            return problem.operator(whole).ravel()[cells]

        def tell(_: Array) -> None:
            nonlocal done
            done += 1
            monitor(done, 1.0)

        operator = LinearOperator((cells.size, cells.size), matvec=displaced, dtype=np.float64)
        found, _ = cg(operator, np.ones(cells.size), rtol=self.tolerance / 2, callback=tell)
        whole.ravel()[cells] = found
        return whole


class IterativeSolver(Solver):
    """A solver that is a start, a step and a residual; one loop does the rest."""

    max_iterations: Annotated[
        int,
        Field(gt=0, description="iterations after which a step is given up, and says so"),
    ] = 20_000

    @abstractmethod
    def begin(self, problem: Problem, start: Array | None) -> Any:
        """Return the first state."""

    @abstractmethod
    def step(self, problem: Problem, state: Any) -> Any:
        """Return the next state; it may reuse the memory of ``state``."""

    @abstractmethod
    def residual(self, problem: Problem, state: Any) -> float:
        """Return the largest residual of a state, relative as `tolerance` is."""

    @abstractmethod
    def pressure(self, state: Any) -> Array:
        """Return the pressure [Pa] of a state."""

    def patience(self, problem: Problem) -> int:
        """Return how many iterations end it if none brings a new least residual or merit.

        A multiple of N here: a gradient method needs O(N) iterations, some of them in vain.
        """
        return sum(problem.grid.shape) + 200

    def merits(self, problem: Problem, state: Any) -> tuple[float, ...]:
        """Return what else than the residual falls while the iteration gets on: here nothing."""
        return ()

    def solve(self, problem: Problem, start: Array | None, monitor: Monitor) -> Solution:
        """Iterate until the tolerance is met, or it is plain that it will not be."""
        state = self.begin(problem, start)
        patience = self.patience(problem)
        best: tuple[float, ...] = ()
        best_at = iteration = 0
        while True:
            residual = self.residual(problem, state)
            monitor(iteration, residual / self.tolerance)
            merits = (residual, *self.merits(problem, state))
            if any(map(lt, merits, best)):
                best_at = iteration
            best = tuple(map(min, merits, best or merits))
            if not np.isfinite(residual):
                stop = Stop.NOT_FINITE
            elif residual <= self.tolerance:
                stop = Stop.DONE
            elif iteration - best_at >= patience:
                at_rounding = residual <= _ROUNDINGS * round_off(problem, self.pressure(state))
                stop = Stop.ROUND_OFF if at_rounding else Stop.STALLED
            elif iteration >= self.max_iterations:
                stop = Stop.ITERATION_LIMIT
            else:
                state = self.step(problem, state)
                iteration += 1
                continue
            return Solution(self.pressure(state), iteration, stop)


class AreaCorrection(Component):
    """Corrects the area of contact for the discretisation."""

    family: ClassVar[str] = "correction"

    @abstractmethod
    def area(self, contact: NDArray[np.bool_], spacing: tuple[float, float]) -> float:
        """Return the area of contact [m²].

        ``contact`` of shape (nx, ny) tells the cells in contact; ``spacing`` [m] their edges.
        """

    def periodic_area(self, contact: NDArray[np.bool_], spacing: tuple[float, float]) -> float:
        """Return the area of contact [m²] on a periodic domain, whose opposite edges touch.

        That of `area` here; a correction that looks at neighbouring cells overrides this.
        """
        return self.area(contact, spacing)


@dataclass(frozen=True)
class Place:
    """Where the outputs of a run or of a study go."""

    directory: Path
    """Folder; made when something is written."""
    name: str
    """Stem of the file names."""
    configuration: str
    """The run or the study, as its `to_json` says it, with paths as they were given."""
    identity: str = ""
    """The run's `Run.identity`: what is there of another run is not to be touched."""
    overwrite: bool = False
    """Whether to begin anew, in place of whatever is there."""

    def file(self, ending: str) -> Path:
        """Return ``directory/name<ending>``."""
        return self.directory / f"{self.name}{ending}"


class Output(Component):
    """Leaves the result of a run or of a study somewhere.

    A run calls `open` once, `step` after each load step, and `close` once, also after an
    interruption, with the steps done so far. Steps that an output has from an earlier process, as
    `resume` says, are not solved again; `step` of the other outputs gets them all the same.

    In a study, an output that has a `study` of its own is called by the study alone; any other is
    called by each run. `endings` says what files it leaves.
    """

    family: ClassVar[str] = "output"

    @property
    def draws_studies(self) -> bool:
        """Whether a study calls it, once; any other is called by each run of the study."""
        return type(self).study is not Output.study

    def endings(self) -> tuple[str, ...]:
        """Return what `Place.file` is given for the files that it leaves, of a run or of a study.

        ``*`` stands for anything, as the number of a step. Outputs that would write the same file
        are refused. Here ``-type*``, or ``-name*`` if there is a field ``name`` that says one.
        """
        return (f"-{getattr(self, 'name', '') or getattr(self, 'type', '')}*",)

    def open(self, place: Place) -> None:
        """Prepare; raise StorageError if it is plain that nothing can be written.

        Here the folder of its first file is tried.
        """
        for ending in self.endings()[:1]:
            storage.check_writable(place.file(ending))

    def resume(self, place: Place) -> xr.Dataset | None:
        """Return the steps that an earlier process finished of the same run, if there are any."""
        return None

    def step(self, place: Place, step: xr.Dataset) -> None:
        """Take one finished step: a dataset with dimension step of length 1."""

    def close(self, place: Place, result: Result) -> tuple[Path, ...]:
        """Finish and return the files left behind."""
        return ()

    def study(self, place: Place, table: xr.Dataset) -> tuple[Path, ...]:
        """Leave what a study shows, made of its table, and return the files.

        ``table`` is what `pellicle.run_study` returns: numbers over the varied axes and ``step``;
        NaN, and a message in ``status``, where a run has not been done. It is called at the end,
        also of a study that was interrupted.
        """
        return ()


class Task(Protocol):
    """A run of a study, as an executor sees it; it pickles."""

    @property
    def name(self) -> str:
        """A line for people."""
        ...

    @property
    def memory(self) -> int:
        """Memory that the task takes while it runs [bytes], estimated."""
        ...


AnyTask = TypeVar("AnyTask", bound=Task)
Report = Callable[[AnyTask, Any], None]
"""Called in the calling process with a task and what its work said."""
Say = Callable[[Any], None]
"""Called by work, wherever it runs, with something small that pickles, for `Report`."""


class Executor(Component):
    """Carries out the runs of a study."""

    family: ClassVar[str] = "executor"

    threads: Annotated[
        Threads | None,
        Field(description="threads of each run's Fourier transforms; if absent, what is fastest"),
    ] = None

    @abstractmethod
    def map(
        self,
        work: Callable[[AnyTask, Say], Outcome],
        tasks: Sequence[AnyTask],
        report: Report[AnyTask],
    ) -> Iterator[tuple[AnyTask, Outcome | Exception]]:
        """Yield each task once, as they finish, with what ``work(task, say)`` returned or raised.

        ``work`` is a picklable function. A task whose worker died comes with an exception that says
        so; it does not stop the others. What ``work`` says reaches ``report`` in this process, as
        soon as may be, or not at all. Where the iterator is closed early, no task goes on.
        """


@dataclass(frozen=True)
class Case:
    """A case of known truth: one row of ``pellicle validate``."""

    name: str
    """What is solved, e.g. ``"Hertz sphere: force"``."""
    configuration: dict[str, Any]
    """The run, as a TOML file would say it."""
    computed: Callable[[Result], float]
    """Takes the quantity out of the result, SI."""
    expected: float
    """Its true value, SI."""
    unit: str
    """Of both, for the table."""
    tolerance: float
    """Relative error that is allowed."""
    source: str
    """Where the true value comes from: author, year."""


Suite = Callable[[], Iterable[Case]]
"""Makes cases, when somebody wants to see them solved."""

FAMILIES: dict[str, type[Component]] = {
    family.family: family for family in (Kernel, Indenter, Solver, AreaCorrection, Output, Executor)
}
"""The base class of each family, by name."""
