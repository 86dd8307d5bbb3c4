"""The kit finds what is wrong: for each rule a component that breaks it, and only it, by a little.

The built-in components, which break none, are checked in tests/contracts.
"""

import json
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from itertools import count
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
import pytest
from pydantic import ConfigDict, Field, SerializationInfo, model_serializer

import pellicle as pl
from pellicle import testing
from pellicle.components import FAMILIES, Component
from pellicle.plugins import registry
from pellicle.testing import component as component_rules
from pellicle.units import Length


def made(family: str, type_: str, **fields: Any) -> Any:
    """Return a built-in component."""
    return registry().components[family][type_].component(**fields)


def base(family: str, type_: str) -> Any:
    """Return the class of a built-in component."""
    return registry().components[family][type_].component


HalfSpace: Any = base("kernel", "half_space")
Paraboloid: Any = base("indenter", "paraboloid")
ConjugateGradient: Any = base("solver", "conjugate_gradient")
Yastrebov: Any = base("correction", "yastrebov")
Csv: Any = base("output", "csv")


# ---- what all components keep ----


class NoDocstring(Paraboloid):
    type: Literal["no_docstring"] = "no_docstring"


NoDocstring.__doc__ = None


class Unfinished(Paraboloid):
    """Shape without a full stop"""  # noqa: D400

    type: Literal["unfinished"] = "unfinished"


class Wishful(Paraboloid):
    """Shape of a library that nobody has."""

    libraries: ClassVar[tuple[str, ...]] = ("pellicle-no-such-library",)


class NoType(pl.AreaCorrection):
    """Correction that has no type."""

    def area(self, contact: Any, spacing: Any) -> float:
        """Return the count [m²]."""
        return float(contact.sum() * spacing[0] * spacing[1])


class NoDescription(Paraboloid):
    """Paraboloid with a field that nobody explains."""

    type: Literal["no_description"] = "no_description"
    offset: Length = 1.0


class BareFloat(Paraboloid):
    """Paraboloid with a number of no unit."""

    type: Literal["bare_float"] = "bare_float"
    offset: Annotated[float | None, Field(description="some length [m]")] = None


class UnitNotTold(Paraboloid):
    """Paraboloid whose description hides a unit."""

    type: Literal["unit_not_told"] = "unit_not_told"
    offset: Annotated[Length | None, Field(description="some length")] = None


class Thawed(Paraboloid):
    """Paraboloid whose fields can be set."""

    model_config = ConfigDict(frozen=False)
    type: Literal["thawed"] = "thawed"

    def __hash__(self) -> int:
        return hash(self.radius)


class Unpicklable(Paraboloid):
    """Paraboloid that stays at home."""

    type: Literal["unpicklable"] = "unpicklable"

    def __getstate__(self) -> Any:
        return threading.Lock()


class Forgetful(Paraboloid):
    """Paraboloid that is written without what it was given."""

    type: Literal["forgetful"] = "forgetful"

    @model_serializer
    def _wrong(self) -> dict[str, Any]:
        return {"type": "forgetful", "radius": 2 * self.radius}


class Holey(Paraboloid):
    """Paraboloid with a list that TOML cannot hold."""

    type: Literal["holey"] = "holey"
    marks: Annotated[tuple[int | None, ...], Field(description="numbers, or none")] = (1, None)


class Hospitable(Paraboloid):
    """Paraboloid whose schema has room for more than it takes."""

    model_config = ConfigDict(json_schema_extra={"additionalProperties": True})
    type: Literal["hospitable"] = "hospitable"


class TwoFaced(Paraboloid):
    """Paraboloid that is another as a Python table than as JSON."""

    type: Literal["two_faced"] = "two_faced"

    @model_serializer
    def _wrong(self, info: SerializationInfo) -> dict[str, Any]:
        factor = 2 if info.mode == "python" else 1
        return {"type": "two_faced", "radius": factor * self.radius}


class Welcoming(Paraboloid):
    """Paraboloid that takes any field."""

    model_config = ConfigDict(extra="ignore")
    type: Literal["welcoming"] = "welcoming"


