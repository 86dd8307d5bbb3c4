"""The explanations of curves that a tension is compared with."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from pellicle import registry
from pellicle.components import HasContactRadius, HasForceCurve, HasLayerForceCurve, Indenter
from pellicle.errors import PellicleError
from pellicle_fit.models.adhesive import WORK_OF_ADHESION, AdhesiveModel, attachment
from pellicle_fit.models.effects import DRAG, DRIFT, DragModel, DriftModel
from pellicle_fit.models.force_model import ClosedFormModel, ForceModel, TensionModel
from pellicle_fit.models.history import History
from pellicle_fit.models.layer import FreeLayerModel
from pellicle_fit.models.relaxing import (
    EXPONENT,
    RELAXATION_TIME,
    SHARE,
    PowerLawModel,
    RelaxingModel,
    StandardLinearModel,
)
from pellicle_fit.parameters import (
    OFFSET,
    SLOPE,
    TENSION,
    THICKNESS,
    Coordinates,
)

from .checks import SHALLOW
from .chi_squared import ChiSquared
from .likelihood import Likelihood
from .rival import Rival, elastic_of

MARGIN = 4.0
"""Difference of AIC from which one explanation is preferred to another with as many parameters.  If
their χ² differ by S without noise, noise makes the difference normal about S with deviation 2√S,
and the wrong one is preferred in Φ(−(S + m)/2√S) ≤ Φ(−√m) of curves: at most 2.3 %, whatever S."""
_INCOMPRESSIBLE = 0.5
"""Poisson's ratio of a layer, whose effect is that of another thickness to first order."""
_CONE = np.pi / 4
"""Half angle of a cone in place of a bead, which its modulus cannot be told from."""


def _same(likelihood: Likelihood) -> ForceModel:
    return likelihood.force_model


def _adhesive(likelihood: Likelihood) -> ForceModel:
    elastic = elastic_of(likelihood)
    assert isinstance(elastic, ClosedFormModel)
    attached = attachment(likelihood.base, likelihood.force, likelihood.moves_out)
    return AdhesiveModel(elastic, likelihood.moves_out, attached, likelihood.stiffness)


def _layer(likelihood: Likelihood) -> ForceModel:
    elastic = elastic_of(likelihood)
    assert isinstance(elastic, ClosedFormModel)
    assert isinstance(elastic.indenter, HasLayerForceCurve)
    return FreeLayerModel(elastic.indenter, _INCOMPRESSIBLE)


def _on_history(
    model: Callable[[TensionModel, History], ForceModel],
) -> Callable[[Likelihood], ForceModel]:
    """Return what builds a model of an effect that depends on the path of a curve in time."""
    return lambda likelihood: model(elastic_of(likelihood), likelihood.history)


def _relaxing(model: type[RelaxingModel]) -> Callable[[Likelihood], ForceModel]:
    """Return what builds a model of a solid that relaxes."""
    return lambda member: model(elastic_of(member), member.history, TENSION in member.free)


def _single_effects(members: Sequence[Likelihood]) -> Iterator[Rival]:
    """Yield the effects, other than a tension, that can bend the curves."""
    if any(p not in member.free for member in members for p in SLOPED.baseline):
        yield SLOPED
    if not all(isinstance(member.force_model, TensionModel) for member in members):
        return
    if all(member.segment != "retract" for member in members):
        power_law, standard_linear = map(_relaxing, (PowerLawModel, StandardLinearModel))
        yield Rival("power_law", "power-law relaxation", False, power_law, (EXPONENT,))
        own = SHARE, RELAXATION_TIME
        yield Rival("standard_linear", "standard linear relaxation", False, standard_linear, own)
        yield Rival("drag", "drag", False, _on_history(DragModel), (DRAG,))
    if all(member.segment == "both" for member in members):
        # On one pass it is a sloping baseline.
        yield Rival("drift", "drift in time", False, _on_history(DriftModel), (DRIFT,), (OFFSET,))
    elastic = [elastic_of(member) for member in members]
    if all(
        isinstance(model, ClosedFormModel) and isinstance(model.indenter, HasContactRadius)
        for model in elastic
    ):
        yield Rival("adhesion", "adhesion", False, _adhesive, (WORK_OF_ADHESION,))
    if all(
        isinstance(model, ClosedFormModel) and isinstance(model.indenter, HasLayerForceCurve)
        for model in elastic
    ):
        yield Rival("thickness", "a thin layer", False, _layer, (THICKNESS,))


