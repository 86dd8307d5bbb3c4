#!/usr/bin/env bash
# Guess: of a Newtonian fluid, shear_modulus_laplace_transform of DLSuR gives G'' = eta omega at the
#   frequencies that the lag times reach, perhaps less accurate at the ends.
# Version: DLSuR 0.0.22 (with a numpy that still has np.float)
# Behaviour: the Laplace integral stops at the last lag time, and moduli are given for every 1/t up
#   to it, where most of the integral is missing. Over the slowest quarter of a decade the loss
#   modulus is negative and the storage modulus far from zero, without a word. The local power law
#   (shear_modulus) is exact there.
# Output seen: G'' over eta omega at 1/t for t = 10, 1000, 6813, 10000 us: power law 1.00 1.00 1.00
#   1.00, Laplace 1.00 1.00 -0.43 -1.50; G' over eta omega at the last: 0.00 and 3.44
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

radius, temperature, viscosity = 100.0, 298.15, 1e-3  # nm, K, Pa s
lag = np.logspace(0, 4, 121)  # us
diffusion = 1.38e-23 * temperature / (6 * np.pi * viscosity * radius * 1e-9)  # m^2/s
displacement = 6 * diffusion * lag * 1e-6 * 1e18  # nm^2
true = viscosity * 1e6 / lag
at = [30, 90, 115, 120]

law = analysis_tools.shear_modulus(lag, displacement, np.ones_like(lag), radius, temperature)
laplace = analysis_tools.shear_modulus_laplace_transform(lag, displacement, radius, temperature)
for name, (_, storage, loss) in {"power law": law, "Laplace": laplace}.items():
    shares = " ".join(f"{loss[index] / true[index]:.2f}" for index in at)
    print(f"{name}: G'' over eta omega {shares}, G' at the last {storage[-1] / true[-1]:.2f}")
times = " ".join(f"{lag[index]:.0f}" for index in at)
print(f"at 1/t for t = {times} us; negative from {lag[laplace[2] < 0].min():.0f} us on")
assert np.allclose(law[2], true, rtol=2e-3), "the local power law is wrong, too"
assert np.isclose(laplace[2][90], true[90], rtol=0.03), "the middle of the range is wrong, too"
assert np.all(laplace[2][-8:] < 0), "the slowest loss moduli are not negative any more"
PYTHON
