#!/usr/bin/env bash
# Guess: calc_msd_raw and msd_local_pwr_law of DLSuR turn the same field correlation g1 into the
#   same mean squared displacement, one as it is, one smoothed: -6 ln(g1) / q^2.
# Version: DLSuR 0.0.22 (with a numpy that still has np.float)
# Behaviour: the raw one has the other sign: every displacement is negative. With replace_neg=True,
#   its own remedy for negative values, none is left to interpolate between and it raises an error.
# Output seen: free diffusion, displacement at 10, 100, 1000 us: true 6 60 600 nm^2, smoothed 6 60
#   600, raw -6 -60 -600; with replace_neg ValueError
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==1.23.5 scipy==1.11.4 pandas==1.5.3 setuptools==69.5.1 wheel==0.43.0
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps \
    --no-build-isolation DLSuR==0.0.22
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from dlsmicro.backend import analysis_tools

lag = np.logspace(0, 4, 81)  # us
true = 6 * 0.1 * lag  # nm^2, a particle of 0.1 um^2/s
wave_vector = analysis_tools.calc_q(1.333, np.radians(173), 633.0)
field = np.exp(-(wave_vector**2) * true / 6)
shown = [20, 40, 60]


def show(name, values):
    print(name, *(f"{values[index]:.0f}" for index in shown), "nm^2")


smooth = analysis_tools.msd_local_pwr_law(lag, field, wave_vector)[0]
raw = analysis_tools.calc_msd_raw(lag, field, wave_vector, replace_neg=False)
show("true", true)
show("smoothed", smooth)
show("raw", raw)
try:
    analysis_tools.calc_msd_raw(lag, field, wave_vector)
    replaced = True
except ValueError as error:
    replaced = False
    print("with replace_neg: ValueError:", error)
assert np.allclose(smooth, true, rtol=1e-3), "the smoothed displacement is wrong, too"
assert np.allclose(raw, -true), "the raw displacement is not the negative one any more"
assert not replaced, "negative displacements are replaced now"
PYTHON
