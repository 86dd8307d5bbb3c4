"""Components that break their contract at work are refused by name, before a result is wrong."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle.plugins import registry
from pellicle.problem import Problem

GRID: dict[str, Any] = {"points": [12, 10], "size": ["0.24 mm", "0.2 mm"]}


def base(family: str, type_: str) -> Any:
    """Return the class of a built-in component."""
    return registry().components[family][type_].component


def run(**parts: Any) -> pl.Result:
    """Solve two depths of a paraboloid on a half-space, with ``parts`` in place of these."""
    configuration: dict[str, Any] = {
        "grid": GRID,
        "kernel": {"type": "half_space", "reduced_modulus": 1e4},
        "indenter": {"type": "paraboloid", "radius": "1 mm"},
        "loading": {"depth": ["2 um", "4 um"]},
    }
    return pl.run(pl.Run(**configuration | parts), progress=False, threads=1)


# ---- kernels ----


class Kernel(base("kernel", "half_space")):  # type: ignore[misc]
    """Half-space that breaks its contract."""

    type: Literal["liar"] = "liar"


class InPlace(Kernel):
    """Works in the array that it is given."""

    def compliance(self, q: Any) -> Any:
        """Return 2/(E* q)."""
        q *= self.reduced_modulus / 2
        return 1 / q


class Complex(Kernel):
    """Returns complex numbers."""

    def compliance(self, q: Any) -> Any:
        """Return the compliance with an imaginary part."""
        return super().compliance(q) * (1 + 0.1j)


class Whole(Kernel):
    """Returns whole numbers."""

    def compliance(self, q: Any) -> Any:
        """Return 1 m/Pa."""
        return np.ones(q.shape, dtype=int)


class Flat(Kernel):
    """Returns all values in a row, and one too few."""

    def compliance(self, q: Any) -> Any:
        """Return a row."""
        return super().compliance(q).ravel()[:-1]


class Scalar(Kernel):
    """Returns one number for all wavenumbers."""

    def compliance(self, q: Any) -> Any:
        """Return a number [m/Pa]."""
        return 1e-8


class Masked(Kernel):
    """Masks what it does not know."""

    def compliance(self, q: Any) -> Any:
        """Return a masked array."""
        return np.ma.masked_array(super().compliance(q), q > np.median(q))


class Nothing(Kernel):
    """Returns nothing."""

    def compliance(self, q: Any) -> Any:
        """Return None."""


class Growing(Kernel):
    """Yields ever more to shorter waves."""

    def compliance(self, q: Any) -> Any:
        """Return a compliance that grows with q."""
        return q * 1e-12


class Exploding(Kernel):
    """Yields ever more to shorter waves until it overflows."""

    def compliance(self, q: Any) -> Any:
        """Return a compliance that grows exponentially with q."""
        return np.exp(q * 1e-5) * 1e-8


class WrongPrimitive(Kernel):
    """Has a primitive 1 % too large."""

    def radial_primitive(self, r: Any) -> Any:
        """Return 1.01 times the integral."""
        return 1.01 * super().radial_primitive(r)


class WrongGreensFunction(Kernel):
    """Has a Green's function of half the value."""

    def greens_function(self, r: Any) -> Any:
        """Return half the displacement."""
        return 0.5 * super().greens_function(r)


class OtherSolid(Kernel):
    """Has the closed form of a solid twice as stiff, consistent in itself."""

    def greens_function(self, r: Any) -> Any:
        """Return half the displacement."""
        return 0.5 * super().greens_function(r)

    def radial_primitive(self, r: Any) -> Any:
        """Return half the integral."""
        return 0.5 * super().radial_primitive(r)


class SkinForgotten(base("kernel", "tensed_membrane")):  # type: ignore[misc]
    """Has the closed form without its skin: right for long waves only."""

    type: Literal["liar"] = "liar"

    def greens_function(self, r: Any) -> Any:
        """Return the displacement of a half-space."""
        return 1 / (np.pi * self.reduced_modulus * r)

    def radial_primitive(self, r: Any) -> Any:
        """Return the integral of a half-space."""
        return r / (np.pi * self.reduced_modulus)


class RadiiInPlace(Kernel):
    """Has a closed form that works in the array that it is given."""

    def greens_function(self, r: Any) -> Any:
        """Return 1/(π E* r)."""
        r *= np.pi * self.reduced_modulus
        return 1 / r


class TextAsMean(Kernel):
    """Says in words how far a uniform pressure sinks it."""

    def mean_compliance(self) -> Any:
        """Return text."""
        return "infinite"