class Stranger(Paraboloid):
    """Paraboloid that no plugin registers."""

    type: Literal["stranger"] = "stranger"


class Usurper(Paraboloid):
    """Paraboloid under a name that is taken."""

    type: Literal["paraboloid"] = "paraboloid"


GENERAL: dict[str, tuple[Callable[[], Any], str]] = {
    "a class": (lambda: Paraboloid, "is_an_instance"),
    "another family": (lambda: made("kernel", "half_space", reduced_modulus=1.0), "is_an_instance"),
    "no docstring": (partial(NoDocstring, radius=1e-3), "class_can_be_registered"),
    "no description": (partial(NoDescription, radius=1e-3), "class_can_be_registered"),
    "no full stop": (partial(Unfinished, radius=1e-3), "docstring_starts_with_a_sentence"),
    "bare float": (partial(BareFloat, radius=1e-3), "numbers_have_units"),
    "unit not told": (partial(UnitNotTold, radius=1e-3), "numbers_have_units"),
    "not frozen": (partial(Thawed, radius=1e-3), "is_frozen"),
    "no pickle": (partial(Unpicklable, radius=1e-3), "pickles"),
    "other JSON": (partial(Forgetful, radius=1e-3), "goes_through_json"),
    "no TOML": (partial(Holey, radius=1e-3), "goes_through_toml"),
    "other schema": (partial(Hospitable, radius=1e-3), "schema_tells_the_fields"),
    "no such library": (partial(Wishful, radius=1e-3), "libraries_are_installed"),
    "unknown fields": (partial(Welcoming, radius=1e-3), "unknown_field_is_refused"),
    "not registered": (partial(Stranger, radius=1e-3), "is_registered"),
    "type is taken": (partial(Usurper, radius=1e-3), "is_registered"),
}


# ---- kernels ----


class Kernel(HalfSpace):
    """Half-space to be broken."""

    type: Literal["broken"] = "broken"


class Scalar(Kernel):
    """Takes one wavenumber at a time."""

    def compliance(self, q: Any) -> Any:
        return np.array([2 / (self.reduced_modulus * float(q.ravel()[0]))])


class Coupled(Kernel):
    """Looks at all wavenumbers for each."""

    def compliance(self, q: Any) -> Any:
        return super().compliance(q) * (1 + 1e-9 * (q / q.max()))


class Single(Kernel):
    """Works in single precision."""

    def compliance(self, q: Any) -> Any:
        return super().compliance(q).astype(np.float32)


class Overwriting(Kernel):
    """Saves memory at its caller's cost."""

    def compliance(self, q: Any) -> Any:
        q *= self.reduced_modulus / 2
        return 1 / q


class Negative(Kernel):
    """Pulls coarse waves up."""

    def compliance(self, q: Any) -> Any:
        return super().compliance(q) - 1e-3


class Overflowing(Kernel):
    """Is NaN for short waves, as sinh/cosh may be."""

    def compliance(self, q: Any) -> Any:
        return np.where(q > 1e11, np.nan, super().compliance(q))


class Growing(Kernel):
    """Yields ever more to short waves."""

    def compliance(self, q: Any) -> Any:
        return super().compliance(q) * (1 + (q * 1e-9) ** 1.1)


class Economical(Kernel):
    """Is content with single precision where there is much to do."""

    def compliance(self, q: Any) -> Any:
        found = super().compliance(q)
        return found if q.size < 300 else found.astype(np.float32).astype(np.float64)


class Wavering(Kernel):
    """Sinks by another amount each time that it is asked."""

    _answers: ClassVar[Any] = count(1)

    def mean_compliance(self) -> float:
        return 1e-6 * next(self._answers)


class Half(Kernel):
    """Has one of the two methods of a closed form."""

    radial_primitive: ClassVar[Any] = property(lambda self: (_ for _ in ()).throw(AttributeError()))


