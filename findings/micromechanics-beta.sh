#!/usr/bin/env bash
# Guess: beta in the model of micromechanics is the beta of Oliver and Pharr, the factor 1.034 of
#   a Berkovich tip in S = beta 2/sqrt(pi) E_r sqrt(A); setting it lowers the modulus by 3.3 %.
# Version: micromechanics 1.3.5
# Behaviour: it is the other constant, epsilon = 0.75, of the contact depth h - epsilon P/S; the
#   factor of S has no name there and is 1. beta = 1.034 makes the contact shallower: the modulus
#   rises by 4 %, hardness by 8 %.
# Output seen: beta 0.75: 98.80 GPa; beta 1.034: 102.82 GPa; as guessed 95.55 GPa
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    micromechanics==1.3.5 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from micromechanics.indentation import Indentation

stiffness, force, depth = np.array([200.0]), np.array([10.0]), np.array([0.4])  # mN/um, mN, um


def evaluate(**model):
    indentation = Indentation("", model=model, output={"verbose": 0})
    modulus, area, _ = indentation.OliverPharrMethod(stiffness, force, depth)
    return modulus[0], force[0] / area[0]


(plain, hardness), (set_, harder) = evaluate(), evaluate(beta=1.034)
print(f"default: {plain:.2f} GPa; beta 1.034: {set_:.2f} GPa; as guessed {plain / 1.034:.2f} GPa")
print(f"hardness {hardness:.3f} and {harder:.3f} GPa")
exact = 2 / np.sqrt(np.pi) * np.sqrt(24.494) * (0.4 - 0.75 * 10 / 200)
assert np.isclose(plain, 200 / exact, rtol=1e-3), "the default is not epsilon = 0.75 and factor 1"
assert np.isclose(set_ / plain, (0.4 - 0.75 * 0.05) / (0.4 - 1.034 * 0.05), rtol=1e-3), "new beta"
PYTHON
