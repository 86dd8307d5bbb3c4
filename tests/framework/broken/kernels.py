"""Kernels that break their contract."""

from itertools import count
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

import pellicle as pl
from pellicle.units import Modulus
from tests.framework.broken.catalogue import GRID, RULE, Broken, Family, Refused, Taken, base, run

Kernel: Any = base("kernel", "half_space")


class Relaxing(Kernel):
    """Half-space half of which relaxes in a second."""

    def branches(self) -> Any:
        return ((0.5, 1.0),)

    def scaled(self, share: float) -> Any:
        return pl.kernel("half_space", reduced_modulus=share * self.reduced_modulus)

    def without_skin(self) -> Any:
        return self


class WithoutForm(pl.Isotropic):
    """Half-space without a closed form."""

    type: Literal["broken"] = "broken"
    reduced_modulus: Annotated[Modulus, Field(description="E* [Pa]")]

    def compliance(self, q: Any) -> Any:
        return 2 / (self.reduced_modulus * q)


def _on(boundary: str) -> Any:
    return lambda kernel, _: run(kernel=kernel, grid=GRID | {"boundary": boundary})


def _relaxes(kernel: Any, _: Any) -> str:
    return run(kernel=kernel, loading={"depth": ["2 um", "2 um"], "time": [0, 1]})


def hole(fault: str, wave: float) -> Broken:
    """Return a kernel that is NaN at one wave [rad/m], which the run here does not have."""
    return Broken(
        fault, OTHERS, compliance=lambda f, q: np.where(abs(q / wave - 1) < 1e-6, np.nan, f(q))
    )


def bad(fault: str, value: float) -> Broken:
    """Return a kernel with one bad value between two wavenumbers."""
    return Broken(fault, RULE, compliance=lambda f, q: np.where((q > 5e4) & (q < 8e4), value, f(q)))


def relaxing(fault: str, run: Refused | Taken = RULE, **members: Any) -> Broken:
    """Return a kernel that relaxes in another way."""
    return Broken(fault, run, "relaxes", good=Relaxing, **members)


def form(fault: str, run: Refused | Taken = RULE, **members: Any) -> Broken:
    """Return a kernel whose closed form is another."""
    return Broken(fault, run, **members)


def _over_step(kernel: Any) -> float:
    """Return the modulus over one that stays the same within 0.8 % of 10 kPa."""
    share: float = kernel.reduced_modulus / 1e4
    return share if abs(share - 1) < 8e-3 else 1.0


ANSWERS = count(1)
OTHERS = Taken("this grid has no such wave")
BRANCHES = Refused("branches() returned (Branch(", "shares and times have to be positive and")
ARRAY = Refused("kernel 'broken': compliance(q) returned a", "return an array of float64 of shape")
LIST = Refused("kernel 'broken' failed", error=TypeError)
PLACE = Refused("read-only", "kernel 'broken' failed", error=ValueError)
MEAN = Refused("mean_compliance() returned 'infinite'", "a real number")
BROKEN: dict[str, Any] = {
    "values_are_of_their_argument_alone": [
        Broken("transpose", ARRAY, compliance=lambda f, q: f(q).T),
        Broken("whole numbers", ARRAY, compliance=lambda f, q: np.ceil(f(q)).astype(int)),
        Broken("masked", ARRAY, compliance=lambda f, q: np.ma.masked_array(f(q), q > np.median(q))),
        Broken("looks at all waves", RULE, compliance=lambda f, q: f(q) * (1 + 1e-6 * q / q.max())),
        Broken("works in place", PLACE, compliance=lambda f, q: f(np.multiply(q, 2, out=q))),
        form("form in place", PLACE, greens_function=lambda f, r: f(np.multiply(r, 2, out=r))),
    ],
    "symbol_is_even_and_broadcast": [
        Broken("odd", RULE, symbol=lambda f, qx, qy: f(qx, qy) * (1 + 0.1 * (qx > 0))),
        Broken("another along y", RULE, symbol=lambda f, qx, qy: f(qx, 2 * qy)),
    ],
    "compliance_is_positive_and_finite": [
        *(bad(fault, value) for fault, value in (("zero", 0.0), ("nan", np.nan))),
        Broken("text", RULE, compliance=lambda f, q: np.full(q.shape, "stiff")),
        Broken("short", OTHERS, compliance=lambda f, q: np.where(q > 1e7, np.nan, f(q))),
    ],
    "compliance_does_not_grow_for_short_waves": [
        Broken("softer to shorter waves", RULE, compliance=lambda f, q: q * 1e-12),
        Broken("overflows", RULE, compliance=lambda f, q: 1e-12 * q**20),
    ],
    "runs_converge": [
        hole("nan at a wave of one grid", np.sqrt(2) * 2e3 * np.pi),
        hole("nan at a wave of one preconditioner", 1.5e3 * np.pi),
    ],
    "closed_form_is_whole": form(
        "half of a closed form", good=WithoutForm, greens_function=lambda f, r: 1e-5 / r
    ),
    "primitive_is_the_integral_of_the_closed_form": [
        form("primitive too large", radial_primitive=lambda f, r: 1.01 * f(r)),
        form("shifted form", radial_primitive=lambda f, r: f(r) + 1e-12),
        form("form of half the value", greens_function=lambda f, r: 0.5 * f(r)),
    ],
    "closed_form_is_the_transform_of_the_compliance": [
        form(
            "closed form of another solid",
            greens_function=lambda f, r: 1.01 * f(r),
            radial_primitive=lambda f, r: 1.01 * f(r),
        ),
        form("skin forgotten", compliance=lambda f, q: f(q) / (1 + 1e-4 * q)),
    ],
    "free_operator_is_the_transform_of_the_compliance": Broken(
        "primitive of fewer digits for many radii",
        Taken("it is less than a closed form may be off"),
        radial_primitive=lambda f, r: f(r) * (1 + 1e-4 * (r.size > 1000)),
    ),
    "numbers_have_derivatives": form(
        "form in steps",
        Taken("no derivative is asked for"),
        greens_function=lambda f, r: f(r) * _over_step(f.__self__),
        radial_primitive=lambda f, r: f(r) * _over_step(f.__self__),
    ),
    "branches_have_shares_and_times": [
        relaxing("overdrawn", BRANCHES, branches=lambda f: ((0.5, 1.0), (0.6, 2.0))),
        relaxing("relaxes in no time", BRANCHES, branches=lambda f: ((0.5, 0.0),)),
    ],
    "scaled_by_one_is_the_kernel": [
        relaxing("relaxes on", scaled=lambda f, share: Relaxing(reduced_modulus=1e4)),
        Broken("mean in words", MEAN, mean_compliance=lambda f: "infinite"),
        Broken("fickle mean", RULE, mean_compliance=lambda f: 1e-6 * next(ANSWERS)),
        Broken("values in a list", LIST, compliance=lambda f, q: f(q).tolist()),
        relaxing("softer when scaled by one", scaled=lambda f, share: f(0.99 * share)),
    ],
    "scaled_stiffens_the_solid_alone": relaxing(
        "skin is scaled", without_skin=lambda f: Relaxing(reduced_modulus=5e3)
    ),
    "without_skin_has_no_skin": relaxing(
        "elastic solid", without_skin=lambda f: pl.kernel("half_space", reduced_modulus=1e4)
    ),
}
KERNELS = Family(
    Kernel,
    {"reduced_modulus": 1e4},
    {"free": _on("free"), "periodic": _on("periodic"), "relaxes": _relaxes},
    ("free", "periodic"),
    BROKEN,
)
