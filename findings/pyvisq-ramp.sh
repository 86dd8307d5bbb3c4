#!/usr/bin/env bash
# Guess: in a relaxation test of pyvisq, whose strain is ramped within D1, a dashpot beside a
#   spring (Kelvin-Voigt) bears c times the strain rate during the ramp.
# Version: pyvisq 1.2.2
# Behaviour: it bears nothing: the stress is that of the spring. The same holds for a dashpot
#   beside a Maxwell element (JeffreysZener). In creep the same dashpot is there, so the two tests
#   of one model do not belong together.
# Output seen: Kelvin-Voigt, halfway up: 2.5 (true 102.5); JeffreysZener 2.47 (true 32.47); creep
#   at one retardation time 0.126 of 0.2 (true 0.126)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pyvisq==1.2.2 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from pyvisq import Test, TestMethod
from pyvisq.models.elements import DashpotParams, SpringParams
from pyvisq.models.kelvinvoigt import KelvinVoigt, KelvinVoigtParams
from pyvisq.models.zener import JeffreysZener, JeffreysZenerParams

damper, spring, beside, ramp = 10.0, 5.0, 3.0, 0.1


def stretch(model):
    model.set_test(Test(TestMethod.RELAXATION, 1.0, ramp, 1.0, 1.0, 1.0))
    model.set_time()
    model.set_input()
    model.run()
    return float(np.interp(ramp / 2, model.data.time, model.data.stress))


solid = KelvinVoigt(KelvinVoigtParams(DashpotParams(damper), SpringParams(spring)))
fluid = JeffreysZener(
    JeffreysZenerParams(DashpotParams(damper), SpringParams(spring), DashpotParams(beside))
)
creep = solid.J(damper / spring)
# Maxwell element under a ramp: c v (1 - exp(-t k / c))
maxwell = damper / ramp * (1 - np.exp(-ramp / 2 * spring / damper))
stresses = stretch(solid), stretch(fluid)
print(f"Kelvin-Voigt {stresses[0]:.2f} (true {spring / 2 + damper / ramp:.2f}), JeffreysZener "
      f"{stresses[1]:.2f} (true {maxwell + beside / ramp:.2f}), creep {creep:.3f}")
assert np.isclose(creep, (1 - np.exp(-1)) / spring), "the dashpot is missing in creep, too"
assert np.isclose(stresses[0], spring / 2, rtol=0.01), "Kelvin-Voigt has a dashpot now"
assert np.isclose(stresses[1], maxwell, rtol=0.01), "JeffreysZener has the dashpot beside it now"
PYTHON