ANY = ("free", "periodic")
KERNELS = {
    InPlace: (ANY, ["changes what it is given", "work on a copy", "test_contracts.py, line"]),
    Complex: (ANY, ["compliance(q) returned an array of complex128", "float64 of shape"]),
    Whole: (ANY, ["compliance(q) returned an array of int64", "float64 of shape"]),
    Flat: (ANY, ["compliance(q) returned an array of float64 of shape"]),
    Scalar: (ANY, ["compliance(q) returned 1e-08"]),
    Masked: (ANY, ["compliance(q) returned a masked array"]),
    Nothing: (ANY, ["compliance(q) returned None"]),
    Growing: (("periodic",), ["compliance(q) grows with q", "has to fall, or to tend to a const"]),
    Exploding: (("periodic",), ["compliance(q) grows with q"]),
    WrongPrimitive: (("free",), ["radial_primitive(r)", "compliance(q)", "have to agree"]),
    WrongGreensFunction: (("free",), ["greens_function(r)", "have to agree"]),
    OtherSolid: (("free",), ["radial_primitive(r)", "compliance(q)", "have to agree"]),
    SkinForgotten: (("free",), ["radial_primitive(r)", "compliance(q)", "have to agree"]),
    RadiiInPlace: (("free",), ["changes what it is given", "work on a copy"]),
    TextAsMean: (("periodic",), ["mean_compliance() returned 'infinite'", "a real number"]),
}


@pytest.mark.parametrize(
    ("lie", "boundary"), [(lie, b) for lie, (boundaries, _) in KERNELS.items() for b in boundaries]
)
def test_a_kernel_that_lies_is_refused(lie: Any, boundary: str) -> None:
    """Whatever is wrong with its values, a run and one application of its operator name it."""
    kernel = lie(reduced_modulus=1e4, **({"tension": 1.0} if lie is SkinForgotten else {}))
    grid = pl.Grid(**GRID, boundary=boundary)
    for use in (
        lambda: run(kernel=kernel, grid=grid),
        lambda: pl.displacement(np.ones(grid.shape), kernel=kernel, grid=grid),
    ):
        with pytest.raises(pl.PluginError) as error:
            use()
        for part in ["kernel 'liar'", *KERNELS[lie][1]]:
            assert part in str(error.value)


@pytest.mark.parametrize("value", [0.0, -1e-8, np.nan, np.inf])
@pytest.mark.parametrize("boundary", ANY)
def test_a_compliance_that_is_not_positive_is_refused(value: float, boundary: str) -> None:
    """One bad value among the grid's wavenumbers is named with its q and the kernel."""

    class Bad(Kernel):
        """Has one bad value."""

        def compliance(self, q: Any) -> Any:
            """Return one bad value between two wavenumbers."""
            return np.where((q > 5e4) & (q < 8e4), value, super().compliance(q))

    grid = pl.Grid(**GRID, boundary=boundary)
    with pytest.raises(pl.ConfigError, match=r"compliance\(q\) of kernel 'liar' is .* m/Pa at q"):
        pl.displacement(np.ones(grid.shape), kernel=Bad(reduced_modulus=1e4), grid=grid)


@pytest.mark.parametrize("thickness", ["1 nm", "1 um", "20 um"])
def test_a_thin_incompressible_layer_may_yield_more_to_shorter_waves(thickness: str) -> None:
    """On cells wider than the layer G(q) grows over all of the grid's waves, and is allowed to."""
    kernel = pl.kernel("bonded_layer", reduced_modulus=1e4, poissons_ratio=0.5, thickness=thickness)
    grid = pl.Grid(points=8, size="4 mm", boundary="periodic")
    values = kernel.compliance(np.linspace(1, 2, 5) * np.pi / 5e-4)
    assert (np.diff(values) > 0).all()
    assert pl.displacement(np.eye(8), kernel=kernel, grid=grid).max() > 0


def test_an_argument_of_a_kernel_is_as_it_was() -> None:
    """A kernel that asks for write access cannot change the wavenumbers of a grid."""
    grid = pl.Grid(**GRID, boundary="periodic")
    before = np.hypot(*grid.wavenumbers())
    with pytest.raises(pl.PluginError):
        pl.displacement(np.ones(grid.shape), kernel=InPlace(reduced_modulus=1e4), grid=grid)
    np.testing.assert_array_equal(np.hypot(*grid.wavenumbers()), before)


# ---- indenters ----


class Indenter(base("indenter", "paraboloid")):  # type: ignore[misc]
    """Paraboloid that breaks its contract."""

    type: Literal["liar"] = "liar"


