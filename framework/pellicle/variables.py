"""The variables of a result: name, unit, meaning, kind and type of each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, Literal, NamedTuple

Kind = Literal[
    "field",
    "main",
    "requested",
    "other",
    "interaction",
    "load",
    "contact",
    "path",
    "oscillation",
    "effort",
    "residual",
    "status",
]
"""``field`` has a value for each cell; ``main`` is listed for each run of a study; ``requested``
exists only if the loading requests it, like variables of a prescription; ``contact`` describes the
shape of the contact; ``interaction`` exists only with an interaction; so does ``path``, which has
one value for all steps of a run; so has ``oscillation``, which exists where a leg oscillates;
``load`` exists only with a load, which has no ``contact`` and no ``residual``."""
Type = Literal["number", "count", "truth", "text"]


WORDS: Final = "short_name"
"""Attribute of a variable with the words that figures and tables show for it."""
WORDS_OF_VALUES: Final = "value_words"
"""Attribute of a coordinate of texts: words by value, as JSON."""
ROLE: Final = "role"
"""Key in ``json_schema_extra`` of a field, and attribute of its coordinate in a study: one of the
roles below."""
SEED: Final = "seed"
"""The values only repeat a random run: they are not compared, nor have they an order."""


def words_of_name(name: str) -> str:
    """Return words for a name that has none: the last part of a dotted path, without _."""
    *outer, last = name.split(".")
    words = f"{outer[-1]} {int(last) + 1}" if outer and last.isdecimal() else last
    return words.replace("_", " ").strip() or name


class Variable(NamedTuple):
    """A number, a truth value or a text of a result, for each step or each cell."""

    name: str
    unit: str
    """SI unit as datasets write it: ``"1"`` for pure numbers, empty for texts."""
    meaning: str
    kind: Kind = "requested"
    type: Type = "number"
    title: str = ""
    """Words for figures and tables, such as "pull-off force"; those of the name if empty."""

    @property
    def words(self) -> str:
        """The name that figures and tables show."""
        return self.title or words_of_name(self.name)

    @property
    def attributes(self) -> dict[str, str]:
        """Words, meaning and unit, as attributes of an xarray variable."""
        described = {"long_name": self.meaning, WORDS: self.words}
        return described | ({"units": self.unit} if self.unit else {})


_BY_KIND: Mapping[Kind, tuple[tuple[str, str, str] | tuple[str, str, str, Type], ...]] = {
    "field": (
        ("pressure", "Pa", "contact pressure"),
        ("displacement", "m", "surface displacement, positive into the solid"),
        ("gap", "m", "gap between surface and indenter"),
        ("contact", "1", "whether the cell is in contact", "truth"),
    ),
    "main": (
        ("depth", "m", "depth of the indenter's lowest point"),
        ("force", "N", "force on the indenter"),
        ("contact_area", "m2", "area of the cells in contact"),
        ("contact_fraction", "1", "contact area over the area of the domain"),
    ),
    "other": (
        ("mean_pressure", "Pa", "force over the area of the domain"),
        ("elastic_energy", "J", "energy of the solid, ½ Σ p u Δ²; NaN on a solid that relaxes"),
    ),
    "load": (
        ("ridge_height", "m", "height of the highest point of the surface"),
        ("ridge_width", "m", "width of the ridge at half of its height, across it"),
        ("ridge_volume", "m3", "volume of the solid that lies above the datum"),
        ("dimple_depth", "m", "depth of the deepest point of the surface"),
        ("dimple_volume", "m3", "volume by which the surface lies below the datum"),
        ("surface_slope", "1", "steepest slope of the surface between cells"),
    ),
    "requested": (
        ("stiffness", "N/m", "contact stiffness dF/dδ, if it is asked for"),
        ("time", "s", "time at the end of the step"),
        ("cycle", "1", "cycles since the oscillation began, in the legs that oscillate"),
        ("wall_pressure", "Pa", "pressure of the indenter without the traction across the gap"),
    ),
    "interaction": (
        ("zone_area", "m2", "area off the contact where the traction exceeds 1 % of the strength"),
        ("zone_width", "m", "mean distance from the contact to the outer edge of the zone"),
        ("energy", "J", "energy of solid and interaction; NaN on a solid that relaxes"),
        ("force_error", "N", "estimated error of the force, from a wider zone"),
        ("force_extrapolated", "N", "force at this depth, extrapolated to a zone of no width"),
        ("jumped", "1", "whether contact jumped in this step, all of it or a part", "truth"),
        ("jump_energy", "J", "energy that jumps lost in this step; 0 if too little to tell"),
        ("residual_traction", "1", "error of the traction across the gap over all tractions"),
    ),
    "contact": (
        ("mean_contact_pressure", "Pa", "force over the contact area"),
        ("contact_radius", "m", "radius of the circle that has the contact area"),
        (
            "semi_major_axis",
            "m",
            "major semi-axis of the ellipse with the contact's second moments",
        ),
        (
            "semi_minor_axis",
            "m",
            "minor semi-axis of the ellipse with the contact's second moments",
        ),
        ("major_axis_angle", "rad", "angle from x to the major axis"),
        ("patches", "1", "parts of the contact; cells that share an edge are of one part", "count"),
        ("perimeter", "m", "length of the border of the contact"),
    ),
    "path": (
        ("pull_off", "N", "lowest force on the path, if the path retracts beyond it"),
        ("pull_off_depth", "m", "depth of the step of lowest force"),
        ("pull_off_radius", "m", "contact radius at the step of lowest force"),
        ("pull_off_step", "1", "number of the step of lowest force", "count"),
        ("pull_off_accuracy", "N", "estimated error of the force at that step, if it is known"),
        ("detach", "m", "depth of the last step in contact before contact is first lost"),
        ("detach_force", "N", "force at the last step in contact before contact is first lost"),
        ("detach_step", "1", "number of the last step in contact", "count"),
        ("detach_accuracy", "m", "distance in depth from there to the next step"),
        (
            "jump_in",
            "m",
            "depth of the first step in contact after one out of contact; that of JKR depends on "
            "the range that the cells give it, and goes to 0 with them",
        ),
        ("jump_in_force", "N", "force at the first step in contact after one out of contact"),
        ("jump_in_step", "1", "number of the first step in contact after one out of it", "count"),
        ("jump_in_accuracy", "m", "distance in depth from there to the step before"),
        ("work", "J", "∫F dδ over the path, by the trapezoidal rule"),
        ("work_accuracy", "J", "Σ|ΔF Δδ|/2 of the steps in which contact is lost or gained"),
        ("dissipated_energy", "J", "work less the change of the energy over the path"),
    ),
    "oscillation": (
        ("oscillation_frequency", "Hz", "frequency of the last oscillation on the path"),
        ("oscillation_amplitude", "m", "amplitude of the depth over its last whole cycle"),
        ("storage_stiffness", "N/m", "force in phase with the depth over the amplitude, K′"),
        ("loss_stiffness", "N/m", "force a quarter of a cycle ahead over the amplitude, K″"),
        ("phase", "rad", "angle by which the force is ahead of the depth"),
        ("cycle_dissipation", "J", "∮F dδ over the last whole cycle"),
        ("cycle_drift", "1", "gain of depth or force over that cycle, over its amplitude"),
    ),
    "effort": (
        ("iterations", "1", "iterations of the solver; with an interaction its rounds", "count"),
        ("operator_applications", "1", "applications of the operator on the finest grid", "count"),
        ("wall_time", "s", "time that the step took"),
    ),
    "residual": (
        ("residual_contact", "1", "largest gap in contact over the indenter's height range there"),
        ("residual_penetration", "1", "largest penetration outside the contact over the same"),
        ("residual_complementarity", "1", "pressure-weighted mean gap over the same"),
        ("residual_load", "1", "relative error of the prescribed force"),
    ),
    "status": (
        ("converged", "1", "whether every residual is under the tolerance", "truth"),
        ("status_code", "", "how the step ended, a name of pellicle.Status", "text"),
        ("status", "", "how the step ended, in a sentence", "text"),
        (
            "caveats",
            "",
            "each status with its values in SI, as JSON [[code, {name: value}], …]",
            "text",
        ),
    ),
}
_TITLES = {
    "semi_major_axis": "major semi-axis",
    "semi_minor_axis": "minor semi-axis",
    "major_axis_angle": "major-axis angle",
    "stiffness": "contact stiffness",
    "zone_area": "area of the zone",
    "zone_width": "width of the zone",
    "force_error": "error of the force",
    "force_extrapolated": "extrapolated force",
    "jumped": "jump",
    "jump_energy": "energy lost in jumps",
    "pull_off": "pull-off force",
    "pull_off_depth": "depth at pull-off",
    "pull_off_radius": "contact radius at pull-off",
    "pull_off_step": "step of pull-off",
    "pull_off_accuracy": "accuracy of the pull-off force",
    "detach": "depth at detachment",
    "detach_force": "force at detachment",
    "detach_step": "step of detachment",
    "detach_accuracy": "accuracy of the depth at detachment",
    "jump_in": "depth at jump-in",
    "jump_in_force": "force at jump-in",
    "jump_in_step": "step of jump-in",
    "jump_in_accuracy": "accuracy of the depth at jump-in",
    "work_accuracy": "accuracy of the work",
    "wall_time": "computing time",
    "storage_stiffness": "storage stiffness K′",
    "loss_stiffness": "loss stiffness K″",
    "phase": "phase angle",
    "cycle_dissipation": "dissipation of a cycle",
    "cycle_drift": "drift of a cycle",
    "residual_traction": "residual of the traction",
    "residual_contact": "residual of the contact",
    "residual_penetration": "residual of penetration",
    "residual_complementarity": "residual of complementarity",
    "residual_load": "residual of the load",
    "status_code": "code of the status",
}
VARIABLES: Mapping[str, Variable] = {
    row[0]: Variable(*row[:3], kind, *row[3:])._replace(title=_TITLES.get(row[0], ""))
    for kind, rows in _BY_KIND.items()
    for row in rows
}
"""The variables of a result by name, besides those of corrections (`corrected_area`)."""


def names_of(*kinds: Kind) -> tuple[str, ...]:
    """Return the names of all variables of these kinds."""
    return tuple(name for name, variable in VARIABLES.items() if variable.kind in kinds)


FIELDS = names_of("field")
FIELDS_OF_LOAD = ("pressure", "displacement")
"""The fields of a result without an indenter."""
OF_LOAD: Final = (
    Variable("force", "N", "force of the load, positive into the solid", "main"),
    *(v for v in VARIABLES.values() if v.kind in ("other", "load", "effort", "status")),
)
"""The numbers and texts of each step of a result without an indenter."""
COORDINATES = ("step", "x", "y")
"""Names of the coordinates of a result."""
WALL_PRESSURE = "wall_pressure"
"""The field that a result has beside `FIELDS` if there is an interaction."""
CAVEATS: Final = "caveats"
"""Text of the caveats of a step, for programs: `pellicle.contact.caveats` reads it."""
REQUIRED = (*names_of("field", "status"), "depth", "force", "contact_area", "iterations")
"""Variables in every result file of a contact."""
REQUIRED_OF_LOAD = (*FIELDS_OF_LOAD, *names_of("status"), "force", "iterations")
"""Variables in every result file of a load."""
CONTACT_AREA: Final = "contact area"
CORRECTED_AREA: Final = "contact_area_"
"""Beginning of the name of an area with a correction, which its type ends."""
CORRECTED_FRACTION: Final = "contact_fraction_"


def corrected_area(type_: str, words: str) -> Variable:
    """Return the variable for the contact area with a correction, which figures name by words."""
    return Variable(
        f"{CORRECTED_AREA}{type_}",
        "m2",
        f"contact area, {type_} correction",
        "other",
        title=f"{CONTACT_AREA}, {words} correction",
    )


def corrected_fraction(area: Variable) -> Variable:
    """Return the variable for a corrected area over the area of the domain."""
    return Variable(
        area.name.replace(CORRECTED_AREA, CORRECTED_FRACTION, 1),
        "1",
        f"{area.meaning}, over the area of the domain",
        "other",
        title=area.title.replace(CONTACT_AREA, "contact fraction", 1),
    )
