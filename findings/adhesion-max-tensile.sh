#!/usr/bin/env bash
# Guess: max_tensile of a potential in Adhesion, its largest tensile stress, has one sign for all
#   potentials.
# Version: Adhesion 0.93
# Behaviour: Exponential and PowerLaw give it as a negative number, LJ93, Lj82, Morse and VDW82 as
#   a positive one. The largest slope of the energy is positive for all of them, the sizes are
#   right. A ratio such as Tabor's with another potential changes its sign, or a fractional power
#   of it is nan.
# Output seen: Exponential -0.050 (largest slope 0.050), PowerLaw -0.050 (0.050), LJ93 0.090
#   (0.090), Lj82 0.051 (0.051), Morse 0.025 (0.025), VDW82 0.002 (0.002)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check Adhesion==0.93 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from Adhesion import Interactions

work, reach = 0.05, 1.0
potentials = {
    "Exponential": Interactions.Exponential(work, reach),
    "PowerLaw": Interactions.PowerLaw(work, 3 * reach),
    "LJ93": Interactions.LJ93(work, reach),
    "Lj82": Interactions.Lj82(work, reach),
    "Morse": Interactions.Morse(work, reach),
    "VDW82": Interactions.VDW82(1.0, 1.0),
}
gaps, signs = np.linspace(1e-6, 6, 60001), {}
for name, potential in potentials.items():
    # below its minimum a potential repels
    attractive = gaps[gaps > potential.r_min] if potential.r_min else gaps
    slope = potential.evaluate(attractive, True, True, True)[1].max()
    print(f"{name} {potential.max_tensile:.3f} ({slope:.3f})")
    assert slope > 0, f"{name}: the energy falls"
    assert np.isclose(abs(potential.max_tensile), slope, rtol=1e-3), f"{name}: another size"
    signs[name] = float(np.sign(potential.max_tensile))
assert {name for name in signs if signs[name] < 0} == {"Exponential", "PowerLaw"}, "other signs"
PYTHON
