"""Stiffness of sines at a fixed contact, and the complex moduli that they tell.

At a fixed contact the stiffness is that of an elastic solid with the complex modulus E*(ω) in place
of E* (the correspondence principle; Lee & Radok 1960), also under a tension, which is not complex.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle_axisymmetric import dynamic_punch_stiffness

from .contact.contact import Contact, OwnArea
from .contact.curve import Curve
from .effect import Adds, ComplexArray, Responds, Yields
from .explanation import Explanation

_STEP = 1e-4
"""Step of derivatives, over the depth or the force."""
_OF_SINES = 0.01
"""Error of the stiffness of a sine over itself, as instruments oscillate."""
_SHALLOW = 1e-6
"""Least depth of a sine, over the range of positions."""
_FURTHEST = 8.0
"""How far the modulus that holds a load may lie from E*, as a logarithm."""
_LEAST_RATE = 0.05
"""Least slope of the logarithm of the force over that of the modulus; 0 of a skin alone."""
_STEPS = 8
"""Steps of Newton's method."""


class _Held(NamedTuple):
    """What a contact is about which it oscillates, of shape (m,), or (k, m) of k trials."""

    contact: Contact
    depth: Array
    radius: Array
    """Contact radius without tension [m]."""
    tensed_radius: Array | None
    """Contact radius [m]; None without a tension."""
    beside: ComplexArray
    """Stiffness [N/m] of what acts beside the solid."""
    softness: Array
    """Compliance [m/N] of what is in series with the solid, but for the cantilever."""
    gain: Array
    """Recorded force over the true one."""
    bends: Array | float
    """Compliance [m/N] of the cantilever less the one by which its bending was subtracted."""


def recorded_stiffness(explanation: Explanation, curve: Curve) -> ComplexArray:
    """Return the stiffness [N/m] of the sines of a curve that an explanation has recorded.

    It has the shape (m,), or (k, m) of k trials.
    """
    held = _held(explanation, curve)
    stiffness = _stiffness(held, _explained(explanation, curve, held)) + held.beside
    # A trial without a contact has no stiffness.
    return np.asarray(held.gain * stiffness / (1 + stiffness * (held.softness + held.bends)))


def misfits(explanation: Explanation, curve: Curve) -> ComplexArray:
    """Return recorded less measured stiffness of the sines of a curve, over its deviation.

    It has the shape (m,), or (k, m) of k trials.
    """
    measured = curve.sine_stiffness
    noise = np.array([sine.deviation for sine in curve.sines])
    deviation = np.hypot(noise, _OF_SINES * np.abs(measured))
    return np.asarray((recorded_stiffness(explanation, curve) - measured) / deviation)


def complex_moduli(explanation: Explanation, curve: Curve) -> ComplexArray:
    """Return the complex moduli E*(ω) [Pa] that the measured sines of a curve tell.

    Of the explanation only the contact counts, not how the solid relaxes.
    """
    held = _held(explanation, curve)
    compliance = held.gain / curve.sine_stiffness - held.softness - held.bends
    stiffness = 1 / compliance - held.beside
    if held.tensed_radius is None:
        return np.asarray(held.contact.modulus * stiffness / _stiffness(held, held.contact.modulus))
    modulus = stiffness / (2 * held.tensed_radius)
    for _ in range(_STEPS):
        here, step = _stiffness(held, modulus), _STEP * modulus
        slope = (_stiffness(held, modulus + step) - here) / step
        modulus = modulus + (stiffness - here) / slope
    return np.asarray(modulus)


def depths(explanation: Explanation, curve: Curve) -> Array:
    """Return the depth [m] of the contact of each sine of a curve."""
    return _held(explanation, curve).depth


def explained_moduli(explanation: Explanation, curve: Curve) -> ComplexArray:
    """Return the complex moduli E*(ω) [Pa] of an explanation at the sines of a curve."""
    return _explained(explanation, curve, _held(explanation, curve))


