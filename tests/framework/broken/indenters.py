"""Indenters that break their contract."""

from itertools import count
from typing import Any

import numpy as np

import pellicle as pl
from tests.framework.broken.catalogue import Broken, Family, Refused, Taken, base, run

Indenter: Any = base("indenter", "paraboloid")


def _run(indenter: Any, _: Any) -> str:
    return run(indenter=indenter)


def below_the_highest(f: Any, x: Any, y: Any) -> Any:
    return f(x, y) - f(x, y).max()


def hovering_punch(f: Any, x: Any, y: Any) -> Any:
    return np.where(x**2 + y**2 < 1e-8, -1e-9, -np.inf)


def curve(fault: str, method: Any) -> Broken:
    """Return an indenter with another force curve, of which no run knows."""
    return Broken(fault, Taken("a fit has guards of its own"), force_curve=method)


LOOKS, ONCE = count(1), Taken("a run looks once")
GIVEN = Refused("read-only", error=ValueError)
NOWHERE = Refused("lies over no cell centre", error=pl.ConfigError)
SUMMIT = Taken("the lowest point may lie between the cells")
POSITIVE = Refused("has values that are positive or NaN", error=pl.ConfigError)
HOVERS = Refused("highest value of profile(x, y) is -1", "it has to be 0 at the lowest point")
BROKEN: dict[str, Any] = {
    "profile_is_accepted": [
        Broken("footprint", Refused("'Domain'; it has to be 'unbounded'"), footprint="Domain"),
        Broken("complex", Refused("complex128"), profile=lambda f, x, y: f(x, y) + 0j),
        Broken("in a row", Refused("shape (12, 10)"), profile=lambda f, x, y: f(x, y).ravel()),
        Broken("heights upwards", POSITIVE, profile=lambda f, x, y: -f(x, y)),
        Broken("unknown", POSITIVE, profile=lambda f, x, y: np.where(x > 5e-5, np.nan, f(x, y))),
        Broken("nowhere", NOWHERE, profile=lambda f, x, y: np.full_like(x + y, -np.inf)),
        Broken(
            "roughness that hovers",
            HOVERS,
            footprint="domain",
            profile=lambda f, x, y: 1e-6 * (np.cos(3e4 * x) * np.cos(3e4 * y) - 1) - 1e-5,
        ),
        Broken("grows", ONCE, profile=lambda f, x, y: f(x, y) * (1 + 1e-9 * next(LOOKS))),
        Broken("moves", GIVEN, profile=lambda f, x, y: f(np.subtract(x, 1e-6, out=x), y)),
    ],
    "lowest_point_is_at_zero": [
        Broken("hovers by little", SUMMIT, profile=lambda f, x, y: f(x, y) - 1e-8),
        Broken("hovers", HOVERS, profile=lambda f, x, y: f(x, y) - 1e-5),
        Broken("punch", HOVERS, profile=hovering_punch),
    ],
    "heights_depend_on_their_own_point": Broken(
        "depends on all points", Taken("a run has one grid"), profile=below_the_highest
    ),
    "run_converges": Broken(
        "hovers over all",
        SUMMIT,
        footprint="domain",
        profile=lambda f, x, y: f(x, y) - 0.05 * np.ptp(f(x, y)),
    ),
    "force_curve_rises": [
        curve("force alone", lambda f, *at: f(*at).force),
        curve("a force too few", lambda f, *at: f(*at)._replace(force=f(*at).force[:-1])),
        curve("sensitivity unknown", lambda f, *at: f(*at)._replace(by_length=np.nan * at[0])),
        curve("sensitivity forgotten", lambda f, *at: f(*at)._replace(by_length=0 * at[0])),
        curve("moves the depths", lambda f, depth, a: f(np.maximum(depth, 0, out=depth), a)),
    ],
}
INDENTERS = Family(Indenter, {"radius": 1e-3}, {"run": _run}, ("run",), BROKEN)
