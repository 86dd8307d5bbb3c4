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
        {"type": "sphere", "radius": 1e308},
        {"type": "flat_punch", "radius": 1e308},
        {"type": "paraboloid", "radius": 1e308},
        {"type": "quadric", "radius_x": 1e308, "radius_y": 1e308},
        {"type": "paraboloid", "radius": 5e-324},
        {"type": "paraboloid", "radius": 1e-308},
        {"type": "quadric", "radius_x": 1e-308, "radius_y": 1.0},
        {"type": "cone", "half_angle": 1e-300},
        {"type": "heights", "values": np.eye(8), "unit": 1e308},
        {"type": "heights", "values": 4 * np.eye(8), "unit": 1e308},
    ],
)
def test_lengths_beyond_numbers(indenter: dict[str, Any], floats: Literal["raise", "warn"]) -> None:
    """Whatever overflows, or vanishes, names the indenter and asks for its units."""
    with (
        np.errstate(over=floats),
        pytest.raises(pl.ConfigError, match=r"^indenter: its heights .*check the units"),
    ):
        _run(indenter)
