#!/usr/bin/env bash
# Guess: rotate(t_deg) of PyToM-3D turns a surface by three angles about x, y and z, each in the
#   same sense.
# Version: pytom3d 0.0.0rc6
# Behaviour: about x and z it turns as a right-handed screw, about y as a left-handed one. A surface
#   that is levelled with its two angles of tilt, from another program say, is level along y and
#   tilted twice as much along x.
# Output seen: 90 degrees: y goes to z, x goes to z (right-handed: z goes to x), x goes to y; tilts
#   of 2 and 3 degrees, turned back: 0.00 along y, 6.00 along x
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


def turn(points, angles):
    surface = Topography()
    surface.get_topography(*np.asarray(points, dtype=float).T)
    surface.rotate(t_deg=np.array(angles, dtype=float))
    return surface.P


x, y, z = np.eye(3)
about_x, about_y, about_z = np.round([
    turn([y], (90, 0, 0))[0], turn([x], (0, 90, 0))[0], turn([x], (0, 0, 90))[0]
])
print(f"about x: y to {about_x}, about y: x to {about_y}, about z: x to {about_z}")

along_x, along_y = np.mgrid[-5:6, -5:6]
level = np.column_stack([along_x.ravel(), along_y.ravel(), np.zeros(121)])


def right_handed(axis, degrees):
    """Turn that carries the axis after `axis` towards the one after that."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    matrix, angle = np.eye(3), np.deg2rad(degrees)
    matrix[first, first] = matrix[second, second] = np.cos(angle)
    matrix[second, first], matrix[first, second] = np.sin(angle), -np.sin(angle)
    return matrix


tilted = level @ right_handed(0, 2).T @ right_handed(1, 3).T
back = turn(turn(tilted, (0, -3, 0)), (-2, 0, 0))
slopes = np.linalg.lstsq(np.column_stack([back[:, :2], np.ones(121)]), back[:, 2], rcond=None)[0]
left_x, left_y = np.rad2deg(np.arctan(abs(slopes[:2])))
print(f"tilts of 2 and 3 degrees, turned back: {left_y:.2f} along y, {left_x:.2f} along x")
assert np.allclose(about_x, z) and np.allclose(about_z, y), "turns about x or z: another sense"
assert np.allclose(about_y, z), "turns about y have the sense of the others now"
assert left_y < 0.1 and np.isclose(left_x, 6, atol=0.1), "another tilt is left now"
PYTHON
