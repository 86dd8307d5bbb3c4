"""Validation cases with known results: closed forms and the axisymmetric integral equation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import pi, radians
from typing import Any

import numpy as np

from pellicle import hookimpl
from pellicle.components import Case, Suite
from pellicle.results import Result
from pellicle_axisymmetric import Adhesion, indent
from pellicle_plugins.closed_forms import hertz, sneddon
from pellicle_plugins.indenters.of_revolution import Cone, Paraboloid, Sphere

from .adhesive_path import curve_of

_MODULUS = 10e3
_RADIUS = 1e-3
_DEPTH = 50e-6
_TENSION = 1.0
_WORK = 50e-3


def closed_forms() -> Iterator[Case]:
    """Yield every case; cases that share a run follow each other."""
    yield from _pressed()
    yield from _adhesion()
    yield from _sine()


def _pressed() -> Iterator[Case]:
    """Yield the cases of indenters at a depth."""
    round_ = {"type": "paraboloid", "radius": _RADIUS}
    true = hertz.sphere(_RADIUS, _MODULUS, depth=_DEPTH)
    expected = true.force, pi * true.semi_x**2, true.peak_pressure
    yield from _cases("Hertz paraboloid", "Hertz 1882", round_, 3 * true.semi_x, *expected)

    quadric = {"type": "quadric", "radius_x": _RADIUS, "radius_y": 2 * _RADIUS}
    true = hertz.ellipse(_RADIUS, 2 * _RADIUS, _MODULUS, depth=_DEPTH)
    area = pi * true.semi_x * true.semi_y
    yield from _cases("Hertz ellipse", "Hertz 1882", quadric, 3 * true.semi_y, true.force, area)

    tip = {"type": "cone", "half_angle": radians(70)}
    cone = sneddon.cone(radians(70), _MODULUS, depth=_DEPTH)
    radius = cone.contact_radius
    yield from _cases("cone", "Sneddon 1965", tip, 3 * radius, cone.force, pi * radius**2)

    radius = 0.1 * _RADIUS
    end = {"type": "flat_punch", "radius": radius}
    force = 2 * _MODULUS * radius * _DEPTH
    yield from _cases("flat punch", "Sneddon 1965", end, 2.2 * radius, force, tolerance=1e-2)

    yield from _tips()

    tensed = indent(Paraboloid(radius=_RADIUS), _MODULUS, _TENSION, depth=_DEPTH)
    radius, source = tensed.contact_radius, "integral equation, after Long et al. 2017"
    expected = tensed.force, pi * radius**2, float(tensed.pressure(np.array(0.0)))
    size = 2.6 * radius
    yield from _cases("tensed paraboloid", source, round_, size, *expected, tension=_TENSION)


def _tips() -> Iterator[Case]:
    """Yield the cases of tips that are blunt, worn or pyramids."""
    at, angle = np.array([_DEPTH]), radians(70)
    blunt = Cone(half_angle=angle, tip_radius=0.2 * _RADIUS)
    worn = Sphere(radius=_RADIUS, flat_radius=0.1 * _RADIUS)
    for name, body, source in (
        ("blunt cone", blunt, "Briscoe, Sebastian & Adams 1994"),
        ("worn sphere", worn, "Sneddon 1965"),
    ):
        force = _MODULUS * float(body.force_curve(at, 0.0).force[0])
        radius = float(body.contact_radius(at, 0.0).radius[0])
        tip = body.model_dump(exclude_none=True)
        yield from _cases(name, source, tip, 2.6 * radius, force, pi * radius**2)

    length = 2 * _TENSION / _MODULUS
    tip = blunt.model_dump(exclude_none=True)
    force = _MODULUS * float(blunt.force_curve(at, length).force[0])
    size = 2 * float(blunt.contact_radius(at, 0.0).radius[0])
    source = "reciprocity, after Shield 1967"
    yield from _cases("tensed blunt cone", source, tip, size, force, tension=_TENSION)

    # Bilodeau's pressure is an approximate one.
    for sides, share in ((3, 0.887), (4, 0.7453)):
        tip = {"type": "pyramid", "half_angle": angle, "sides": sides}
        force, size = share * _MODULUS * np.tan(angle) * _DEPTH**2, 4 * _DEPTH * np.tan(angle)
        name = f"pyramid of {sides} sides"
        yield from _cases(name, "Bilodeau 1992", tip, size, force, tolerance=1.2e-2)


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
    q = 2 * pi / wavelength
    true = (_MODULUS * q / 2 + _TENSION * q**2) * amplitude
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


def _cases(
    name: str,
    source: str,
    indenter: dict[str, Any],
    size: float,
    *expected: float,
    tension: float = 0.0,
    tolerance: float = 1e-3,
) -> Iterator[Case]:
    """Yield the cases of one run: force, to a tolerance, and if given area and pressure."""
    configuration = {
        "grid": {"points": 256, "size": size},
        "kernel": _kernel(tension),
        "indenter": indenter,
        "loading": {"depth": _DEPTH},
        "corrections": [{"type": "yastrebov"}],
    }
    quantities: list[tuple[str, str, float, Callable[[Result], float]]] = [
        ("force", "N", tolerance, lambda r: float(r.dataset["force"][-1])),
        ("corrected area", "m²", 5e-3, lambda r: float(r.dataset["contact_area_yastrebov"][-1])),
        ("highest pressure", "Pa", 5e-3, lambda r: float(r.dataset["pressure"][-1].max())),
    ]
    for value, (quantity, unit, allowed, computed) in zip(expected, quantities, strict=False):
        yield Case(f"{name}: {quantity}", configuration, computed, value, unit, allowed, source)


def _kernel(tension: float) -> dict[str, Any]:
    if tension:
        return {"type": "tensed_membrane", "reduced_modulus": _MODULUS, "tension": tension}
    return {"type": "half_space", "reduced_modulus": _MODULUS}


def _pull_off(result: Result) -> float:
    return float(curve_of(result.dataset, _WORK).instability().force)


def _unloaded_radius(result: Result) -> float:
    return float(curve_of(result.dataset, _WORK).at_zero_load().contact_radius)


@hookimpl
def register_validations(register: Callable[[Suite], None]) -> None:
    """Register the suite."""
    register(closed_forms)
