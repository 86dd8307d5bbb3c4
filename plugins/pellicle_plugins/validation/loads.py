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
    load = {
        "type": "droplet",
        "radius": _RADIUS,
        "surface_tension": _TENSION,
        "contact_angle": pi / 3,
        "width": _WIDTH,
    }
    exact = discs.droplet(_RADIUS, _TENSION * sin(pi / 3), _WIDTH)
    cell = 4 * _RADIUS / 256
    for name, kernel in _KERNELS.items():
        solid = pl.registry().make(pl.Kernel, kernel).compliance
        run = {"grid": {"points": 256, "size": 4 * _RADIUS}, "kernel": kernel, "load": load}
        # The middle cells lie beside the centre.
        depth = discs.displacement(solid, exact, cell / 2**0.5)
        volume = discs.volume_within(solid, exact, _RADIUS)
        for quantity, unit, expected, tolerance, computed in (
            ("depth of the centre", "m", depth, 1e-3, _centre),
            ("volume within", "m³", volume, 1e-3, _volume),
            ("elastic energy", "J", discs.energy(solid, exact), 2e-3, _energy),
        ):
            row = f"droplet on a {name}: {quantity}"
            yield Case(row, run, computed, expected, unit, tolerance, "Hankel integral")
    yield _line()


def _line() -> Case:
    """Return the height of a straight ridge over the middle between two, a sum over waves."""
    length, width, kernel = 4 * _RADIUS, _WIDTH, _KERNELS["tensed half-space"]
    number = np.arange(1.0, 200_000.0)
    q = 2 * pi / length * number
    waves = pl.registry().make(pl.Kernel, kernel).compliance(q) * np.sinc(number * width / length)
    height = 2 * _TENSION / length * float((waves * (1 - np.cos(pi * number))).sum())
    run = {
        "grid": {"points": [256, 2], "size": length, "boundary": "periodic"},
        "kernel": kernel,
        "load": {"type": "ridge", "line_force": -_TENSION, "width": width},
    }
    row = "straight ridge on a tensed half-space: height"
    return Case(row, run, _height, height, "m", 1e-3, "sum over waves")


def _height(result: Result) -> float:
    return float(np.ptp(result.dataset["displacement"][-1].values))


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