def untried_beside_tension(chi_squared: ChiSquared) -> str:
    """Return which effects are not tried beside a tension, in words; empty if all are."""
    members = chi_squared.members
    if not any(member.segment == "both" and member.history.unloading.any() for member in members):
        return ""
    return (
        "relaxation beside a tension, whose force is not known while a contact shrinks, was not "
        "tried"
    )


def _shapes(members: Sequence[Likelihood], deepest: float) -> Iterator[Rival]:
    """Yield other shapes of the same size on a half-space without tension, down to a depth [m]."""
    models = [member.force_model for member in members]
    indenters = [model.indenter for model in models if isinstance(model, ClosedFormModel)]
    if len(indenters) < len(models) or not all(isinstance(i, Indenter) for i in indenters):
        return
    types = {getattr(indenter, "type", "") for indenter in indenters}
    for name in ("paraboloid", "sphere", "cone"):
        if types in ({name}, {"flat_punch"}):
            continue
        # Shallow, sphere and paraboloid are one shape.
        radii = [getattr(indenter, "radius", np.inf) for indenter in indenters]
        if name != "cone" and deepest <= SHALLOW * min(radii):
            continue
        if all(_shape(name, indenter) is not None for indenter in indenters):

            def build(member: Likelihood, name: str = name) -> ForceModel:
                assert isinstance(member.force_model, ClosedFormModel)
                shape = _shape(name, member.force_model.indenter)
                assert shape is not None
                return ClosedFormModel(shape)

            words = f"a cone of {np.degrees(_CONE):g}°" if name == "cone" else f"a {name}"
            yield Rival(name, words, False, build, of_shape=True, has_size=name != "cone")


def _shape(name: str, indenter: object) -> HasForceCurve | None:
    """Return another shape with the size of an indenter; None if it has none."""
    radius = getattr(indenter, "radius", None)
    fields = {"half_angle": _CONE} if name == "cone" else {"radius": radius}
    if None in fields.values():
        return None
    try:
        shape = registry().make(Indenter, {"type": name, **fields})
    except PellicleError:
        return None
    return shape if isinstance(shape, HasForceCurve) else None


NONE = Rival("none", "no tension", False, _same)
TENSED = Rival("tension", "tension", True, _same)
SLOPED = Rival("baseline_slope", "a sloping baseline", False, _same, baseline=(OFFSET, SLOPE))


def sloped(rival: Rival) -> Rival:
    """Return an explanation beside a sloping baseline."""
    return replace(
        rival,
        code=f"{rival.code}+{SLOPED.code}",
        words=f"{rival.words} and {SLOPED.words}",
        baseline=SLOPED.baseline,
    )


def rivals(chi_squared: ChiSquared, parameters: Coordinates) -> list[Rival]:
    """Return the explanations of the curves without tension, then those with it.

    ``parameters`` are the best with a tension.
    """
    members = chi_squared.members
    depths = [member.deepest(part) for member, part in chi_squared.curves(parameters)]
    effects = [*_single_effects(members), *_shapes(members, max(depths))]
    untried = untried_beside_tension(chi_squared)
    pairs = [
        replace(
            effect,
            code=f"tension+{effect.code}",
            words=f"tension and {effect.words}",
            has_tension=True,
        )
        for effect in effects
        if not (effect.of_shape or (effect.relaxes and untried))
    ]
    return [NONE, *effects, TENSED, *pairs]
