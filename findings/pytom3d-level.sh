#!/usr/bin/env bash
# Guess: svd() and rotate_by_svd() of PyToM-3D turn a tilted surface into its principal plane: it is
#   level afterwards.
# Version: pytom3d 0.0.0rc6
# Behaviour: the turn goes the wrong way, as the matrix of the decomposition is not transposed. A
#   surface with its middle at the origin is tilted by twice the angle; a second call doubles it
#   again. With the matrix transposed by hand it is level.
# Output seen: tilt of 5 degrees: 10.0 after the turn, 20.0 after a second one; transposed 0.0
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.2.6 scipy==1.17.1 pandas==2.3.3 matplotlib==3.10.8
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps pytom3d==0.0.0rc6
cd "$folder"
MPLBACKEND=agg "$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from pytom3d.core import Topography


def tilt(surface):
    """Angle between the best plane and the level one, in degrees."""
    points = surface.P - surface.P.mean(axis=0)
    normal = np.linalg.svd(points, full_matrices=False)[2][2]
    return float(np.rad2deg(np.arccos(min(abs(normal[2]), 1.0))))


def make():
    surface = Topography()
    surface.make_grid([-10, 10], [-5, 5], 41, 21)
    surface.add_points(lambda x, y: np.tan(np.deg2rad(5)) * x)
    return surface


surface, other = make(), make()
angles = [tilt(surface)]
for _ in range(2):
    surface.svd()
    surface.rotate_by_svd()
    angles.append(tilt(surface))
other.svd()
other.rotate(rot_mat=other.Vt.T)
print("tilt {:.1f} degrees, turned {:.1f}, turned again {:.1f}".format(*angles))
print(f"transposed {tilt(other):.1f}")
assert np.isclose(angles[0], 5) and tilt(other) < 1e-4, "the transposed turn is wrong, too"
assert np.isclose(angles[1], 10, atol=0.1), "the surface is level now"
assert np.isclose(angles[2], 20, atol=0.1), "another tilt after a second turn"
PYTHON
