#!/usr/bin/env bash
# Guess: msd() of pyDWS inverts its own formula for the correlation function: the mean squared
#   displacement of a gel, which stops at 1 nm^2, stops there at all times.
# Version: pyDWS 1.1.2
# Behaviour: it seeks the time constant of an equivalent diffusion and not beyond 1e5 s. A
#   displacement that stays needs a constant that grows with time; past the bound the displacement
#   grows in proportion to time. The gel turns into a liquid, after 4 s here, sooner where it is
#   stiffer; the correlation function that is "calculated" with it moves away from the measured one.
#   No message.
# Output seen: 1 s: 1 nm^2, 10 s: 3.44 nm^2, 1000 s: 344 nm^2 (true: 1 nm^2)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    pyDWS==1.1.2 numpy==2.4.6 scipy==1.17.1 pandas==2.3.3
cd "$folder"
MPLBACKEND=agg "$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
import pyDWS

wavelength, index = 633e-9, 1.33
cell, free_path = 2e-3, 2e-4  # m
number = 2 * np.pi * index / wavelength


def correlation(msd):
    """Intensity correlation of light that passes a slab, for a mean squared displacement."""
    root, depth, extrapolation, start = number * np.sqrt(msd), cell / free_path, 2 / 3, 2.0
    source = np.sinh(start * root) + extrapolation * root * np.cosh(start * root)
    slab = (1 + extrapolation**2 * root**2) * np.sinh(depth * root)
    slab += 2 * extrapolation * root * np.cosh(depth * root)
    return ((depth + 2 * extrapolation) / (start + extrapolation) * source / slab) ** 2


time = np.geomspace(1e-6, 1e3, 91)
true = 1e-18 * (1 - np.exp(-((time / 1e-4) ** 0.6)))
table = pyDWS.msd(time, correlation(true), free_path, wavelength, cell, index, 5e-7, None)[0]
found = table["msd"].to_numpy()
at = {t: int(np.argmin(abs(time - t))) for t in (1.0, 10.0, 1000.0)}
print(*(f"{t:g} s: {1e18 * found[k]:.3g} nm^2" for t, k in at.items()), "(true: 1 nm^2)")
assert np.allclose(found[time < 2], true[time < 2], rtol=0.01), "short times are wrong, too"
late = found[at[1000.0]] / found[at[10.0]]
assert found[at[1000.0]] > 100e-18 and np.isclose(late, 100, rtol=0.01), "it stops now"
PYTHON
