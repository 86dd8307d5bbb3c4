"""Interactions that break their contract."""

from itertools import count
from typing import Any, Literal

import numpy as np

from tests.framework.broken.catalogue import Broken, Family, Refused, Taken, base, run

Linear: Any = base("interaction", "linear")
WORK, RANGE = 0.05, 2e-6


class Law(Linear):
    """Linear softening to be broken."""

    type: Literal["broken"] = "broken"


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


CALLS = count(1)
GIVEN, ROUNDING = Refused("read-only", error=ValueError), Taken("it is rounding")
NAN, REPELS = Refused("slope(gap) has values that are NaN"), Refused("repels; it has to be ≤ 0")
LEFT = Refused("energy(gap) is", "J/m² at the cutoff of", "m; it has to be 0 there")
STRONGEST = Refused("traction(gap) grows from", "the attraction has to be strongest at a closed")
NO_DERIVATIVE = Refused("traction(gap) is not −dγ/dg of energy(gap)")
BROKEN: dict[str, Any] = {
    "cutoff_is_a_length": Broken("far", Refused("cutoff() is inf m"), cutoff=lambda f: np.inf),
    "closed_gap_attracts": [
        Broken("energy", Refused("energy(0) is 0 J/m²"), energy=lambda f, gap: f(gap) + WORK),
        Broken("strongest late", STRONGEST, traction=late_traction, energy=late_energy),
    ],
    "values_are_finite": Broken(
        "no slope at a closed gap", NAN, slope=lambda f, gap: np.where(gap > 0, f(gap), np.nan)
    ),
    "values_are_vectorised": [
        Broken("mean energy", LEFT, energy=lambda f, gap: np.full_like(gap, f(gap).mean())),
        Broken("traction in a list", Taken("it is as good"), traction=lambda f, g: f(g).tolist()),
    ],
    "functions_leave_their_argument": [
        Broken("moves", GIVEN, energy=lambda f, g: f(np.sqrt(g, out=g))),
        Broken("tires", ROUNDING, traction=lambda f, g: f(g) * (1 - 1e-15 * next(CALLS))),
    ],
    "energy_rises_to_nothing": Broken("ends early", LEFT, cutoff=lambda f: f() / 2),
    "attraction_falls_with_the_gap": [
        Broken("pushes late", REPELS, traction=lambda f, gap: f(gap) + 50 * (gap > 0.9 * RANGE)),
        Broken("pulls late", STRONGEST, traction=lambda f, gap: f(gap) - 500 * (gap > 0.5 * RANGE)),
    ],
    "rigid_sphere_is_pulled_by_2_pi_w_r": Broken(
        "pulls twice as much as its energy says",
        NO_DERIVATIVE,
        traction=lambda f, gap: 2 * f(gap),
        slope=lambda f, gap: 2 * f(gap),
    ),
    "traction_is_the_derivative_of_the_energy": Broken(
        "traction of another law", NO_DERIVATIVE, traction=lambda f, g: -WORK / RANGE * (g < RANGE)
    ),
    "slope_is_the_derivative_of_the_traction": Broken(
        "slope of another", Refused("is not dσ/dg of traction(gap)"), slope=lambda f, g: 0.9 * f(g)
    ),
    "resolved_keeps_the_work_of_adhesion": Broken(
        "weaker on a grid",
        Taken("a run has no other work of adhesion than that of the law on its grid"),
        resolved=lambda f, kernel, grid: Law(work_of_adhesion=0.99 * WORK, range=RANGE),
    ),
    "run_under_a_pull_converges": Broken(
        "cannot be resolved on some grids",
        Refused("has no attribute", "interaction 'broken' failed", error=AttributeError),
        resolved=lambda f, *given: f(*given) if given[1].shape[0] in (16, 256) else None,
    ),
}
SETTINGS = {"work_of_adhesion": WORK, "range": RANGE}
INTERACTIONS = Family(Law, SETTINGS, {"run": _run}, ("run",), BROKEN)
