"""Corrections of the area of contact that break their contract."""

from typing import Any

import numpy as np

from tests.framework.broken.catalogue import GRID, Broken, Family, Refused, Taken, base, run

Correction: Any = base("correction", "yastrebov")
NEAR = Taken("a run asks only whether the area is between 0 and that of the domain")
GIVEN, NONE = Refused("read-only", error=ValueError), Refused("between 0 and 0 m², without contact")


def _on(boundary: str) -> Any:
    parts: Any = {"grid": GRID | {"boundary": boundary}, "loading": {"force": "10 nN"}}
    return lambda correction, _: run(corrections=[correction], **parts)


def _apart(correction: Any, _: Any) -> str:
    return run(corrections=[correction], loading={"depth": 0.0})


def constant(fault: str, area: Any, *words: str) -> Broken:
    """Return a correction whose area is always the same."""
    return Broken(fault, Refused(*words), area=lambda f, c, h, b: area)


def across_x(f: Any, c: Any, h: Any, b: Any) -> Any:
    return h[0] * h[1] * (np.count_nonzero(c) - 0.1 * np.count_nonzero(c[1:] != c[:-1]))


# Methods take contact c, spacing h [m] and boundary b.
BROKEN: dict[str, Any] = {
    "no_contact_has_no_area": [
        *(constant(repr(value), value, "a real number") for value in (np.nan, "1 mm^2", True)),
        Broken(
            "marks cells",
            GIVEN,
            "free",
            area=lambda f, c, h, b: f(np.logical_or(c, 1, out=c), h, b),
        ),
        constant("negative", -1.0, "-1 m²; it has to be between 0 and 4.8e-08 m²"),
        constant("a square metre", 1.0, "1 m²; it has to be between 0 and 4.8e-08 m²"),
        Broken("one cell", NONE, "apart", area=lambda f, c, h, b: max(f(c, h, b), h[0] * h[1])),
    ],
    "full_contact_is_the_domain": Broken("less", NEAR, area=lambda f, c, h, b: 0.99 * f(c, h, b)),
    "area_is_near_the_count": Broken(
        "twice", NEAR, area=lambda f, c, h, b: f(c, h, b) * (1 + (0 < c.mean() < 1))
    ),
    "area_scales_with_the_cells": Broken(
        "takes off cells of a size that it knows",
        NEAR,
        area=lambda f, c, h, b: f(c, h, b) - 1e-12 * (0 < c.mean() < 1) * (h[0] * h[1] > 1e-12),
    ),
    "area_does_not_depend_on_the_view": Broken("boundaries across x", NEAR, area=across_x),
    "periodic_area_has_no_seam": Broken(
        "edge is a border", NEAR, area=lambda f, c, h, b: f(c, h, "free")
    ),
    "goes_into_the_result": Broken(
        "ignores wide cells", NEAR, area=lambda f, c, h, b: f(c, h, b) if h[0] < 3e-5 else 0.0
    ),
}
CORRECTIONS = Family(
    Correction,
    {},
    {"free": _on("free"), "periodic": _on("periodic"), "apart": _apart},
    ("free", "periodic"),
    BROKEN,
)
