"""The contract of effects as a test: one call checks an effect.

An effect is asked on clean curves of a round tip and of a cone, on the approach alone and on both
passes, with its quantities where searches start; on a curve for which it has an excuse it is not.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import wraps
from itertools import chain, islice

import numpy as np

from pellicle.errors import ConvergenceError
from pellicle.testing import check, rules_of
from pellicle_fit.contact.curve import Curve
from pellicle_fit.effect import Adds, Bends, Effect, Records, Responds, Sizes, Yields, quantities

from .cases import DEPTHS, STIFFNESS, Case, curves

_PLACES = Bends, Responds, Adds, Yields, Records
_VALUES = 2
"""Starts of each curve at which an effect is asked."""
_LIMIT = 1e-3
"""Difference of forces that is left at the limit of a quantity, over the largest."""
_SCALES = {"lengths": (2.0, 1.0, 1.0), "forces": (1.0, 3.0, 1.0), "times": (1.0, 1.0, 5.0)}
_HALVINGS = 12


def _in_each_case(rule: Callable[[Case], str]) -> Callable[[Effect], str]:
    """Return the rule of an effect that those of it are, known, on the curves on which it acts."""

    @wraps(rule)
    def broken(effect: Effect) -> str:
        free = _free(effect)
        for words, curve in curves():
            sizes, excused = Sizes.of_curve(curve), _excuse(effect, curve)
            for start in () if excused else islice(free.starts(sizes), _VALUES):
                known = free.known(sizes).model_copy(update=dict(start))
                if violation := rule(Case(known, curve)):
                    return f"{words}: {violation}"
        return ""

    return broken


def check_effect(effect: Effect) -> None:
    """Check that an effect keeps its contract.

    Besides the rules of all components: it acts on one of the curves of the kit; without its cause,
    at 0 or at the limit of a quantity, the force is that without it; units are right; what it
    returns is finite, where nothing touches too, of the right shape and a function of each row;
    contact and depths grow; jumps are told; and searches start within its limits.
    """
    check(effect, Effect, rules_of(__name__))


def stands_in_one_place(effect: Effect) -> str:
    """The class derives from one of Bends, Responds, Adds, Yields and Records."""
    places = [place.__name__ for place in _PLACES if isinstance(effect, place)]
    return "" if len(places) == 1 else f"it derives from {' and '.join(places) or 'Effect alone'}"


def starts_lie_within_limits(effect: Effect) -> str:
    """starts() and limits() name quantities, and starts lie between the limits."""
    known, free = quantities(type(effect)), _free(effect)
    for words, curve in curves():
        sizes = Sizes.of_curve(curve)
        limits, starts = free.limits(sizes), list(free.starts(sizes))
        if not starts:
            return f"starts() yields nothing on {words}; without quantities it yields {{}} once"
        for name, value in [*dict.fromkeys(limits).items(), *chain(*(s.items() for s in starts))]:
            if name not in known:
                return f"{name} is not one of its quantities, {', '.join(known)}"
            low, high = limits.get(name, (-np.inf, np.inf))
            if value is not None and not low <= known[name](value) <= high:
                return f"{name} starts at {value:g} on {words}, outside {low:g} to {high:g}"
    return ""


def acts_on_a_curve(effect: Effect) -> str:
    """excuse() returns an empty text for one of the curves of the kit, else why not."""
    reasons = dict.fromkeys(_excuse(effect, curve) for _, curve in curves())
    return f"on all of them it is excused: {'; '.join(reasons)}" if all(reasons) else ""


@_in_each_case
def returns_a_number_for_each_row(case: Case) -> str:
    """It returns finite float64 of the shape of its argument, which stays, and the same each time.

    So it does before contact, at tiny and at large forces, and down to the depth limit. What is no
    response depends on each row alone: of every second row it is every second one.
    """
    first, second = (case.given(case.rows) for _ in range(2))
    if not isinstance(first, np.ndarray) or first.dtype != np.float64:
        return f"{first!r}, which is no array of float64"
    if first.shape != case.rows.shape:
        return f"of shape {first.shape} for {case.rows.shape}"
    if not np.array_equal(first, second, equal_nan=True):
        return "the second call returns something else"
    effect, ends, largest = case.effect, case.rows.copy(), float(case.rows.max())
    deepest = effect.contact(case.contact).depth_limit if isinstance(effect, Bends) else np.inf
    ends[:4] = [0.0, 1e-9 * largest, -largest, min(10 * largest, deepest)]
    finite = np.isfinite(case.given(ends))
    if not finite.all():
        return f"it is not finite at {ends[~finite][0]:g} in SI"
    curve, every = case.curve, slice(None, None, 2)
    rows = {name: getattr(curve, name)[every] for name in ("position", "force", "time")}
    half = case._replace(curve=replace(curve, **rows, unloading=curve.moves_out[every]))
    far = np.abs(half.given(half.rows) - first[every]) > _LIMIT**2 * np.max(np.abs(first))
    differs = not isinstance(effect, Responds) and far.any()
    return "without every second row the others change" if differs else ""


@_in_each_case
def acts_where_no_row_touches(case: Case) -> str:
    """With a contact point that no row reaches, as searches try them, its force is finite."""
    for share in (0.0, 1e-3, 1.0, 10.0):
        point = float(np.max(case.curve.base)) + share * case.curve.span
        if not np.isfinite(case.force(case.effect, contact_point=point)).all():
            return f"it is not, {share:g} ranges of the positions beyond the deepest row"
    return ""


@_in_each_case
def depths_grow(case: Case) -> str:
    """A bent contact has no force at depths ≤ 0, and one that grows; with what yields, bases sink.

    The depth of the base, δ + u(F), grows with that of the solid.
    """
    contact, deepest = case.contact, 2 * float(DEPTHS[-1])
    if isinstance(case.effect, Bends):
        contact = case.effect.contact(contact)
        deepest = min(deepest, contact.depth_limit)
    depth = deepest * np.linspace(-1.0, 1.0, 201)
    force = contact.force(depth)
    if np.any(force[:101] != 0) or not np.all(np.diff(force[100:]) > 0):
        return f"the forces at {depth[95]:g}, …, {depth[-1]:g} m are {force[95:]}"
    give = case.effect.give(force) if isinstance(case.effect, Yields) else 0.0
    sinks = np.diff(depth + give) > 0
    if sinks[100 : 100 + DEPTHS.size].all():
        return ""
    return f"the base does not from a depth of {depth[:-1][~sinks][0]:g} m on"


@_in_each_case
def without_its_cause_it_is_nothing(case: Case) -> str:
    """At 0, or in the limit, of one of its quantities the force is that of a set without it."""
    least, words = np.inf, ""
    for name, quantity in quantities(type(case.effect)).items():
        value = getattr(case.effect, name)
        for off in (0.0, 1e-9 * value, 1e9 * value):
            with suppress(ValueError, ConvergenceError):
                off = quantity(off)
                nothing = case._replace(effect=case.effect.model_copy(update={name: off}))
                far = np.max(np.abs(nothing.force(nothing.effect) - case.force()))
                far -= max(case.force_tolerance, _LIMIT * case.curve.largest if off else 0.0)
                least, words = min((least, words), (far, f"{name} = {off:g}"))
    if not words or least <= 0:
        return ""
    return f"even with {words} in SI the force differs by {least:.2g} N"


@_in_each_case
def units_are_right(case: Case) -> str:
    """With lengths, forces or times times a factor, quantities by their units, F is as expected.

    The modulus is the one at the end of the loading.
    """
    for words, factors in _SCALES.items():
        scaled = case.scaled(*factors)
        far = np.max(np.abs(scaled.force(scaled.effect) - factors[1] * case.force(case.effect)))
        if far > scaled.force_tolerance:
            return (
                f"with {words} {max(factors):g} times as large the force is off by {far:.2g} N; "
                "is the unit of a quantity wrong?"
            )
    return ""


@_in_each_case
def jumps_are_told(case: Case) -> str:
    """A force may jump with the contact point only where `jumps` says so."""
    if case.effect.jumps:
        return ""
    # A soft cantilever may jump by itself.
    case = case._replace(curve=replace(case.curve, stiffness=None))
    shifts = [*(float(np.ptp(DEPTHS)) / DEPTHS.size / 8 * np.arange(-8.0, 9.0))]
    for halving in range(_HALVINGS + 1):
        forces = [case.force(case.effect, contact_point=shift) for shift in shifts]
        if halving < _HALVINGS:
            # A jump is a bend of a curve that halving does not make smaller.
            at = int(np.argmax(np.max(np.abs(np.diff(forces, 2, axis=0)), axis=1)))
            shifts = [*np.linspace(shifts[at], shifts[at + 2], 5)]
    jump = float(np.max(np.abs(np.diff(forces, axis=0))))
    return f"the force jumps by {jump:.2g} N" if jump > _LIMIT * case.curve.largest else ""


@_in_each_case
def what_it_says_is_valid(case: Case) -> str:
    """accuracy() is a share, searched() a whole number ≥ 0; relaxed() and stiffness() are > 0.

    complex_modulus() is None or one number for each frequency, that of a solid without a source.
    """
    known = case.effect
    says = {
        "accuracy()": 0 <= known.accuracy(case.contact, case.curve, frozenset()) < 1,
        "searched()": known.searched(case.curve) in range(100),
        "relaxed()": not isinstance(known, Responds) or 0 < known.relaxed(1.0) < np.inf,
        "stiffness()": not isinstance(known, Records) or 0 < known.stiffness(STIFFNESS) < np.inf,
        "complex_modulus()": not isinstance(known, Responds) or _is_passive(known),
    }
    wrong = [name for name, is_valid in says.items() if not is_valid]
    return f"{' and '.join(wrong)} is not" if wrong else ""


def _is_passive(effect: Responds) -> bool:
    frequency = np.array([0.1, 1.0, 10.0])
    found = effect.complex_modulus(frequency, np.full(3, DEPTHS[-1]), 0.0)
    if found is None:
        return True
    valid = found.shape == frequency.shape and np.isfinite(found).all()
    return bool(valid and np.all(found.real > 0) and np.all(found.imag > -_LIMIT * found.real))


def _excuse(effect: Effect, curve: Curve) -> str:
    return effect.excuse(curve.contact, curve, frozenset())


def _free(effect: Effect) -> Effect:
    """Return the effect with all of its quantities open."""
    return effect.model_copy(update=dict.fromkeys(quantities(type(effect))))


QUICK = [
    stands_in_one_place,
    starts_lie_within_limits,
    returns_a_number_for_each_row,
    depths_grow,
    what_it_says_is_valid,
]
"""Rules that balance no forces, which a fit asks of effects that pellicle does not ship."""
