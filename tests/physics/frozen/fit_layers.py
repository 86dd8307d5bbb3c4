"""What is frozen of fits, in layers of their own tolerances, and what counts as a change."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from tests.physics.frozen import reader
from tests.physics.frozen.fit_curves import (
    CASES,
    DRAG,
    HERTZ,
    MODULUS,
    TENSION,
    TOUCH,
    WORK,
    Case,
    case,
)

RELAXING = {"power_law", "standard_linear"}
# --- What is recorded ------------------------------------------------------------------------

VALUES = [
    {
        "contact_point": TOUCH,
        "reduced_modulus": MODULUS * factor,
        "tension": TENSION * factor * tension,
        "relaxation_exponent": exponent,
        "relaxed_share": 2 * exponent,
        "relaxation_time": 0.1 / exponent,
        "work_of_adhesion": WORK * exponent,
        "drag": DRAG * exponent / 3,
        "drift": HERTZ * exponent / 10,
        "thickness": 1e-6 / exponent,
        "offset": HERTZ * exponent / 10,
        "slope": HERTZ * exponent / 1e-6,
    }
    for factor, tension, exponent in ((0.5, 0.03, 0.05), (1.0, 0.3, 0.1), (2.0, 2.0, 0.3))
]
"""Parameters of models, of small, middle and large effects."""
_EFFECTS = {
    "approach": ("power_law", "standard_linear", "drag", "adhesion", "layer", "slope"),
    "both": ("power_law", "standard_linear", "drag", "drift", "adhesion"),
    "dwell": ("power_law", "standard_linear", "drag"),
    "retract": ("adhesion", "layer"),
}
"""Effects that a curve of each segment may have, each alone and beside a tension."""
_SHAPES: dict[str, dict[str, Any]] = {
    "cone": {"indenter": "cone", "radius": None, "half_angle": 1.2},
    "sphere": {"indenter": "sphere"},
    "layer given": {"thickness": 5e-6, "poissons_ratio": 0.4},
}


def _model_case(segment: str, spring: float | None, options: Mapping[str, Any]) -> Case:
    return case(
        "tension",
        segment=segment,
        points=22,
        spring=spring,
        seed=50,
        options=options,
        tension=0.3 * TENSION,
    )


def forces() -> Iterator[tuple[str, Any]]:
    """Yield forces of every model at `VALUES`, over the largest, and that one."""
    for spring in (None, 0.03):
        where = "" if spring is None else ", cantilever"
        for segment, single in _EFFECTS.items():
            sets = [
                {*effect, *tension}
                for effect in ((), *((e,) for e in single))
                for tension in ((), ("tension",))
            ]
            curve = _model_case(segment, spring, {})
            for effects in sets:
                if not _excluded(curve, effects):
                    yield f"{segment}{where}: {_name(effects)}", _forces(curve, effects)
        for name, options in _SHAPES.items():
            yield f"{name}{where}", _forces(_model_case("approach", spring, options), {"tension"})


def _forces(curve: Case, effects: set[str]) -> Any:
    arrays = [reader.forces(curve, effects, values) for values in VALUES]
    return [[_digits(abs(f).max(), 14), *(round(v, 11) for v in f / abs(f).max())] for f in arrays]


def chi_squared() -> Iterator[tuple[str, Any]]:
    """Yield χ² at the true parameters, of noise of several kinds."""
    for name, curve, effects in _models():
        values = {**VALUES[1], "offset": 0.0, "slope": 0.0, **curve.values}
        yield name, reader.chi_squared(curve, effects, values)
        if "1/f" in name:
            yield f"{name}, memory", reader.chi_squared(curve, effects, values, memory=0.4)
        if name.startswith("many rows"):
            value = reader.chi_squared(curve, effects, values, condensed=True)
            yield f"{name}, condensed", value


def noise() -> Iterator[tuple[str, Any]]:
    """Yield the noise about models at the true parameters, and the checks that fail."""
    for name, curve, effects in _models():
        yield name, reader.noise(curve, effects, curve.values)


def _models() -> Iterator[tuple[str, Case, frozenset[str]]]:
    """Yield each curve with its true explanation, as far as the fit lacks it, and with none."""
    for name, curve in CASES.items():
        given = {"sphere"} | ({"layer"} if "thickness" in curve.options else set())
        for effects in {frozenset[str](), curve.effects - given}:
            if not _excluded(curve, effects):
                yield f"{name}: {_name(effects)}", curve, effects


def fit(name: str) -> Any:
    """Return what the fit of a case answers, without what is not frozen."""
    curve, answer = CASES[name], reader.fit(CASES[name])
    names = answer.get("explanations", {})
    gone = {e for e in names if _excluded(curve, {*e.split(" + ")})}
    if gone:
        answer["explanations"] = {e: values for e, values in names.items() if e not in gone}
        answer["tied"] = [e for e in answer["tied"] if e not in gone]
        if gone & {*answer.pop("alternatives")}:
            del answer["over_alternatives"]
    return answer


def _excluded(curve: Case, effects: Collection[str]) -> bool:
    """Return whether a model is of those that are not frozen, by the list in `not_frozen`."""
    baseline = curve.options.get("baseline") in ("offset", "slope")
    two_instruments = baseline and "spring_constant" in curve.options and "adhesion" in effects
    unloads = curve.options.get("segment") == "both"
    return two_instruments or (
        unloads and "tension" in effects and not RELAXING.isdisjoint(effects)
    )


def tables() -> Iterator[tuple[str, Any]]:
    """Yield the columns of a population and of a map of 3 × 3 curves."""
    lattice = [
        [case("tension", seed=60 + x + y, points=120, tension=tension * TENSION) for x in range(3)]
        for y, tension in ((0, 0.0), (3, 0.0), (6, 0.1))
    ]
    for name, columns in reader.tables(lattice).items():
        for column, values in columns.items():
            yield f"{name}: {column}", values


def _name(effects: Collection[str]) -> str:
    return " + ".join(sorted(effects)) or "none"


# --- What counts as a change -----------------------------------------------------------------


def force_changes(old: Any, new: Any) -> Iterator[str]:
    """Yield differences of forces beyond 1e-10 of the largest."""
    for number, (was, now) in enumerate(zip(old, new, strict=True)):
        scale = abs(now[0] / was[0] - 1)
        error = max(scale, *(abs(a - b) for a, b in zip(was[1:], now[1:], strict=True)))
        if not error < 1e-10:
            yield f"forces {number} differ by {error:.2g} of the largest"


def number_changes(tolerance: float, old: Any, new: Any) -> Iterator[str]:
    """Yield a relative difference of two numbers, or of those of two tables."""
    if isinstance(old, dict):
        for name in old:
            if isinstance(old[name], float):
                yield from (f"{name}: {t}" for t in number_changes(tolerance, old[name], new[name]))
            elif old[name] != new[name]:
                yield f"{name}: {old[name]} → {new[name]}"
    elif not abs(new - old) <= tolerance * abs(old):
        yield f"{old} → {new}"


def fit_changes(old: Any, new: Any) -> Iterator[str]:
    """Yield differences of the answers of a fit, each layer with its own tolerance."""
    for name in ("failed", "explanations"):
        if sorted(old.get(name, ())) != sorted(new.get(name, ())):
            yield f"{name}: {sorted(old.get(name, ()))} → {sorted(new.get(name, ()))}"
    if old.keys() != new.keys():
        yield f"answers: {sorted(old)} → {sorted(new)}"
        return
    # A minimum that differs by 0.02 in χ² has another scatter.
    for was, now in zip(old["noise"], new["noise"], strict=True):
        yield from (f"noise: {text}" for text in number_changes(1e-4, was, now))
    yield from (f"threshold: {t}" for t in number_changes(1e-6, old["threshold"], new["threshold"]))
    for was, now in zip(old["chi_squared"], new["chi_squared"], strict=True):
        yield from _chi_squared(was, now)
    yield from _parameters("headline", old["headline"], new["headline"])
    if "verdict" not in old:
        return
    yield from (f"margin: {text}" for text in number_changes(1e-6, old["margin"], new["margin"]))
    explanations = old["explanations"]
    for name in explanations.keys() & new["explanations"].keys():
        was, now = explanations[name], new["explanations"][name]
        yield from (
            f"{name}: {text}" for text in _chi_squared(was["chi_squared"], now["chi_squared"])
        )
        if abs(now["delta_aic"] - was["delta_aic"]) > 0.1:
            yield f"{name}: ΔAIC {was['delta_aic']} → {now['delta_aic']}"
        yield from _parameters(name, was["parameters"], now["parameters"])
    yield from _verdict_changes(old, new)


def _verdict_changes(old: Any, new: Any) -> Iterator[str]:
    aic = {name: e["delta_aic"] for name, e in old["explanations"].items()}
    least, margin = min(aic.values()), old["margin"]
    on_edge = {name for name, value in aic.items() if abs(value - least - margin) < 0.2}
    moved = {*old["tied"]} ^ {*new["tied"]}
    if moved - on_edge:
        yield f"tied: {old['tied']} → {new['tied']}"
    tensed = min(value for name, value in aic.items() if "tension" in name.split(" + "))
    lead = min(value for name, value in aic.items() if "tension" not in name.split(" + ")) - tensed
    if abs(abs(lead) - margin) < 0.3:
        return
    for name in ("verdict", "chosen", "alternatives"):
        if old.get(name) != new.get(name) and not (name == "alternatives" and moved):
            yield f"{name}: {old[name]} → {new[name]}"
    if old.get("alternatives") == new.get("alternatives"):
        for name, was in old.get("over_alternatives", {}).items():
            now = new["over_alternatives"][name]
            ends = [end for end in was or () if isinstance(end, float)]
            if (was is None) != (now is None) or not _same_ends(
                was or (), now or (), 0.02, float(np.mean(ends or [0.0]))
            ):
                yield f"{name} over alternatives: {was} → {now}"


def _chi_squared(old: float, new: float) -> Iterator[str]:
    if not new <= old + max(0.02, 1e-6 * old):
        yield f"χ²: {old} → {new}, above what it was"


def _parameters(name: str, old: Any, new: Any) -> Iterator[str]:
    """Yield values that differ by more than 0.05 bounds, and ends by 2 % of their distance."""
    if old.keys() != new.keys():
        yield f"{name}: {sorted(old)} → {sorted(new)}"
        return
    tolerance = 0.05 if "adhesion" in name else 0.02
    for parameter, (value, *ends, bound) in old.items():
        now, *ends_now, _ = new[parameter]
        if bound is not None and not abs(now - value) <= 0.05 * bound + 1e-9 * abs(value):
            yield f"{name}, {parameter}: {value} → {now} (bound {bound})"
        if not _same_ends(ends, ends_now, tolerance, value):
            yield f"{name}, {parameter}: {ends} → {ends_now}"


def _same_ends(old: Any, new: Any, tolerance: float, value: float) -> bool:
    """Return whether ends are as far from a value, to a tolerance; what is no number is equal."""
    return all(
        was == now
        if not isinstance(was, float) or not isinstance(now, float)
        else abs(now - was) <= tolerance * abs(was - value) + 1e-9 * abs(was)
        for was, now in zip(old, new, strict=True)
    )


def table_changes(name: str, old: Any, new: Any) -> Iterator[str]:
    """Yield differences of a column: its unit, where it has no number, and its numbers."""
    if old["unit"] != new["unit"]:
        yield f"unit {old['unit']} → {new['unit']}"
    before, now = old["values"], new["values"]
    if before is None or now is None:
        if before != now:
            yield "numbers and texts"
        return
    if [v is None for v in before] != [v is None for v in now]:
        yield f"{before} → {now}"
        return
    pairs = [(a, b) for a, b in zip(before, now, strict=True) if a is not None]
    # Ends and bounds are of the size of a column, which a contact point is far from.
    size = float(np.ptp([a for a, _ in pairs] or [0.0])) or max(
        (abs(a) for a, _ in pairs), default=0.0
    )
    if any(abs(a - b) > 2e-3 * max(abs(a), size) for a, b in pairs):
        yield f"{before} → {now}"


# --- The layers ------------------------------------------------------------------------------

Changes = Callable[[Any, Any], Iterator[str]]
LAYERS: dict[str, tuple[Callable[[], Iterator[tuple[str, Any]]], Callable[[str], Changes]]] = {
    "forces": (forces, lambda name: force_changes),
    "chi_squared": (
        chi_squared,
        lambda name: partial(number_changes, 1e-3 if name.endswith("condensed") else 1e-9),
    ),
    "noise": (noise, lambda name: partial(number_changes, 1e-9)),
    "fits": (lambda: ((name, fit(name)) for name in CASES), lambda name: fit_changes),
    "tables": (tables, lambda name: partial(table_changes, name)),
}
"""Layers of the freeze: what yields their entries, and what compares two of a name."""


def differences(layer: str, old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Return what differs between entries of a layer beyond its tolerance."""
    changes = LAYERS[layer][1]
    texts = [f"{name}: is gone" for name in old if name not in new]
    texts += [f"{name}: is new" for name in new if name not in old]
    for name in old.keys() & new.keys():
        texts += [f"{name}: {text}" for text in changes(name)(old[name], rounded(new[name]))]
    return texts


def rounded(value: Any) -> Any:
    """Return JSON data with numbers of ten digits; forces have theirs already."""
    if isinstance(value, float):
        return _digits(value, 14 if value == round(value, 11) else 10)
    if isinstance(value, dict):
        return {name: rounded(item) for name, item in value.items()}
    return [rounded(item) for item in value] if isinstance(value, list) else value


def _digits(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")
