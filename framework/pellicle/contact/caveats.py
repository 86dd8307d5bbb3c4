"""Caveats of a load step, as data: a status, and the values that its sentence states."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from enum import Enum
from math import isfinite
from string import Formatter
from types import MappingProxyType
from typing import Any, Final, NamedTuple, Self, TypeVar

from pellicle.units import DIGITS, readable

from .solution import Stop

# Between the caveats in the sentence of a step.
_AND: Final = "; moreover, "
Place = TypeVar("Place")


class Status(Enum):
    """How a load step ended, the gravest first; the value is the template of its sentence.

    `NOT_RUN` and `FAILED` occur in the table of a study only.
    """

    phrase: str
    """Words to follow "in 2 of 3 steps"; empty where the step did not converge."""

    def __new__(cls, template: str, phrase: str = "") -> Self:
        """Return a member with its template and phrase."""
        status = object.__new__(cls)
        status._value_, status.phrase = template, phrase
        return status

    FAILED = "failed: {reason}"
    NOT_RUN = "not run"
    NOT_FINITE = (
        "the pressure became NaN or infinite; check the kernel's compliance and the profile for "
        "extreme values"
    )
    PULLED_OFF = (
        "no contact carries a force of {force:N}: that of the step before is lost between "
        "{carried:N} and {lost:N}; a softer holder follows it further: prescribe depth, or "
        "base_displacement with a spring_constant"
    )
    NOTHING_TO_PULL = (
        "there is no contact that could carry a force of {force:N}; press before you pull"
    )
    NEGATIVE_PRESSURE = "the solver returned a negative pressure, {measure:.1e} of the highest"
    LOAD = "the force misses the prescribed one by {measure:.1e}, over {tolerance:.1e}; {stop:stop}"
    CONTACT_RESIDUAL = (
        "the surface misses the indenter inside the contact by {measure:.1e} of the indenter's "
        "height range there, over the tolerance {tolerance:.1e}; {stop:stop}"
    )
    PENETRATION = (
        "the surface penetrates the indenter outside the contact by {measure:.1e} of the height "
        "range in contact, over the tolerance {tolerance:.1e}; {stop:stop}"
    )
    COMPLEMENTARITY = (
        "pressure acts across a gap: complementarity {measure:.1e} is over the tolerance "
        "{tolerance:.1e}; {stop:stop}"
    )
    TRACTION = (
        "the traction across the gap misses that of the interaction by {measure:.1e}, over the "
        "tolerance {tolerance:.1e}; {stop:stop}"
    )
    STIFFNESS = (
        "the contact stiffness is not known: its displacement misses by {measure:.1e}, over the "
        "tolerance {tolerance:.1e}; loosen solver.tolerance, or leave loading.stiffness out"
    )
    STRIP = (
        "the contact reaches the edge of a grid one cell across: on a free boundary it is a strip "
        "{length:m} long, not a line contact, which repeats along its line; give "
        'grid.boundary = "periodic", or more than one of grid.points each way'
    )
    CONTACT_AT_EDGE = (
        "the contact reaches the edge of the domain, where the indenter does not end, so force "
        "and area are wrong; enlarge grid.size = {size_x:m} × {size_y:m} or press in less far "
        "(loading.{prescribed} = {value:unit})"
    )
    BEYOND_EDGE = (
        "the lowest point of the indenter lies outside the domain, so nothing touches within; "
        "enlarge grid.size = {size_x:m} × {size_y:m}, or move the indenter"
    )
    ZONE_AT_EDGE = (
        "the zone in which the interaction pulls reaches the edge of the domain, where the "
        "indenter does not end, so the force is wrong; enlarge grid.size = {size_x:m} × "
        "{size_y:m}, or give the interaction a shorter range, which jkr has on smaller cells"
    )
    AREA = (
        "the contact area misses the prescribed one by {measure:.1e}, over {tolerance:g}; "
        "{end:variant}"
    )
    NOT_REACHED = (
        "the {quantity} misses the prescribed one by {measure:.1e}, over {tolerance:g}; "
        "{end:variant}"
    )
    NEAREST_AREA = (
        "converged; the contact area misses the prescribed one by {measure:.1e}: it jumps from "
        "{below:unit} to {above:unit}, and no load attains a nearer number of whole cells; use "
        "more points",
        "the contact jumps across the prescribed value",
    )
    NEAREST = (
        "converged; the {quantity} misses the prescribed one by {measure:.1e}: it jumps from "
        "{below:unit} to {above:unit}",
        "the contact jumps across the prescribed value",
    )
    COARSE = (
        "converged, but the cells are too coarse for this contact, which covers {cells:count} of "
        "them, {width:m} wide: force, depth and area may be far off; use more points, or a smaller "
        "grid.size",
        "the cells are too coarse for this contact",
    )
    COARSE_ZONE = (
        "converged, but the zone in which the interaction pulls is {cells:.1f} cells wide, where "
        "it takes {least:g} for the contact not to be pinned by the cells: force and area may be "
        "off; use more points, or a longer range",
        "the cells are too coarse for this contact",
    )
    COARSE_LOAD = (
        "converged, but the finest part of the load is {across:.1f} cells wide, where it takes "
        "{least:g}: the surface near it may be far off; use more points, or a smaller grid.size",
        "the cells are too coarse for this load",
    )
    COARSE_LINE = (
        "converged, but a line force without a width is spread over a cell, {width:m} wide, and "
        "its ridge lacks about {share:.0%} of its height; use more points or a smaller grid.size, "
        "or give the load a width",
        "the cells are too coarse for this load",
    )
    STEEP = (
        "converged, but slopes in contact reach {slope:.2f}, and the theory is for slopes up to "
        "{most:g}: force and area are those of the model, not of the experiment",
        "slopes in contact are beyond the theory",
    )
    STEEP_SURFACE = (
        "converged, but slopes of the surface reach {slope:.2f}, and the theory is for slopes up "
        "to {most:g}: heights and widths are those of the model, not of the experiment",
        "slopes of the surface are beyond the theory",
    )
    LINE_OF_CELLS = (
        "converged, but a line force without a width, on a surface without tension, makes a ridge "
        "of no finite height: here it is spread over a cell, {width:m} wide, and the height grows "
        "as the cells shrink; give the load a width",
        "a line force without width or tension depends on the cells",
    )
    THROUGH_LAYER = (
        "converged, but the surface is pressed down by {deepest:m}, through a layer {thickness:m} "
        "thick to its rigid base: the numbers are those of the equations, not of an experiment; "
        "press in less far",
        "the surface is pressed through a layer to its rigid base",
    )
    JUMPED = (
        "converged; a part of the contact jumped after the last step{loss:variant}: in between it "
        "is not in equilibrium; smaller steps show where it jumps",
        "a part of the contact jumped",
    )
    FEW_AT_PULL_OFF = (
        "converged, but at pull-off the radius of the contact has {cells:.1f} cells, so the "
        "pull-off force {off:variant}; use more points, or a smaller grid.size",
        "the pull-off force is that of a contact of few cells",
    )
    CONVERGED = "converged"

    @property
    def converged(self) -> bool:
        """Whether the numbers of the step may be used, possibly with a caveat."""
        return _GRAVEST_FIRST.index(self) >= _GRAVEST_FIRST.index(Status.NEAREST_AREA)

    @property
    def at_edge(self) -> bool:
        """Whether the domain is too small."""
        return self in (Status.CONTACT_AT_EDGE, Status.BEYOND_EDGE, Status.ZONE_AT_EDGE)

    @property
    def verdict(self) -> str:
        """The status in one or two words, for tables."""
        usual = "converged" if self.converged else "NOT CONVERGED"
        return {
            Status.NOT_RUN: "not run",
            Status.FAILED: "failed",
            Status.COARSE: "too coarse",
            Status.COARSE_ZONE: "too coarse",
            Status.COARSE_LOAD: "too coarse",
            Status.COARSE_LINE: "too coarse",
        }.get(self, usual)


_GRAVEST_FIRST: Final = tuple(Status)
_VARIANTS: Final = {
    "nothing nearer": "nothing nearer can be resolved: use more points",
    "jump": "it jumps from {below:unit} to {above:unit}: use more points",
    "jump with a law": (
        "it jumps from {below:unit} to {above:unit}: no contact between them is stable, or the "
        "cells are too large to show it"
    ),
    "not found": "no load that attains it was found",
    "known": " and lost {lost:J}",
    "unknown": "",
    "known error": "may be off by {error:.0%}",
    "unknown error": "has no known error",
}
"""Parts of sentences that a value names."""


class Caveat(NamedTuple):
    """A limit of a load step: a status, and the values that its sentence states."""

    status: Status
    values: Mapping[str, float | str] = MappingProxyType({})
    """Numbers in SI; units, quantities, members of `Stop` and variants by name."""

    @property
    def sentence(self) -> str:
        """The message to the user."""
        return _Sentence(self.values).format(self.status.value)


def rank_caveats(caveats: Iterable[Caveat]) -> tuple[Caveat, ...]:
    """Return the caveats of a step that count, the gravest first.

    A failure hides the rest, since the other numbers of the step mean nothing; for the same reason
    the accuracy is only asked of a step that has not failed. A contact on too few cells has too few
    in its zone, too.
    """
    by_gravity = sorted(caveats, key=lambda caveat: _GRAVEST_FIRST.index(caveat.status))
    if by_gravity and not by_gravity[0].status.converged:
        return (by_gravity[0],)
    is_coarse = any(caveat.status is Status.COARSE for caveat in by_gravity)
    return tuple(c for c in by_gravity if not (is_coarse and c.status is Status.COARSE_ZONE))


def status_of(caveats: Sequence[Caveat]) -> Status:
    """Return the status of a step with these caveats, the gravest first."""
    return caveats[0].status if caveats else Status.CONVERGED


def sentence_of(caveats: Sequence[Caveat]) -> str:
    """Return the message of a step with these caveats, the gravest first."""
    first, *others = [caveat.sentence for caveat in caveats or (Caveat(Status.CONVERGED),)]
    rest = [re.sub("^converged(, but|;) ", "", other) for other in others]
    return _AND.join([first, *rest])


def verdict_of(caveats: Iterable[Caveat]) -> str:
    """Return how a step with these caveats ended in one or two words, for tables."""
    verdicts = (caveat.status.verdict for caveat in caveats)
    return next((v for v in verdicts if v != Status.CONVERGED.verdict), Status.CONVERGED.verdict)


def to_text(caveats: Iterable[Caveat]) -> str:
    """Return caveats as JSON, ``[[code, {name: value}], …]``, with "inf" and "nan" in quotes."""
    rows = [
        (
            caveat.status.name,
            {
                n: v if isinstance(v, str) or isfinite(v) else str(v)
                for n, v in caveat.values.items()
            },
        )
        for caveat in caveats
    ]
    return json.dumps(rows, ensure_ascii=False)


def from_text(text: str) -> tuple[Caveat, ...]:
    """Return the caveats in a text of `to_text`; none of an empty text."""
    return tuple(
        Caveat(
            Status[code],
            {n: float(v) if v in ("inf", "-inf", "nan") else v for n, v in values.items()},
        )
        for code, values in json.loads(text or "[]")
    )


def by_phrase(caveats: Iterable[tuple[Place, Caveat]]) -> dict[str, list[tuple[Place, Caveat]]]:
    """Return the caveats of steps that converged by the phrase of their status, gravest first.

    Each comes with a place, such as the number of its step. Within a phrase they are in the order
    given.
    """
    groups: dict[str, list[tuple[Place, Caveat]]] = {s.phrase: [] for s in Status if s.phrase}
    for place, caveat in caveats:
        if caveat.status.phrase:
            groups[caveat.status.phrase].append((place, caveat))
    return {phrase: group for phrase, group in groups.items() if group}


class _Sentence(Formatter):
    """Fills in a template; beside the formats of Python it knows units and what a name stands for.

    ``{force:N}``, ``{width:m}`` and ``{lost:J}`` are quantities, ``{below:unit}`` is one in the
    value ``unit``, ``{stop:stop}`` the remedy of a `Stop`, ``{end:variant}`` a part of a sentence.
    """

    def __init__(self, values: Mapping[str, float | str]) -> None:
        self._values = values

    def format(self, template: str, /, *_: Any, **__: Any) -> str:
        """Return the template with the values filled in."""
        return self.vformat(template, (), self._values)

    def format_field(self, value: Any, format_spec: str) -> str:
        """Return a value in words."""
        match format_spec:
            case "N" | "m" | "J":
                return readable(value, format_spec, DIGITS)
            case "unit":
                return readable(value, str(self._values["unit"]), DIGITS)
            case "count":
                return str(value or "none")
            case "stop":
                return Stop[value].value
            case "variant":
                return self.format(_VARIANTS[value])
        return format(value, format_spec)
