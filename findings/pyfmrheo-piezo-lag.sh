#!/usr/bin/env bash
# Guess: the lag of the piezo that ComputePiezoLag of pyfmrheo finds on a stiff sample is taken
#   off when it is given as fi to the computation of a modulus.
# Version: pyfmrheo 0.1.3
# Behaviour: the sines take it off. The Fourier transform turns the modulus by minus the size of
#   fi, whichever its sign: a lag, which ComputePiezoLag gives as a negative angle, is not taken
#   off but doubled, and the loss modulus drops to half at 5 degrees.
# Output seen: lag -5.0 degrees: FFT 313+46j Pa, sines 300+100j Pa; true 300+100j Pa, not
#   corrected 308+73j Pa
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pyfmrheo==0.1.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from pyfmrheo.models import rheology

shear, radius, depth, spring = 300 + 100j, 5e-6, 500e-9, 0.1
rate, frequency, amplitude, lag = 1000.0, 10.0, 10e-9, np.radians(5)
turn = 2 * np.pi * frequency * np.arange(1000) / rate

# on a stiff sample the tip moves with the piezo, whose sensor is 5 degrees ahead
found, _, _ = rheology.ComputePiezoLag(np.sin(turn), np.sin(turn - lag), rate, frequency)
# on the soft sample the force follows the indentation that the sensor tells 5 degrees late
stiffness = 4 * np.sqrt(radius * depth) * shear / (1 - 0.5) * np.exp(-1j * lag)
deflection, phase = amplitude * abs(stiffness) / spring, np.angle(stiffness)
bent = deflection * np.sin(turn + phase)
height = amplitude * np.sin(turn) + bent


def transform(angle):
    storage, loss, _ = rheology.ComputeComplexModulusFFT(
        bent, height, [0, 0], spring, rate, frequency, "paraboloid", radius, depth, fi=angle
    )
    return complex(storage, loss)


young = rheology.ComputeComplexModulusSine(
    deflection, amplitude, depth, phase, frequency, "paraboloid", radius, spring, fi=found
)
sines, once, twice = young / 3, shear * np.exp(-1j * lag), shear * np.exp(-2j * lag)
print(f"lag {found:.1f} degrees: FFT {transform(found):.0f} Pa, sines {sines:.0f} Pa, "
      f"not corrected {transform(0):.0f} Pa")
assert np.isclose(found, -5), "another sign of the lag"
assert np.isclose(transform(0), once), "without a correction it is another modulus"
assert np.isclose(sines, shear), "sines are wrong, too"
assert np.isclose(transform(found), twice), "the FFT does not double the lag any more"
assert np.isclose(transform(-found), twice * np.exp(0j)), "the sign counts now"
PYTHON
