"""The cases of the benchmarks whose operator applications are frozen."""

from collections.abc import Callable, Iterator
from functools import partial
from itertools import product
from typing import NamedTuple

from operator_counts import KERNELS

from tests.physics.frozen import reader


class Case(NamedTuple):
    """A solve, or a path of solves, whose applications are counted."""

    name: str
    applications: Callable[[], int]
    slow: bool


def _cases() -> Iterator[Case]:
    solves = product(("rough", "punch", "smooth"), (0.0, 0.02, 1.0), (64, 128, 256))
    for case, tension, points in solves:
        count = partial(reader.unit_applications, case, tension, points)
        yield Case(f"{case}, s = {tension:g} L, {points}", count, points > 128)
    for case, kernel in product(("rough", "free"), KERNELS):
        count = partial(reader.kernel_applications, case, kernel, 64)
        yield Case(f"{case}, {kernel}, 64", count, case == "free")
    paths = [("paraboloid", s) for s in (0.0, 0.1, 1.0, 10.0)] + [("rough punch", 0.0)]
    for case, tension in paths:
        count = partial(reader.adhesive_applications, case, tension, 64)
        yield Case(f"sticking {case}, s = {tension:g}, 64", count, True)


CASES = tuple(_cases())
