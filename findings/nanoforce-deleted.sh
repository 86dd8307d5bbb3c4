#!/usr/bin/env bash
# Guess: delete_curve of nanoforce takes a bad curve out with all that was computed from it.
# Version: nanoforce 0.3.32 (for Python 3.11 with tkinter, without its dependency "sklearn", which
#   cannot be installed)
# Behaviour: it takes out the forces and positions. Adhesion, modulus, contact point and the others
#   that have one number per curve are deleted along a second axis that they do not have; the
#   exception is caught, and all of them stay. From the deleted curve on, row n of the one belongs
#   to curve n + 1 of the other, and histograms and means have the bad curve still.
# Output seen: curves 0 2 3 left, their forces 1 3 4 nN; adhesion 1 200 3 4 nN
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

adhesion = np.array([1.0, 200.0, 3.0, 4.0])  # nN, the second curve is bad
z = np.linspace(0, 50, 101)
afm = AFM()
afm.z_approach = afm.z_withdraw = np.repeat(z[:, None], 4, axis=1)
afm.retract = -adhesion * np.exp(-((z[:, None] - 10) ** 2) / 20)
afm.approach = np.abs(afm.retract)
afm.calc_adhesion()
before = afm.adhesion.copy()
afm.delete_curve(1)
left = -afm.retract.min(axis=0)
print("curves left:", *left, "nN; adhesion:", *afm.adhesion, "nN")
assert np.allclose(before, adhesion), "the adhesion is wrong before"
assert np.allclose(left, [1, 3, 4]), "another curve is deleted"
assert np.allclose(afm.adhesion, adhesion), "the adhesion of the bad curve is deleted now"
afm.calc_adhesion()
assert np.allclose(afm.adhesion, left), "computed again it is wrong, too"
PYTHON