class MovesPoints(Indenter):
    """Moves the points that it is asked for."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return the profile of moved points."""
        x -= 1e-6
        return super().profile(x, y)


class ComplexHeights(Indenter):
    """Returns complex heights."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return heights with an imaginary part."""
        return super().profile(x, y) + 0j


class WholeHeights(Indenter):
    """Returns heights rounded to metres."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return whole numbers."""
        return np.trunc(super().profile(x, y)).astype(int)


class HeightsInARow(Indenter):
    """Returns heights in a row."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return a row."""
        return super().profile(x, y).ravel()


class Hovering(Indenter):
    """Has its lowest point 10 µm above the surface."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return heights that nowhere come near 0."""
        return super().profile(x, y) - 1e-5


class HoveringPunch(Indenter):
    """Flat punch 1 nm above the surface."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return −1 nm below the punch, nothing elsewhere."""
        return np.where(x**2 + y**2 < 1e-8, -1e-9, -np.inf)


class HoveringRoughness(Indenter):
    """Fills the domain, 10 µm above the surface."""

    footprint: ClassVar[Any] = "domain"

    def profile(self, x: Any, y: Any) -> Any:
        """Return waves that nowhere come near 0."""
        return 1e-6 * (np.cos(3e4 * x) * np.cos(3e4 * y) - 1) - 1e-5


class Capital(Indenter):
    """Misspells where it ends."""

    footprint: ClassVar[Any] = "Domain"


INDENTERS = {
    MovesPoints: ["changes what it is given", "work on a copy"],
    ComplexHeights: ["profile(x, y) returned an array of complex128"],
    WholeHeights: ["profile(x, y) returned an array of int64"],
    HeightsInARow: ["profile(x, y) returned an array of float64 of shape (120,)", "(12, 10)"],
    Hovering: ["highest value of profile(x, y) is -1.01e-05 m", "0 at the lowest point"],
    HoveringPunch: ["highest value of profile(x, y) is -1e-09 m"],
    HoveringRoughness: ["highest value of profile(x, y) is -1.0"],
    Capital: ["footprint is 'Domain'", "'unbounded' or 'domain'"],
}


@pytest.mark.parametrize("lie", INDENTERS)
def test_an_indenter_that_lies_is_refused(lie: Any) -> None:
    """Whatever is wrong with its profile, the message says what it is and what it has to be."""
    with pytest.raises(pl.PluginError) as error:
        run(indenter=lie(radius=1e-3))
    for part in ["indenter 'liar'", *INDENTERS[lie]]:
        assert part in str(error.value)


CONE = {"type": "cone", "half_angle": "20 degree"}


@pytest.mark.parametrize(
    "indenter",
    [
        {"type": "paraboloid", "radius": "0.1 mm"},
        CONE,
        {"type": "shifted", "x": "9 um", "part": CONE},
        {"type": "shifted", "x": "1 mm", "part": {"type": "paraboloid", "radius": "1 mm"}},
        {"type": "sphere", "radius": "0.1 mm"},
        {"type": "flat_punch", "radius": "0.1 mm"},
    ],
    ids=lambda indenter: indenter["type"],
)
@pytest.mark.parametrize("points", [12, 13, 2, 1, [12, 1]], ids=str)
def test_an_apex_between_the_cells_is_no_lie(indenter: dict[str, Any], points: Any) -> None:
    """However coarse the grid, a profile that is 0 between or beyond its cells is taken."""
    # No pressure at all, so that nothing is refused for another reason.
    result = run(
        indenter=indenter, grid={"points": points, "size": "0.24 mm"}, loading={"force": 0}
    )
    assert result.dataset["force"].item() == 0


@pytest.mark.parametrize(
    "indenter",
    [
        {"type": "sphere", "radius": "15 um"},
        {"type": "self_affine", "rms_height": "1 um", "hurst": 0.5, "cutoff_wavelength": "50 um"},
    ],
    ids=lambda indenter: indenter["type"],
)
def test_summits_as_wide_as_a_cell_are_no_lie(indenter: dict[str, Any]) -> None:
    """A body of four cells, or roughness of few cells, may miss 0 by all its height."""
    grid = {"points": 12, "size": "0.24 mm"}
    assert run(indenter=indenter, grid=grid, loading={"force": 0}).dataset["force"].item() == 0


def curve_in_a_row(curve: pl.ForceCurve, depth: Any) -> Any:
    """Return the force alone."""
    return curve.force


def too_short(curve: pl.ForceCurve, depth: Any) -> Any:
    """Return a force too few."""
    return curve._replace(force=curve.force[:-1])


def complex_force(curve: pl.ForceCurve, depth: Any) -> Any:
    """Return a complex force."""
    return curve._replace(force=curve.force + 0j)


