#!/usr/bin/env bash
# Guess: get_comp_mat of pyMFD takes the sensitivity of the deflection (nm/V) from the slope that
#   most of the curves on the rigid base have; a single bad curve does not matter.
# Version: pyMFD 1.0.0
# Behaviour: it takes the upper edge of the fullest of 20 bars, and the bars cover all slopes from
#   the least to the largest. One curve of a hundred that is ten times as steep makes a bar as
#   wide as half the slope: the sensitivity is 30 % low, and a beam on the base is 1.7 times too
#   compliant at its tip, and more towards its root. Without the bad curve it is 1 % off.
# Output seen: true sensitivity 50.0 nm/V; without the bad curve 50.6, with it 35.0; compliance at
#   the tip of the beam over the true one 1.00 and 1.67
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    pyMFD==1.0.0 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2 Bottleneck==1.6.0
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import contextlib
import io

import numpy as np
from pyMFD.summarize import get_comp_mat

side, base, stiffness, sensitivity = 16, 8, 40.0, 50.0  # points, points, N/m, nm/V
piezo = np.linspace(0, 500, 256)
compliance = np.zeros((side, side))
compliance[:, base:] = 1e-4 * np.arange(1, side - base + 1) ** 3  # m/N, a beam from column 8 on


def evaluate(steeper):
    slope = 1 / sensitivity / (1 + stiffness * compliance)
    slope *= 1 + 1e-3 * np.random.default_rng(0).normal(size=slope.shape)
    slope[0, 0] *= steeper
    curves = np.maximum(200 - piezo[:, None], 0) * np.flipud(slope).ravel()
    printed, scan = io.StringIO(), {
        "name": "beam", "afm_spring_constant": stiffness, "cantilevers": [{"fixed_edge": base}],
    }
    with contextlib.redirect_stdout(printed):
        found, quality = get_comp_mat(piezo, curves, scan, linearize=False)
    assert quality.min() > 0.9, "the curves are bad"
    nm_per_volt = float(printed.getvalue().split("=")[-1].split()[0])
    share = found[8, -1] / compliance[8, -1]
    print(f"steeper by {steeper}: {nm_per_volt:.1f} nm/V, compliance at the tip {share:.2f}")
    return nm_per_volt, share


(good, right), (bad, wrong) = evaluate(1), evaluate(10)
assert abs(good / sensitivity - 1) < 0.03 and abs(right - 1) < 0.05, "it is wrong without, too"
assert bad < 0.75 * sensitivity, "a bad curve does not matter any more"
assert wrong > 1.4, "the compliance is right now"
PYTHON
