#!/usr/bin/env bash
# Guess: the transform of Hertz's pressure, sqrt(1 - r^2) below the contact and zero beside it, is
#   an easy one for hankel; its estimate of the error says when steps or their number are too
#   coarse.
# Version: hankel 1.2.2
# Behaviour: few points lie below the contact. At the default h = 0.05 the transform is 38 % off, to
#   both sides, for any N; the estimate of the error, which is the last term of the sum, is 0, as
#   the pressure is 0 there. At h = 0.001 it is still 3 % off. A smooth pressure that decays, such
#   as (1 + r^2)^-1.5, comes out within 3 % at the default.
# Output seen: k = 0.5, 1: N 200 -37 % +38 %, error 0; N 3200 -37 % +38 %, error 0; smooth -3 % +0 %
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    hankel==1.2.2 numpy==2.4.6 scipy==1.17.1 mpmath==1.3.0
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from hankel import HankelTransform

k = np.array([0.5, 1.0])
true = (np.sin(k) - k * np.cos(k)) / k**3


def hertz(r):
    return np.sqrt(np.maximum(1 - r**2, 0))


def compare(pressure, true, number, step):
    found, error = HankelTransform(nu=0, N=number, h=step).transform(pressure, k, ret_err=True)
    off = found / true - 1
    print(f"N {number}, h {step}: off by {100 * off[0]:+.0f} % {100 * off[1]:+.0f} %, "
          f"estimated error {np.abs(error).max():.1g}")
    return off, np.abs(error).max()


for number in (200, 3200):
    off, error = compare(hertz, true, number, 0.05)
    assert off[0] < -0.3 and off[1] > 0.3, "the sharp edge is no trouble any more"
    assert error == 0, "the estimated error says so now"
fine, error = compare(hertz, true, 3200, 0.001)
assert 0.01 < np.abs(fine).max() < 0.05 and error == 0, "a fine step is another story now"
smooth, _ = compare(lambda r: (1 + r**2) ** -1.5, np.exp(-k), 3200, 0.05)
assert np.abs(smooth).max() < 0.05, "a smooth pressure is wrong, too"
PYTHON
