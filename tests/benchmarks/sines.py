"""Sines of made curves: K′, K″ and moduli within their intervals, and what fits say.

Prints docs/measurements/sines.csv. A ramp of 1 s to 1 µm, a hold at a depth or under a force, and
in it sines of 0.5, 2 and 10 Hz, one after the other. The slow course is that of Lee & Radok (1960),
under a tension with the effective modulus; the sines are those of a contact that stays.
"""

import csv
import sys
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.special import gamma

import pellicle as pl
from pellicle_axisymmetric import dynamic_punch_stiffness, punch_radius
from pellicle_fit.files.sines import separate

RADIUS, DEPTH, MODULUS, TOUCH = 5e-6, 1e-6, 2e3, 3e-6
RATE, BEFORE, RAMP, HOLD, GAP, CYCLES, AMPLITUDE = 100.0, 0.5, 1.0, 2.0, 0.3, 10, 2e-8
FREQUENCIES = 0.5, 2.0, 10.0
NOISE, COVERED, FITTED = 0.01, 100, 6
BEAD: Any = pl.indenter("paraboloid", radius=RADIUS)


class Law(NamedTuple):
    """A law of relaxation, over E*."""

    name: str
    quantities: dict[str, float]
    primitive: Callable[[Any], Any]
    """∫ E dt [s]."""
    modulus: Callable[[Any], Any]
    """E*(ω) at s = iω [1/s]."""


def zener(share: float, time: float) -> Law:
    """Return the standard linear solid."""
    return Law(
        "standard_linear",
        {"relaxed_share": share, "relaxation_time": time},
        lambda t: (1 - share) * t - share * time * np.expm1(-t / time),
        lambda s: 1 - share + share * s * time / (1 + s * time),
    )


def power(exponent: float) -> Law:
    """Return the power law."""
    return Law(
        "power_law",
        {"relaxation_exponent": exponent},
        lambda t: t ** (1 - exponent) / (1 - exponent),
        lambda s: s**exponent * gamma(1 - exponent),
    )


def matrix(law: Law, time: Any) -> Any:
    """Return the integrals of E over the steps before each time, of shape (n, n − 1)."""
    passed = np.maximum(time[:, None] - time[None], 0.0)
    return -np.diff(law.primitive(passed), axis=1)


def course(law: Law, tension: float, hold: str, time: Any) -> tuple[Any, Any, Any]:
    """Return depths, forces and effective moduli of the slow course."""
    depth = DEPTH * np.minimum(np.maximum(time, 0.0), RAMP)
    weights, step = matrix(law, time), 1 / RATE
    area = BEAD.force_curve(depth, 0.0).force
    if hold == "force":
        # Under a constant force the area grows so that its history carries it.
        force = MODULUS * weights @ np.diff(area) / step
        last = int(np.searchsorted(time, RAMP))
        for k in range(last, int(time.size)):
            rest = weights[k, : k - 1] @ np.diff(area[:k]) / step
            area[k] = area[k - 1] + (force[last] / MODULUS - rest) * step / weights[k, k - 1]
        depth = (area / (4 / 3 * np.sqrt(RADIUS))) ** (2 / 3)
    carried = weights @ np.diff(area) / step
    share = np.where(area > 0, carried / np.maximum(area, 1e-300), 1.0)
    force = np.zeros_like(time)
    for k in np.flatnonzero((depth > 0) & (share > 0)).tolist():
        modulus = share[k] * MODULUS
        length = 2 * tension / modulus
        force[k] = modulus * BEAD.force_curve(depth[[k]], length).force[0]
    return depth, force, share


