"""What other libraries of Fourier transforms would save inside a solve.

Runs the cases of cost.py with scipy.fft and with each library that is installed in its place, in
turn in one process, and prints the time of the solve with scipy.fft over that with the library.

    pip install mkl_fft pyfftw ducc0
    python tests/benchmarks/transforms.py --points 512 1024
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from itertools import product
from typing import Any

import cost
import scipy.fft
from tables import print_head, print_row

import pellicle as pl


class Ducc:
    """ducc0 as a backend of scipy.fft, as far as pellicle uses it."""

    __ua_domain__ = "numpy.scipy.fft"

    def __init__(self) -> None:
        import ducc0

        self._fft = ducc0.fft

    def __ua_function__(self, method: Any, args: Any, kwargs: Any) -> Any:
        """Carry out a transform, or leave it to scipy.fft."""
        name, axis = method.__name__, kwargs.get("axis", -1)
        a = args[0]
        if name == "rfft2":
            return self._fft.r2c(a)
        if name == "irfft2":
            s = kwargs["s"]
            return self._fft.c2r(a, lastsize=s[-1], forward=False, inorm=2)
        if name == "irfft" and "n" in kwargs:
            return self._fft.c2r(a, axes=(axis,), lastsize=kwargs["n"], forward=False, inorm=2)
        if name in ("fft", "ifft") and "n" not in kwargs:
            out = a if kwargs.get("overwrite_x") else None
            forward = name == "fft"
            return self._fft.c2c(
                a, axes=(axis,), forward=forward, inorm=0 if forward else 2, out=out
            )
        return NotImplemented


def _mkl() -> Any:
    import mkl_fft.interfaces.scipy_fft

    return mkl_fft.interfaces.scipy_fft


def _fftw() -> Any:
    import pyfftw

    pyfftw.interfaces.cache.enable()
    pyfftw.interfaces.cache.set_keepalive_time(60)
    return pyfftw.interfaces.scipy_fft


LIBRARIES: dict[str, Callable[[], Any]] = {"mkl_fft": _mkl, "pyfftw": _fftw, "ducc0": Ducc}


def installed() -> Iterator[tuple[str, Any]]:
    """Yield the name and the backend of each library that is there; scipy.fft itself first."""
    yield "scipy", None
    for name, make in LIBRARIES.items():
        try:
            yield name, make()
        except ImportError:
            print(f"{name} is not installed")


def solving(case: str, points: int, tension: float, backend: Any) -> float:
    """Return the processor time of one solve [s]."""
    given, tolerance, _ = cost.problem(case, points, tension)
    chosen = scipy.fft.set_backend(backend, only=False) if backend else nullcontext()
    with scipy.fft.set_workers(1), chosen:
        started = time.process_time()
        pl.solver("active_set", tolerance=tolerance).solve(given, None, lambda *_: None)
        return time.process_time() - started


def main() -> None:
    """Print the table."""
    parser = cost.case_options(__doc__, [512, 1024], [0.0, 0.02])
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    libraries = list(installed())
    print_head("case", "s/L", "N", *(name for name, _ in libraries))
    for case, tension, points in product(options.cases, options.tension, options.points):
        best = dict.fromkeys((name for name, _ in libraries), float("inf"))
        for _ in range(options.repeats):
            for name, backend in libraries:
                best[name] = min(best[name], solving(case, points, tension, backend))
        ratios = (f"{best['scipy'] / seconds:.2f}" for seconds in best.values())
        print_row(case, f"{tension:g}", points, *ratios)


if __name__ == "__main__":
    main()