def unknown_sensitivity(curve: pl.ForceCurve, depth: Any) -> Any:
    """Return NaN for a sensitivity."""
    return curve._replace(by_length=np.full_like(depth, np.nan))


def moves_depth(curve: pl.ForceCurve, depth: Any) -> Any:
    """Write to the depths."""
    depth += 1e-6
    return curve


FORCE_CURVES = {
    curve_in_a_row: "force_curve(depth, length) returned array(",
    too_short: "force_curve(depth, length).force returned an array of float64 of shape (",
    complex_force: "force_curve(depth, length).force returned an array of complex128",
    unknown_sensitivity: "force_curve(depth, length).by_length has values that are NaN",
    moves_depth: "changes what it is given",
}


@pytest.mark.parametrize("change", FORCE_CURVES)
def test_a_force_curve_that_lies_is_refused(change: Any) -> None:
    """No modulus is fitted by a force that is none."""

    class Bead(base("indenter", "sphere")):  # type: ignore[misc]
        """Sphere with another force curve."""

        type: Literal["liar"] = "liar"

        def force_curve(self, depth: Any, length: float) -> Any:
            """Return the force curve, changed."""
            return change(super().force_curve(depth, length), depth)

    depth = np.linspace(-1e-6, 2e-6, 60)
    force = 1e4 * base("indenter", "sphere")(radius=1e-5).force_curve(depth, 1e-7).force
    with pytest.raises(pl.PluginError, match="indenter 'liar'") as error:
        pl.fit(depth, force, indenter=Bead(radius=1e-5))
    assert FORCE_CURVES[change] in str(error.value)


# ---- solvers ----


class Solver(base("solver", "conjugate_gradient")):  # type: ignore[misc]
    """Conjugate gradients that break their contract."""

    type: Literal["liar"] = "liar"

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        """Return the solution, changed."""
        return self.change(super().solve(problem, start, monitor), problem, start)

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Return something else."""
        return solution


class NoSolution(Solver):
    """Forgets to return."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Return None."""


class BarePressure(Solver):
    """Returns the pressure alone."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Return an array."""
        return solution.pressure


class Transposed(Solver):
    """Returns a pressure of the wrong shape."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Return the transpose."""
        return replace(solution, state=solution.pressure.T)


class ComplexPressure(Solver):
    """Returns a complex pressure."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Return an imaginary part."""
        return replace(solution, state=solution.pressure + 1j)


class PressureAsText(Solver):
    """Returns text as its pressure."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Return text."""
        return replace(solution, state="10 Pa")


class NoStop(Solver):
    """Does not say why it stopped."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Return a solution without a reason."""
        return replace(solution, stop=None)


class OtherOperator(Solver):
    """Puts another operator into its problem."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Set the operator behind the back of the dataclass."""
        object.__setattr__(problem, "operator", None)
        return solution


class AssignsOperator(Solver):
    """Assigns another operator to its problem."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Set the operator."""
        problem.operator = None
        return solution


class SofterOperator(Solver):
    """Makes the operator twice as soft in place, and solves that."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Scale the symbol."""
        problem.operator._symbol["D"][...] *= 2
        return solution


class OtherSymbol(Solver):
    """Gives the operator another symbol."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Replace the symbol."""
        problem.operator._symbol.double = 2 * problem.operator._symbol["D"]
        return solution


class OtherKernel(Solver):
    """Gives the operator another kernel."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Replace the kernel."""
        problem.operator.kernel = None
        return solution


class LowersProfile(Solver):
    """Lowers the indenter."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Write to the profile."""
        problem.profile[...] -= 1e-6
        return solution


class WorksInStart(Solver):
    """Returns the array that it is given to start from, with new values."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Write to the start."""
        if start is not None:
            start.pressure[...] = solution.pressure
            return replace(solution, state=start)
        return solution


