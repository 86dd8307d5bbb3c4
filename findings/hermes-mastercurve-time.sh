#!/usr/bin/env bash
# Guess: AutomatedMasterCurve of hermes-rheo shifts relaxation moduli over time (x="time") as it
#   does dynamic moduli over frequency: a hotter curve moves to longer times by the same factor.
# Version: hermes-rheo 2.0.0, mastercurves 0.2.3, piblin 0.0.3
# Behaviour: it sorts by temperature and seeks factors of 0.01 to 1 between neighbours, the default
#   of mastercurves. Over time the factors are above 1: all come out as 1, nothing is shifted, no
#   message, and WLF fitted to them has a C1 of 0. Sorted from hot to cold (reverse_data=True) it is
#   right over time and all 1 over frequency. Factors below 0.01 come out as 0.01.
# Output seen: true factors 1, 0.316, 0.1: over frequency 1, 0.317, 0.1; over time 1, 1, 1 (true: 1,
#   3.16, 10); true factors of 3e-4 and 1e-7: 0.01 and 0.0001
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check hermes-rheo==2.0.0 \
    mastercurves==0.2.3 piblin==0.0.3 numpy==2.4.6
cd "$folder"
MPLBACKEND=agg "$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from hermes_rheo.transforms.automated_mastercurve import AutomatedMasterCurve
from piblin.data import Measurement, MeasurementSet, OneDimensionalCompositeDataset


def factors(name, modulus, x, temperatures):
    """Shift factors that are found; the true ones are 10^((25 - T) / 10)."""
    measurements = []
    for temperature in temperatures:
        y = modulus(x, 10 ** ((25 - temperature) / 10))
        dataset = OneDimensionalCompositeDataset(
            data_arrays=[x, y, np.full_like(x, temperature)],
            data_array_names=[name, "modulus", "temperature"],
            data_array_units=["", "Pa", "C"],
            default_independent_name=name,
            default_dependent_name="modulus",
        )
        measurements.append(Measurement(datasets=[dataset], conditions={}, details={}))
    measured = MeasurementSet(measurements=measurements, merge_redundant=False)
    found = AutomatedMasterCurve(x=name, y="modulus").apply_to(measured)
    return np.array(found.hparams[0], dtype=float)


def relax(time, shift):
    return 1e6 / (1 + time / shift) ** 0.4


def oscillate(rate, shift):
    return 1e6 * (rate * shift / (1 + rate * shift)) ** 0.4


x, near, far = np.geomspace(0.01, 100, 30), (25.0, 30.0, 35.0), (25.0, 60.0, 95.0)
over_rate = factors("angular frequency", oscillate, x, near)
over_time = factors("time", relax, x, near)
wide = factors("angular frequency", oscillate, np.geomspace(1e-4, 1e4, 60), far)
print("frequency {:.3f} {:.3f} {:.3f}, time {:.3f} {:.3f} {:.3f}".format(*over_rate, *over_time))
print("far apart {:.2g} {:.2g} {:.2g}".format(*wide))
assert np.allclose(over_rate, [1, 10**-0.5, 0.1], rtol=0.05), "frequencies are shifted wrongly, too"
assert np.allclose(over_time, 1, rtol=0.01), "times are shifted now"
assert np.allclose(wide, [1, 1e-2, 1e-4], rtol=0.05), "curves far apart are shifted now"
PYTHON
