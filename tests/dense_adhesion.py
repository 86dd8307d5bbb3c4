"""Adhesive contact on small grids by a slow descent with dense matrices."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.numerics.gap_law import GapLaw
from pellicle.numerics.problem import Problem

# Share of the old traction that a round keeps, so that a step of the descent is small.
_KEPT = 0.5
# Missed tractions over all tractions at which the descent has settled.
_SETTLED = 1e-10


class DenseState(NamedTuple):
    """The state at the end of a descent; arrays of shape (nx·ny,)."""

    wall: Array
    """Wall pressure [Pa]."""
    traction: Array
    """Traction across the gap [Pa]."""
    depth: float
    """Depth [m]."""
    energy: float
    """Energy [J], minus force times depth under force control."""
    settled: bool
    """Whether the missed tractions are below 10⁻¹⁰ of all."""
    in_contact: bool
    """Whether a force is carried by a contact; true under depth control."""


@dataclass(frozen=True)
class DenseContact:
    """A problem of at most some hundred cells with its full influence matrix."""

    problem: Problem
    law: GapLaw
    matrix: Array
    """Displacement of cell i per pressure on cell j [m/Pa]."""

    @classmethod
    def of(cls, problem: Problem) -> DenseContact:
        """Return the problem with the matrix of its operator, column by column."""
        assert problem.law
        assert not problem.operator.deflection(1.0)
        shape, size = problem.grid.shape, problem.profile.size
        units = np.eye(size).reshape(size, *shape)
        matrix = np.array([problem.operator(unit).ravel() for unit in units]).T
        return cls(problem, problem.law.law, 0.5 * (matrix + matrix.T))

    def descend(self, wall: Array, traction: Array, rounds: int) -> DenseState:
        """Return the end of the descent from tractions across the gap.

        A round closes the contact under tractions between the present ones and those of the law at
        the present gap. The laws are concave, so the energy falls in every round (Yuille &
        Rangarajan 2003).
        """
        contact = wall > 0
        settled = False
        for _ in range(rounds):
            closed = self._closed(traction, contact)
            if closed is None:
                nothing = np.zeros(traction.size)
                return DenseState(nothing, nothing, 0.0, 0.0, True, False)
            wall, depth, gap = closed
            contact = wall > 0
            exerted = self.exerted(gap, contact)
            missed = float(np.abs(exerted - traction).sum())
            magnitude = float(np.abs(wall + traction).sum())
            settled = missed <= _SETTLED * magnitude
            if settled:
                break
            following = _KEPT * traction + (1 - _KEPT) * exerted
            # The wall of a closed cell takes up any change of its traction.
            traction = np.where(contact, exerted, following)
        return DenseState(wall, traction, depth, self.energy(wall, traction, depth), settled, True)

    def gap(self, pressure: Array, depth: float) -> Array:
        """Return u − f − δ [m]."""
        gap: Array = self.matrix @ pressure - self.problem.profile.ravel() - depth
        return gap

    def exerted(self, gap: Array, contact: Mask) -> Array:
        """Return the traction that the law exerts [Pa], −(strength) in contact."""
        reached = gap < self.law.cutoff()
        within = np.where(contact, 0.0, np.clip(gap, 0.0, self.law.cutoff()))
        traction = np.where(reached | contact, self.law.traction(within), 0.0)
        if self.law.needs_contact:
            traction[~self._joined(contact, contact | reached)] = 0.0
        return traction

    def energy(self, wall: Array, traction: Array, depth: float) -> float:
        """Return the energy [J]."""
        pressure = wall + traction
        # A law that needs contact acts where its traction does, any other on every cell.
        acts = (traction != 0) | (not self.law.needs_contact)
        gap = np.clip(self.gap(pressure, depth), 0.0, self.law.cutoff())
        elastic = 0.5 * float(pressure @ self.matrix @ pressure)
        total = elastic + float(self.law.energy(gap[acts]).sum())
        if self.problem.prescribed == "force":
            total -= self.problem.value * depth / self.problem.grid.cell_area
        return total * self.problem.grid.cell_area

    def _joined(self, contact: Mask, reached: Mask) -> Mask:
        """Return the cells of ``reached`` that are joined to a contact along edges."""
        shape = self.problem.grid.shape
        seeds, mask = contact.reshape(shape), reached.reshape(shape)
        wraps = self.problem.grid.boundary == "periodic"
        while True:
            grown = seeds.copy()
            for axis in (0, 1):
                for shift in (-1, 1):
                    moved = np.roll(seeds, shift, axis)
                    if not wraps:
                        edge: list[int | slice] = [slice(None), slice(None)]
                        edge[axis] = 0 if shift == 1 else -1
                        moved[tuple(edge)] = False
                    grown |= moved & mask
            if np.array_equal(grown, seeds):
                return seeds.ravel()
            seeds = grown

    def _closed(self, traction: Array, contact: Mask) -> tuple[Array, float, Array] | None:
        """Return wall pressure, depth and gap of the contact under ``traction``.

        Cells of the wrong sign change sides all at once, then, should that run in a circle, one by
        one (Murty 1974), which ends for every positive definite matrix.
        """
        problem, size = self.problem, traction.size
        depth, force = problem.value, None
        if problem.prescribed == "force":
            force = problem.value / problem.grid.cell_area - float(traction.sum())
            if force <= 0:
                return None
        lifted = self.matrix @ traction - problem.profile.ravel()
        contact = contact.copy()
        if force is not None and not contact.any():
            contact[np.argmin(lifted)] = True
        for change in range(40 + 10 * size):
            cells = np.flatnonzero(contact)
            wall = np.zeros(size)
            if cells.size:
                block = self.matrix[np.ix_(cells, cells)]
                if force is None:
                    wall[cells] = np.linalg.solve(block, depth - lifted[cells])
                else:
                    both = np.ones((2, cells.size))
                    both[0] = lifted[cells]
                    solved, ones = np.linalg.solve(block, both.T).T
                    depth = (force + float(solved.sum())) / float(ones.sum())
                    wall[cells] = depth * ones - solved
            gap = lifted + self.matrix @ wall - depth
            heights = float(np.abs(gap).max()) or 1.0
            wrong = np.flatnonzero(np.where(contact, wall < 0, gap < -1e-13 * heights))
            if not wrong.size:
                return wall, depth, np.where(contact, 0.0, gap)
            contact[wrong if change < 40 else wrong[-1:]] ^= True
        raise RuntimeError("the contact runs in a circle")