class StartAsArray(Solver):
    """Takes the state that it starts from for an array, which it was in earlier versions."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        """Scale the start."""
        return super().solve(problem, None if start is None else 0.5 * start, monitor)


class CopiesStart(Solver):
    """Copies the state that it starts from as if it were an array."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        """Copy the start."""
        return super().solve(problem, None if start is None else start.copy(), monitor)


class ClipsStart(Solver):
    """Clips the state that it starts from as if it were an array."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        """Clip the start."""
        return super().solve(problem, None if start is None else np.maximum(start, 0), monitor)


class NamesPressure(Solver):
    """Names the argument of a solution that is a state by now."""

    def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
        """Make a solution by keyword."""
        made: Any = pl.Solution
        return made(pressure=solution.pressure, iterations=1)


OUTDATED = ["not an array: its pressure is start.pressure", "pellicle.Solution(pressure or state"]
SOLVERS = {
    StartAsArray: OUTDATED,
    CopiesStart: OUTDATED,
    ClipsStart: OUTDATED,
    NamesPressure: OUTDATED,
    NoSolution: ["solve() returned None", "pellicle.Solution"],
    BarePressure: ["solve() returned array(", "pellicle.Solution"],
    Transposed: ["solve().pressure returned an array of float64 of shape (10, 12)", "(12, 10)"],
    ComplexPressure: ["solve().pressure returned an array of complex128"],
    PressureAsText: ["solve().pressure returned '10 Pa'"],
    NoStop: ["stop None", "pellicle.Stop"],
    OtherOperator: ["solve() changes problem.operator", "leave its problem as it is"],
    AssignsOperator: ["changes what it is given", "operator"],
    SofterOperator: ["changes what it is given", "read-only"],
    OtherSymbol: ["solve() changes problem.operator.symbol"],
    OtherKernel: ["solve() changes problem.operator.kernel"],
    LowersProfile: ["changes what it is given", "read-only"],
    WorksInStart: ["changes what it is given", "read-only"],
}


@pytest.mark.parametrize("loading", [{"depth": ["2 um", "4 um"]}, {"contact_radius": "60 um"}])
@pytest.mark.parametrize("lie", SOLVERS)
def test_a_solver_that_lies_is_refused(lie: Any, loading: dict[str, Any]) -> None:
    """No number of a result comes from a problem that the solver changed, or from no pressure."""
    with pytest.raises(pl.PluginError) as error:
        run(solver=lie(tolerance=1e-6), loading=loading)
    for part in ["solver 'liar'", *SOLVERS[lie]]:
        assert part in str(error.value)


def test_applications_cannot_be_set() -> None:
    """The count of operator applications in a result is the operator's own."""

    class Modest(Solver):
        """Sets the count back."""

        def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
            """Set the count."""
            problem.operator.applications = 0

    with pytest.raises(AttributeError, match="applications") as error:
        run(solver=Modest(tolerance=1e-6))
    assert error.value.__notes__[0].startswith("solver 'liar' failed")


def test_a_solver_that_uses_its_memory_again_changes_no_earlier_step() -> None:
    """Each step keeps its own pressure, though the solver returns one array for all."""
    memory = np.zeros((12, 10))

    class Thrifty(Solver):
        """Returns the same array each time."""

        def change(self, solution: pl.Solution, problem: Any, start: Any) -> Any:
            """Write into one array."""
            memory[...] = solution.pressure
            return replace(solution, state=memory)

    thrifty = run(solver=Thrifty(tolerance=1e-6)).dataset
    plain = run(solver=Solver(tolerance=1e-6)).dataset
    np.testing.assert_array_equal(thrifty["pressure"], plain["pressure"])


class WideResponse(Solver):
    """Presses off the contact."""

    def response(self, problem: Problem, state: Any, monitor: Any) -> Any:
        """Return a pressure everywhere."""
        return super().response(problem, state, monitor) + 1.0


class NoResponse(Solver):
    """Has no pressure under a punch."""

    def response(self, problem: Problem, state: Any, monitor: Any) -> Any:
        """Return None."""


class FillsContact(Solver):
    """Makes the footprint larger."""

    def response(self, problem: Problem, state: Any, monitor: Any) -> Any:
        """Write to the contact."""
        state.pressure[...] = 1.0
        return super().response(problem, state, monitor)


RESPONSES = {
    WideResponse: "response() returned a pressure off the contact",
    NoResponse: "response() returned None",
    FillsContact: "changes what it is given",
}


@pytest.mark.parametrize("lie", RESPONSES)
def test_a_response_that_lies_is_refused(lie: Any) -> None:
    """The contact stiffness of a result is not made of a pressure that is none."""
    with pytest.raises(pl.PluginError, match="solver 'liar'") as error:
        run(solver=lie(tolerance=1e-6), loading={"depth": "4 um", "stiffness": True})
    assert RESPONSES[lie] in str(error.value)


# ---- corrections ----


def correction_that_returns(returned: object) -> pl.AreaCorrection:
    """Return a correction whose area is ``returned``."""

    class Correction(pl.AreaCorrection):
        """Area that breaks its contract."""

        type: Literal["liar"] = "liar"

        def area(self, contact: Any, spacing: Any) -> Any:
            """Return the same for any contact."""
            return returned

    return Correction()


