"""What a curve of a folder tells of the next one: what need not be compared, and where to start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle_fit.estimation.candidate import Candidate, Types
from pellicle_fit.estimation.coordinates import CONTACT_POINT, MODULUS
from pellicle_fit.estimation.objective import Objective

from .verdict import Verdict

RULED_OUT = 40.0
"""ΔAIC to the best beyond which an explanation is not compared on curves alike."""


class Neighbour(NamedTuple):
    """A curve like another, of which all explanations were compared."""

    is_described: bool
    """Whether a model describes it."""
    tied: frozenset[Types]
    """What could not be told from the chosen explanation, itself included."""
    ruled_out: frozenset[Types]
    values: Mapping[Types, Mapping[str, float]]
    """Values in SI of the quantities of each explanation."""
    baseline: Types
    """What of a baseline it needs, beside what was asked for."""

    @classmethod
    def of_dict(cls, fit: Mapping[str, Any]) -> Neighbour:
        """Return the neighbour that the JSON data of a fit of one curve describe."""
        explanations = {frozenset(row["effects"]): row for row in fit["explanations"]}
        return cls(
            fit["verdict"] != Verdict.UNDESCRIBED.value,
            frozenset(types for types, row in explanations.items() if row["tied"]),
            frozenset(t for t, row in explanations.items() if row["delta_aic"] > RULED_OUT),
            {
                types: {name: e["value"] for name, e in row["parameters"].items()}
                for types, row in explanations.items()
            },
            frozenset(fit["baseline"]),
        )

    def has(self, selected: Types, is_described: bool) -> bool:
        """Return whether it could be explained by what was chosen on another curve."""
        return selected in self.tied and is_described == self.is_described

    def starts(
        self, objective: Objective, types: Types, simple: Candidate, parts: Sequence[Candidate]
    ) -> list[Array]:
        """Return coordinates of an explanation: as far from those of a simple one as here.

        And those of its parts, with the others as here; none if it was not compared here.
        """
        there, beside = self.values.get(types), self.values.get(simple.types)
        if there is None or beside is None:
            return []
        known = {name: e.value for name, e in simple.parameters.items()}
        values = dict(there)
        values[MODULUS] *= known[MODULUS] / beside[MODULUS]
        values[CONTACT_POINT] += known[CONTACT_POINT] - beside[CONTACT_POINT]
        at = objective.at_values(
            {(s.name, s.curve): values.get(s.name, np.nan) for s in objective.slots}
        )
        if not np.isfinite(at).all():
            return []
        others = (objective.at_values(of.objective.values(of.minimum.at)) for of in parts)
        return [at, *(np.where(np.isnan(coordinates), at, coordinates) for coordinates in others)]
