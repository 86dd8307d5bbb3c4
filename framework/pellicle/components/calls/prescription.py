"""Calls of a prescription: its check of a value, its target and its report."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pellicle.checks import component_name, errors_attributed_to, real_number
from pellicle.components.prescription import Prescription, Search, Setting
from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.problem import Depth, Force
from pellicle.errors import ConfigError, PluginError, shown


def check_value(prescription: Prescription, setting: Setting, value: float, field: str) -> None:
    """Let a prescription check a prescribed value; its errors name ``field``.

    If an error names a field already, it keeps that one.
    """
    try:
        with errors_attributed_to(prescription):
            prescription.check(setting, value)
    except ConfigError as error:
        named = any(problem.field for problem in error.problems)
        raise (error if named else error.within(field)) from None


def target_of(prescription: Prescription, setting: Setting, value: float) -> Depth | Force | Search:
    """Return the depth, the force or the search for a prescribed value."""
    with errors_attributed_to(prescription):
        target = prescription.target(setting, value)
    call, name = f"target(setting, {value:g})", component_name(prescription)
    if not isinstance(target, (Depth, Force, Search)):
        raise PluginError(
            f"{name}: {call} returned {shown(target)}; it has to return a pellicle.Depth, Force "
            "or Search"
        )
    for field in ("value", "compliance", "goal", "resolution", "width", "guess"):
        number = getattr(target, field, None)
        if number is None:
            continue
        number = real_number(prescription, f"{call}.{field}", number)
        signed = field in ("goal", "guess") or (
            field == "value" and (isinstance(target, Depth) or setting.law is not None)
        )
        if not np.isfinite(number) or (number < 0 and not signed):
            allowed = "finite" if signed else "finite and ≥ 0"
            raise PluginError(f"{name}: {call}.{field} is {number:g}; it has to be {allowed}")
    if not isinstance(target, Search):
        return target
    quantity = target.measure
    if target.control not in (Depth, Force) or not callable(quantity):
        raise PluginError(
            f"{name}: {call} has to search by control = Depth or Force, with a function as measure"
        )

    def measure(step: Equilibrium) -> float:
        with errors_attributed_to(prescription):
            return real_number(prescription, f"{call}.measure(step)", quantity(step))

    return replace(target, measure=measure)


def report_of(prescription: Prescription, setting: Setting, step: Equilibrium) -> dict[str, float]:
    """Return the variables that a prescription adds to a step."""
    with errors_attributed_to(prescription):
        report = prescription.report(setting, step)
    declared = {v.name for v in prescription.variables if v.kind != "residual"}
    if not isinstance(report, dict) or report.keys() != declared:
        raise PluginError(
            f"{component_name(prescription)}: report() returned {shown(report)}; it has to return "
            f"a dict of {', '.join(sorted(declared)) or 'nothing'}, as its variables declare"
        )
    return {
        name: real_number(prescription, f"report()[{name!r}]", value)
        for name, value in report.items()
    }