class WrongPrimitive(Kernel):
    """Primitive 1 % too large."""

    def radial_primitive(self, r: Any) -> Any:
        return 1.01 * super().radial_primitive(r)


class ShiftedPrimitive(Kernel):
    """Primitive that does not start at 0."""

    def radial_primitive(self, r: Any) -> Any:
        return super().radial_primitive(r) + 1e-12


class WrongForm(Kernel):
    """Closed form 1 % too large, its primitive too."""

    def greens_function(self, r: Any) -> Any:
        return 1.01 * super().greens_function(r)

    def radial_primitive(self, r: Any) -> Any:
        return 1.01 * super().radial_primitive(r)


class Hasty(Kernel):
    """Primitive 0.1 ‰ too large where there are many radii."""

    def radial_primitive(self, r: Any) -> Any:
        return super().radial_primitive(r) * (1 + 1e-4 * (r.size > 1000))


class Complex(Kernel):
    """Yields out of phase."""

    def compliance(self, q: Any) -> Any:
        return super().compliance(q) * (1 + 0.1j)


class Whole(Kernel):
    """Counts in metres per pascal."""

    def compliance(self, q: Any) -> Any:
        return np.ceil(super().compliance(q)).astype(int)


class OverwritingRadii(Kernel):
    """Has a closed form that saves memory at its caller's cost."""

    def greens_function(self, r: Any) -> Any:
        found = super().greens_function(r)
        r *= 2
        return found


KERNELS = {
    Complex: "compliance_is_vectorised",
    Whole: "compliance_is_vectorised",
    OverwritingRadii: "closed_form_leaves_its_argument",
    Scalar: "compliance_is_vectorised",
    Coupled: "compliance_is_vectorised",
    Single: "compliance_is_vectorised",
    Overwriting: "compliance_leaves_its_argument",
    Negative: "compliance_is_positive_and_finite",
    Overflowing: "compliance_is_positive_and_finite",
    Growing: "compliance_does_not_grow_for_short_waves",
    Economical: "periodic_operator_is_the_compliance",
    Wavering: "uniform_pressure_sinks_by_the_mean_compliance",
    Half: "closed_form_is_whole",
    WrongPrimitive: "primitive_is_the_integral_of_the_closed_form",
    ShiftedPrimitive: "primitive_is_the_integral_of_the_closed_form",
    WrongForm: "closed_form_is_the_transform_of_the_compliance",
    Hasty: "free_operator_is_the_transform_of_the_compliance",
}


# ---- indenters ----


class Indenter(Paraboloid):
    """Paraboloid to be broken."""

    type: Literal["broken"] = "broken"


class Flattened(Indenter):
    """Heights in a row."""

    def profile(self, x: Any, y: Any) -> Any:
        return super().profile(x, y).ravel()


class Raised(Indenter):
    """Heights upwards."""

    def profile(self, x: Any, y: Any) -> Any:
        return -super().profile(x, y)


class Gone(Indenter):
    """No indenter anywhere."""

    def profile(self, x: Any, y: Any) -> Any:
        return np.full(np.broadcast(x, y).shape, -np.inf)


class Moving(Indenter):
    """Shifts the points of its caller."""

    def profile(self, x: Any, y: Any) -> Any:
        found = super().profile(x, y)
        x -= 1e-6
        return found


class Random(Indenter):
    """Another roughness at each look."""

    _rng: ClassVar[Any] = np.random.default_rng(0)

    def profile(self, x: Any, y: Any) -> Any:
        return super().profile(x, y) * self._rng.uniform(1, 1.001)


class Hovering(Indenter):
    """Lowest point a micrometre too high."""

    def profile(self, x: Any, y: Any) -> Any:
        return super().profile(x, y) - 1e-6


class Relative(Indenter):
    """Measures from the highest of the points that it is asked for."""

    def profile(self, x: Any, y: Any) -> Any:
        found = super().profile(x, y)
        return found - found.max()


