#!/usr/bin/env bash
# Guess: Rs of surface_roughness, true over nominal area of a fracture surface, is 1 for a flat
#   one and grows with roughness.
# Version: surface_roughness 0.0.3
# Behaviour: the nominal area of a triangle is not halved, that of the surface is; Rs of a flat
#   surface is 0.5 and all others are half of the true ones.
# Output seen: flat 0.500; ridges at 45 degrees 0.707 (true 1.414); area 361.0 (true 361)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    surface_roughness==0.0.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import meshio
import numpy as np
from surface_roughness import Surface

n = 20
x, y = np.meshgrid(np.arange(n, dtype=float), np.arange(n, dtype=float))
node = np.arange(n * n).reshape(n, n)
corners = [node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]]
triangles = np.concatenate(
    [np.column_stack([corners[k].ravel() for k in three]) for three in [(0, 1, 2), (0, 2, 3)]]
)


def measure(height):
    points = np.column_stack([x.ravel(), y.ravel(), height.ravel()])
    surface = Surface(mesh=meshio.Mesh(points, [("triangle", triangles)]), verbose=False)
    return surface.rs(), surface.area


# the surface is turned to its mean plane, which must not be level to the last digit
flat, area = measure(1e-6 * x)
ridges, _ = measure(np.abs(x % 2 - 1) + 1e-6 * x)
print(f"flat {flat:.3f}, ridges at 45 degrees {ridges:.3f} (true 1.414), area {area:.1f}")
assert np.isclose(area, (n - 1) ** 2), "the area is wrong, too"
assert np.isclose(flat, 0.5, atol=1e-3), "Rs of a flat surface is another one now"
assert np.isclose(ridges, np.sqrt(0.5), atol=0.01), "Rs of ridges is another one now"
PYTHON
