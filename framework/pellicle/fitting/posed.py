"""A curve as it is fitted: its rows, what is asked of it, and an indenter with a force curve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pellicle.components import HasForceCurve, Indenter
from pellicle.errors import ConfigError, PellicleError

from .curves.columns import Measured
from .curves.curve import Curve, Segment, clean
from .curves.sources import Source
from .models.force_model import CONTACT_POINT, tension_model
from .models.simulation import simulate
from .problem import Question, question
from .statistics.initial_guess import BEFORE
from .statistics.likelihood import Likelihood


@dataclass(frozen=True)
class Posed:
    """A curve and what is asked of it; it pickles to workers."""

    name: str
    curve: Curve
    asked: Question

    def modelled(self, **study: Any) -> Posed:
        """Return the same with an indenter that has a force curve, simulated if need be.

        ``study`` goes to `simulate`.

        Raises
        ------
        ConfigError, ConvergenceError, StorageError
            As for `simulate`.
        """
        asked, position = self.asked, self.curve.position
        if asked.material is None:
            return self
        span = float(np.ptp(position))
        point = asked.fixed.get(CONTACT_POINT)
        reach = (1 + BEFORE) * span if point is None else float(position[-1]) - point
        # Where nothing reaches contact, the fit itself says so.
        deepest = reach if reach > 0 else span
        made = simulate(asked.indenter, asked.material, deepest, **study)
        return replace(self, asked=replace(asked, indenter=made, material=None))


def likelihood(curve: Posed) -> Likelihood:
    """Return the likelihood of a curve by an indenter that has a force curve.

    Its noise, which is not known yet, is set to the largest force.
    """
    data, model = curve.curve, tension_model(curve.asked.indenter)
    noise = float(np.max(np.abs(data.force)))
    whole = Likelihood(data.position, data.force, model, noise, (), data.stiffness)
    free = tuple(p for p in whole.parameters if p not in curve.asked.fixed)
    return replace(whole, free=free)


def posed(
    sources: Sequence[Source],
    indenter: str | Mapping[str, Any] | Indenter | HasForceCurve,
    options: Mapping[str, Any],
) -> list[Posed | PellicleError]:
    """Return each source as it is fitted, or why it cannot be.

    ``options`` are those of `question`.

    Raises
    ------
    ConfigError, PluginError
        An argument is not allowed.
    """
    found: list[Posed | PellicleError] = []
    for source in sources:
        measured = source.curve
        if isinstance(measured, PellicleError):
            found.append(measured)
            continue
        is_depth = measured.depth is not None
        try:
            asked = question(indenter, source.fields, is_depth=is_depth, **options)
        except ConfigError as error:
            raise error if len(sources) == 1 else source.named(error) from None
        try:
            found.append(Posed(source.name, _cleaned(measured, asked.segment), asked))
        except ConfigError as error:
            found.append(error)
    return found


def _cleaned(measured: Measured, segment: Segment) -> Curve:
    """Return the rows of a measured curve that are fitted."""
    place = measured.position if measured.depth is None else measured.depth
    made = clean(place, measured.force, segment, measured.stiffness)  # type: ignore[arg-type]
    return replace(made, messages=(*measured.messages, *made.messages))
