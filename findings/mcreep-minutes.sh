#!/usr/bin/env bash
# Guess: time_to_seconds of mcreep converts a table of minutes; after that it is fitted as one of
#   seconds, with the same compliances.
# Version: mcreep 1.1.6
# Behaviour: t_start and t_hold cut the table before the conversion, so they are minutes, and then
#   choose the rows of the fit after it, as seconds: of a hold from 6 s to 10 min the first four
#   seconds are fitted. The correction for the ramp takes 0.1 as its seconds, too. R2fit is near 1;
#   R2all, over all rows, says that it failed.
# Output seen: slow compliance 0.2: table in seconds 0.200, in minutes -0.938; R2fit 1.000 and
#   1.000, R2all 1 and -1740
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    mcreep==1.1.6 numpy==2.4.6 scipy==1.17.1 pandas==3.0.1 matplotlib==3.11.2
cd "$folder"
MPLBACKEND=Agg "$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from mcreep import const, func, model

# Berkovich tip, h^2 / K = F (C0 + Cv t + sum C (1 - exp(-t / tau))), a ramp of 6 s, then a hold
ramp, hold, load, compliances, delays = 6.0, 600.0, 10.0, (0.1, 0.2), (5.0, 100.0)
time = np.linspace(ramp, ramp + hold, 2401)
depth = 0.3 + 1e-4 * (time - ramp / 2)
for compliance, tau in zip(compliances, delays):
    share = tau / ramp * (np.exp(ramp / tau) - 1)
    depth += compliance * (1 - share * np.exp(-time / tau))
experiment = const.Experiment("Berkovich", F=load)
depth = np.sqrt(experiment.K * load * depth)
depth *= 1 + 5e-5 * np.random.default_rng(2).normal(size=time.size)


def fit(name, unit):
    np.savetxt(name, np.column_stack([time / unit, depth]), fmt="%.10g")
    plots = const.PlotParameters("t", "h", showfigs=False)
    creep = model.Model(
        experiment, const.DataParameters(time_to_seconds=unit), plots, "S+D+2KV",
        func.evp_s_d_2kv, rtimes=list(delays),
    )
    creep.run(name, ramp / unit, hold / unit)
    slow, fitted = creep.table_of_results_evp.iloc[0].C2, creep.table_of_results.iloc[0]
    print(f"{name}: C2 {slow:.3f}, R2fit {fitted.R2fit:.3f}, R2all {fitted.R2all:.3g}")
    return slow, fitted.R2fit, fitted.R2all


seconds, minutes = fit("seconds.txt", 1.0), fit("minutes.txt", 60.0)
assert abs(seconds[0] / compliances[1] - 1) < 0.01, "a table of seconds is wrong, too"
assert abs(minutes[0] / compliances[1] - 1) > 0.5, "a table of minutes gives the same now"
assert minutes[1] > 0.99, "the fit itself says so now"
assert minutes[2] < 0.9, "R squared of all rows does not say so any more"
PYTHON
