"""The record of a fit: what was fitted, with which versions, and when."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import UTC, datetime
from itertools import chain
from time import perf_counter
from typing import Any

from pellicle import registry
from pellicle.components import Component
from pellicle.schema import walk

from .config import FitConfig
from .files.measurement import Measurement


def record_of(config: FitConfig, data: Iterable[dict[str, Any]], began: float) -> dict[str, Any]:
    """Return versions, date and wall time [s] of a fit since ``began`` of ``perf_counter``."""
    libraries = {entry["library"] for entry in data if entry["library"]}
    return {
        "versions": registry().all_versions(components_of(config), libraries),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "wall_time": round(perf_counter() - began, 3),
    }


def data_of(curve: Measurement, config: FitConfig) -> dict[str, Any]:
    """Return the origin of a curve, and which part of it is fitted, as JSON data."""
    return {
        **curve.origin._asdict(),
        "spring_constant": curve.stiffness,
        "segment": config.segment,
        "baseline": config.baseline,
        "poissons_ratio": config.poissons_ratio,
    }


def components_of(config: FitConfig) -> set[type[Component]]:
    """Return the components that a fit uses; of some only the tables are known."""
    fields = walk({"indenter": config.indenter, "kernel": config.kernel})
    types = {value for path, value, _ in fields if path.endswith(".type")}
    families = registry().components.values()
    named = {family[name].component for family in families for name in types & family.keys()}
    objects = config.indenter, config.executor, *config.model, *chain(*config.rivals)
    return named | {type(entry) for entry in objects if isinstance(entry, Component)}
