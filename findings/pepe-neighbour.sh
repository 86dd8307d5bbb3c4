#!/usr/bin/env bash
# Guess: calculateD2Min of pepe counts each particle within interactionRadius as a neighbour: one
#   that moves alone is seen in the non-affine motion D2min, whichever it is.
# Version: pepe-granular 1.2.9 (its one module, without the image tools of the others)
# Behaviour: the first of the particles found is left out as the reference particle itself, but what
#   is within a radius is not sorted by distance. A neighbour is left out, the reference is counted
#   instead with a bond of no length. With interactionNeighbors, which are sorted, all are seen.
# Output seen: square lattice, one of 8 neighbours moved: lowest and highest D2min with a radius
#   0.0000 0.0049, with 8 neighbours 0.0042 0.0052
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

before = np.stack(np.meshgrid(np.arange(7.0), np.arange(7.0)), -1).reshape(-1, 2)
middle = 24
distance = np.hypot(*(before - before[middle]).T)
neighbours = np.flatnonzero((distance > 0) & (distance < 1.6))


def measure(**which):
    found = []
    for moved in neighbours:
        after = before.copy()
        after[moved] += (0.1, 0.2)
        found.append(d2min.calculateD2Min(before, after, middle, **which)[0])
    print(which, *(f"{value:.4f}" for value in found))
    return np.array(found)


radius, count = measure(interactionRadius=1.6), measure(interactionNeighbors=8)
assert len(neighbours) == 8 and np.all(count > 4e-3), "a number of neighbours is wrong, too"
assert np.sum(radius < 1e-12) == 1, "no neighbour is left out any more"
PYTHON
