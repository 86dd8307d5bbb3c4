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
from pellicle.components.indenter import profile_of
from pellicle.components.kernel import Kernel, instantaneous
from pellicle.components.prescription import target_of
from pellicle.config.gradient import HEIGHTS, all_derivatives
from pellicle.config.run import Run
from pellicle.contact.load_step import LoadStep
from pellicle.contact.masks import dilated
from pellicle.errors import ConfigError
from pellicle.runs.differences import differences
from pellicle.schema.model import get, python_names, with_value
from pellicle.surface.from_kernel import operator_of
from pellicle.surface.operators import Derivative

from . import Surroundings
from .requested import responding

_WAVES: Final = 24
_WIDER: Final = 1.5


class Gradient:
    """What the derivatives of a run need, made once; what has none is refused."""

    def __init__(self, run: Run, setting: Setting) -> None:
        self.paths = run.gradient or ()
        self._operators = {p: _of_operator(run, p) for p in self.paths if p.startswith("kernel.")}
        self._profiles = {
            p: _of_profile(run, setting, p) for p in self.paths if p.startswith("indenter.")
        }
        if self.paths:
            # A search for nothing, as for no area, may be no search.
            ends = {run.loading.values[0], run.loading.values[-1]}
            targets = [target_of(run.loading.prescription, setting, value) for value in ends]
            self._searches = any(isinstance(target, Search) for target in targets)
            if HEIGHTS in self.paths or self._profiles:
                _refuse_target_of_heights(run, setting)

    def add(self, run: Run, step: LoadStep, surroundings: Surroundings) -> LoadStep:
        """Add the derivatives of a step, with what is prescribed kept; NaN if it is not solved.

        A search keeps the depth where it tells the force, and the force where it tells the depth.
        """
        step = responding(run, step, surroundings)
        assert step.response
        equilibrium, k = step.equilibrium, step.response.stiffness.value
        response, cell = step.response.pressure, run.grid.cell_area
        contact, control = equilibrium.contact, equilibrium.problem.control
        known = step.converged and (contact.any() or not equilibrium.zone.any())
        compliance = control.compliance if isinstance(control, Depth) else 0.0
        measures: dict[str, float] = {}
        fields: dict[str, Array] = {}
        for variable in all_derivatives(run):
            quantity, _, name = variable.name.partition("_by_")
            path = next(p for p, n in python_names(self.paths).items() if n == name)
            # At a fixed depth, and of the depth at a fixed force; any multiple of r serves that.
            at_depth = self._force_by(path, response, equilibrium.pressure, cell)
            with np.errstate(all="ignore"):
                at_force = -at_depth / (response.sum() * cell)
            if quantity == "force":
                value = at_depth / (1 + k * compliance) if np.isfinite(k) else at_depth * np.nan
                value = value * (self._searches or isinstance(control, Depth))
            elif self._searches or not isinstance(control, Depth):
                value = at_force
            else:
                value = 0.0 - compliance * at_depth / (1 + k * compliance)
            value = value if known else value * np.nan
            if path == HEIGHTS:
                fields[variable.name] = np.asarray(value)
            else:
                measures[variable.name] = float(value)
        return step.having(measures, fields=fields)

    def _force_by(self, path: str, response: Array, pressure: Array, cell: float) -> Array:
        """Return the derivative of the force at a fixed depth: a number, or a field by heights."""
        if path == HEIGHTS:
            return cell * response
        if path in self._profiles:
            # The profile has no derivative where its edge moves; off the contact none is needed.
            change = self._profiles[path]
            return np.asarray(cell * np.where(response != 0, response * change, 0.0).sum())
        return np.asarray(-cell * (response * self._operators[path](pressure)).sum())


def _of_operator(run: Run, path: str) -> Callable[[Array], Array]:
    """Return dA/dθ by a number θ of the kernel, from operators of its neighbours."""
    longest, finest = 2 * np.pi / max(run.grid.size), np.pi / min(run.grid.spacing)
    q = np.geomspace(longest, finest, _WAVES)

    def solid(value: float) -> Kernel:
        return instantaneous(with_value(run.kernel, path.removeprefix("kernel."), value))

    def waves(value: float) -> Array:
        symbol, nothing = solid(value).symbol, np.zeros_like(q)
        logarithms: Array = np.log(np.concatenate([symbol(q, nothing), symbol(nothing, q)]))
        return logarithms

    nodes, weights = _differences(run, path, waves, 1.0)
    return Derivative((operator_of(solid(value), run.grid) for value in nodes), weights)


def _of_profile(run: Run, setting: Setting, path: str) -> Array:
    """Return df/dθ by a number θ of the indenter; NaN at an edge that moves with it."""
    finite = np.isfinite(setting.profile)
    size = float(np.ptp(setting.profile[finite])) or max(run.grid.size)

    def profile(value: float) -> Array:
        return profile_of(with_value(run.indenter, path.removeprefix("indenter."), value), run.grid)

    def heights(value: float) -> Array:
        return np.where(np.isfinite(shape := profile(value)), shape, setting.profile)[finite]

    nodes, weights = _differences(run, path, heights, size)
    change = np.full(run.grid.shape, np.nan)
    change[finite] = sum(w * heights(v) for v, w in zip(nodes, weights, strict=True))
    edge = finite & dilated(~finite, run.grid.boundary)
    if edge.any() and _moves_edge(profile, get(run, path), finite):
        change[edge] = np.nan
        if (edge & (setting.profile == setting.profile.max())).any():
            raise _undefined(run, path, "moves the edge of a flat end, by whole cells")
    return change


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


def _refuse_target_of_heights(run: Run, setting: Setting) -> None:
    """Refuse a prescription whose depth or force depends on the heights of the indenter."""
    prescription, value = run.loading.prescription, run.loading.values[0]
    targets = [
        target_of(prescription, replace(setting, profile=scale * setting.profile), value)
        for scale in (1.0, _WIDER)
    ]
    if not isinstance(targets[0], Search) and targets[0] != targets[1]:
        raise ConfigError(
            f"{prescription.type_name} depends on the heights of the indenter itself; prescribe "
            "depth or force",
            "gradient",
        )


def _undefined(run: Run, path: str, reason: str) -> ConfigError:
    index = (run.gradient or ()).index(path)
    return ConfigError(
        f"{path!r} {reason}, so it has no derivative on these cells; leave it out",
        f"gradient.{index}",
    )
