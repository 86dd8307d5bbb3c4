#!/usr/bin/env bash
# Guess: the two ways of pyfmrheo to a complex modulus, from the Fourier transform or from fitted
#   sines, give one modulus for one oscillation.
# Version: pyfmrheo 0.1.3
# Behaviour: ComputeComplexModulusFFT gives the shear modulus, ComputeComplexModulusSine Young's
#   modulus; both are called G. They differ by 2 (1 + nu), which is 3 at the default nu = 0.5.
#   With a pyramid they differ by another 3 %, as its factor is 3/4 in one and 4/(3 sqrt(3)) in
#   the other (and 1/sqrt(2) in the fit of the approach).
# Output seen: paraboloid: FFT 300+100j Pa, sines 900+300j Pa; pyramid: FFT 300+100j, sines
#   877+292j; true shear modulus 300+100j Pa
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pyfmrheo==0.1.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from pyfmrheo.models import rheology

shear, ratio, depth = 300 + 100j, 0.5, 500e-9  # Pa, Poisson's ratio, mean indentation in m
spring, rate, frequency, amplitude = 0.1, 1000.0, 10.0, 10e-9
turn = 2 * np.pi * frequency * np.arange(1000) / rate


def compute(shape, tip, stiffness):
    phase, deflection = np.angle(stiffness), amplitude * abs(stiffness) / spring
    bent = deflection * np.sin(turn + phase)
    height = amplitude * np.sin(turn) + bent
    storage, loss, _ = rheology.ComputeComplexModulusFFT(
        bent, height, [0, 0], spring, rate, frequency, shape, tip, depth, poisson_ratio=ratio
    )
    sines = rheology.ComputeComplexModulusSine(
        deflection, amplitude, depth, phase, frequency, shape, tip, spring, poisson_ratio=ratio
    )
    return complex(storage, loss), sines


radius, angle = 5e-6, 35.0
sphere = compute("paraboloid", radius, 4 * np.sqrt(radius * depth) * shear / (1 - ratio))
pyramid = compute("pyramid", angle, 3 * np.tan(np.radians(angle)) * depth * shear / (1 - ratio))
for name, values in [("paraboloid", sphere), ("pyramid", pyramid)]:
    print("{}: FFT {:.0f} Pa, sines {:.0f} Pa".format(name, *values))
assert np.isclose(sphere[0], shear) and np.isclose(pyramid[0], shear), "the FFT has another modulus"
assert np.isclose(sphere[1], 2 * (1 + ratio) * shear), "sines have the modulus of the FFT now"
assert np.isclose(pyramid[1] / sphere[1], 0.75 / (4 / 3**1.5)), "another factor of the pyramid"
PYTHON
