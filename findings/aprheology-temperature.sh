#!/usr/bin/env bash
# Guess: aprheology takes the temperature of a relaxation curve from the mean of its temperature
#   column; the activation energy of relaxation times that follow Arrhenius is the one they were
#   made with.
# Version: aprheology 0.3.2 (without its window)
# Behaviour: the mean is rounded to whole degrees, without a word, for the table, the plots, the
#   choice of curves and the activation energy. Curves at 60.8 and 61.2 degrees are two at 61.
# Output seen: 80 kJ/mol; curves at 60.0 and 65.0 degrees: 79.9; at 60.4 and 64.6 (taken as 60 and
#   65): 67.1; at 60.4 and 61.6 (taken as 60 and 62): 48.0
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==1.26.4 scipy==1.11.4 \
    pandas==2.2.3 matplotlib==3.8.4 statsmodels==0.14.2
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps aprheology==0.3.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import sys
import types

import numpy as np
from scipy.constants import R

sys.modules["aprheology.gui"] = types.SimpleNamespace(GUI=None)  # no window here
from aprheology import StressRelaxation

energy = 80e3  # J/mol
time = np.linspace(0.01, 100, 400)  # s


def write(temperatures):
    lines = ["Project:\tgel", "Test:\trelaxation"]
    for celsius in temperatures:
        tau = 10 * np.exp(energy / R * (1 / (celsius + 273.15) - 1 / 333.15))
        lines += ["Result:\trelaxation",
                  "Interval data:\tPoint No.\tTime\tRelaxation Modulus\tTemperature",
                  "\t\t[s]\t[Pa]\t[°C]"]
        lines += [f"\t{index + 1}\t{at:.4f}\t{1000 * np.exp(-at / tau):.6f}\t{celsius:.2f}"
                  for index, at in enumerate(time)]
    with open("curves.txt", "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


def measure(temperatures):
    write(temperatures)
    curves = StressRelaxation("curves.txt").curves
    taken = [curve["T"] for curve in curves]
    found = StressRelaxation.get_Ea(taken, [curve["tau"] for curve in curves])[0]
    print(f"{temperatures} taken as {taken[::-1]}: {found / 1e3:.1f} kJ/mol")
    return taken[::-1], found / energy


whole, near, nearer = measure([60.0, 65.0]), measure([60.4, 64.6]), measure([60.4, 61.6])
assert np.isclose(whole[1], 1, rtol=0.01), "whole degrees are wrong, too"
assert near[0] == [60, 65] and nearer[0] == [60, 62], "temperatures are taken in another way now"
assert np.isclose(near[1], 0.839, atol=0.005), "the activation energy is another one now"
assert np.isclose(nearer[1], 0.599, atol=0.005), "the activation energy is another one now"
PYTHON
