#!/usr/bin/env bash
# Guess: MittagLeffler of differintP gives what the relaxation of a spring in series with a
#   springpot needs, E_a(-(t / tau)^a), for times up to ten or a hundred times tau: it falls from 1
#   towards 0.
# Version: differintP 0.0.4, mpmath 1.4.1 (for the true values)
# Behaviour: it sums 50 terms of the power series, in double precision. For a springpot of order 0.5
#   the modulus is right to 16 tau; at 25 tau it is -3e9, at 100 tau -2e24, for one of order 0.3
#   -458 already at 10 tau. No warning. More terms, an option, help at 25 tau; at 100 tau they make
#   it worse, as they cancel.
# Output seen: order 0.5: 4 tau 0.2554 (true 0.2554), 25 tau -2.877e+09 (0.1107), 100 tau -2.161e+24
#   (0.0561); 100 tau with 200 terms -5.364e+41
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    differintP==0.0.4 numpy==2.4.6 scipy==1.17.1 numba==0.68.1 mpmath==1.4.1
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import mpmath
import numpy as np
from differintP.functions import MittagLeffler

order, times = 0.5, (4.0, 25.0, 100.0)  # in units of tau


def true(time):
    """E_0.5(-sqrt(t)) = exp(t) erfc(sqrt(t))."""
    return float(mpmath.exp(time) * mpmath.erfc(mpmath.sqrt(time)))


def relax(time, **options):
    return float(MittagLeffler(order, 1, np.array([-(time**order)]), **options)[0])


for time in times:
    print(f"{time:g} tau: {relax(time):.4g} (true {true(time):.4f})")
more = relax(100.0, num_terms=200)
print(f"100 tau with 200 terms: {more:.4g}")
assert np.isclose(relax(times[0]), true(times[0]), rtol=1e-6), "short times are wrong, too"
assert abs(relax(25.0)) > 1e9 and abs(relax(100.0)) > 1e20, "long times are right now"
assert abs(more) > 1e20, "more terms help now"
PYTHON
