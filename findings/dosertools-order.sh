#!/usr/bin/env bash
# Guess: make_summary_dataframe of dosertools fits each run of a sample by itself: its relaxation
#   time does not depend on the runs beside it.
# Version: dosertools 1.0.2
# Behaviour: the fit begins at a tenth of the first diameter, or where the elastic regime begins if
#   that is later. The later beginning of one run stays for all runs and samples after it. In
#   another order, of file names say, the same video has another relaxation time.
# Output seen: a run alone 22.2 ms, before another run 22.2 ms, after it 27.4 ms
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==2.2.6 scipy==1.17.1 \
    pandas==2.3.3 matplotlib==3.10.8 scikit-image==0.26.0 holoviews==1.22.1
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps dosertools==1.0.2
cd "$folder"
MPLBACKEND=agg "$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
import pandas as pd
from dosertools.data_processing.fitting import make_summary_dataframe


def thin(run, beginning):
    """A filament whose elastic regime, from `beginning` on, is a while in coming."""
    time = np.arange(0, 1, 1e-3)
    diameter = beginning * np.exp(-time / 0.15) * (1 + np.exp(-time / 0.03)) / 2
    columns = {"time (s)": time, "D/D0": diameter, "Dtc/D0": beginning}
    return pd.DataFrame({**columns, "sample": "0.1-polymer", "run": run})


def relaxation(*runs):
    """Relaxation time of the first run, in ms, wherever it stands in the list."""
    table = make_summary_dataframe(pd.concat(runs, ignore_index=True), "percent-name")
    return float(table.loc[table["run"] == 1, "Lambda E (ms)"].iloc[0])


first, other = thin(1, 0.12), thin(2, 0.06)
alone, before, after = relaxation(first), relaxation(first, other), relaxation(other, first)
print(f"alone {alone:.1f} ms, before the other run {before:.1f} ms, after it {after:.1f} ms")
assert np.isclose(alone, before), "a later run changes it, too"
assert after > 1.1 * alone, "the order of the runs does not matter now"
PYTHON
