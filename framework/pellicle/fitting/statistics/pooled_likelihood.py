"""How well one modulus and one tension explain several curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pellicle.arrays import Array

from .likelihood import MODULUS, OFFSET, POINT, SLOPE, TENSION, ChiSquared, Likelihood

SHARED = [MODULUS, TENSION]
_OWN = (POINT, OFFSET, SLOPE)
"""Parameters that each curve has for itself."""
_ALL = 5


@dataclass(frozen=True)
class Pool(ChiSquared):
    """χ² of several curves that share modulus and tension.

    Parameters are those of the first curve, in the order of `likelihood`, then contact point,
    offset and slope of each other one.
    """

    members: tuple[Likelihood, ...]
    """One for each curve."""
    free: tuple[int, ...]

    @classmethod
    def of(cls, members: Sequence[Likelihood]) -> Pool:
        """Return the pool in which what is free in a curve is free."""
        places = (_places(number)[k] for number, member in enumerate(members) for k in member.free)
        return cls(tuple(members), tuple(dict.fromkeys(places)))

    def parts(self, parameters: Array) -> list[Array]:
        """Return the parameters of each curve."""
        return [parameters[_places(number)] for number in range(len(self.members))]

    def joined(self, parts: Sequence[Array]) -> Array:
        """Return all parameters; modulus and tension are those of the first curve."""
        return np.concatenate([parts[0], *(part[list(_OWN)] for part in parts[1:])])

    def place(self, number: int, which: int) -> int:
        """Return where a parameter of a curve is among those of the pool."""
        return _places(number)[which]

    def kind(self, which: int) -> int:
        """Return which parameter of a curve a parameter is."""
        return which if which < _ALL else _OWN[(which - _ALL) % len(_OWN)]

    @cached_property
    def scale(self) -> Array:
        """What each parameter moves by, about."""
        return self.joined([member.scale for member in self.members])

    @cached_property
    def limits(self) -> tuple[Array, Array]:
        """The least and the greatest value of each parameter; of the modulus, relative."""
        lowest, highest = zip(*(member.limits for member in self.members), strict=True)
        return self.joined(lowest), self.joined(highest)

    @property
    def accuracy(self) -> float:
        """Of the least exact force curve, relative to the largest force."""
        return max(member.accuracy for member in self.members)

    def coarse(self) -> Pool | None:
        """Return the same with force curves of coarser grids, if there are any."""
        coarser = [member.coarse() for member in self.members]
        if not any(coarser):
            return None
        pairs = zip(coarser, self.members, strict=True)
        return Pool(tuple(made or member for made, member in pairs), self.free)

    def expanded(self, parameters: Array) -> tuple[Array, Array]:
        """Return residuals of the same squares as all, six for each curve, and their derivatives.

        A rotation changes neither χ² nor a step of Gauss and Newton, and in the right coordinates
        six are left of thousands of points: a hundred curves fit into memory.
        """
        rotated: list[Array] = []
        for member, part in zip(self.members, self.parts(parameters), strict=True):
            residuals, slopes = member.expanded(part)
            rotated.append(np.asarray(np.linalg.qr(np.column_stack([slopes, residuals]), mode="r")))
        slopes = np.zeros((sum(map(len, rotated)), parameters.size))
        for number, own in enumerate(rotated):
            rows = slice((_ALL + 1) * number, (_ALL + 1) * (number + 1))
            slopes[rows, _places(number)] = own[:, :_ALL]
        return np.concatenate([own[:, _ALL] for own in rotated]), slopes


def _places(member: int) -> list[int]:
    """Return where the parameters of a curve are among those of the pool."""
    if not member:
        return list(range(_ALL))
    first = _ALL + len(_OWN) * (member - 1)
    return [first, MODULUS, TENSION, first + 1, first + 2]