@pytest.mark.parametrize("boundary", ANY)
@pytest.mark.parametrize(
    ("returned", "message"),
    [
        (-1.0, "returned -1 m²; it has to be between 0 and 4.8e-08 m²"),
        (1.0, "returned 1 m²; it has to be between 0 and 4.8e-08 m²"),
        (np.inf, "returned inf m²"),
        (np.nan, "returned nan; it has to return a real number"),
        ("1 mm^2", "returned '1 mm^2'; it has to return a real number"),
        (None, "returned None"),
        (True, "returned True"),
        (1e-9 + 0j, "returned (1e-09+0j)"),
        (np.ones(3), "returned an array of float64 of shape (3,)"),
    ],
)
def test_a_correction_that_lies_is_refused(returned: object, message: str, boundary: str) -> None:
    """An area is a number between 0 and the domain's, and the message says which it has to be."""
    with pytest.raises(pl.PluginError, match="correction 'liar'") as error:
        run(
            corrections=[correction_that_returns(returned)],
            grid=GRID | {"boundary": boundary},
            loading={"force": "10 nN"},
        )
    assert message in str(error.value)


def test_a_correction_without_contact_is_nothing() -> None:
    """Where nothing touches, no correction makes an area."""
    with pytest.raises(pl.PluginError, match="between 0 and 0 m², without contact"):
        run(corrections=[correction_that_returns(1e-9)], loading={"depth": 0.0})


def test_a_correction_cannot_change_the_contact() -> None:
    """The contact that a correction is given is read-only."""

    class Filling(pl.AreaCorrection):
        """Fills the contact."""

        type: Literal["liar"] = "liar"

        def area(self, contact: Any, spacing: Any) -> float:
            """Write to the contact."""
            contact[...] = True
            return 1e-9

    with pytest.raises(pl.PluginError, match="correction 'liar' changes what it is given"):
        run(corrections=[Filling()])


# ---- outputs ----


class Output(pl.Output):
    """Output that breaks its contract."""

    type: Literal["liar"] = "liar"


def writes_pressure(data: Any) -> None:
    """Write to the pressure."""
    data["pressure"].values[...] = 0


def writes_status(data: Any) -> None:
    """Write to the text of the status."""
    data["status"].values[...] = "perfect"


def writes_coordinates(data: Any) -> None:
    """Write to the coordinates of the cells."""
    data["x"].values[...] = 0


def replaces_force(data: Any) -> None:
    """Replace a variable."""
    data["force"] = data["force"] * 2


def replaces_attributes(data: Any) -> None:
    """Replace the attributes, of the whole and of a variable."""
    data.attrs["configuration"] = "{}"
    data["force"].attrs["units"] = "kN"


CHANGES = [
    writes_pressure,
    writes_status,
    writes_coordinates,
    replaces_force,
    replaces_attributes,
]


@pytest.mark.parametrize("method", ["step", "close"])
@pytest.mark.parametrize("change", CHANGES)
def test_an_output_cannot_change_the_result(change: Any, method: str, tmp_path: Path) -> None:
    """What an output writes into its data reaches neither the result nor the outputs after it."""

    class Changing(Output):
        """Changes what it is given."""

        def step(self, place: Any, step: Any) -> None:
            """Change a step."""
            if method == "step":
                change(step)

        def close(self, place: Any, result: Any) -> Any:
            """Change the result."""
            if method == "close":
                change(result.dataset)
            return ()

    untouched = run().dataset
    configuration = pl.Run.from_json(untouched.attrs["configuration"])
    outputs = (Changing(), registry().make(pl.Output, {"type": "hdf5"}))
    changed = configuration.model_copy(update={"outputs": outputs})
    refused = pytest.raises(pl.PluginError, match="output 'liar' changes what it is given")
    # Whether coordinates can be written to, and are copies then, depends on the version of pandas.
    with refused if change is writes_pressure else suppress(pl.PluginError):
        pl.run(changed, directory=tmp_path, progress=False, threads=1)
    (file,) = tmp_path.glob("*.h5")
    kept = pl.load(file).dataset
    for name in ("pressure", "status", "force"):
        np.testing.assert_array_equal(kept[name], untouched[name][: kept.sizes["step"]])
    np.testing.assert_array_equal(kept["x"], untouched["x"])
    assert kept["force"].attrs["units"] == "N"
    assert "half_space" in kept.attrs["configuration"]


def test_the_result_may_be_changed_by_its_owner() -> None:
    """Only outputs are given read-only arrays: a user may write into a result."""
    dataset = run(outputs=[Output()]).dataset
    dataset["pressure"].values[...] = 1
    assert (dataset["pressure"] == 1).all()