class Aloof(Indenter):
    """Ends with the domain, its lowest point a twentieth of its range too high."""

    footprint: ClassVar[Any] = "domain"

    def profile(self, x: Any, y: Any) -> Any:
        found = super().profile(x, y)
        return found - 0.05 * np.ptp(found)


class Misspelt(Indenter):
    """Ends where nobody looks."""

    footprint: ClassVar[Any] = "Domain"


class ComplexHeights(Indenter):
    """Heights with an imaginary part."""

    def profile(self, x: Any, y: Any) -> Any:
        return super().profile(x, y) + 0j


class NotANumber(Indenter):
    """Heights that are not known everywhere."""

    def profile(self, x: Any, y: Any) -> Any:
        return np.where(x > 5e-4, np.nan, super().profile(x, y))


class Insensitive(Indenter):
    """Force curve that does not know what the tension does."""

    def force_curve(self, depth: Any, length: Any) -> Any:
        found = super().force_curve(depth, length)
        return found._replace(by_length=0 * found.by_length)


class Shallow(Indenter):
    """Force curve that changes the depths that it is given."""

    def force_curve(self, depth: Any, length: Any) -> Any:
        depth[...] = np.maximum(depth, 0)
        return super().force_curve(depth, length)


INDENTERS = {
    Insensitive: "force_curve_rises",
    Shallow: "force_curve_rises",
    Misspelt: "footprint_is_known",
    ComplexHeights: "profile_has_the_shape_of_the_grid",
    NotANumber: "profile_is_nowhere_positive",
    Flattened: "profile_has_the_shape_of_the_grid",
    Raised: "profile_is_nowhere_positive",
    Gone: "profile_is_nowhere_positive",
    Moving: "profile_is_pure",
    Random: "profile_is_pure",
    Hovering: "lowest_point_is_at_zero",
    Relative: "heights_depend_on_their_own_point",
    Aloof: "run_converges",
}


# ---- solvers ----


class Solver(ConjugateGradient):
    """Conjugate gradients to be broken."""

    type: Literal["broken"] = "broken"


class Sucking(Solver):
    """Leaves a negative pressure in one cell."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        found = super().solve(problem, start, monitor)
        pressure = found.pressure.copy()
        pressure[0, 0] = -1e-9 * pressure.max()
        return replace(found, state=pressure)


class Lying(Solver):
    """Says that it is done when it is not."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        found = super().solve(problem, start, monitor)
        return replace(found, state=1.0001 * found.pressure)


class GivingUp(Solver):
    """Stops early, and says so."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        return super().model_copy(update={"max_iterations": 3}).loop(problem, start, monitor)

    def loop(self, problem: Any, start: Any, monitor: Any) -> Any:
        return ConjugateGradient.solve(self, problem, start, monitor)


class Overwritten(Solver):
    """Works in the array that it is given to start from."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        found = super().solve(problem, start, monitor)
        if start is not None:
            start.pressure[...] = found.pressure
        return found


class Shared(Solver):
    """Returns the array that it is given to start from, if that is right."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        found = super().solve(problem, start, monitor)
        if start is None:
            return found
        return replace(found, state=start, stop=pl.Stop.STALLED)


class Stale(Solver):
    """Takes the step before for the answer."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        found = super().solve(problem, start, monitor)
        if start is None:
            return found
        return replace(found, state=start.pressure.copy(), stop=pl.Stop.STALLED)


class Absolute(Solver):
    """Knows of soft solids only."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        found = super().solve(problem, start, monitor)
        soft = problem.operator.kernel.reduced_modulus < 1.5e4
        stop = pl.Stop.STALLED
        return found if soft else replace(found, state=0.9 * found.pressure, stop=stop)


class Silent(Solver):
    """Tells nobody how far it is."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        return super().solve(problem, start, lambda *told: None)


class Miscounting(Solver):
    """Returns another number of iterations than it told."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        found = super().solve(problem, start, monitor)
        return replace(found, iterations=found.iterations + 1)


class Round(Solver):
    """Takes every punch for a round one."""

    def response(self, problem: Any, state: Any, monitor: Any) -> Any:
        return 1.01 * super().response(problem, state, monitor)


class Wide(Solver):
    """Presses off the contact."""

    def response(self, problem: Any, state: Any, monitor: Any) -> Any:
        return super().response(problem, state, monitor) + 1e-3


class Mute(Solver):
    """Returns nothing."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        super().solve(problem, start, monitor)


