"""Heights beyond the numbers of a computer are refused in words, not computed with."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest

import pellicle as pl


def _run(indenter: pl.Indenter | dict[str, Any]) -> pl.Result:
    return pl.run(
        {
            "grid": {"points": 8, "size": "1 mm", "boundary": "periodic"},
            "kernel": {"type": "half_space", "reduced_modulus": "10 kPa"},
            "indenter": indenter,
            "loading": {"force": "1 uN"},
        },
        progress=False,
    )


@pytest.mark.parametrize("floats", ["raise", "warn"])
@pytest.mark.parametrize(
    "indenter",
    [
        {"type": "heights", "values": 1e30 * np.eye(8), "unit": 1e90},
        {"type": "heights", "values": 1e-30 * np.eye(8), "unit": 1e-90},
        {"type": "heights", "values": 1e300 * np.eye(8), "unit": 1e90},
    ],
)
def test_heights_beyond_numbers(indenter: dict[str, Any], floats: Literal["raise", "warn"]) -> None:
    """Whatever overflows, or vanishes, names the indenter and asks for its units."""
    with (
        np.errstate(over=floats),
        pytest.raises(pl.ConfigError, match=r"^indenter: its heights .*check the units"),
    ):
        _run(indenter)
