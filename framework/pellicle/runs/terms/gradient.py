"""Derivatives of force and depth by heights, and by numbers of the kernel and the indenter.

On the contact A p = f + δ. With r = dp/dδ, the pressure of a flat punch on it, a change of the
profile by df and of the operator by dA changes the force by dF = Δ² Σ r (df − dA p), Δ² being the
area of a cell. A law whose traction follows the gap off the contact changes nothing in this, since
the answer of the surface is symmetric. No more is solved than for the stiffness k = Δ² Σ r.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final

import numpy as np

from pellicle.arrays import Array
from pellicle.components import Depth, Search, Setting
from pellicle.components.calls import profile_of, target_of
from pellicle.components.kernel import Kernel, instantaneous
from pellicle.config.gradient import HEIGHTS
from pellicle.config.run import Run
from pellicle.contact.masks import dilate
from pellicle.errors import ConfigError
from pellicle.runs.differences import differences
from pellicle.schema.model import get, python_names, with_value
from pellicle.surface.from_kernel import operator_of
from pellicle.surface.operators import weighted_sum

from . import ContactStep, Surroundings
from .extra_measures import add_response

_WAVES: Final = 24
_WIDER: Final = 1.5


class Gradient:
    """What the derivatives of a run need, made once; what has none is refused."""

    def __init__(self, run: Run, setting: Setting) -> None:
        self.names = python_names(run.gradient or ())
        self._changes: dict[str, Callable[[Array], Array]] = {}
        self._searches = False
        if not self.names:
            return
        loading = run.indentation.loading
        for path in self.names:
            if path != HEIGHTS:
                of = _of_operator if path.startswith("kernel.") else _of_profile
                self._changes[path] = of(run, setting, path)
        # A search for nothing, as for no area, may be no search.
        prescription, values = loading.prescription, loading.values
        ends = [target_of(prescription, setting, v) for v in (values[0], values[-1])]
        self._searches = any(isinstance(target, Search) for target in ends)
        if all(path.startswith("kernel.") for path in self.names) or self._searches:
            return
        higher = replace(setting, profile=_WIDER * setting.profile)
        if target_of(prescription, higher, values[0]) != ends[0]:
            raise ConfigError(
                f"{prescription.type_name} depends on the heights of the indenter itself; "
                "prescribe depth or force",
                "gradient",
            )

    def add(self, run: Run, step: ContactStep, surroundings: Surroundings) -> ContactStep:
        """Add the derivatives of a step, with what is prescribed kept; NaN if it is not solved.

        A search keeps the depth where it tells the force, and the force where it tells the depth.
        """
        step = add_response(run, step, surroundings)
        assert step.response
        (response, k), equilibrium = step.response, step.equilibrium
        control, cell = equilibrium.problem.control, run.grid.cell_area
        known = step.converged and (equilibrium.contact.any() or not equilibrium.zone.any())
        keeps_depth = isinstance(control, Depth)
        compliance = control.compliance if isinstance(control, Depth) else 0.0
        derivatives: dict[str, Array] = {}
        for path, name in self.names.items():
            change = response
            if path in self._changes:
                # Off the contact no change is needed, and a profile may have none.
                change = self._changes[path](equilibrium.pressure)
                change = np.where(response != 0, response * change, 0.0).sum()
            with np.errstate(all="ignore"):
                # On its spring, or at a fixed depth; the depth at a fixed force.
                force = cell * change / (1 + k * compliance) if np.isfinite(k) else np.nan * change
                depth = -change / response.sum()
            force, depth = (
                force if keeps_depth or self._searches else 0.0 * change,
                depth if not keeps_depth or self._searches else 0.0 - compliance * force,
            )
            derivatives[f"force_by_{name}"] = force if known else np.nan * force
            derivatives[f"depth_by_{name}"] = depth if known else np.nan * depth
        return step.with_measures(
            {name: float(value) for name, value in derivatives.items() if np.ndim(value) == 0},
            fields={name: value for name, value in derivatives.items() if np.ndim(value)},
        )


def _of_operator(run: Run, setting: Setting, path: str) -> Callable[[Array], Array]:
    """Return −(dA/dθ) p as a function of p, by a number θ of the kernel."""
    longest, finest = 2 * np.pi / max(run.grid.size), np.pi / min(run.grid.spacing)
    q = np.geomspace(longest, finest, _WAVES)

    def solid(value: float) -> Kernel:
        return instantaneous(with_value(run.kernel, path.removeprefix("kernel."), value))

    def waves(value: float) -> Array:
        symbol, nothing = solid(value).symbol, np.zeros_like(q)
        logarithms: Array = np.log(np.concatenate([symbol(q, nothing), symbol(nothing, q)]))
        return logarithms

    nodes, weights = _differences(run, path, waves, 1.0)
    return weighted_sum([operator_of(solid(value), run.grid) for value in nodes], [*-weights])


def _of_profile(run: Run, setting: Setting, path: str) -> Callable[[Array], Array]:
    """Return df/dθ by a number θ of the indenter, whatever p; NaN at an edge that moves with it."""
    finite = np.isfinite(setting.profile)
    size = float(np.ptp(setting.profile[finite])) or max(run.grid.size)

    def profile(value: float) -> Array:
        return profile_of(with_value(run.indenter, path.removeprefix("indenter."), value), run.grid)

    def heights(value: float) -> Array:
        return np.where(np.isfinite(shape := profile(value)), shape, setting.profile)[finite]

    nodes, weights = _differences(run, path, heights, size)
    change = np.full(run.grid.shape, np.nan)
    change[finite] = sum(w * heights(v) for v, w in zip(nodes, weights, strict=True))
    edge = finite & dilate(~finite, run.grid.boundary)
    if edge.any() and _moves_edge(profile, get(run, path), finite):
        change[edge] = np.nan
        if (edge & (setting.profile == setting.profile.max())).any():
            raise _undefined(run, path, "moves the edge of a flat end, by whole cells")
    return lambda _: change


def _moves_edge(profile: Callable[[float], Array], value: float, finite: Array) -> bool:
    """Return whether the indenter ends elsewhere for another value, or cannot have that value."""
    try:
        ends = [np.isfinite(profile(value * factor)) for factor in (_WIDER, 1 / _WIDER)]
    except ConfigError:
        return True
    return any((end != finite).any() for end in ends)


def _differences(
    run: Run, path: str, values: Callable[[float], Array], size: float
) -> tuple[Array, Array]:
    """Return the nodes and weights of a number of the run; refuse one without a derivative."""
    try:
        return differences(values, float(get(run, path)), size)
    except ValueError as error:
        raise _undefined(run, path, str(error)) from None


def _undefined(run: Run, path: str, reason: str) -> ConfigError:
    field = f"gradient.{(run.gradient or ()).index(path)}"
    reason = f"{path!r} {reason}, so it has no derivative on these cells; leave it out"
    return ConfigError(reason, field)