@pytest.mark.parametrize("returned", [None, "file.txt", ("file.txt",), 3, [None]])
def test_files_that_are_none_are_refused(returned: Any) -> None:
    """What close() returns are paths."""

    class Untrue(Output):
        """Names no files."""

        def close(self, place: Any, result: Any) -> Any:
            """Return anything but files."""
            return returned

    with pytest.raises(pl.PluginError, match=r"output 'liar': close\(\) returned .* pathlib.Path"):
        run(outputs=[Untrue()])


@pytest.mark.parametrize("returned", [".txt", None, (1,)])
def test_endings_that_are_none_are_refused(returned: Any) -> None:
    """One text is not a tuple of texts: two outputs could replace each other's files unnoticed."""

    class Untrue(Output):
        """Forgets a comma."""

        def endings(self) -> Any:
            """Return anything but a tuple of text."""
            return returned

    with pytest.raises(pl.PluginError, match=r"output 'liar': endings\(\) returned"):
        run(outputs=[Untrue(), {"type": "hdf5"}])


@pytest.mark.parametrize("change", CHANGES[:1])
def test_an_output_cannot_change_the_table_of_a_study(change: Any, tmp_path: Path) -> None:
    """The table that run_study returns is that of the runs, whatever an output does to its own."""

    class Changing(Output):
        """Changes the table."""

        def study(self, place: Any, table: Any) -> Any:
            """Write to the forces."""
            table["force"].values[...] = 0
            return ()

    with pytest.raises(pl.PluginError, match="output 'liar' changes what it is given"):
        pl.run_study(study(outputs=[Changing()]), tmp_path, progress=False, threads=1)


def test_each_output_gets_data_of_its_own(tmp_path: Path) -> None:
    """What one output leaves out or replaces in its dataset, the next one still has."""

    class Dropping(Output):
        """Drops the pressure and renames the run."""

        def close(self, place: Any, result: Any) -> Any:
            """Change the dataset itself, not its arrays."""
            del result.dataset["pressure"]
            result.dataset.attrs["title"] = "another"
            return ()

    class Looking(Output):
        """Looks at what it is given."""

        type: Literal["looking"] = "looking"
        seen: ClassVar[list[Any]] = []

        def close(self, place: Any, result: Any) -> Any:
            """Keep what is there."""
            self.seen.append(("pressure" in result.dataset, result.dataset.attrs["title"]))
            return ()

    run(title="ours", outputs=[Dropping(), Looking()])
    assert Looking.seen == [(True, "ours")]


@pytest.mark.parametrize("code", [0, 3])
def test_a_component_cannot_end_the_process(code: int) -> None:
    """A component that calls sys.exit() is named; the run does not end as if all were well."""

    class Leaving(Kernel):
        """Ends the process."""

        def compliance(self, q: Any) -> Any:
            """Leave."""
            raise SystemExit(code)

    class LeavingAtTheEnd(Output):
        """Ends the process when the run is done."""

        def close(self, place: Any, result: Any) -> Any:
            """Leave."""
            raise SystemExit(code)

    with pytest.raises(pl.PluginError, match=rf"kernel 'liar' calls sys.exit\({code}\)"):
        run(kernel=Leaving(reduced_modulus=1e4))
    with pytest.raises(pl.PluginError, match=rf"output 'liar' calls sys.exit\({code}\)"):
        run(outputs=[LeavingAtTheEnd()])


def test_a_file_system_that_is_read_only_is_no_lie() -> None:
    """What an output raises because it cannot write is not taken for a change of its data."""

    class Unlucky(Output):
        """Cannot write."""

        def close(self, place: Any, result: Any) -> Any:
            """Raise what the system raises."""
            raise OSError("the volume is read-only")

    with pytest.raises(OSError, match="the volume is read-only") as error:
        run(outputs=[Unlucky()])
    assert error.value.__notes__[0].startswith("output 'liar' failed")


@pytest.mark.parametrize("returned", ["nothing", 3, {"step": 1}])
def test_steps_that_are_none_are_refused(returned: Any) -> None:
    """What resume() returns is a dataset of steps, or None."""

    class Resuming(Output):
        """Has no steps."""

        def resume(self, place: Any) -> Any:
            """Return anything but steps."""
            return returned

    with pytest.raises(pl.PluginError, match=r"output 'liar': resume\(\) returned"):
        run(outputs=[Resuming()])


# ---- executors ----


