"""What our own area corrections keep beyond the contract."""

import numpy as np
import pytest

from pellicle import Run
from pellicle.runs.runner import solve


def test_result_has_the_periodic_area() -> None:
    """On a periodic grid a contact has the same corrected area wherever the domain is cut."""

    def areas(shift: float) -> tuple[float, float]:
        x = np.arange(24)[:, None] + shift
        heights = np.cos(2 * np.pi * x / 24) + np.cos(2 * np.pi * np.arange(24) / 24)
        run = Run(
            grid={"points": 24, "size": 1e-3, "boundary": "periodic"},
            kernel={"type": "half_space", "reduced_modulus": 1e4},
            indenter={"type": "heights", "values": heights, "unit": "1 um"},
            loading={"mean_pressure": 10.0},
            corrections=[{"type": "yastrebov"}],
        )
        data = solve(run).dataset
        return data["contact_area"].item(), data["contact_area_yastrebov"].item()

    (cells, inside), (cells_across, across) = areas(12), areas(0)
    assert cells == cells_across
    assert inside < cells
    assert across == pytest.approx(inside, rel=1e-12)
