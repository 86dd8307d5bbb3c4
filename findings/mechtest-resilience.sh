#!/usr/bin/env bash
# Guess: resilience of mechtest_ufmg is the area under the stress-strain curve up to the yield
#   strength, as toughness is up to the end; with dx the step of the integration.
# Version: mechtest-ufmg 0.1.2
# Behaviour: stress and strain are the wrong way round: it is the area beside the curve, the
#   complementary energy. The two are the same for a straight line only. For a curve that stiffens,
#   as that of a soft tissue, it is too large. dx has no effect.
# Output seen: energy over the true one: straight line 1.00; stress ~ strain^3: resilience 2.99,
#   toughness 1.00
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==1.26.4 scipy==1.11.4 pandas==2.2.3 matplotlib==3.8.4
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps mechtest-ufmg==0.1.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from mechtest_ufmg import Properties

strain = np.linspace(0, 0.1, 2001)
found = {}
for name, exponent in {"line": 1, "stiffening": 3}.items():
    stress = 5 * (strain / 0.1) ** exponent  # MPa
    true = 5 * 0.1 / (exponent + 1)
    found[name] = [Properties.resilience(strain, stress, 5.0, dx=step, show=False) / true
                   for step in (1.0, 5e-5)]
    whole = Properties.toughness(strain, stress, show=False) / true
    print(f"{name}: resilience {found[name][0]:.2f}, with dx of the data {found[name][1]:.2f}, "
          f"toughness {whole:.2f} of the energy")
    assert np.isclose(whole, 1, rtol=1e-3), "the toughness is wrong, too"
assert np.allclose(found["line"], 1, rtol=0.01), "a straight line is wrong, too"
assert np.allclose(found["stiffening"], 3, rtol=0.01), "a stiffening curve has another energy now"
PYTHON
