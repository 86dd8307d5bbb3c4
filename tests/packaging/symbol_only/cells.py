"""Print the relative errors of the reference coefficients, given a file of them, as JSON."""

import csv
import json
import sys
from pathlib import Path

import numpy as np

import pellicle as pl

lines = Path(sys.argv[1]).read_text().splitlines()
rows = [
    {key: float(value) for key, value in row.items()}
    for row in csv.DictReader(line for line in lines if not line.startswith("#"))
]
errors = {}
for s in sorted({row["s_over_D"] for row in rows}):
    kernel = pl.kernel("skin", reduced_modulus=1.0, tension=s / 2)
    grid = pl.Grid(points=[1001, 58], size=[1001.0, 58.0])
    pressure = np.zeros(grid.shape)
    pressure[0, 0] = 1.0
    u = pl.displacement(pressure, kernel=kernel, grid=grid)
    errors[s] = [
        u[int(row["i"]), int(row["j"])] / row["K_times_Estar_over_D"] - 1
        for row in rows
        if row["s_over_D"] == s
    ]
print(json.dumps(errors))  # noqa: T201 - what it is for
