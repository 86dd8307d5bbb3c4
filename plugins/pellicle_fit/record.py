"""The record of a fit: codes, numbers and sentences, from which tables, pages and rows are made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from pellicle.files import json_text

from .estimation.intervals import Estimate
from .selection.verdict import Verdict

NUMBERS = {
    **dict.fromkeys(("r_squared", "chi_squared", "points"), "1"),
    "noise": "N",
    "indentation": "m",
    "largest_force": "N",
    **dict.fromkeys(("lead", "tension_needed", "failed_checks", "messages"), "1"),
}
"""Unit of each number of a fit that is not a quantity of it; checks and messages are counted."""
MODULI = "reduced_modulus", "youngs_modulus"
OVER_TIED = *MODULI, "tension"
"""Quantities whose intervals are over all explanations that the curves cannot tell apart."""
ENDS = "", "_low", "_high"
"""What the names of value and ends of an interval end with."""


class Record:
    """The fit of one curve, or of several of one solid, as its JSON data hold it; or no fit."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.data = dict(data)

    def __bool__(self) -> bool:
        return bool(self.data)

    @cached_property
    def _estimates(self) -> dict[str, Estimate]:
        over_tied = {name: self.data[name] for name in OVER_TIED if name in self.data}
        # Modulus and tension come first.
        entries = {**over_tied, **self.data.get("parameters", {}), **over_tied}
        return {name: Estimate.of_dict(entry) for name, entry in entries.items()}

    def estimates(self) -> dict[str, Estimate]:
        """Return modulus and tension, and the other quantities of the chosen explanation by name.

        Those of further curves have their number behind the name, as ``contact_point_1``.  Where no
        model describes the curves, what nobody asked for is left out.
        """
        return self._estimates

    @property
    def if_present(self) -> dict[str, Estimate]:
        """Moduli and quantities of what was asked for, if it were there though there is no sign."""
        return {name: Estimate.of_dict(e) for name, e in self.data["if_present"].items()}

    @property
    def verdict(self) -> Verdict:
        """Whether what was asked for, a tension by default, is needed."""
        return Verdict(self.data["verdict"])

    @property
    def headline(self) -> str:
        """The verdict in a few words, as it fits a table; empty without a fit."""
        return str(self.data.get("headline", ""))

    @property
    def comparison(self) -> str:
        """The verdict in words."""
        return str(self.data["comparison"])

    @property
    def steps(self) -> list[dict[str, str]]:
        """What to ``do`` next and ``why``, the most urgent first; empty if nothing would help."""
        return list(self.data.get("next", ()))

    @property
    def advice(self) -> str:
        """What to do first, in words; empty if nothing would help."""
        return "{do}: {why}".format(**self.steps[0]) if self.steps else ""

    @property
    def agreement(self) -> str:
        """Whether several curves agree on what they share, in words; empty for one."""
        return str(self.data["agreement"])

    @property
    def curves(self) -> list[dict[str, Any]]:
        """JSON data of each curve: its name, noise, failed checks and origin."""
        return list(self.data.get("curves", ()))

    @property
    def curve(self) -> dict[str, Any]:
        """JSON data of the only curve; empty without a fit."""
        return self.curves[0] if self else {}

    @property
    def sines(self) -> list[dict[str, Estimate]]:
        """What each sine tells: frequency, storage and loss stiffness and modulus, phase.

        The moduli are the parts of the complex reduced modulus.  Of several curves it is those of
        each in order.
        """
        of = (sine for curve in self.curves for sine in curve.get("sines", ()))
        return [{name: Estimate.of_dict(e) for name, e in sine.items()} for sine in of]

    @property
    def messages(self) -> list[str]:
        """Warnings, and notes of what was done; those of one of several curves with its name."""
        return list(self.data.get("messages", ()))

    @property
    def notes(self) -> list[str]:
        """Messages that say what was done."""
        return list(self.data.get("notes", ()))

    @property
    def warnings(self) -> list[str]:
        """Messages that call for care."""
        return [text for text in self.messages if text not in self.notes]

    @property
    def warnings_beside_checks(self) -> list[str]:
        """Warnings of one curve but for the checks that its residuals fail."""
        beside = [*self.curve["messages"], *self.data["remarks"]]
        return [text for text in beside if text not in self.notes]

    @property
    def failed_checks(self) -> list[str]:
        """Codes of the checks that the residuals of the only curve fail."""
        return [check["code"] for check in self.curve.get("failed_checks", ())]

    def values(self) -> dict[str, float]:
        """Return all numbers in SI by name, ends of intervals too; NaN is an open end, or none."""
        if not self:
            return {}
        counts = {"failed_checks": len(self.failed_checks), "messages": len(self.messages)}
        noise = {"points": self.curve["points"], "noise": self.curve["noise"]["value"]}
        known = self.data | noise | counts
        sines = {
            f"sine_{number}_{name}": estimate
            for number, sine in enumerate(self.sines, 1)
            for name, estimate in sine.items()
        }
        found = {
            f"{name}{end}": number
            for name, e in (self.estimates() | sines).items()
            for end, number in zip(ENDS, (e.value, e.low, e.high), strict=True)
        } | {name: known.get(name) for name in NUMBERS}
        return {name: np.nan if value is None else float(value) for name, value in found.items()}

    def best(self, name: str) -> Estimate | None:
        """Return an estimate; of explanations that share no value, with that of the chosen one."""
        found = self.estimates().get(name)
        if found is None or not np.isnan(found.value):
            return found
        of = "reduced_modulus" if name == "youngs_modulus" else name
        ratio = self.data["poissons_ratio"] if of != name else 0.0
        # An explanation without the quantity has none of it.
        selected = self.data["parameters"].get(of, {"value": 0.0})
        return replace(found, value=(1 - ratio**2) * selected["value"])

    def has_no_sign(self, name: str) -> bool:
        """Return whether there is no sign of what was asked for, which has the quantity."""
        return name in self.data.get("if_present", ()) and name not in MODULI

    def common_errors(self, name: str) -> dict[str, float]:
        """Return by how much each error that curves share moves a quantity [SI], by its name."""
        errors: dict[str, dict[str, float]] = self.data.get("common_errors", {})
        return errors.get(name, {})

    def to_dict(self) -> dict[str, Any]:
        """Return the fit as JSON data."""
        return dict(self.data)

    def to_json(self) -> str:
        """Return what `to_dict` returns as JSON."""
        return json_text(self.data)