class Rowwise(Solver):
    """Returns the pressure in a row."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        found = super().solve(problem, start, monitor)
        return replace(found, state=found.pressure.ravel())


class OutOfPhase(Solver):
    """Returns a complex pressure."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        found = super().solve(problem, start, monitor)
        return replace(found, state=found.pressure + 0j)


class Meddling(Solver):
    """Puts an operator of its own into the problem."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        found = super().solve(problem, start, monitor)
        object.__setattr__(problem, "operator", None)
        return found


SOLVERS = {
    Mute: "solve_returns_a_solution",
    Rowwise: "solve_returns_a_solution",
    OutOfPhase: "solve_returns_a_solution",
    Meddling: "solve_returns_a_solution",
    Sucking: "pressure_is_nowhere_negative",
    Lying: "done_means_solved",
    GivingUp: "what_is_prescribed_is_solved",
    Overwritten: "start_belongs_to_the_caller",
    Shared: "start_belongs_to_the_caller",
    Stale: "start_does_not_matter",
    Absolute: "pressure_is_proportional_to_the_stiffness",
    Silent: "progress_is_told",
    Miscounting: "progress_is_told",
    Round: "response_is_that_of_a_flat_punch",
    Wide: "response_is_that_of_a_flat_punch",
}


# ---- corrections ----


class Correction(Yastrebov):
    """Correction to be broken."""

    type: Literal["broken"] = "broken"


class Several(Correction):
    """An area for each row."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return contact.sum(axis=1) * spacing[0] * spacing[1]


class Filling(Correction):
    """Marks cells of its caller's."""

    def area(self, contact: Any, spacing: Any) -> Any:
        contact[20:25, 10:15] = True
        return super().area(contact, spacing)


class Floor(Correction):
    """Never less than one cell."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return max(super().area(contact, spacing), spacing[0] * spacing[1])


class Overall(Correction):
    """One per cent off, boundary or not."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return 0.99 * super().area(contact, spacing)


class Excessive(Correction):
    """Takes off ten times too much."""

    def area(self, contact: Any, spacing: Any) -> Any:
        count = np.count_nonzero(contact) * spacing[0] * spacing[1]
        return count - 30 * (count - super().area(contact, spacing))


class Unscaled(Correction):
    """Takes off cells of a size that it knows."""

    def area(self, contact: Any, spacing: Any) -> Any:
        cell = spacing[0] * spacing[1]
        return super().area(contact, spacing) - 1e-12 * (0 < contact.mean() < 1) * (cell > 1e-12)


class Skewed(Correction):
    """Sees boundaries across x only."""

    def area(self, contact: Any, spacing: Any) -> Any:
        cell = spacing[0] * spacing[1]
        switches = np.count_nonzero(contact[1:] != contact[:-1])
        return cell * (np.count_nonzero(contact) - 0.1 * switches)


class Seamed(Correction):
    """Takes the edge of a periodic domain for a border."""

    def periodic_area(self, contact: Any, spacing: Any) -> float:
        return float(self.area(contact, spacing))


class Microscopic(Correction):
    """Sees nothing of cells wider than 30 µm."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return super().area(contact, spacing) if spacing[0] < 3e-5 else 0.0


class Wordy(Correction):
    """Says the area in words."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return f"{super().area(contact, spacing)} m²"


class Lost(Correction):
    """Does not know the area."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return np.nan


class Failing(Correction):
    """Says −1 for no contact, as C programs do."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return super().area(contact, spacing) if contact.any() else -1