def curve(law: Law, tension: float, hold: str) -> tuple[Any, Any, Any, Any]:
    """Return times, positions and forces without noise, and the stiffness of the sines."""
    starts = RAMP + HOLD + np.cumsum([0.0, *(CYCLES / f + GAP for f in FREQUENCIES)])
    time = np.arange(-BEFORE, starts[-1], 1 / RATE)
    depth, force, share = course(law, tension, hold, time)
    depth = np.where(time < 0, DEPTH * time, depth)
    told = []
    for f, start in zip(FREQUENCIES, starts, strict=False):
        at = (time >= start) & (time < start + CYCLES / f)
        k = int(np.flatnonzero(at).mean())
        length = 2 * tension / (share[k] * MODULUS)
        mean = np.mean(depth[at], keepdims=True)
        slope = BEAD.force_curve(mean, length).by_depth
        radius = punch_radius(slope, length)[0]
        modulus = MODULUS * law.modulus(np.array([2j * np.pi * f]))
        (stiffness,) = dynamic_punch_stiffness(radius, modulus, tension)
        turn = np.exp(2j * np.pi * f * (time[at] - start))
        # A contact that creeps stiffens as its radius grows.
        wider = np.sqrt(depth[at] / mean)
        depth[at] += AMPLITUDE * turn.imag
        force[at] += AMPLITUDE * wider * (stiffness * turn).imag
        told.append(stiffness)
    return time, TOUCH + depth, force, np.array(told)


def noisy(force: Any, seed: int) -> Any:
    """Return forces with noise."""
    return force + NOISE * force.max() * np.random.default_rng(seed).standard_normal(force.size)


def covered(time: Any, position: Any, force: Any, told: Any) -> int:
    """Return in how many of as many curves K′ and K″ lie in their intervals, over six each."""
    inside = 0
    for seed in range(COVERED):
        sines = separate(position, noisy(force, seed), time, None, FREQUENCIES, 0.0).sines
        for sine, true in zip(sines, told, strict=True):
            off = sine.stiffness - true
            inside += sum(abs(part) < 1.96 * sine.deviation for part in (off.real, off.imag))
    return inside


def held(fit: Any, name: str, true: float) -> bool:
    """Return whether an interval holds a value."""
    estimate = fit.estimates().get(name)
    return estimate is not None and (estimate.low or 0.0) <= true <= (estimate.high or np.inf)


def fits(law: Law, tension: float, segment: str, of: Any) -> dict[str, int]:
    """Return in how many fits the law is named, and intervals hold what was made."""
    time, position, force, _ = of
    moduli = MODULUS * law.modulus(2j * np.pi * np.array(FREQUENCIES))
    counts = dict.fromkeys(("law", "tension_claimed", "quantities", "tension", "moduli"), 0)
    for seed in range(FITTED):
        options: dict[str, Any] = {"segment": segment, "frequencies": [*FREQUENCIES]}
        fit = pl.fit(position, noisy(force, seed), time=time, indenter=BEAD, **options)
        named = {law.name, "tension"} if tension else {law.name}
        counts["law"] += set(fit.data["model"]["effects"]) == named
        counts["tension_claimed"] += fit.tension_needed
        counts["quantities"] += all(held(fit, n, v) for n, v in law.quantities.items())
        counts["tension"] += held(fit, "tension", tension)
        for sine, true in zip(fit.sines, moduli, strict=True):
            parts = ("storage", true.real), ("loss", true.imag)
            found = ((sine[f"{name}_modulus"], value) for name, value in parts)
            counts["moduli"] += sum(e.low <= value <= e.high for e, value in found)
    return counts


def main() -> None:
    """Print the table."""
    heads = "law,tension_mN_m,hold,stiffness_in_600,segment,fits,law_named,tension_claimed"
    writer = csv.writer(sys.stdout)
    writer.writerow([*heads.split(","), "law_held", "tension_held", "moduli_held_of_six_each"])
    for law in (zener(0.5, 0.3), power(0.15), power(0.3)):
        for tension, hold in ((0.0, "depth"), (0.0, "force"), (5e-3, "depth")):
            of = curve(law, tension, hold)
            inside = covered(*of)
            told = partial(fits, law, tension, of=of)
            for segment in ("approach", "approach+hold"):
                counts = told(segment)
                quantity = ",".join(f"{v:g}" for v in law.quantities.values())
                row = [f"{law.name} {quantity}", 1e3 * tension, hold, inside, segment, FITTED]
                writer.writerow([*row, *counts.values()])
                sys.stdout.flush()


if __name__ == "__main__":
    main()
