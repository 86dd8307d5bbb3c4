#!/usr/bin/env bash
# Guess: scan_movie of synth-afm takes ten frames a second of a molecule whose positions are given
#   every 10 ms: a second of it, 100 positions, is a movie of 10 frames, 0.1 s apart.
# Version: synth-afm 0.1.2 (its simulator needs JAX only)
# Behaviour: each position begins a frame: 100 frames, each 10 ms after the one before, though each
#   takes 100 ms to scan. What drifts or diffuses is ten times slower from frame to frame than at
#   the rate that was asked for. The rate counts within a frame, where the lag from line to line is
#   right. Where positions are a frame apart, which is the default, all is right.
# Output seen: 1 A each 10 ms, 10 frames a second: 1.0 A from frame to frame in 31 frames (true 10
#   A, 4 frames)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check jax==0.10.2 numpy==2.4.6
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps synth-afm==0.1.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import jax.numpy as jnp
import numpy as np
from synth_afm import AFMSimulator

steps, interval = 31, 0.01  # s
along = 10 + np.arange(steps)  # A: 100 A/s
path = np.column_stack([along, np.full(steps, 32.0), np.full(steps, 5.0)])
atom = jnp.asarray(path[:, None, :])
simulator = AFMSimulator(pixel_size=1.0, grid_size=(64, 64), tip_radius=5.0)


def step(rate, **options):
    """Number of frames and how far the atom moves from one to the next, in A."""
    movie = np.asarray(simulator.scan_movie(atom, frames_per_second=rate, **options))
    places = [np.unravel_index(np.argmax(frame), frame.shape)[0] for frame in movie]
    return len(movie), float(np.median(np.diff(places[:12])))


slow, fast = step(10.0, trajectory_dt=interval), step(1 / interval, trajectory_dt=interval)
print(f"10 frames a second: {slow[0]} frames, {slow[1]:.1f} A apart (true 10 A)")
print(f"100 frames a second: {fast[0]} frames, {fast[1]:.1f} A apart (true 1 A)")
assert fast == (steps, 1.0), "a position for each frame is wrong, too"
assert slow == (steps, 1.0), "frames have the rate that was asked for now"
PYTHON
