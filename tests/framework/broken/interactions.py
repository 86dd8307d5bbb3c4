"""Interactions that break their contract."""

from itertools import count
from typing import Any

import numpy as np

from pellicle.errors import ConfigError
from tests.framework.broken.catalogue import Broken, Family, Refused, base, run

Law: Any = base("interaction", "linear")
WORK, RANGE = 0.05, 2e-6


def _run(law: Any, _: Any) -> str:
    return run(
        grid={"points": 32, "size": "0.6 mm"},
        kernel={"type": "half_space", "reduced_modulus": "700 kPa"},
        interaction=law,
        loading={"depth": "5 um"},
        solver={"type": "active_set", "tolerance": 1e-6},
    )


def late_energy(f: Any, gap: Any) -> Any:
    share = np.clip(gap / RANGE, 0, 1)
    return WORK * (3 * share**2 - 2 * share**3 - 1)


def late_traction(f: Any, gap: Any) -> Any:
    share = gap / RANGE
    return -6 * WORK / RANGE * np.clip(share * (1 - share), 0, None)


def opposite(f: Any, gap: Any) -> Any:
    return -f(gap)


CALLS = count(1)
GIVEN, ALONE = (
    Refused("read-only", error=ValueError),
    Refused("among other gaps or when asked again"),
)
NAN = Refused("slope(gap) has values that are NaN")
LEFT = Refused("energy(gap) is", "J/m² at the cutoff of", "m; it has to be 0 there")
NO_DERIVATIVE = Refused("traction(gap) is not −dγ/dg of energy(gap)")
ATTRACTS_LATE = Refused("traction(gap) goes from", "most at a closed gap", error=ConfigError)
BROKEN: dict[str, Any] = {
    "values_are_finite_and_of_their_gap_alone": [
        Broken("far", Refused("cutoff() is inf m"), cutoff=lambda f: np.inf),
        Broken("no slope there", NAN, slope=lambda f, gap: np.where(gap > 0, f(gap), np.nan)),
        Broken("mean energy", ALONE, energy=lambda f, gap: np.full_like(gap, f(gap).mean())),
        Broken("moves", GIVEN, energy=lambda f, g: f(np.sqrt(g, out=g))),
        Broken("tires", ALONE, traction=lambda f, g: f(g) * (1 - 1e-6 * next(CALLS))),
    ],
    "energy_ends_at_the_cutoff": [
        Broken("energy", LEFT, energy=lambda f, gap: f(gap) + WORK),
        Broken("ends early", LEFT, cutoff=lambda f: f() / 2),
    ],
    "traction_is_the_derivative_of_the_energy": [
        Broken(
            "pulls twice as much as its energy says",
            NO_DERIVATIVE,
            traction=lambda f, gap: 2 * f(gap),
            slope=lambda f, gap: 2 * f(gap),
        ),
        Broken("of another law", NO_DERIVATIVE, traction=lambda f, g: -WORK / RANGE * (g < RANGE)),
    ],
    "slope_is_the_derivative_of_the_traction": Broken(
        "slope of another", Refused("is not dσ/dg of traction(gap)"), slope=lambda f, g: 0.9 * f(g)
    ),
    "resolved_keeps_the_work_of_adhesion": Broken(
        "weaker on a grid",
        Refused("resolved(kernel, grid) returns a law of −γ(0) ="),
        resolved=lambda f, kernel, grid: Law(work_of_adhesion=0.99 * WORK, range=RANGE),
    ),
    "run_under_a_pull_converges": [
        Broken(
            "cannot be resolved on some grids",
            Refused("has no attribute", "interaction 'broken' failed", error=AttributeError),
            resolved=lambda f, *given: f(*given) if given[1].shape[0] in (16, 256) else None,
        ),
        Broken(
            *("strongest late", ATTRACTS_LATE),
            energy=late_energy,
            traction=late_traction,
            slope=lambda f, gap: -6 * WORK / RANGE**2 * np.clip(1 - 2 * gap / RANGE, -1, None),
        ),
        Broken("repels", ATTRACTS_LATE, energy=opposite, traction=opposite, slope=opposite),
    ],
}
SETTINGS = {"work_of_adhesion": WORK, "range": RANGE}
INTERACTIONS = Family(Law, SETTINGS, {"run": _run}, ("run",), BROKEN)
