#!/usr/bin/env bash
# Guess: find_resonance of spmkit gives the quality factor of a thermal spectrum as the instrument
#   writes it, in m/sqrt(Hz), which is what extract_thermal of the same package returns.
# Version: spmkit 0.1.2
# Behaviour: its width is the one at half of the largest amplitude, where the energy is a quarter:
#   sqrt(3) times that of the resonance. The quality factor is 58 % of the true one, the damping 1.7
#   times too large. The field is named psd, and for a spectrum of power the function is right;
#   fit_sho beside it, which falls back to this one where its fit fails, expects amplitudes.
# Output seen: Q = 50: find_resonance 28.9 (amplitudes), 50.0 (power), fit_sho 50.0 (amplitudes)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    spmkit==0.1.2 numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from spmkit.core.analysis.resonance import find_resonance, fit_sho

quality, resonance = 50.0, 70e3
frequency = np.linspace(1e3, 150e3, 200_001)
power = 1 / ((frequency**2 - resonance**2) ** 2 + (resonance * frequency / quality) ** 2)
power *= (1e-12) ** 2 / power.max()  # pm/sqrt(Hz) at the peak
amplitude = np.sqrt(power)

found = {
    "amplitudes": find_resonance(frequency, amplitude).q_factor,
    "power": find_resonance(frequency, power).q_factor,
    "fit_sho": fit_sho(frequency, amplitude / amplitude.max()).q_factor,
}
print(", ".join(f"{name} {value:.1f}" for name, value in found.items()))
assert np.isclose(found["power"], quality, rtol=0.01), "a spectrum of power is wrong, too"
assert np.isclose(found["fit_sho"], quality, rtol=0.01), "the fit is wrong, too"
assert np.isclose(found["amplitudes"], quality / np.sqrt(3), rtol=0.01), "amplitudes: another one"
PYTHON
