"""The contract of effects as a test: one call checks an effect."""

from __future__ import annotations

from pellicle.testing import check, rules_of

from .effect import Effect


def check_effect(effect: Effect) -> None:
    """Check that an effect keeps its contract."""
    check(effect, Effect, rules_of(__name__))
