#!/usr/bin/env bash
# Guess: the two modes of the drift correction in pyfastspm, "full" and "common" (the "section which
#   stays constant during the entire movie"), hold the sample still in the same way.
# Version: pyfastspm 1.0.6 (its one module, without the others' dependencies)
# Behaviour: in "full" they do. In "common" the frame i is cut out with the drift of the frame -i,
#   counted from the end, and the other sign. For a steady drift the two cancel, except in the first
#   frame, which is off by the whole drift. After a drift that is not steady the sample jumps.
# Output seen: row of a molecule, 12 frames: steady drift: full 71 in all, common 25 in the first,
#   49 in the others; a jump after frame 9: full 65 in all, common 31 in six, 47 in six
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==1.26.4 scipy==1.15.3 \
    scikit-image==0.25.2 matplotlib==3.10.3
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps pyfastspm==1.0.6
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import importlib.util
import logging
import types

import numpy as np

(package,) = importlib.util.find_spec("pyfastspm").submodule_search_locations
spec = importlib.util.spec_from_file_location("drift", f"{package}/artefact_removal/drift.py")
drift = importlib.util.module_from_spec(spec)
spec.loader.exec_module(drift)
row, column = np.mgrid[:64, :64]


def correct(path):
    frames = [np.exp(-((row - 24 - down) ** 2 + (column - 32) ** 2) / 8) for down in path]
    movie = types.SimpleNamespace(data=np.stack(frames), filename="movie.h5", channels="uf",
                                  processing_log=logging.getLogger("movie"))
    known = -2.0 * np.array(path)  # the frames are enlarged to 128 rows
    table = [known, 0 * known, np.diff(known, prepend=0), 0 * known]
    np.savetxt("movie.drift.txt", np.column_stack(table))
    found = {}
    for mode in ("full", "common"):
        still, _ = drift.Drift(movie, stepsize=1).correct(mode=mode, known_drift="integrated")
        found[mode] = [int(np.unravel_index(np.argmax(frame), frame.shape)[0]) for frame in still]
        print(mode, *found[mode])
    return found


steady, jump = correct(range(12)), correct([0] * 9 + [8] * 3)
for found in (steady, jump):
    assert len(set(found["full"])) == 1, "the mode full is wrong, too"
first, *others = steady["common"]
assert set(others) == {first + 24}, "a steady drift is corrected in another way now"
assert sorted(jump["common"]) == [31] * 6 + [47] * 6, "a jump is corrected in another way now"
PYTHON
