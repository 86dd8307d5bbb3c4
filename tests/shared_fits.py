"""Lets the tests of several ways to one fit do it once."""

from __future__ import annotations

import io
import pickle
from collections.abc import Callable
from dataclasses import replace

import pytest

import pellicle as pl
from pellicle_fit.files.measurement import Origin
from pellicle_fit.one_curve import fit_problem
from pellicle_fit.problem import FitProblem


def share_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let fits of this process have the result of an earlier one of an equal problem.

    A problem holds all rows and options that a fit knows, so a way to it that changes one is still
    seen; that equal problems have equal results is tested without this.
    """
    fits: dict[bytes, pl.Fit] = {}

    def shared(problem: FitProblem, report: Callable[[str], None] = lambda stage: None) -> pl.Fit:
        """Return the fit of a problem, whatever its file and its place."""
        key = io.BytesIO()
        pickler = pickle.Pickler(key)
        # References to the same object would make the bytes of equal problems differ.
        pickler.fast = True
        curve = replace(problem.curve, origin=Origin(), site=None)
        pickler.dump(replace(problem, name="", curve=curve))
        if key.getvalue() not in fits:
            fits[key.getvalue()] = fit_problem(problem, report)
        return fits[key.getvalue()]

    for module in ("one_curve", "many"):
        monkeypatch.setattr(f"pellicle_fit.{module}.fit_problem", shared)
