"""A run of three steps that takes a few milliseconds, and what tests make of it."""

from __future__ import annotations

from typing import Any

RUN: dict[str, Any] = {
    "grid": {"points": 20, "size": "0.4 mm"},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "1 N/m"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": ["5 um", "10 um", "15 um"]},
    "outputs": [],
}
