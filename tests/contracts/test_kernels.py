"""What every kernel keeps: its compliance, its closed form and the operators agree."""

import numpy as np
import pytest
from scipy.integrate import quad

from pellicle import Grid, Kernel, displacement
from pellicle.operators import HasClosedForm, mean_compliance

WIDTH = 1e-4
"""Of the Gaussian pressure exp(−r²/2w²) [m]."""


def closed_form(kernel: Kernel) -> HasClosedForm:
    """Return the kernel, if it has a closed form."""
    if not isinstance(kernel, HasClosedForm):
        pytest.skip("gives its compliance only")
    return kernel


def centre_by_hankel(kernel: Kernel) -> float:
    """Return u(0) = ∫ G(q) p̂(q) q dq / 2π [m] for the Gaussian, p̂ = 2πw² exp(−q²w²/2)."""

    def integrand(t: float) -> float:
        return float(kernel.compliance(np.array([t / WIDTH]))[0]) * t * np.exp(-(t**2) / 2)

    return quad(integrand, 0, 9, epsabs=0, epsrel=1e-11)[0]


@pytest.mark.parametrize("shape", [(24,), (4, 6), (2, 3, 4)])
def test_compliance_is_vectorised(kernel: Kernel, shape: tuple[int, ...]) -> None:
    """The result has the shape of q, and each value depends on its own q only."""
    q = np.geomspace(1.0, 1e9, 24)
    one_by_one = np.array([kernel.compliance(q[i : i + 1])[0] for i in range(q.size)])
    result = kernel.compliance(q.reshape(shape))
    assert result.shape == shape
    np.testing.assert_allclose(result, one_by_one.reshape(shape), rtol=1e-14)


def test_compliance_leaves_its_argument(kernel: Kernel) -> None:
    """A kernel is pure: wavenumbers that cannot be written to are enough."""
    q = np.geomspace(1.0, 1e9, 24)
    q.setflags(write=False)
    np.testing.assert_array_equal(kernel.compliance(q), kernel.compliance(q))


def test_compliance_is_positive_and_no_greater_for_shorter_waves(kernel: Kernel) -> None:
    """Pressure pushes the surface inwards, and fine waves of it no more than coarse ones."""
    assert (kernel.compliance(np.geomspace(1e-3, 1e12, 200)) > 0).all()
    assert (np.diff(kernel.compliance(np.geomspace(1e5, 1e12, 200))) <= 0).all()


def test_primitive_is_the_integral_of_the_closed_form(kernel: Kernel) -> None:
    """The primitive starts at 0 and grows by ∫ G r dr from each radius to the next."""
    form = closed_form(kernel)
    radii = np.geomspace(1e-9, 1e2, 45)
    primitive = form.radial_primitive(radii)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    middle, half = (radii[1:] + radii[:-1]) / 2, np.diff(radii) / 2
    r = middle[:, None] + half[:, None] * nodes
    integral = half * ((form.greens_function(r) * r) @ weights)
    np.testing.assert_allclose(np.diff(primitive), integral, rtol=1e-12)
    assert form.radial_primitive(np.zeros(1))[0] == pytest.approx(0, abs=primitive[0] * 1e-9)


def test_closed_form_is_the_transform_of_the_compliance(kernel: Kernel) -> None:
    """The middle of a Gaussian pressure sinks equally in real and in Fourier space."""
    form = closed_form(kernel)

    def integrand(t: float) -> float:
        r = np.array([t * WIDTH])
        return float((form.greens_function(r) * r)[0]) * np.exp(-(t**2) / 2)

    middle = 2 * np.pi * WIDTH * quad(integrand, 0, 9, epsabs=0, epsrel=1e-11)[0]
    assert middle == pytest.approx(centre_by_hankel(kernel), rel=1e-10)


def test_free_operator_is_the_transform_of_the_compliance(kernel: Kernel) -> None:
    """On a free grid the middle of a Gaussian pressure sinks as the Hankel integral says."""
    closed_form(kernel)
    grid = Grid(points=255, size=10 * WIDTH, boundary="free")
    x, y = grid.coordinates()
    pressure = np.exp(-(x**2 + y**2) / (2 * WIDTH**2))
    middle = displacement(pressure, kernel=kernel, grid=grid)[127, 127]
    # Cells of uniform pressure cost h²/24w² = 6e-5 of it.
    assert middle == pytest.approx(centre_by_hankel(kernel), rel=1e-4)


@pytest.mark.parametrize(("m", "n"), [(1, 0), (0, 3), (5, 2), (8, 4)])
def test_periodic_operator_is_the_compliance(kernel: Kernel, m: int, n: int) -> None:
    """A wave of pressure on a rectangular periodic grid is answered by G(q) times the wave."""
    grid = Grid(points=[32, 18], size=["1 mm", "0.7 mm"], boundary="periodic")
    x, y = grid.coordinates()
    qx, qy = 2 * np.pi * m / grid.size[0], 2 * np.pi * n / grid.size[1]
    wave = np.cos(qx * x + qy * y + 0.3)
    expected = kernel.compliance(np.array([np.hypot(qx, qy)]))[0] * wave
    found = displacement(wave, kernel=kernel, grid=grid)
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


def test_mean_compliance_is_what_a_uniform_pressure_does(kernel: Kernel) -> None:
    """On a periodic grid a uniform pressure has that displacement, and none if it is infinite."""
    grid = Grid(points=[6, 5], size="1 mm", boundary="periodic")
    mean = mean_compliance(kernel)
    expected = np.full(grid.shape, 3 * mean if np.isfinite(mean) else 0.0)
    found = displacement(np.full(grid.shape, 3.0), kernel=kernel, grid=grid)
    np.testing.assert_allclose(found, expected, rtol=1e-14, atol=0)
