#!/usr/bin/env bash
# Guess: a surface whose shape is not that of the model is refused.
# Version: tamaas 2.9.0 (its wheels are for Linux on x86-64)
# Behaviour: the number of points is compared, not the shape. A surface of 64 x 32 points in a
#   model of 32 x 64, as after a transposition, is read in the order of its memory: another
#   surface, without a warning. Only another number of points is refused.
# Output seen: contact area 0.0967 right, 0.0752 transposed; 32 x 32: refused
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check tamaas==2.9.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
import tamaas

tamaas.set_log_level(tamaas.LogLevel.error)
along, across = np.cos(2 * np.pi * np.arange(32) / 32), np.cos(4 * np.pi * np.arange(64) / 64)
heights = np.add.outer(0.02 * along, 0.01 * across)


def area(surface):
    model = tamaas.Model(tamaas.model_type.basic_2d, [1.0, 1.0], [32, 64])
    model.E, model.nu = 1.0, 0.0
    tamaas.PolonskyKeerRey(model, surface, 1e-10).solve(0.005)
    return (model.traction > 0).mean()


right, transposed = area(heights), area(heights.T.copy())
print(f"contact area {right:.4f} right, {transposed:.4f} transposed")
in_memory = area(heights.T.copy().reshape(32, 64))
assert transposed == in_memory, "the points are taken in another order now"
assert abs(transposed / right - 1) > 0.1, "the areas agree now"
try:
    area(heights[:, :32].copy())
except Exception as error:
    print("32 x 32:", type(error).__name__)
else:
    raise SystemExit("another number of points is taken, too")
PYTHON