CORRECTIONS = {
    Wordy: "area_is_pure",
    Lost: "area_is_pure",
    Failing: "no_contact_has_no_area",
    Several: "area_is_pure",
    Filling: "area_is_pure",
    Floor: "no_contact_has_no_area",
    Overall: "full_contact_is_the_domain",
    Excessive: "area_is_near_the_count",
    Unscaled: "area_scales_with_the_cells",
    Skewed: "area_does_not_depend_on_the_view",
    Seamed: "periodic_area_has_no_seam",
    Microscopic: "goes_into_the_result",
}


# ---- outputs ----


class Output(pl.Output):
    """Text with the depth of each step, to be broken."""

    type: Literal["broken"] = "broken"

    def endings(self) -> tuple[str, ...]:
        return (".json",)

    def close(self, place: Any, result: Any) -> Any:
        path = place.file(".json")
        path.write_text(json.dumps(self.told(result.dataset["depth"].values.tolist())))
        return (path,)

    def told(self, depths: list[float]) -> list[float]:
        return depths


class LosesFirst(Output):
    """Forgets the first step."""

    def told(self, depths: list[float]) -> list[float]:
        return depths[1:] or ["none"]  # type: ignore[list-item]


class LosesLast(Output):
    """Forgets the last step."""

    def told(self, depths: list[float]) -> list[float]:
        return depths[:-1] or ["none"]  # type: ignore[list-item]


class Nameless(Output):
    """Does not name what it leaves."""

    def close(self, place: Any, result: Any) -> Any:
        super().close(place, result)
        return ()


class Littering(Output):
    """Leaves more than it names."""

    def close(self, place: Any, result: Any) -> Any:
        place.file(".log").write_text("done")
        return super().close(place, result)


class Untold(Output):
    """Leaves and names a file that it tells nobody of beforehand."""

    def endings(self) -> tuple[str, ...]:
        return ("-*.json",)


class Empty(Output):
    """Leaves a file with nothing in it."""

    def close(self, place: Any, result: Any) -> Any:
        (path,) = super().close(place, result)
        path.write_text("")
        return (path,)


class Own(Output):
    """Leaves a file of a name that another run would have too."""

    def close(self, place: Any, result: Any) -> Any:
        (path,) = super().close(place, result)
        return (path.replace(path.with_name("result.json")),)


class Once(Output):
    """Refuses to replace its own file."""

    def open(self, place: Any) -> None:
        super().open(place)
        if place.file(".json").exists():
            raise pl.StorageError(f"{place.file('.json')} exists")


class Optimistic(Output):
    """Finds out after the computation that it cannot write."""

    def open(self, place: Any) -> None:
        pass

    def close(self, place: Any, result: Any) -> Any:
        place.directory.mkdir(parents=True, exist_ok=True)
        return super().close(place, result)


class Resuming(Output):
    """Goes on from a file that need not be there."""

    def resume(self, place: Any) -> Any:
        json.loads(place.file(".json").read_text())


class Normalising(Output):
    """Divides the pressure by its maximum, in place."""

    def step(self, place: Any, step: Any) -> None:
        step["pressure"].values[...] /= step["pressure"].values.max()


class Renaming(Output):
    """Takes the data for its own."""

    def close(self, place: Any, result: Any) -> Any:
        result.dataset.attrs["title"] = "mine"
        return super().close(place, result)


class Spoken(Output):
    """Says the name of its file."""

    def close(self, place: Any, result: Any) -> Any:
        (path,) = super().close(place, result)
        return str(path)


OUTPUTS = {
    Normalising: "leaves_its_data_as_they_are",
    Renaming: "leaves_its_data_as_they_are",
    Spoken: "leaves_the_files_it_names",
    LosesFirst: "loses_no_step",
    LosesLast: "loses_no_step",
    Nameless: "leaves_the_files_it_names",
    Littering: "leaves_the_files_it_names",
    Untold: "leaves_the_files_it_names",
    Empty: "leaves_the_files_it_names",
    Own: "leaves_the_files_it_names",
    Once: "leaves_the_files_it_names",
    Optimistic: "hopeless_folder_is_known_before_computing",
    Resuming: "works_in_a_run",
}


# ---- executors ----


