"""Paths of adhesive contact in the units E* = R = w = 1, with their closed theory."""

from collections.abc import Sequence
from math import pi
from typing import Any

import numpy as np
import xarray as xr

import pellicle as pl
from pellicle_axisymmetric.adhesive_contact import Adhesion
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests import tables_of_runs as tables
from tests.tables_of_runs import heights, self_affine

FORCE = pi
"""πwR."""
JKR: dict[str, Any] = {"type": "jkr", "work_of_adhesion": 1.0}
PARABOLOID: dict[str, Any] = {"type": "paraboloid", "radius": 1.0}


def theory(length: float) -> Adhesion:
    """Return the closed theory of the paraboloid at an elastocapillary length s."""
    return Adhesion(Paraboloid(radius=1.0), 1.0, length / 2, 1.0)


def half_space(length: float) -> dict[str, Any]:
    """Return the kernel of a half-space with an elastocapillary length s, 0 included."""
    return tables.tensed(1.0, length / 2) if length else tables.half_space()


def solved(
    points: int | Sequence[int],
    length: float,
    values: Sequence[float],
    *,
    size: float | Sequence[float] = 5.0,
    boundary: str = "free",
    interaction: dict[str, Any] | None = None,
    indenter: dict[str, Any] | None = None,
    kernel: dict[str, Any] | None = None,
    **loading: Any,
) -> xr.Dataset:
    """Return the path through ``values``: depths unless ``loading`` names another quantity."""
    quantity = loading.pop("quantity", "depth")
    run = {
        "grid": {"points": points, "size": size, "boundary": boundary},
        "kernel": kernel or half_space(length),
        "indenter": indenter or PARABOLOID,
        "interaction": interaction or JKR,
        "loading": {quantity: [float(value) for value in values], **loading},
    }
    return pl.run(run, progress=False).dataset


def retracted(points: int, length: float, depth: float, size: float) -> xr.Dataset:
    """Return the step at ``depth`` that a larger contact has been retracted to."""
    before = [0.1] if depth < 0 else []
    return solved(points, length, [*before, depth + 0.25, depth], size=size).isel(step=-1)


def retraction_cases(length: float) -> dict[str, tuple[float, float, float, float]]:
    """Return domain, depth, force and radius of the contacts that retractions are tested at."""
    closed = theory(length)
    return {
        name: (size, float(contact.depth), float(contact.force), float(contact.contact_radius))
        for name, size, contact in (
            ("a = 1.5", 5.0, closed.equilibrium(1.5)),
            ("F = 0", 7.0, closed.at_force(0.0)),
        )
    }


def wavy(
    points: int, values: Sequence[float], height: float, work: float, **options: Any
) -> xr.Dataset:
    """Return a path on a sine of wavelength 1, one cell across on a periodic grid."""
    x = (np.arange(points) + 0.5) / points
    return solved(
        [points, 1],
        0.0,
        values,
        size=[1.0, 1 / points],
        boundary="periodic",
        indenter=heights((height * np.cos(2 * pi * x))[:, None]),
        **{"interaction": {"type": "jkr", "work_of_adhesion": work}, **options},
    )


def wave_pressure(half_width: float, height: float, work: float) -> float:
    """Return the mean pressure [Pa] on a sine of wavelength 1 with contacts of a half-width.

    p* sin² πa − √(2E*w tan πa), p* = πE*h (Johnson, Int. J. Solids Struct. 32 (1995) 423).
    """
    angle = pi * half_width
    return float(pi * height * np.sin(angle) ** 2 - np.sqrt(2 * work * np.tan(angle)))


def rough_path(points: int, length: float) -> xr.Dataset:
    """Return a path of a rough punch that sticks, there and back."""
    down = np.linspace(0.1, 0.4, 4)
    rough = self_affine(0.1, 0.8, 0.5, seed=1)
    work = {"type": "jkr", "work_of_adhesion": 0.02}
    path = [*down, *down[-2::-1], 0.0, -0.1, -0.2]
    return solved(points, length, path, indenter=rough, interaction=work)


def relaxing(
    fraction: float = 0.8, time: float = 1.0, solid: dict[str, Any] | None = None
) -> dict[str, Any]:
    """Return a kernel of which a fraction relaxes; by default E* = 5 relaxes to 1 in a time 1."""
    return tables.relaxing(solid or tables.half_space(5.0), fraction, time)


def pulled_off(
    points: int, speed: float, interaction: dict[str, Any], number: int = 40, **options: Any
) -> float:
    """Return the lowest force of a paraboloid that is pressed, dwells and is pulled at a speed.

    The path has ``number`` steps from the depth 0.5, where it has dwelt for 50 relaxation times,
    to −1.6.
    """
    pressed, pulled = [0.25, 0.5, 0.5], np.linspace(0.5, -1.6, number + 1)[1:]
    times = [0.0, 25.0, 50.0, *(50.0 + (0.5 - pulled) / speed)]
    path = solved(
        points,
        0.0,
        [*pressed, *pulled],
        size=7.0,
        interaction=interaction,
        time=times,
        **{"kernel": relaxing(), **options},
    )
    lowest = int(path["force"].values.argmin())
    assert len(pressed) < lowest < path.sizes["step"] - 1
    return float(path["force"][lowest])
