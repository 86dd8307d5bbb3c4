"""What is frozen of fits, in layers of their own tolerances, and what counts as a change."""

from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from typing import Any

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
FAR = 30.0
"""ΔAIC over the best beyond which a minimum may be rough."""
GAIN = 2.05
"""ΔAIC by which a pair has to be ahead of its parts, and a rounding."""
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
    """Return what the fit of a case answers."""
    return reader.fit(CASES[name])


def _excluded(curve: Case, effects: Collection[str]) -> bool:
    """Return whether a model is of those that are not frozen, by the list in `not_frozen`."""
    unloads = curve.options.get("segment") == "both"
    return unloads and "tension" in effects and not RELAXING.isdisjoint(effects)


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
    """Yield differences of the answers of a fit, each part with its own tolerance."""
    for name in ("failed", "explanations"):
        if sorted(old[name]) != sorted(new[name]):
            yield f"{name}: {sorted(old[name])} → {sorted(new[name])}"
    # A minimum that differs by 0.02 in χ² has another scatter.
    for was, now in zip(old["noise"], new["noise"], strict=True):
        yield from (f"noise: {text}" for text in number_changes(1e-4, was, now))
    yield from (f"threshold: {t}" for t in number_changes(1e-4, old["threshold"], new["threshold"]))
    aic = {name: known["delta_aic"] for name, known in old["explanations"].items()}
    least = min(aic.values())
    for name in old["explanations"].keys() & new["explanations"].keys():
        was, now = old["explanations"][name], new["explanations"][name]
        # What is far behind, or no better than nothing or than its parts, is not sought to the end.
        known = [aic[part] for part in ("none", *name.split(" + ")) if part in aic]
        idle = now["given_up"] and aic[name] > min(known) - GAIN
        if not idle and aic[name] - least < FAR and now["delta_aic"] > was["delta_aic"] + 0.05:
            yield f"{name}: ΔAIC {was['delta_aic']} → {now['delta_aic']}, above what it was"
        if name == old["chosen"]:
            yield from _parameters(name, was["parameters"], now["parameters"])
    for name in ("verdict", "chosen", "tied"):
        if old[name] != new[name]:
            yield f"{name}: {old[name]} → {new[name]}"
    yield from _parameters("over what is tied", old["over_tied"], new["over_tied"])


def _parameters(name: str, old: Any, new: Any) -> Iterator[str]:
    """Yield values and ends that differ by 2 % of the reach of their interval."""
    if old.keys() != new.keys():
        yield f"{name}: {sorted(old)} → {sorted(new)}"
        return
    for parameter, (value, *ends) in old.items():
        # An interval that is open below reaches from 0.
        middle = next((known for known in (value, ends[0]) if known is not None), 0.0)
        reach = max((abs(end - middle) for end in ends if end is not None), default=0.0)
        for was, now in zip(old[parameter], new[parameter], strict=True):
            both = was is not None and now is not None
            if not (both and abs(now - was) <= 0.02 * reach + 1e-6 * abs(was)) and was is not now:
                yield f"{name}, {parameter}: {old[parameter]} → {new[parameter]}"
                break


# --- The layers ------------------------------------------------------------------------------

Changes = Callable[[Any, Any], Iterator[str]]
LAYERS: dict[str, tuple[Callable[[], Iterator[tuple[str, Any]]], Changes]] = {
    "forces": (forces, force_changes),
    "chi_squared": (chi_squared, partial(number_changes, 1e-9)),
    "noise": (noise, partial(number_changes, 1e-9)),
    "fits": (lambda: ((name, fit(name)) for name in CASES), fit_changes),
}
"""Layers of the freeze: what yields their entries, and what compares two of a name."""


def differences(layer: str, old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Return what differs between entries of a layer beyond its tolerance."""
    changes = LAYERS[layer][1]
    texts = [f"{name}: is gone" for name in old if name not in new]
    texts += [f"{name}: is new" for name in new if name not in old]
    for name in old.keys() & new.keys():
        texts += [f"{name}: {text}" for text in changes(old[name], rounded(new[name]))]
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
