#!/usr/bin/env bash
# Guess: the Mittag-Leffler function of rheojax, which joins a power series and its limit for large
#   arguments "smoothly", falls from 1 towards 0 for the relaxation of a spring and a springpot in
#   series, E_a(-(t / tau)^a), whatever the order a is.
# Version: rheojax 0.7.1 (asks for Python 3.12; this function needs JAX only, which is 0.10.2 here)
# Behaviour: the series is used to where its terms have grown far past the 16 digits of a double,
#   the further the smaller the order. An order of 0.8 is right within a few per cent; orders of 0.2
#   and 0.3 are off by any power of ten over a decade of time, from 22 and 30 tau on, right before
#   and after. No warning. Its fractional models use it.
# Output seen: where it is worst from 1 to 1000 tau: order 0.2: -1.04e+60 at 251 tau (true 0.225),
#   order 0.3: -2.55e+35 at 89 tau (0.172), order 0.8: 0.0473 at 9 tau (0.048)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    jax==0.10.2 numpy==2.4.6 scipy==1.17.1
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps \
    --ignore-requires-python rheojax==0.7.1
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import importlib.util
import logging
import sys
from pathlib import Path
from types import ModuleType

import jax
import jax.numpy as jnp
import numpy as np
from scipy.integrate import quad

jax.config.update("jax_enable_x64", True)
package = Path(importlib.util.find_spec("rheojax").submodule_search_locations[0])
config, log = ModuleType("rheojax.core.jax_config"), ModuleType("rheojax.logging")
config.safe_import_jax = lambda: (jax, jnp)
log.get_logger = logging.getLogger
for module in (ModuleType("rheojax"), ModuleType("rheojax.core"), config, log):
    sys.modules[module.__name__] = module
spec = importlib.util.spec_from_file_location("ml", package / "utils" / "mittag_leffler.py")
ml = importlib.util.module_from_spec(spec)
spec.loader.exec_module(ml)


def true(order, time):
    """Sum of exponentials with the spectrum of the springpot and the spring."""
    def density(u):
        power = np.exp(order * u)
        below = power**2 + 2 * power * np.cos(np.pi * order) + 1
        return np.exp(-np.exp(u) * time) * power * np.sin(np.pi * order) / np.pi / below
    return quad(density, -60, 10, limit=500)[0]


largest = {}
for order in (0.2, 0.3, 0.8):
    times = np.geomspace(1, 1000, 61)
    found = np.asarray(ml.mittag_leffler_e(jnp.asarray(-(times**order)), order))
    right = np.array([true(order, time) for time in times])
    worst = int(np.argmax(abs(found - right)))
    largest[order] = float(abs(found / right - 1).max())
    print(f"order {order}: {found[worst]:.3g} at {times[worst]:.0f} tau (true {right[worst]:.3f})")
    assert np.allclose(found[[0, -1]], right[[0, -1]], rtol=0.01), "1 and 1000 tau are wrong, too"
assert largest[0.8] < 0.05, "large orders are wrong, too"
assert largest[0.3] > 10 and largest[0.2] > 1e6, "small orders are right now"
PYTHON
