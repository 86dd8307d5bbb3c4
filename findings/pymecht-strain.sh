#!/usr/bin/env bash
# Guess: with disp_measure="strain" ("the Green-Lagrange strain") pymecht stretches a sample by
#   sqrt(2 E + 1): the same stress as with that stretch.
# Version: pymecht 1.1.3 (without torch, which only its random parameters use)
# Behaviour: the stretch is sqrt(E) + 1, in extension along one and along two axes. A strain of 1 %
#   is a stretch of 1.10, and a small stress grows with the root of the strain.
# Output seen: neo-Hookean bar, strain 0.01, 0.04, 0.20: stress over that of the true stretch 10.08
#   5.15 2.53; with stretches 1.00
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==1.26.4 scipy==1.11.4 \
    matplotlib==3.8.4 pandas==2.2.3 tqdm==4.67.1 pyDOE==0.3.8 sympy==1.12
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps pymecht==1.1.3
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import sys
import types

import numpy as np

sys.modules["torch"] = types.ModuleType("torch")
sys.modules["torch.quasirandom"] = types.SimpleNamespace(SobolEngine=None)
import pymecht

strain = np.array([0.01, 0.04, 0.2])
stretch = np.sqrt(2 * strain + 1)
true = stretch**2 - 1 / stretch  # Cauchy stress of a neo-Hookean bar, mu = 1


def pull(measure, values):
    bar = pymecht.UniaxialExtension(pymecht.MatModel("nh"), measure, "cauchy")
    return bar.disp_controlled(values) / true


by_strain, by_stretch = pull("strain", strain), pull("stretch", stretch)
print("stress over the true one: with strains", *(f"{value:.2f}" for value in by_strain),
      "with stretches", *(f"{value:.2f}" for value in by_stretch))
taken = 1 + np.sqrt(strain)
assert np.allclose(by_stretch, 1), "stretches are wrong, too"
assert np.allclose(by_strain * true, taken**2 - 1 / taken), "strains are another stretch now"
PYTHON
