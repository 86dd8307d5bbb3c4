"""Corrections that break their contract at work are refused by name, before a result is wrong."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest

import pellicle as pl
from tests.framework.broken_contracts.short_run import BOUNDARIES, GRID, run


def correction_that_returns(returned: object) -> pl.AreaCorrection:
    """Return a correction whose area is ``returned``."""

    class Correction(pl.AreaCorrection):
        """Area that breaks its contract."""

        type: Literal["liar"] = "liar"

        def area(self, contact: Any, spacing: Any) -> Any:
            """Return the same for any contact."""
            return returned

    return Correction()


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize(
    ("returned", "message"),
    [
        (-1.0, "returned -1 m²; it has to be between 0 and 4.8e-08 m²"),
        (1.0, "returned 1 m²; it has to be between 0 and 4.8e-08 m²"),
        (np.inf, "returned inf m²"),
        (np.nan, "returned nan; it has to return a real number"),
        ("1 mm^2", "returned '1 mm^2'; it has to return a real number"),
        (None, "returned None"),
        (True, "returned True"),
        (1e-9 + 0j, "returned (1e-09+0j)"),
        (np.ones(3), "returned an array of float64 of shape (3,)"),
    ],
)
def test_a_correction_that_lies_is_refused(returned: object, message: str, boundary: str) -> None:
    """An area is a number between 0 and the domain's, and the message says which it has to be."""
    with pytest.raises(pl.PluginError, match="correction 'liar'") as error:
        run(
            corrections=[correction_that_returns(returned)],
            grid=GRID | {"boundary": boundary},
            loading={"force": "10 nN"},
        )
    assert message in str(error.value)


def test_a_correction_without_contact_is_nothing() -> None:
    """Where nothing touches, no correction makes an area."""
    with pytest.raises(pl.PluginError, match="between 0 and 0 m², without contact"):
        run(corrections=[correction_that_returns(1e-9)], loading={"depth": 0.0})


def test_a_correction_cannot_change_the_contact() -> None:
    """The contact that a correction is given is read-only."""

    class Filling(pl.AreaCorrection):
        """Fills the contact."""

        type: Literal["liar"] = "liar"

        def area(self, contact: Any, spacing: Any) -> float:
            """Write to the contact."""
            contact[...] = True
            return 1e-9

    with pytest.raises(pl.PluginError, match="correction 'liar' changes what it is given"):
        run(corrections=[Filling()])