class Executor(pl.Executor):
    """One task after the other, to be broken."""

    type: Literal["broken"] = "broken"

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        for task in tasks:
            yield task, self.attempt(work, task, partial(report, task))

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        try:
            return work(task, say)
        except Exception as error:
            return error
        except SystemExit as error:
            return RuntimeError(str(error))


class Dropping(Executor):
    """Leaves out the last of many tasks."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        yield from super().map(work, tasks[:5], report)


class Repeating(Executor):
    """Yields the first task again."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        yield from super().map(work, [*tasks, *tasks[:1]], report)


class Twice(Executor):
    """Carries tasks out twice to be sure, and yields them once."""

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        first = super().attempt(work, task, say)
        second = super().attempt(work, task, lambda said: None)
        return second if isinstance(second, FileExistsError) else first


class Copying(Executor):
    """Yields copies of tasks."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        for task, outcome in super().map(work, tasks, report):
            yield replace(task), outcome


class Crossing(Executor):
    """Gives outcomes to the wrong tasks."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        outcomes = [outcome for _, outcome in super().map(work, tasks, report)]
        yield from zip(tasks, reversed(outcomes), strict=True)


class Caching(Executor):
    """Takes equal tasks for one."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        yield from super().map(work, list(dict.fromkeys(tasks)), report)


class Fragile(Executor):
    """Needs a task."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        with ThreadPoolExecutor(len(tasks)):
            yield from super().map(work, tasks, report)


class Hiding(Executor):
    """Says None for an exception."""

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        found = super().attempt(work, task, say)
        return None if isinstance(found, ValueError) else found


class Raising(Executor):
    """Lets an exception out."""

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        return work(task, say)


class Leaving(Executor):
    """Lets ``sys.exit()`` out."""

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        try:
            return work(task, say)
        except Exception as error:
            return error


class Confusing(Executor):
    """Reports everything for the first task."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        for task in tasks:
            yield task, self.attempt(work, task, partial(report, tasks[0]))


class Swallowing(Executor):
    """Keeps what report raises to itself."""

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        try:
            return super().attempt(work, task, say)
        except KeyboardInterrupt as error:
            return RuntimeError(str(error))


class Lingering(Executor):
    """Goes on when nobody listens any more."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        pool = ThreadPoolExecutor(2)
        futures = [pool.submit(self.attempt, work, task, lambda said: None) for task in tasks]
        for task, future in zip(tasks, futures, strict=True):
            yield task, future.result()


