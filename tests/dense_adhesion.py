"""Adhesive contact on small grids by a slow descent with dense matrices."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array, Mask
from pellicle.contact.law import Law
from pellicle.contact.problem import Adhesive, Problem

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

    problem: Adhesive
    law: Law
    matrix: Array
    """Displacement of cell i per pressure on cell j [m/Pa]."""

    @classmethod
    def of(cls, problem: Problem) -> DenseContact:
        """Return the problem with the matrix of its operator, column by column."""
        assert isinstance(problem, Adhesive)
        assert not problem.operator.deflection(1.0)
        shape, size = problem.grid.shape, problem.profile.size
        units = np.eye(size).reshape(size, *shape)
        matrix = np.array([problem.operator(unit).ravel() for unit in units]).T
        return cls(problem, problem.law, 0.5 * (matrix + matrix.T))

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

    @cached_property
    def points(self) -> tuple[Array, NDArray[np.int64]]:
        """The gap of each point at which the law acts per gap of each cell, and the point's cell.

        A law that is averaged acts at the middles of the four quarters of a cell, where the gap is
        bilinear between the middles of the cells. Beyond the edge of the domain it is that of the
        last row, and a cell stands for a neighbour beyond a step of four cutoffs.
        """
        size = self.problem.profile.size
        if not self.law.averaged:
            return np.eye(size), np.arange(size)
        heights = self.problem.heights
        rows = []
        for i, j in np.ndindex(heights.shape):
            for di, dj in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
                row = np.zeros(heights.shape)
                for a, b, weight in ((0, 0, 9), (di, 0, 3), (0, dj, 3), (di, dj, 1)):
                    # At the edge of the domain only one of the two indices may lead beyond it.
                    at = i + a if self._neighbour(i + a, j) else i
                    cell = self._neighbour(at, j + b) or self._neighbour(at, j)
                    assert cell
                    step = abs(heights[cell] - heights[i, j]) > 4 * self.law.cutoff()
                    row[(i, j) if step else cell] += weight / 16
                rows.append(row.ravel())
        return np.array(rows), np.repeat(np.arange(size), 4)

    def exerted(self, gap: Array, contact: Mask) -> Array:
        """Return the traction that the law exerts [Pa], −(strength) within a contact."""
        gaps, acts = self._at_points(gap, contact)
        within = np.clip(gaps, 0.0, self.law.cutoff())
        acts &= gaps < self.law.cutoff()
        at_points = np.where(acts, self.law.traction(within), 0.0)
        weights, cells = self.points
        exerted: Array = weights.T @ at_points * (gap.size / cells.size)
        return exerted

    def energy(self, wall: Array, traction: Array, depth: float) -> float:
        pressure = wall + traction
        gaps, acts = self._at_points(self.gap(pressure, depth), wall > 0)
        bound = self.law.energy(np.clip(gaps, 0.0, self.law.cutoff())[acts])
        elastic = 0.5 * float(pressure @ self.matrix @ pressure)
        total = elastic + float(bound.sum()) * (wall.size / gaps.size)
        if self.problem.prescribed == "force":
            total -= self.problem.value * depth / self.problem.grid.cell_area
        return total * self.problem.grid.cell_area

    def _at_points(self, gap: Array, contact: Mask) -> tuple[Array, Mask]:
        """Return the gap at the points, and where the law acts."""
        weights, cells = self.points
        closed = np.where(contact, 0.0, gap)
        if not self.law.needs_contact:
            return weights @ closed, np.ones(cells.size, dtype=bool)
        joined = self._joined(contact, contact | (gap < self.law.cutoff()))
        if cells.size > gap.size:
            # The points of cells beside those that are joined have a share of their gap.
            shape = self.problem.grid.shape
            mask = joined.reshape(shape)
            grown = np.zeros(shape, dtype=bool)
            for i, j in np.ndindex(shape):
                beside = (self._neighbour(i + a, j + b) for a in (-1, 0, 1) for b in (-1, 0, 1))
                grown[i, j] = any(mask[cell] for cell in beside if cell)
            joined = grown.ravel()
        return weights @ closed, joined[cells]

    def _neighbour(self, i: int, j: int) -> tuple[int, int] | None:
        nx, ny = self.problem.grid.shape
        if self.problem.grid.boundary == "periodic":
            return i % nx, j % ny
        return (i, j) if 0 <= i < nx and 0 <= j < ny else None

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
