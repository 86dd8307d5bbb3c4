#!/usr/bin/env bash
# Guess: adjust_tip_position of nanoforce makes the positions those of the tip and keeps the ones of
#   the piezo as z_approach_piezo; called again, it changes nothing.
# Version: nanoforce 0.3.32 (for Python 3.11 with tkinter, without its dependency "sklearn", which
#   cannot be installed)
# Behaviour: z_approach_piezo is the same array as z_approach, which is then written over: both are
#   the tip, the piezo is gone. Each call adds the deflection once more; a sample of stiffness as
#   the cantilever's, indented 30 nm, is indented 10 nm, then lifted by 10 nm.
# Output seen: piezo -50.0 nm, tip -20.0 nm: z_approach -20.0, z_approach_piezo -20.0; again 10.0
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==1.26.4 scipy==1.11.4 pandas==2.2.3 plotly==5.24.1 easygui==0.98.3 NSFopen==2.2.4 \
    seaborn==0.13.2 scikit-learn==1.4.2 matplotlib==3.8.4
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps nanoforce==0.3.32
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from nanoforce.nanoforce import AFM

piezo, force = np.array([[-50.0], [-20.0], [0.0]]), np.array([[3.0], [1.0], [0.0]])  # nm, nN
afm = AFM()
afm.set_spr_const(0.1)  # N/m
afm.approach, afm.retract, afm.indent_depth = force, force.copy(), np.zeros(1)
afm.z_approach, afm.z_withdraw = piezo.copy(), piezo.copy()
afm.adjust_tip_position()
tip, kept = afm.z_approach.copy(), afm.z_approach_piezo.copy()
afm.adjust_tip_position()
print(f"piezo {piezo[0, 0]} nm: z_approach {tip[0, 0]}, z_approach_piezo {kept[0, 0]}, "
      f"again {afm.z_approach[0, 0]}")
assert np.allclose(tip, piezo + force / 0.1), "the tip is wrong, too"
assert np.array_equal(kept, tip), "the positions of the piezo are kept now"
assert np.allclose(afm.z_approach, piezo + 2 * force / 0.1), "a second call changes nothing now"
PYTHON
