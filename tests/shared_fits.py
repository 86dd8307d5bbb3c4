"""Lets the tests of several ways to one fit do it once, or without rivals."""

from typing import Any

import pytest

from pellicle_fit.selection.recipe import Answer, answer

ANSWER = "pellicle_fit.problem.answer"


def share_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let fits of this process have the answer of an earlier one to an equal question.

    The arguments hold all that an answer depends on, so a way to them that changes one is still
    seen; that equal arguments have equal answers is tested without this.
    """
    answers: dict[str, Answer] = {}

    def shared(curves: list[Any], *effects: Any, **options: Any) -> Answer:
        """Return the answer to equal arguments, if there is one."""
        arrays = [(c.position, c.force, c.time, c.unloading) for c in curves]
        rows = [[a if a is None else a.tolist() for a in columns] for columns in arrays]
        bodies = [(curve.indenter, curve.stiffness, curve.sines) for curve in curves]
        key = repr((rows, bodies, effects, options))
        if key not in answers:
            answers[key] = answer(curves, *effects, **options)
        return answers[key]

    monkeypatch.setattr(ANSWER, shared)


def skip_rivals(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let fits of this process skip rivals: most of their time, and tested elsewhere."""

    def alone(curves: list[Any], model: Any, rivals: Any, **options: Any) -> Answer:
        """Compare the model with nothing."""
        return answer(curves, model, (), **options)

    monkeypatch.setattr(ANSWER, alone)
