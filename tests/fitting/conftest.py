"""Lets the tests here use the ensemble of the benchmarks, and the files of instruments."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path += [str(HERE), str(HERE.parent / "benchmarks")]
