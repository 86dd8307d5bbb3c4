#!/usr/bin/env bash
# Guess: G and J of one model describe one solid: stiff at once, soft later, and G J is 1 at zero
#   time and, in an elastic solid, at all times.
# Version: pyvisq 1.2.2
# Behaviour: Powerlaw relaxes from modulus_0 to modulus_inf, but its creep begins at the soft end,
#   1 / modulus_inf, and grows without a bound; with an exponent of zero, an elastic solid of
#   modulus_0 in relaxation, J is 1 / modulus_inf + 1 / modulus_0. Other models (Zener) agree with
#   themselves.
# Output seen: modulus_0 10, modulus_inf 1: G(0) J(0) = 10.0 (Zener 1.0); J at 1e9 tau 51.1;
#   exponent 0: G = 10.0, J = 1.1
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pyvisq==1.2.2 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from pyvisq.models.elements import DashpotParams, SpringParams
from pyvisq.models.powerlaw import Powerlaw, PowerlawParams
from pyvisq.models.zener import SLS, SLSParams

power = Powerlaw(PowerlawParams(modulus_0=10.0, modulus_inf=1.0, tau=1.0, e=0.3))
elastic = Powerlaw(PowerlawParams(modulus_0=10.0, modulus_inf=1.0, tau=1.0, e=0.0))
zener = SLS(SLSParams(DashpotParams(9.0), SpringParams(9.0), SpringParams(1.0)))
at_once = [model.G(0.0) * model.J(0.0) for model in (power, zener)]
late = power.J(1e9)
print(f"G(0) J(0) = {at_once[0]:.1f} (Zener {at_once[1]:.1f}), J late {late:.1f}; "
      f"exponent 0: G = {elastic.G(1.0):.1f}, J = {elastic.J(1.0):.1f}")
assert np.isclose(at_once[1], 1), "Zener is wrong, too"
assert np.isclose(at_once[0], 10), "creep begins at another compliance now"
assert late > 10 * power.J(0.0), "creep has a bound now"
assert np.isclose(elastic.G(1.0), 10) and np.isclose(elastic.J(1.0), 1.1), "exponent 0 is another"
PYTHON
