"""Sinusoidal surfaces in partial and in full contact."""

import numpy as np
import pytest

from pellicle_plugins.closed_forms.westergaard import pressure_amplitude, wavy

AMPLITUDE, WAVELENGTH, E = 2e-6, 1e-3, 1e5


@pytest.mark.parametrize("share", [0.01, 0.5, 0.99])
def test_pressure_has_the_stated_mean(share: float) -> None:
    """The pressure averages to p̄ over a period."""
    full = pressure_amplitude(AMPLITUDE, WAVELENGTH, E)
    contact = wavy(AMPLITUDE, WAVELENGTH, E, mean_pressure=share * full)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    theta = np.pi / 2 * nodes
    x = contact.half_width * np.sin(theta)
    mean = weights @ (contact.pressure(x) * np.cos(theta)) * np.pi / 2
    assert mean * contact.half_width / WAVELENGTH == pytest.approx(share * full, rel=1e-6)


def test_surface_follows_the_sine() -> None:
    """The Hilbert transform of the pressure gives the slope of the sine in contact."""
    contact = wavy(AMPLITUDE, WAVELENGTH, E, half_width=0.3 * WAVELENGTH)
    n = 2**14
    x = (np.arange(n) + 0.5) / n * WAVELENGTH - WAVELENGTH / 2
    q = 2 * np.pi * np.fft.rfftfreq(n, WAVELENGTH / n)
    spectrum = np.fft.rfft(contact.pressure(x))
    slope = np.fft.irfft(np.sign(q) * 2j / E * spectrum, n)
    expected = -AMPLITUDE * 2 * np.pi / WAVELENGTH * np.sin(2 * np.pi * x / WAVELENGTH)
    inner = np.abs(x) < 0.25 * WAVELENGTH
    assert slope[inner] == pytest.approx(expected[inner], abs=2e-4 * np.abs(expected).max())


def test_light_contact_is_that_of_a_cylinder() -> None:
    """At low pressure a² = 4 F R / πE*, the line contact of the crest."""
    contact = wavy(AMPLITUDE, WAVELENGTH, E, mean_pressure=1e-6)
    radius = (WAVELENGTH / (2 * np.pi)) ** 2 / AMPLITUDE
    expected = np.sqrt(4 * 1e-6 * WAVELENGTH * radius / (np.pi * E))
    assert contact.half_width == pytest.approx(expected, rel=1e-5)


def test_pressure_is_continuous_at_full_contact() -> None:
    """Partial contact just short of full has the pressure of full contact."""
    full = pressure_amplitude(AMPLITUDE, WAVELENGTH, E)
    x = np.linspace(-0.4, 0.4, 9) * WAVELENGTH
    short = wavy(AMPLITUDE, WAVELENGTH, E, mean_pressure=full * (1 - 1e-9))
    over = wavy(AMPLITUDE, WAVELENGTH, E, mean_pressure=full)
    assert short.pressure(x) == pytest.approx(over.pressure(x), rel=1e-6)
    assert over.half_width == pytest.approx(WAVELENGTH / 2)


def test_tension_adds_the_laplace_pressure() -> None:
    """Tension adds τ₀ times the curvature of the crest."""
    tensed = pressure_amplitude(AMPLITUDE, WAVELENGTH, E, 0.05)
    curvature = AMPLITUDE * (2 * np.pi / WAVELENGTH) ** 2
    plain = pressure_amplitude(AMPLITUDE, WAVELENGTH, E)
    assert tensed - plain == pytest.approx(0.05 * curvature)