class Halting(Executor):
    """Carries out nothing more once a worker has died."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        dead = False
        for task, outcome in super().map(work, tasks, report):
            yield task, RuntimeError("no worker is left") if dead else outcome
            dead = dead or "ended the process" in str(outcome)


EXECUTORS = {
    Dropping: "each_task_comes_once_with_its_outcome",
    Repeating: "each_task_comes_once_with_its_outcome",
    Copying: "each_task_comes_once_with_its_outcome",
    Crossing: "each_task_comes_once_with_its_outcome",
    Twice: "each_task_is_carried_out_once",
    Caching: "equal_tasks_are_two_tasks",
    Fragile: "no_tasks_are_no_trouble",
    Hiding: "failure_is_an_outcome",
    Raising: "failure_is_an_outcome",
    Leaving: "exit_is_an_outcome",
    Confusing: "what_is_said_is_reported",
    Swallowing: "report_that_raises_ends_the_tasks",
    Lingering: "nothing_goes_on_after_closing",
    Halting: "death_of_a_worker_is_an_outcome",
}

FIELDS: dict[str, dict[str, Any]] = {
    "kernel": {"reduced_modulus": 1e4},
    "indenter": {"radius": 1e-3},
    "solver": {"tolerance": 1e-6},
}
MUTANTS = [
    (family, mutant, rule)
    for family, mutants in (
        ("kernel", KERNELS),
        ("indenter", INDENTERS),
        ("solver", SOLVERS),
        ("correction", CORRECTIONS),
        ("output", OUTPUTS),
        ("executor", EXECUTORS),
    )
    for mutant, rule in mutants.items()
]


WITHOUT = {"periodic_run_converges", "free_run_converges"}
"""Whole runs: a kernel that fails in them fails in an operator before, as far as we know."""


def test_each_rule_has_a_mutant(monkeypatch: pytest.MonkeyPatch) -> None:
    """No rule could be dropped, or say yes to everything, without a test that fails."""
    rules: set[str] = set()

    def collect(component: object, family: str, own: Any, *arguments: Any) -> None:
        rules.update(rule.__name__ for rule in own)

    modules = [sys.modules[f"pellicle.testing.{family}s"] for family in FAMILIES]
    for family, module in zip(FAMILIES, modules, strict=True):
        monkeypatch.setattr(module, "check", collect)
        getattr(testing, f"check_{family}")(None)
    rules.update(rule.__name__ for rule in component_rules.RULES)
    rules |= {"is_an_instance", "is_registered", "goes_through_the_registry"}
    broken = {rule for _, _, rule in MUTANTS} | {rule for _, rule in GENERAL.values()}
    assert rules - broken == WITHOUT | {"goes_through_the_registry"}


def test_the_registry_makes_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """A component that is installed, and another when it has been a table, is caught."""
    ours = registry()
    mine = replace(ours.components["indenter"]["paraboloid"], component=TwoFaced, type="two_faced")
    more = {**ours.components["indenter"], "two_faced": mine}
    changed = replace(ours, components={**ours.components, "indenter": more})
    monkeypatch.setattr(component_rules, "registry", lambda: changed)
    said = complaint("indenter", TwoFaced(radius=1e-3))
    assert "breaks the rule goes_through_the_registry\n" in said


def complaint(family: str, component: Any) -> str:
    """Return what the kit says of a component."""
    with pytest.raises(AssertionError) as caught:
        getattr(testing, f"check_{family}")(component)
    return str(caught.value)


@pytest.mark.parametrize(
    ("family", "mutant", "rule"), MUTANTS, ids=[mutant.__name__ for _, mutant, _ in MUTANTS]
)
def test_mutant_is_caught(family: str, mutant: type[Component], rule: str) -> None:
    """The message names the class, the rule, what is asked and what was found."""
    said = complaint(family, mutant(**FIELDS.get(family, {})))
    first, asked, found = said.split("\n")[:3]
    assert first.startswith(f"{mutant.__name__} breaks the rule ")
    assert first.split()[-1] == rule, said
    assert asked.startswith("asked: ")
    assert len(found) > len("found: ")


@pytest.mark.parametrize("name", GENERAL)
def test_general_rule_is_checked(name: str) -> None:
    """What is wrong with a component of any family is caught by the rule that says so."""
    make, rule = GENERAL[name]
    assert f"breaks the rule {rule}\n" in complaint("indenter", make())


@pytest.mark.parametrize(
    ("family", "component"),
    [
        ("kernel", Kernel(reduced_modulus=1e4)),
        ("indenter", Indenter(radius=1e-3)),
        ("solver", Solver(**FIELDS["solver"])),
        ("correction", Correction()),
        ("output", Output()),
        ("executor", Executor()),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_the_mutants_are_made_of_is_whole(family: str, component: Any) -> None:
    """Without its fault each mutant breaks nothing but that no plugin registers it."""
    said = complaint(family, component)
    assert "breaks the rule is_registered\n" in said
    assert f'"{family}.broken" = "' in said
    assert "pip install -e ." in said


def test_a_class_of_no_type_is_named() -> None:
    """A class that cannot be registered is told what it lacks."""
    assert 'NoType needs a field: type: Literal["…"] = "…"' in complaint("correction", NoType())


def test_what_a_component_raises_is_the_cause() -> None:
    """An error of the author's own code comes with its traceback."""
    with pytest.raises(AssertionError, match="ValueError") as caught:
        testing.check_executor(Raising())
    assert isinstance(caught.value.__cause__, ValueError)