class Executor(pl.Executor):
    """One task after the other, and no contract kept."""

    type: Literal["liar"] = "liar"

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        """Yield each task with its outcome, changed."""
        for task in tasks:
            yield from self.change(task, work(task, lambda said: None))

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield something else."""
        yield task, outcome


class Twice(Executor):
    """Yields each task twice."""

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield twice."""
        yield from [(task, outcome)] * 2


class Never(Executor):
    """Yields no task."""

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield nothing."""
        return ()


class Copies(Executor):
    """Yields copies of tasks."""

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield a copy."""
        yield replace(task), outcome


class OutcomeOnly(Executor):
    """Yields outcomes without their tasks."""

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield the outcome."""
        yield outcome


class NoOutcome(Executor):
    """Loses the outcomes."""

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield None for the outcome."""
        yield task, None


class Returning(Executor):
    """Returns a list."""

    def map(self, work: Any, tasks: Any, report: Any) -> Any:
        """Return all at once."""
        return [(task, work(task, lambda said: None)) for task in tasks]


EXECUTORS = {
    Twice: "yields kernel.reduced_modulus = 10000 twice; it has to yield each task once",
    Never: "map() ended without 2 of 2 tasks, such as kernel.reduced_modulus = 10000",
    Copies: "it has to yield each of the tasks that it was given, the object itself",
    OutcomeOnly: "it has to yield each of the tasks that it was given, the object itself",
    NoOutcome: "with None; it has to yield it with what its work returned or raised",
    Returning: "map() returned [(RunTask(",
}


def study(executor: Any = None, **parts: Any) -> pl.Study:
    """Return two runs."""
    return pl.Study(
        run={
            "grid": {"points": 16, "size": "0.3 mm"},
            "kernel": {"type": "half_space"},
            "indenter": {"type": "paraboloid", "radius": "1 mm"},
            "loading": {"depth": "5 um"},
            "outputs": [],
            **parts,
        },
        vary={"kernel.reduced_modulus": [1e4, 2e4]},
        executor=executor or {"type": "serial"},
    )


@pytest.mark.parametrize("lie", EXECUTORS)
def test_an_executor_that_lies_is_refused(lie: Any, tmp_path: Path) -> None:
    """Runs are not mixed up or left out unnoticed, and those that were done are kept."""
    with pytest.raises(pl.PluginError, match="executor 'liar'") as error:
        pl.run_study(study(lie()), tmp_path, progress=False, threads=1)
    assert EXECUTORS[lie] in str(error.value)
    assert (tmp_path / "study.h5").exists()
    table = pl.run_study(study(), tmp_path, progress=False, threads=1)
    assert (table["status"] == "converged").all()


# ---- threads ----

NO_THREADS = [0, -1, 1.5, 2.0, "2", True, np.float64(2), [2], np.array([1, 2])]


@pytest.mark.parametrize("threads", NO_THREADS, ids=repr)
def test_threads_are_a_whole_number(threads: Any, tmp_path: Path) -> None:
    """Anything but None or a whole number ≥ 1 is refused in words, and nothing is computed."""
    configuration = pl.Run(
        grid=GRID,
        kernel={"type": "half_space", "reduced_modulus": 1e4},
        indenter={"type": "paraboloid", "radius": "1 mm"},
        loading={"depth": "2 um"},
    )
    for use in (
        lambda: pl.run(configuration, directory=tmp_path, progress=False, threads=threads),
        lambda: pl.run_study(study(), tmp_path, progress=False, threads=threads),
    ):
        with pytest.raises(pl.ConfigError, match=r"threads: .* whole number of threads ≥ 1"):
            use()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("type_", ["serial", "processes", "dask"])
@pytest.mark.parametrize("threads", [0, -1, 1.5, "2", True], ids=repr)
def test_threads_of_an_executor_are_a_whole_number(type_: str, threads: Any) -> None:
    """The field says the same as the argument, in a file too."""
    address = {"address": "tcp://127.0.0.1:8786"} if type_ == "dask" else {}
    with pytest.raises(pl.ConfigError, match=r"threads: .* whole number of threads ≥ 1"):
        registry().make(pl.Executor, {"type": type_, "threads": threads, **address})


def test_threads_of_numpy_are_taken() -> None:
    """A whole number of numpy is as good as one of Python."""
    result = pl.run(
        pl.Run(
            grid=GRID,
            kernel={"type": "half_space", "reduced_modulus": 1e4},
            indenter={"type": "paraboloid", "radius": "1 mm"},
            loading={"depth": "2 um"},
        ),
        progress=False,
        threads=np.int64(1),  # type: ignore[arg-type]
    )
    assert result.converged
    executor = registry().make(pl.Executor, {"type": "serial", "threads": np.int64(2)})
    assert executor.threads == 2