def _explained(explanation: Explanation, curve: Curve, held: _Held) -> ComplexArray:
    contact, frequency = held.contact, np.array([sine.frequency for sine in curve.sines])
    for effect in explanation.of(Responds):
        share = effect.complex_modulus(frequency, held.radius, contact.length)
        assert share is not None
        return np.asarray(contact.modulus * share)
    return np.asarray(contact.modulus * np.ones(frequency.shape, dtype=complex))


def _stiffness(held: _Held, modulus: ComplexArray | float) -> ComplexArray:
    """Return the stiffness [N/m] of the solid with some moduli [Pa] at its contact."""
    contact = held.contact
    if held.tensed_radius is None:
        return np.asarray(contact.stiffness(held.depth) * (modulus / contact.modulus))
    complex_ones: ComplexArray = np.asarray(modulus, dtype=complex)
    return dynamic_punch_stiffness(held.tensed_radius, complex_ones, contact.tension)


def _held(explanation: Explanation, curve: Curve) -> _Held:
    states, contact = curve.held, explanation.contact(curve)
    small = _STEP * np.max(np.abs(states.force))
    free = explanation.free_force(states)

    recorded = [
        explanation.recorded(force, states) for force in (states.force, states.force + small)
    ]
    gain = (recorded[1] - recorded[0]) / small
    true = (states.force - free) / gain

    def give(force: Array) -> Array:
        return sum((e.give(force) for e in explanation.of(Yields)), start=np.zeros_like(force))

    softness = (give(true + small) - give(true)) / small
    bends: Array | float = 0.0
    depth = explanation.base_depth(states) - give(true)
    stiffness = explanation.stiffness(curve)
    if curve.stiffness is not None and stiffness is not None:
        depth = depth - true / stiffness
        bends = 1 / stiffness - gain / curve.stiffness
    depth = np.maximum(depth, _SHALLOW * curve.span)
    step = _STEP * depth

    def beside(depth: Array, states: Curve) -> Array:
        forces = (add.force(contact, states, depth) for add in explanation.of(Adds))
        return sum(forces, start=np.zeros_like(depth))

    still = beside(depth, states)
    damping = beside(depth, states.at_velocity(1.0)) - still
    omega = 2 * np.pi * np.array([sine.frequency for sine in curve.sines])
    stiff = (beside(depth + step, states) - still) / step + 1j * omega * damping
    tensed = _tensed_radius(contact, depth, true - still) if np.any(contact.tension) else None
    bare = contact.radius(depth) if contact.half_space else depth
    return _Held(contact, depth, bare, tensed, stiff, softness, gain, bends)


def _tensed_radius(contact: Contact, depth: Array, load: Array) -> Array:
    """Return the radius [m] of a contact of some depths [m] under loads [N], under a tension.

    With the modulus that holds the load then: a solid that relaxes has a smaller one than E*.
    """
    shape = np.broadcast_shapes(depth.shape, np.shape(contact.modulus), np.shape(contact.tension))

    def column(values: Array | float) -> Array:
        return np.broadcast_to(values, shape).reshape(-1, 1)

    deep, log = column(depth), np.zeros((int(np.prod(shape)), 1))
    area, log_load = contact.area, column(_log(load))
    modulus: Any = column(contact.modulus)
    tension: Any = column(contact.tension)
    assert isinstance(area, OwnArea)
    stretch = area.width, area.height, contact.depth_limit
    width, height, limit = (s if isinstance(s, float) else column(s) for s in stretch)
    area = replace(area, width=width, height=height)
    flat = replace(contact, tension=tension, size=width, area=area, depth_limit=limit)

    def of(log: Array) -> Contact:
        return replace(flat, modulus=modulus * np.exp(log))

    for _ in range(_STEPS):
        here = _log(of(log).force(deep))
        rate = (_log(of(log + _STEP).force(deep)) - here) / _STEP
        log = np.clip(
            log + (log_load - here) / np.maximum(rate, _LEAST_RATE), -_FURTHEST, _FURTHEST
        )
    return np.asarray(of(log).punch(deep)[2].reshape(shape))


def _log(force: Array) -> Array:
    return np.log(np.maximum(force, 1e-300))
