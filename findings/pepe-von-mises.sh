#!/usr/bin/env bash
# Guess: vonMisesStrain of pepe takes the tensor that calculateD2Min beside it returns: a sheared
#   packing has a strain of half the shear.
# Version: pepe-granular 1.2.9 (its one module, without the image tools of the others)
# Behaviour: it multiplies matrices with *, which for the arrays that it is given is done element by
#   element. Simple shear has no strain at all; a stretch along the axes is right. With the same
#   tensor as np.matrix the shear is right, too.
# Output seen: strain of a shear of 0.2: array 0.0000, matrix 0.1005; of a stretch by 1.1: 0.0959,
#   0.0959
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==1.26.4 scipy==1.11.4 scikit-learn==1.5.2
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps pepe-granular==1.2.9
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import importlib.util

import numpy as np

(package,) = importlib.util.find_spec("pepe").submodule_search_locations
spec = importlib.util.spec_from_file_location("d2min", f"{package}/analysis/D2Min.py")
d2min = importlib.util.module_from_spec(spec)
spec.loader.exec_module(d2min)

before = np.random.default_rng(0).uniform(0, 10, (200, 2))
motions = {"shear": np.array([[1.0, 0.2], [0.0, 1.0]]), "stretch": np.diag([1.1, 1 / 1.1])}
found = {}
for name, gradient in motions.items():
    _, tensor = d2min.calculateD2Min(before, before @ gradient.T, 0)
    assert np.allclose(tensor, gradient), "the tensor itself is wrong, too"
    found[name] = [float(d2min.vonMisesStrain(kind(tensor))) for kind in (np.array, np.matrix)]
    print(f"{name}: array {found[name][0]:.4f}, matrix {found[name][1]:.4f}")
assert np.allclose(found["stretch"], 0.0959, atol=1e-4), "a stretch is wrong, too"
assert np.isclose(found["shear"][1], 0.1005, atol=1e-4), "a matrix is wrong, too"
assert found["shear"][0] < 1e-12, "a sheared packing has a strain now"
PYTHON
