#!/usr/bin/env bash
# Guess: load_model_from_file(path) gives the model that stands in the file of that path, also
#   when the file has been edited, and when another folder has one of the same name.
# Version: nanite 4.2.3
# Behaviour: the file is imported by its name without the folder, once in a session. An edited
#   file, or one of the same name in another folder, gives the first model, without a word: a
#   corrected factor changes no modulus until Python is started again.
# Output seen: E with the factor 4/3: 1000 Pa; edited to 2: 1000 Pa; folder b, factor 4: 1000 Pa;
#   another name, factor 4: 333 Pa
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check nanite==4.2.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from pathlib import Path

import numpy as np
from nanite import Indentation
from nanite.model import load_model_from_file

MODEL = """
import lmfit
import numpy as np

def get_parameter_defaults():
    parameters = lmfit.Parameters()
    parameters.add("E", value=3e3, min=0)
    parameters.add("contact_point", value=0)
    parameters.add("baseline", value=0)
    return parameters

def paraboloid(delta, E, contact_point=0, baseline=0):
    "Paraboloid of R = 5 um on a solid with a Poisson's ratio of 0."
    return {factor} * E * np.sqrt(5e-6) * np.maximum(contact_point - delta, 0) ** 1.5 + baseline

model_doc, model_func, model_key, model_name = paraboloid.__doc__, paraboloid, "own", "own model"
parameter_keys, parameter_units = ["E", "contact_point", "baseline"], ["Pa", "m", "N"]
parameter_names = ["Young's Modulus", "Contact Point", "Force Baseline"]
valid_axes_x, valid_axes_y = ["tip position"], ["force"]
"""
tip = np.linspace(1e-6, -5e-7, 1000)
force = 4 / 3 * 1e3 * np.sqrt(5e-6) * np.maximum(-tip, 0) ** 1.5


def modulus(path, factor):
    path.parent.mkdir(exist_ok=True)
    path.write_text(MODEL.format(factor=factor))
    load_model_from_file(path, register=True)
    curve = Indentation(
        {"force": force, "tip position": tip, "segment": np.zeros(tip.size, dtype=np.uint8)},
        {"path": Path("curve"), "enum": 0, "imaging mode": "force-distance"},
    )
    curve.fit_model(model_key="own", preprocessing=[], weight_cp=0, segment=0)
    fitted = curve.fit_properties["params_fitted"]["E"].value
    print(f"{path} with the factor {factor}: {fitted:.1f} Pa")
    return fitted


assert abs(modulus(Path("a/model.py"), 4 / 3) - 1000) < 1, "a first model is not right"
assert abs(modulus(Path("c/other.py"), 4) - 1000 / 3) < 1, "a model of another name is not right"
assert abs(modulus(Path("a/model.py"), 2) - 1000) < 1, "an edited file is read again now"
assert abs(modulus(Path("b/model.py"), 4) - 1000) < 1, "a file of another folder is read now"
PYTHON
