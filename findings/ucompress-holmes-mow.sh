#!/usr/bin/env bash
# Guess: the permeability of Holmes and Mow in ucompress falls with compression and vanishes when
#   the pores close, at J = 1 - phi_0, as that of Kozeny and Carman beside it does.
# Version: ucompress 1.0.0
# Behaviour: where Holmes and Mow have the solid content at rest, it has the one of the compressed
#   sample. With three quarters of fluid it is zero at J = 0.5, half of the pores open, and grows
#   again below, with an even exponent up to the one at rest when the pores are closed; with an odd
#   one it is negative, with another one nan. At 10 % compression it is 8 % low.
# Output seen: J 1, 0.9, 0.5, 0.25: found 1.000 0.688 0.000 1.000; Holmes and Mow 1.000 0.751 0.111
#   0.000
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    ucompress==1.0.0 numpy==2.4.6 scipy==1.17.1 sympy==1.14.0
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from ucompress.models.permeability import HolmesMow, KozenyCarman

fluid, exponent = 0.75, 2.0
volume = np.array([1, 0.9, 0.5, 0.25])  # J


class Gel:
    physical = {"k_0": 1.0, "phi_0": fluid, "a": exponent, "M": 0.0}


def evaluate(kind):
    permeability = kind()
    permeability.lambdify(Gel)
    return permeability.eval_permeability(volume)


found, carman = evaluate(HolmesMow), evaluate(KozenyCarman)
true = ((volume - (1 - fluid)) / fluid) ** exponent
for name, values in [("found", found), ("Holmes and Mow", true), ("Kozeny and Carman", carman)]:
    print(name, *(f"{value:.3f}" for value in values))
assert np.isclose(found[0], 1) and np.isclose(carman[0], 1), "at rest it is wrong, too"
assert np.isclose(carman[3], 0), "Kozeny and Carman's does not vanish, too"
assert np.isclose(found[2], 0) and true[2] > 0.1, "at J = 0.5 it does not vanish any more"
assert np.isclose(found[3], 1), "with closed pores it vanishes now"
PYTHON
