"""Contract rules of kernels: the compliance, its closed form and the operators agree."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import read_only
from pellicle.components import Kernel
from pellicle.components.calls import branches_of, instantaneous
from pellicle.grid import Grid
from pellicle.surface.kernel_calls import HasClosedForm, mean_compliance
from pellicle.surface.operators import displacement

from .component import check
from .rules import require, require_close, require_pure, require_vectorised, rules_of
from .small_runs import solved

_WIDTH = 1e-4
"""Width w of the Gaussian pressure exp(−r²/2w²) [m]."""
_WAVES = read_only(np.geomspace(1.0, 1e9, 24))
"""Wavenumbers q [rad/m]."""
_FORMS = ("greens_function", "radial_primitive")


def check_kernel(kernel: Kernel) -> None:
    """Check that a kernel keeps its contract.

    Besides the rules of all components: ``compliance`` is vectorised, pure, positive and finite for
    10⁻³ to 10¹² rad/m, and does not grow towards ever shorter waves; a closed form, if the kernel
    has one, agrees with it; so do the operators of both boundaries; a small indentation converges
    on both. A kernel with ``branches`` has valid ones, and its ``scaled`` kernels are those of a
    stiffer or softer solid under the same skin; the indentation is then that of ``scaled(1)``.
    """
    check(kernel, "kernel", rules_of(__name__))


def compliance_is_vectorised(kernel: Kernel) -> None:
    """compliance(q) is a float array of the shape of q; each value depends on its own q only."""
    require_vectorised(kernel.compliance, _WAVES, "compliance(q)", relative=1e-12)


def compliance_leaves_its_argument(kernel: Kernel) -> None:
    """A kernel is pure: it does not change q, and a second call returns the same."""
    require_pure(kernel.compliance, _WAVES, "compliance(q)")


def compliance_is_positive_and_finite(kernel: Kernel) -> None:
    """The compliance is positive and finite at every q > 0."""
    q = np.geomspace(1e-3, 1e12, 200)
    values = kernel.compliance(q)
    for bad in np.flatnonzero(~(np.isfinite(values) & (values > 0))):
        raise AssertionError(f"compliance is {values[bad]:g} m/Pa at q = {q[bad]:g} rad/m")


def compliance_does_not_grow_for_short_waves(kernel: Kernel) -> None:
    """The compliance does not grow with q at large q."""
    q = np.geomspace(1e10, 1e12, 9)
    values = kernel.compliance(q)
    for bad in np.flatnonzero(np.diff(values) > 1e-9 * values[:-1]):
        raise AssertionError(
            f"compliance rises from {values[bad]:g} to {values[bad + 1]:g} m/Pa between q = "
            f"{q[bad]:g} and {q[bad + 1]:g} rad/m"
        )


def branches_have_shares_and_times(kernel: Kernel) -> None:
    """branches() returns pairs of a share > 0 and a time > 0, whose shares sum to at most 1."""
    branches_of(kernel)


def scaled_by_one_is_the_kernel(kernel: Kernel) -> None:
    """scaled(1) is elastic, with the compliance and the mean compliance of the kernel."""
    elastic = kernel.scaled(1.0)
    require(not branches_of(elastic), f"scaled(1) has the branches {branches_of(elastic)}")
    require_close(
        elastic.compliance(_WAVES),
        kernel.compliance(_WAVES),
        "the compliance [m/Pa] of scaled(1)",
        relative=1e-12,
    )
    require(
        math.isclose(mean_compliance(elastic), mean_compliance(kernel), rel_tol=1e-12),
        f"mean_compliance() of scaled(1) is {mean_compliance(elastic):g} m/Pa; expected "
        f"{mean_compliance(kernel):g}",
    )


def scaled_stiffens_the_solid_alone(kernel: Kernel) -> None:
    """The stiffness of scaled(share) is 1/G + (share − 1)/G₀, with G₀ of without_skin()."""
    q = _WAVES
    whole, solid = 1 / kernel.compliance(q), 1 / kernel.without_skin().compliance(q)
    for share in (0.01, 0.5, 3.0):
        require_close(
            1 / kernel.scaled(share).compliance(q),
            whole + (share - 1) * solid,
            f"the stiffness [Pa/m] of scaled({share:g})",
            # The two terms cancel for small shares.
            relative=1e-11,
        )


def without_skin_has_no_skin(kernel: Kernel) -> None:
    """The solid without its skin relaxes as the kernel does, and has no skin to take off."""
    solid = kernel.without_skin()
    if branches_of(solid) != branches_of(kernel):
        wrong = "relaxes as another kernel does" if branches_of(solid) else "does not relax"
        raise AssertionError(f"without_skin() {wrong}")
    require_close(
        solid.without_skin().compliance(_WAVES),
        solid.compliance(_WAVES),
        "the compliance [m/Pa] of without_skin().without_skin()",
        relative=1e-12,
    )


def _indent(kernel: Kernel, boundary: str) -> None:
    # A run of a kernel that relaxes would need times.
    kernel = instantaneous(kernel)
    grid = {"points": 24, "size": "1 mm", "boundary": boundary}
    solved(grid=grid, kernel=kernel, loading={"depth": ["5 um", "20 um"]})


def periodic_operator_is_the_compliance(kernel: Kernel) -> None:
    """A wave of pressure on a periodic grid displaces the surface by G(q) times the wave."""
    grid = Grid(points=[32, 18], size=["1 mm", "0.7 mm"], boundary="periodic")
    x, y = grid.coordinates()
    for m, n in ((1, 0), (0, 3), (5, 2), (8, 4)):
        qx, qy = 2 * np.pi * m / grid.size[0], 2 * np.pi * n / grid.size[1]
        wave = np.cos(qx * x + qy * y + 0.3)
        compliance = float(kernel.compliance(np.array([np.hypot(qx, qy)]))[0])
        require_close(
            displacement(wave, kernel=kernel, grid=grid),
            compliance * wave,
            f"the displacement [m] under a wave of 1 Pa, q = ({qx:g}, {qy:g}) rad/m,",
            absolute=1e-11 * compliance,
        )


def periodic_run_converges(kernel: Kernel) -> None:
    """A paraboloid pressed into a periodic surface converges."""
    _indent(kernel, "periodic")


def uniform_pressure_sinks_by_the_mean_compliance(kernel: Kernel) -> None:
    """On a periodic grid uniform pressure p displaces by p mean_compliance(), or 0 if that is ∞."""
    grid = Grid(points=[6, 5], size="1 mm", boundary="periodic")
    mean = mean_compliance(kernel)
    expected = np.full(grid.shape, 3 * mean if np.isfinite(mean) else 0.0)
    values = displacement(np.full(grid.shape, 3.0), kernel=kernel, grid=grid)
    require_close(values, expected, "the displacement [m] under 3 Pa", relative=1e-13)


def closed_form_is_whole(kernel: Kernel) -> None:
    """A kernel has both of greens_function and radial_primitive, or neither."""
    present = [name for name in _FORMS if hasattr(kernel, name)]
    require(len(present) != 1, f"{' '.join(present)} alone is defined")


def closed_form_leaves_its_argument(kernel: Kernel) -> None:
    """greens_function(r) and radial_primitive(r) do not change r."""
    for name in _FORMS:
        if method := getattr(kernel, name, None):
            require_pure(method, np.geomspace(1e-6, 1.0, 9), f"{name}(r)")


def _middle_by_compliance(kernel: Kernel, cell: float = 0.0) -> float:
    """Return u(0) = ∫ G(q) p̂(q) q dq / 2π [m] for the Gaussian, p̂ = 2πw² exp(−q²w²/2).

    A pressure uniform in each cell of side h has p̂ smaller by the factor 1 − q²h²/24. Springs, the
    limit of G at q → ∞, respond to the value at the centre of their cell instead.
    """
    springs = kernel.compliance(np.array([1e12]))

    def integrand(t: Array) -> float:
        q = t / _WIDTH
        compliance = kernel.compliance(q)
        reduction = (compliance - springs) * (q * cell) ** 2 / 24
        return float(((compliance - reduction) * t)[0])

    return _integral(integrand)


def _integral(function: Callable[[Array], float]) -> float:
    """Return ∫ f(t) exp(−t²/2) dt over t > 0."""
    # Imported here because the workers of `check_executor` import this package too.
    from scipy.integrate import quad

    def integrand(t: float) -> float:
        return function(np.array([t])) * float(np.exp(-(t**2) / 2))

    # Without full_output, quad may warn of its accuracy, which pytest may turn into an error.
    return float(quad(integrand, 0, 9, epsabs=0, epsrel=1e-11, limit=200, full_output=1)[0])


def primitive_is_the_integral_of_the_closed_form(kernel: Kernel) -> None:
    """radial_primitive is 0 at r = 0 and grows by ∫ greens_function r dr."""
    if not isinstance(kernel, HasClosedForm):
        return
    radii = np.geomspace(1e-9, 1e2, 45)
    primitive = kernel.radial_primitive(radii.copy())
    nodes, weights = np.polynomial.legendre.leggauss(16)
    middle, half = (radii[1:] + radii[:-1]) / 2, np.diff(radii) / 2
    r = middle[:, None] + half[:, None] * nodes
    integral = half * ((kernel.greens_function(r.copy()) * r) @ weights)
    require_close(
        np.diff(primitive),
        integral,
        "the growth of radial_primitive [m³/N] between radii of 1 nm to 100 m",
        relative=1e-10,
        absolute=1e-13 * float(np.abs(primitive).max()),
    )
    require_close(
        kernel.radial_primitive(np.zeros(1)),
        np.zeros(1),
        "radial_primitive(0) [m³/N]",
        absolute=1e-9 * float(np.abs(primitive[0])),
    )


def closed_form_is_the_transform_of_the_compliance(kernel: Kernel) -> None:
    """At the centre of a Gaussian pressure, greens_function and compliance agree."""
    if not isinstance(kernel, HasClosedForm):
        return
    form = kernel
    middle = _integral(lambda t: float((form.greens_function(t * _WIDTH) * t * _WIDTH)[0]))
    require_close(
        2 * np.pi * _WIDTH * middle,
        _middle_by_compliance(kernel),
        "by greens_function, the central displacement [m] of a Gaussian of 1 Pa, 0.1 mm wide,",
        relative=1e-9,
    )


def free_operator_is_the_transform_of_the_compliance(kernel: Kernel) -> None:
    """On a free grid, a Gaussian pressure displaces its centre by the Hankel integral."""
    grid = Grid(points=255, size=10 * _WIDTH, boundary="free")
    x, y = grid.coordinates()
    pressure = np.exp(-(x**2 + y**2) / (2 * _WIDTH**2))
    require_close(
        displacement(pressure, kernel=kernel, grid=grid)[127, 127],
        _middle_by_compliance(kernel, grid.spacing[0]),
        "on a free grid, the central displacement [m] of a Gaussian of 1 Pa, 0.1 mm wide,",
        # The grid ends at five widths, where the Gaussian is 4e-6.
        relative=1e-5,
    )


def free_run_converges(kernel: Kernel) -> None:
    """A paraboloid pressed into a free surface converges."""
    _indent(kernel, "free")
