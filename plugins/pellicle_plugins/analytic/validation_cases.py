"""Validation cases with known results: closed forms and the axisymmetric integral equation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import pi, radians
from typing import Any

import numpy as np

from pellicle import hookimpl
from pellicle.components import Case, Suite
from pellicle.results.result import Result
from pellicle_plugins.indenters.paraboloid import Paraboloid

from . import hertz
from .adhesion import Adhesion
from .adhesive_path import curve_of
from .axisymmetric import indent
from .cone import cone
from .flat_punch import flat_punch
from .full_contact import pressure_amplitude

_MODULUS = 10e3
_RADIUS = 1e-3
_DEPTH = 50e-6
_TENSION = 1.0
_WORK = 50e-3


def closed_forms() -> Iterator[Case]:
    """Yield every case; cases that share a run follow each other."""
    for make in (_hertz, _ellipse, _cone, _flat_punch, _tensed_paraboloid, _adhesion, _sine):
        yield from make()


def _hertz() -> Iterator[Case]:
    true = hertz.sphere(_RADIUS, _MODULUS, depth=_DEPTH)
    paraboloid = {"type": "paraboloid", "radius": _RADIUS}
    case = _with("Hertz paraboloid", "Hertz 1882", paraboloid, 3 * true.semi_x)
    yield case("force", true.force, "N", 1e-3, _force)
    yield case("corrected area", pi * true.semi_x**2, "m²", 5e-3, _area)
    yield case("highest pressure", true.peak_pressure, "Pa", 5e-3, _highest_pressure)


def _ellipse() -> Iterator[Case]:
    true = hertz.ellipse(_RADIUS, 2 * _RADIUS, _MODULUS, depth=_DEPTH)
    quadric = {"type": "quadric", "radius_x": _RADIUS, "radius_y": 2 * _RADIUS}
    case = _with("Hertz ellipse", "Hertz 1882", quadric, 3 * true.semi_y)
    yield case("force", true.force, "N", 1e-3, _force)
    yield case("corrected area", pi * true.semi_x * true.semi_y, "m²", 5e-3, _area)


def _cone() -> Iterator[Case]:
    angle = radians(70)
    true = cone(angle, _MODULUS, depth=_DEPTH)
    tip = {"type": "cone", "half_angle": angle}
    case = _with("cone", "Sneddon 1965", tip, 3 * true.contact_radius)
    yield case("force", true.force, "N", 1e-3, _force)
    yield case("corrected area", pi * true.contact_radius**2, "m²", 5e-3, _area)


def _flat_punch() -> Iterator[Case]:
    radius = 0.1 * _RADIUS
    true = flat_punch(radius, _MODULUS, depth=_DEPTH)
    end = {"type": "flat_punch", "radius": radius}
    case = _with("flat punch", "Sneddon 1965", end, 2.2 * radius)
    yield case("force", true.force, "N", 1e-2, _force)


def _tensed_paraboloid() -> Iterator[Case]:
    true = indent(Paraboloid(radius=_RADIUS), _MODULUS, _TENSION, depth=_DEPTH)
    paraboloid = {"type": "paraboloid", "radius": _RADIUS}
    source = "integral equation, after Long et al. 2017"
    case = _with("tensed paraboloid", source, paraboloid, 2.6 * true.contact_radius, _TENSION)
    yield case("force", true.force, "N", 1e-3, _force)
    yield case("corrected area", pi * true.contact_radius**2, "m²", 5e-3, _area)
    centre = float(true.pressure(np.array(0.0)))
    yield case("highest pressure", centre, "Pa", 5e-3, _highest_pressure)


def _adhesion() -> Iterator[Case]:
    paraboloid = Paraboloid(radius=_RADIUS)
    for name, tension, source in (
        ("adhesive paraboloid", 0.0, "Johnson, Kendall & Roberts 1971"),
        ("adhesive tensed paraboloid", _TENSION, "integral equation and superposition"),
    ):
        theory = Adhesion(paraboloid, _MODULUS, tension, _WORK)
        pull_off, unloaded = theory.instability(), theory.at_force(0.0)
        low, high = 0.5 * float(pull_off.contact_radius), 1.1 * float(unloaded.contact_radius)
        start, stop = (
            indent(paraboloid, _MODULUS, tension, contact_radius=a).depth for a in (low, high)
        )
        configuration = {
            "grid": {"points": 128, "size": 2.6 * high},
            "kernel": _kernel(tension),
            "indenter": {"type": "paraboloid", "radius": _RADIUS},
            "loading": {"depth": {"start": start, "stop": stop, "num": 10}, "stiffness": True},
        }
        for quantity, expected, unit, computed in (
            ("pull-off", pull_off.force, "N", _pull_off),
            ("contact radius without load", unloaded.contact_radius, "m", _unloaded_radius),
        ):
            row = f"{name}: {quantity}"
            yield Case(row, configuration, computed, float(expected), unit, 1e-2, source)


def _sine() -> Iterator[Case]:
    wavelength, amplitude, points = 1e-3, 1e-6, 64
    wave = np.cos(2 * pi * (np.arange(points) + 0.5) / points)
    true = pressure_amplitude(amplitude, wavelength, _MODULUS, _TENSION)
    heights = np.repeat(amplitude * wave[:, None], points, axis=1).tolist()
    yield Case(
        name="full contact of a sine, tension: pressure amplitude",
        configuration={
            "grid": {"points": points, "size": wavelength, "boundary": "periodic"},
            "kernel": _kernel(_TENSION),
            "indenter": {"type": "heights", "values": heights, "unit": 1.0},
            "loading": {"mean_pressure": 2 * true},
            "solver": {"type": "conjugate_gradient", "tolerance": 1e-12},
        },
        computed=lambda result: float(
            2 * np.mean(result.dataset["pressure"][-1].values * wave[:, None])
        ),
        expected=true,
        unit="Pa",
        tolerance=1e-10,
        source="(E*/2)(q + s q²)Δ",
    )


def _with(
    name: str, source: str, indenter: dict[str, Any], size: float, tension: float = 0.0
) -> Callable[[str, float, str, float, Callable[[Result], float]], Case]:
    """Return a function that makes the cases of one run, each for one quantity."""
    configuration = {
        "grid": {"points": 256, "size": size},
        "kernel": _kernel(tension),
        "indenter": indenter,
        "loading": {"depth": _DEPTH},
        "corrections": [{"type": "yastrebov"}],
    }

    def case(
        quantity: str,
        expected: float,
        unit: str,
        tolerance: float,
        computed: Callable[[Result], float],
    ) -> Case:
        row = f"{name}: {quantity}"
        return Case(row, configuration, computed, expected, unit, tolerance, source)

    return case


def _kernel(tension: float) -> dict[str, Any]:
    if tension:
        return {"type": "tensed_membrane", "reduced_modulus": _MODULUS, "tension": tension}
    return {"type": "half_space", "reduced_modulus": _MODULUS}


def _force(result: Result) -> float:
    return float(result.dataset["force"][-1])


def _area(result: Result) -> float:
    return float(result.dataset["contact_area_yastrebov"][-1])


def _pull_off(result: Result) -> float:
    return float(curve_of(result.dataset, _WORK).instability().force)


def _unloaded_radius(result: Result) -> float:
    return float(curve_of(result.dataset, _WORK).at_zero_load().contact_radius)


def _highest_pressure(result: Result) -> float:
    return float(result.dataset["pressure"][-1].max())


@hookimpl
def register_validations(register: Callable[[Suite], None]) -> None:
    """Register the suite."""
    register(closed_forms)
