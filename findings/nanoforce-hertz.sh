#!/usr/bin/env bash
# Guess: calc_modulus of nanoforce, "the Hertz model for a spherical indenter", gives back the
#   modulus of a curve that Hertz's law made.
# Version: nanoforce 0.3.32 (for Python 3.11 with tkinter, without its dependency "sklearn", which
#   cannot be installed)
# Behaviour: it puts a straight line through the origin and all points in contact and takes the
#   force of that line at the deepest one as Hertz's. A straight line below d^1.5 is 6/7 of it
#   there: the modulus is 14 % low, for any radius, depth or modulus, where the points are evenly
#   spread; more of them deep in the contact make it less. The cone (calc_modulus_sneddon) is right.
# Output seen: sphere 0.858 of the modulus, cone 1.000
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

modulus, ratio, radius, angle = 1e6, 0.5, 1e-6, 35
z = np.linspace(-100, 100, 401)  # nm, negative in the sample, the deepest first
depth = 1e-9 * np.maximum(-z, 0)
reduced = modulus / (1 - ratio**2)
forces = {
    "sphere": 4 / 3 * reduced * np.sqrt(radius) * depth**1.5,
    "cone": 2 / np.pi * reduced * np.tan(np.radians(angle)) * depth**2,
}


def fit(shape):
    afm = AFM()
    afm.z_approach, afm.approach = z[:, None], 1e9 * forces[shape][:, None]
    if shape == "sphere":
        afm.calc_modulus(poisson_ratio=ratio, indenter_radius=radius)
    else:
        afm.calc_modulus_sneddon(poisson_ratio=ratio, opening_angle=angle)
    return float(afm.modulus[0]) * 1e6 / modulus


seen = {shape: fit(shape) for shape in forces}
print("; ".join(f"{shape}: {found:.3f} of the modulus" for shape, found in seen.items()))
assert np.isclose(seen["cone"], 1, rtol=1e-6), "the cone is wrong, too"
assert np.isclose(seen["sphere"], 6 / 7, rtol=0.01), "the sphere has another modulus now"
PYTHON
