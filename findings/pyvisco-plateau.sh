#!/usr/bin/env bash
# Guess: a Prony series that fits the storage and loss moduli of a solid keeps its plateau, the
#   modulus at low frequency.
# Version: pyvisco 2.1.3
# Behaviour: in the frequency domain, fit() with its default, opt=False, lets the terms make up
#   the whole instantaneous modulus: the plateau is zero, the solid a liquid, and the loss modulus
#   takes up what is left over, several times too large. opt=True, which the documentation has for
#   fewer terms, keeps the plateau; so does the time domain.
# Output seen: plateau 50 of 100 MPa: default 0.0 MPa, largest loss modulus 31.9 MPa (true 7.2);
#   opt=True 50.0 and 7.2; time domain 50.0
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pyvisco==2.1.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from pyvisco import load, master, prony

# five Maxwell elements of 10 MPa beside a spring of 50 MPa, over the eight decades around them
plateau, frequency, time = 50.0, np.geomspace(1e-4, 1e4, 81), np.geomspace(1e-4, 1e4, 81)
turns = 2 * np.pi * frequency * 10.0 ** np.arange(-2, 3)[:, None]
storage = plateau + (10 * turns**2 / (1 + turns**2)).sum(axis=0)
loss = (10 * turns / (1 + turns**2)).sum(axis=0)
relaxation = plateau + (10 * np.exp(-time / 10.0 ** np.arange(-2, 3)[:, None])).sum(axis=0)


def fit(header, columns, domain, **options):
    rows = [",".join(f"{value:.12g}" for value in row) for row in zip(*columns)]
    curve, _ = load.user_master("\n".join([*header, *rows]).encode(), domain, 20, "E")
    curve = master.smooth(curve)
    series, moduli = prony.fit(prony.discretize(curve), curve, **options)
    return series["E_0"] * (1 - series["df_terms"]["alpha_i"].sum()), moduli["E_loss"].max()


header, columns = ["f,E_stor,E_loss", "Hz,MPa,MPa"], (frequency, storage, loss)
default = fit(header, columns, "freq")
optimised = fit(header, columns, "freq", opt=True)
in_time = fit(["t,E_relax", "s,MPa"], (time, relaxation), "time")
for name, values in [("default", default), ("opt=True", optimised), ("time domain", in_time)]:
    print("{}: plateau {:.1f} MPa, largest loss modulus {:.1f} MPa".format(name, *values))
print(f"true: {plateau:.1f} and {loss.max():.1f} MPa")
for values in (optimised, in_time):
    assert np.allclose(values, (plateau, loss.max()), rtol=0.02), "the sound cases are wrong, too"
assert abs(default[0]) < 0.1, "the plateau is kept now"
assert default[1] > 4 * loss.max(), "the loss modulus is another one now"
PYTHON
