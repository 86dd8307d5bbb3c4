#!/usr/bin/env bash
# Guess: a force of some pN is fitted in newtons with min=0, which it is far from in terms of its
#   error; the bound is not reached, so the fit is the one without it.
# Version: lmfit 1.3.4
# Behaviour: with one bound a value is sqrt(x**2 + 1) - 1 of an inner x, which double precision
#   resolves to 1e-16 in the unit of the value. A step of x for the derivative changes less than
#   that. The start value comes back, or 0 with an error of 0, and success is True. Without a
#   bound, or in pN, the value is right.
# Output seen: 6e-12 N from 2e-12 N: without bound 5.99e-12, min=0 2e-12, success True, "One or
#   more variable did not affect the fit"; 6e-18 J from 2e-18 J: without bound 5.99e-18, min=0
#   0 +- 0, success True, "Fit succeeded"; in pN with min=0 5.99
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check lmfit==1.3.4 numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import lmfit
import numpy as np

separation = np.linspace(0, 5, 200)  # in decay lengths
noise = 0.02 * np.random.default_rng(1).normal(size=separation.size)
shape = np.exp(-separation)


def fit(true, **bounds):
    measured = true * (shape + noise)
    parameters = lmfit.Parameters()
    parameters.add("amplitude", value=true / 3, **bounds)

    def residuals(parameters):
        return (parameters["amplitude"].value * shape - measured) / (0.02 * true)

    result = lmfit.minimize(residuals, parameters)
    amplitude = result.params["amplitude"]
    error = f"+- {amplitude.stderr}, success {result.success}, {result.message}"
    print(f"true {true:g}, {bounds}: {amplitude.value:.3g} {error}")
    assert result.success, "a fit that finds nothing is reported now"
    return amplitude.value / true, amplitude.stderr


for true in (6e-12, 6e-18):
    assert abs(fit(true)[0] - 1) < 0.05, "without bounds it is wrong, too"
assert abs(fit(6.0, min=0)[0] - 1) < 0.05, "in pN it is wrong, too"
assert abs(fit(6e-12, min=0)[0] - 1 / 3) < 0.01, "a lower bound of pN does not keep the start now"
assert fit(6e-18, min=0) == (0, 0), "a lower bound of aJ gives another value than 0 now"
PYTHON
