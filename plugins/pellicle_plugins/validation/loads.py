"""Validation cases of known loads: a drop and a ring, on skins, half-spaces and layers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import pi, sin
from typing import Any

import numpy as np

import pellicle as pl
from pellicle import hookimpl
from pellicle.components import Case, Suite
from pellicle.results import Result
from pellicle_plugins.loads.shares import within_circle

from . import discs

_RADIUS, _WIDTH = 0.25e-3, 0.0625e-3
_TENSION = 0.03
_SOURCE = "Hankel integral"
_LAYER = {
    "type": "bonded_layer",
    "youngs_modulus": 3e3,
    "poissons_ratio": 0.45,
    "thickness": 2e-4,
}
_KERNELS: dict[str, dict[str, Any]] = {
    "half-space": {"type": "half_space", "reduced_modulus": 1e4},
    "tensed half-space": {"type": "tensed_membrane", "reduced_modulus": 1e4, "tension": 0.1},
    "tensed layer": {"type": "coated", "tension": 0.1, "substrate": _LAYER},
}


def known_loads() -> Iterator[Case]:
    """Yield the cases, those that share a run after each other."""
    for name, kernel in _KERNELS.items():
        yield from _droplet(name, kernel)
    yield _line()


def _droplet(name: str, kernel: dict[str, Any]) -> Iterator[Case]:
    load = {
        "type": "droplet",
        "radius": _RADIUS,
        "surface_tension": _TENSION,
        "contact_angle": pi / 3,
        "width": _WIDTH,
    }
    configuration = {"grid": {"points": 256, "size": 4 * _RADIUS}, "kernel": kernel, "load": load}
    table = {key: value for key, value in kernel.items() if key != "type"}
    compliance = pl.kernel(kernel["type"], **table).compliance
    exact = discs.droplet(_RADIUS, _TENSION * sin(pi / 3), _WIDTH)
    centre = 0.5 * 2**0.5 * 4 * _RADIUS / 256
    rows: tuple[tuple[str, str, float, float, Callable[[Result], float]], ...] = (
        ("depth of the centre", "m", discs.displacement(compliance, exact, centre), 1e-3, _centre),
        ("volume within", "m³", discs.volume_within(compliance, exact, _RADIUS), 1e-3, _volume),
        ("elastic energy", "J", discs.energy(compliance, exact), 2e-3, _energy),
    )
    for quantity, unit, expected, tolerance, computed in rows:
        row = f"droplet on a {name}: {quantity}"
        yield Case(row, configuration, computed, expected, unit, tolerance, _SOURCE)


def _line() -> Case:
    """Return the height of a straight ridge over the middle between two, a sum over waves."""
    length, points, width = 1e-3, 256, 1e-3 / 16
    q = 2 * pi / length * np.arange(1.0, 200_000.0)
    compliance = pl.kernel("tensed_membrane", reduced_modulus=1e4, tension=0.1).compliance(q)
    spread = np.sinc(0.5 * q * width / pi)
    height = (
        2 * _TENSION / length * float((compliance * spread * (1 - np.cos(pi * q / q[0]))).sum())
    )
    configuration = {
        "grid": {"points": [points, 2], "size": [length, length], "boundary": "periodic"},
        "kernel": _KERNELS["tensed half-space"],
        "load": {"type": "ridge", "line_force": -_TENSION, "width": width},
    }
    return Case(
        name="straight ridge on a tensed half-space: height",
        configuration=configuration,
        computed=lambda result: float(np.ptp(result.dataset["displacement"][-1].values)),
        expected=height,
        unit="m",
        tolerance=1e-3,
        source="sum over waves",
    )


def _centre(result: Result) -> float:
    displacement = result.dataset["displacement"][-1].values
    return float(displacement[tuple(n // 2 for n in displacement.shape)])


def _volume(result: Result) -> float:
    share = within_circle(*result.grid.coordinates(), _RADIUS)
    displacement = result.dataset["displacement"][-1].values
    return float((share * displacement).sum()) * result.grid.cell_area


def _energy(result: Result) -> float:
    return float(result.dataset["elastic_energy"][-1])


@hookimpl
def register_validations(register: Callable[[Suite], None]) -> None:
    """Register the suite."""
    register(known_loads)
