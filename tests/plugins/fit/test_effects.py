"""Effects against closed forms, as sets, and what the kit says of those that are broken."""

import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import beta

import pellicle as pl
from pellicle.arrays import Array
from pellicle.testing import rules_of
from pellicle_axisymmetric import Adhesion
from pellicle_fit.contact.contact import Contact
from pellicle_fit.contact.curve import Curve
from pellicle_fit.effect import (
    Adds,
    Bends,
    Effect,
    Fitted,
    Solid,
    Weighed,
    Yields,
    fitted,
    quantities,
)
from pellicle_fit.effects.tension import Tension
from pellicle_fit.explanation import Explanation
from pellicle_fit.selection.recipe import answer
from pellicle_fit.selection.verdict import Verdict
from pellicle_fit.testing import check_effect
from pellicle_fit.testing import effects as testing

R, E = 5e-6, 2e3
DEPTH = np.linspace(-0.4e-6, 1.2e-6, 81)
WIDE = np.linspace(0.0, 1.2e-6, 7)[1:]


def body(name: str, **fields: float) -> Any:
    """Return an indenter with a force curve."""
    return pl.indenter(name, **fields)


def effect(name: str, **fields: Any) -> Any:
    """Return an effect of a type."""
    return pl.registry().make(Effect, {"type": name, **fields})


def bead(depth: Array = DEPTH, tip: Any = None, speed: float = 1e-6, **fields: Any) -> Curve:
    """Return a curve of a paraboloid on a half-space, whose base moves at a constant speed."""
    tip = tip or body("paraboloid", radius=R)
    force = Contact.on_half_space(tip, E, 2 * WIDE[-1]).force(depth)
    way = np.abs(np.diff(depth, prepend=depth[0]))
    return Curve(depth, force, tip, np.cumsum(way) / speed, **fields)


def force(curve: Curve, *effects: Effect, modulus: float = E) -> Array:
    """Return the recorded force [N] of known effects, with the contact at 0."""
    solid = Solid(reduced_modulus=modulus, contact_point=0.0)
    return Explanation(solid, tuple(effects)).force(curve)


def hertz(depth: Array, radius: float = R) -> Array:
    """Return F = 4/3 E* √R δ^(3/2) [N]."""
    force: Array = 4 / 3 * E * np.sqrt(radius) * np.maximum(depth, 0) ** 1.5
    return force


def test_a_size_is_that_of_the_indenter() -> None:
    """Whatever else bends the curve: a tension, a layer, a worn tip, adhesion."""
    curve, larger = bead(), bead(tip=body("paraboloid", radius=1.1 * R))
    size = effect("size", size_error=0.1)
    for beside in (
        (),
        (effect("tension", tension=1e-3),),
        (effect("layer", thickness=4e-6),),
        (effect("worn_tip", flat_radius=0.5e-6),),
        (effect("adhesion", work_of_adhesion=1e-5),),
        (effect("sphere"),),
    ):
        np.testing.assert_allclose(
            force(curve, size, *beside), force(larger, *beside), rtol=1e-6, atol=1e-18
        )


def test_a_worn_tip() -> None:
    """δ = (a/R) √(a² − b²), F = (2 E*/3R) (2a² + b²) √(a² − b²); b = 0 is Hertz.

    Its contact is interpolated, to 1e-8.
    """
    flat = 0.6e-6
    a = np.linspace(flat, 2.5e-6, 40)
    rise = np.sqrt(a**2 - flat**2)
    contact = Contact.on_half_space(body("paraboloid", radius=R), E, 2 * WIDE[-1])
    worn = effect("worn_tip", flat_radius=flat).contact(contact)
    expected = 2 * E / 3 / R * (2 * a**2 + flat**2) * rise
    np.testing.assert_allclose(worn.force(a / R * rise), expected, rtol=1e-7, atol=1e-20)
    np.testing.assert_allclose(worn.radius(a[5:] / R * rise[5:]), a[5:], rtol=1e-6)
    for tip in ("paraboloid", "sphere"):
        curve = bead(tip=body(tip, radius=R))
        np.testing.assert_allclose(force(curve, effect("worn_tip", flat_radius=0)), force(curve))


def test_other_shapes() -> None:
    """A sphere for a paraboloid and the reverse; a cone of 45° has F = 2 E* δ²/π."""
    ball, dish = body("sphere", radius=R), body("paraboloid", radius=R)
    curves = {tip: Contact.on_half_space(tip, E, 2 * WIDE[-1]).force(WIDE) for tip in (ball, dish)}
    for tip, other in ((ball, dish), (dish, ball)):
        bent = effect("sphere").contact(Contact.on_half_space(tip, E, 2 * WIDE[-1]))
        np.testing.assert_array_equal(bent.force(WIDE), curves[other])
    cone = effect("cone").contact(Contact.on_half_space(ball, E, 2 * WIDE[-1]))
    np.testing.assert_allclose(cone.force(WIDE), 2 * E * WIDE**2 / np.pi, rtol=1e-6)


def test_a_layer() -> None:
    """A flat punch as wide as an incompressible layer is thick: F = 2E*aδ · 3.618736."""
    punch = Contact.on_half_space(body("flat_punch", radius=R), E, 2 * WIDE[-1])
    depth = np.array([1e-8])
    layer = effect("layer", thickness=R).contact(punch)
    np.testing.assert_allclose(layer.force(depth), 2 * E * R * depth * 3.618736, rtol=1e-4)
    thick = effect("layer", thickness=1.0, poissons_ratio=0.3)
    np.testing.assert_allclose(force(bead(), thick), hertz(DEPTH), rtol=1e-4)


def test_a_stiff_surface() -> None:
    """On a paraboloid k = 2E*a (1 + g e^(−a/l)) is integrated in closed form."""
    for gain, reach in ((0.5, 1e-6), (-0.4, 0.05e-6), (0.3, 1e-4)):
        a = np.sqrt(R * WIDE)
        excess = 2 * reach**3 - np.exp(-a / reach) * (
            a**2 * reach + 2 * a * reach**2 + 2 * reach**3
        )
        expected = hertz(WIDE) + 4 * E * gain / R * excess
        contact = Contact.on_half_space(body("paraboloid", radius=R), E, 2 * WIDE[-1])
        stiff = effect("stiff_surface", gain=gain, reach=reach).contact(contact)
        np.testing.assert_allclose(stiff.force(WIDE), expected, rtol=1e-6)
        np.testing.assert_allclose(
            stiff.stiffness(WIDE), 2 * E * a * (1 + gain * np.exp(-a / reach)), rtol=1e-6
        )


def test_a_solid_that_softens() -> None:
    """The force falls behind linearly, and is constant where it would fall."""
    contact = Contact.on_half_space(body("paraboloid", radius=R), E, 2 * WIDE[-1])
    soft = effect("softening", softening_length=2 * WIDE[-1]).contact(contact)
    np.testing.assert_allclose(soft.force(WIDE), hertz(WIDE) * (1 - WIDE / (2 * WIDE[-1])))
    assert soft.depth_limit == WIDE[-1]


@pytest.mark.parametrize(("exponent", "lost"), [(0.1, 1.861980), (0.2, 1.725471), (0.3, 1.591086)])
def test_a_power_law(exponent: float, lost: float) -> None:
    """A ramp (Lee & Radok), and when contact is lost on the way back at the same speed (Ting)."""
    depth, speed = np.linspace(0.0, 1e-6, 200), 0.5e-6
    relaxing = effect("power_law", relaxation_exponent=exponent)
    t = depth / speed
    ramp = hertz(np.ones(1) * speed) * 1.5 * beta(1.5, 1 - exponent) * t ** (1.5 - exponent)
    np.testing.assert_allclose(
        force(bead(depth, speed=speed), relaxing), ramp, rtol=2e-3, atol=1e-13
    )
    there = bead(np.append(depth, depth[-2::-1]), speed=speed)
    back = force(there, relaxing)
    gone = there.clock[np.flatnonzero(back > 1e-4 * back.max())[-1]]
    assert gone / t[-1] == pytest.approx(lost, abs=0.02)
    assert relaxing.relaxed(2.0) == pytest.approx(2.0**-exponent)


def test_a_standard_linear_solid() -> None:
    """A flat punch at a constant speed: F = 2aE* v ((1 − g) t + g T (1 − e^(−t/T)))."""
    share, constant, speed = 0.6, 0.4, 1e-6
    depth = np.linspace(0.0, 1e-6, 200)
    curve = bead(depth, body("flat_punch", radius=R), speed)
    t = curve.clock
    expected = (1 - share) * t - share * constant * np.expm1(-t / constant)
    found = force(curve, effect("standard_linear", relaxed_share=share, relaxation_time=constant))
    np.testing.assert_allclose(found, 2 * R * E * speed * expected, rtol=1e-3, atol=1e-13)


@pytest.mark.parametrize("stiffness", [None, 0.02])
def test_adhesion(stiffness: float | None) -> None:
    """The stable branch of Johnson, Kendall & Roberts, to where a depth or a cantilever ends it."""
    work = 2e-5
    a = np.geomspace(0.01, 1, 4000) * 3e-6
    pull = 4 * E * a**3 / 3 / R - np.sqrt(8 * np.pi * work * E * a**3)
    base = a**2 / R - np.sqrt(2 * np.pi * work * a / E) + (pull / stiffness if stiffness else 0)
    stable = a >= a[np.argmin(base)]
    out = np.linspace(1.2e-6, -0.9e-6, 300)
    curve = replace(bead(out), stiffness=stiffness, unloading=np.full(out.size, True))
    found = force(curve, effect("adhesion", work_of_adhesion=work))
    # The touch, which this curve does not show, comes about over four rows.
    over, half = curve.base - base.min(), 2 * np.ptp(curve.position) / curve.base.size
    touches, apart = over > half, over < -half
    expected = np.interp(curve.base, base[stable], pull[stable])
    np.testing.assert_allclose(found[touches], expected[touches], atol=2e-4 * pull.max())
    assert not found[apart].any()
    assert touches.any()
    assert apart.any()


def test_adhesion_of_a_worn_tip() -> None:
    """The edge holds the rim until its punch lets go; back is wider than there while both hold."""
    work, tension, stiffness, flat = 2e-5, 6e-4, 4e-4, 0.38e-6
    tip = body("paraboloid", radius=R, flat_radius=flat)
    sticky = Adhesion(tip, E, tension, work)
    edge = sticky.equilibrium(flat)
    wide = sticky.equilibrium(flat * (1 + np.geomspace(1e-6, 9, 2000)))
    base = wide.depth + wide.force / stiffness
    end = float(edge.depth + edge.force / stiffness)
    fold, left = int(base.argmin()), float(base[0])
    assert end < base[fold] < left
    path = np.linspace(1.01 * end, -2 * end, 400)
    for unloading, first in ((True, float(base[fold])), (False, float(base[:fold].max()))):
        curve = Curve(path, 0 * path, tip, stiffness=stiffness, unloading=np.full(400, unloading))
        found = force(
            curve,
            effect("tension", tension=tension),
            effect("adhesion", work_of_adhesion=work),
        )
        wider = np.interp(curve.base, base[fold:], wide.force[fold:])
        held = edge.force * curve.base / end
        near = np.abs(curve.base - first) < 0.05 * (left - end)
        expected = np.where(curve.base > first, wider, held)
        seen = ~near & (curve.base > (0.98 * end if unloading else 0.1e-6))
        scale = float(-edge.force)
        np.testing.assert_allclose(found[seen], expected[seen], atol=2e-3 * scale)


def test_of_the_instrument() -> None:
    """A drag on the contact radius, an offset, a slope and a drift add up in any order."""
    curve = bead(np.append(DEPTH, DEPTH[-2::-1]), speed=2e-6)
    depth = curve.position
    speed = np.where(curve.moves_out, -2e-6, 2e-6)
    drag = effect("drag", drag=0.3)
    expected = hertz(depth) + 0.3 * np.sqrt(R * np.maximum(depth, 0)) * speed
    np.testing.assert_allclose(force(curve, drag), expected, rtol=1e-6, atol=1e-15)
    records = [effect("offset", offset=1e-11), effect("slope", slope=1e-5)]
    records.append(effect("drift", drift=-2e-12))
    expected = expected + 1e-11 + 1e-5 * (depth - depth[0]) - 2e-12 * curve.clock
    for effects in ((drag, *records), (*reversed(records), drag)):
        np.testing.assert_allclose(force(curve, *effects), expected, rtol=1e-6, atol=1e-15)


def test_a_wrong_spring_constant() -> None:
    """A spring 1 + ε times as stiff bends and pushes by as much more than is recorded."""
    error, assumed = 0.15, 0.03
    true = hertz(DEPTH)
    recorded = true / (1 + error)
    tip = DEPTH + true / assumed / (1 + error) - recorded / assumed
    curve = Curve(tip, recorded, body("paraboloid", radius=R), stiffness=assumed)
    found = force(curve, effect("spring", spring_error=error))
    np.testing.assert_allclose(found, recorded, rtol=1e-6, atol=1e-18)


@pytest.mark.parametrize(
    ("series", "give"),
    [
        (effect("compliance", compliance=20.0), lambda f: 20 * f),
        (effect("compliance", compliance=-20.0), lambda f: -20 * f),
        (
            effect("brush", brush_length=0.4e-6, brush_force=1e-10),
            lambda f: 0.4e-6 / 2 / np.pi * np.log1p(f / 1e-10),
        ),
        (
            effect("rough_toe", height=5e-8, toe_force=1e-11),
            lambda f: 5e-8 * np.log1p(np.cbrt(f / 1e-11)),
        ),
        (
            effect("rough_toe", height=1e-7, toe_force=1e-15),
            lambda f: 1e-7 * np.log1p(np.cbrt(f / 1e-15)),
        ),
    ],
    ids=["compliance", "too small a sensitivity", "brush", "rough toe", "soft toe"],
)
def test_in_series(series: Effect, give: Callable[[Any], Any]) -> None:
    """The depth of the solid is what its own and the others' give leave, by bracketing."""
    curve = bead(stiffness=0.05)

    def balanced(base: float) -> float:
        def excess(depth: float) -> float:
            pushed = float(hertz(np.array([depth]))[0])
            return depth + pushed / 0.05 + float(give(pushed)) - base

        return float(brentq(excess, 0, 3 * base, xtol=1e-18)) if base > 0 else base

    depth = np.array([balanced(base) for base in curve.base])
    np.testing.assert_allclose(force(curve, series), hertz(depth), rtol=1e-5, atol=1e-15)


def test_sets_are_composed_in_one_order() -> None:
    """That of places and ranks, never that of writing; one of each rank and name."""
    parts = [effect("size", size_error=0.2), effect("layer", thickness=5e-6)]
    parts += [
        effect("tension", tension=1e-3),
        effect("brush", brush_length=1e-7, brush_force=1e-10),
    ]
    curve = bead(stiffness=0.05)
    np.testing.assert_array_equal(force(curve, *parts), force(curve, *reversed(parts)))
    solid = Solid()
    assert "one place" in Explanation(solid, (effect("sphere"), effect("cone"))).excuse([])
    clash = Explanation(solid, (effect("stiff_surface"), Softening())).excuse([])
    assert clash == "two of them have a quantity of one name"


class Softening(Bends):
    """Contact of a stranger, no longer the indenter's own, with a name that is taken."""

    type: Literal["softening"] = "softening"
    rank: ClassVar[int] = 4
    reach: Annotated[float, Fitted("m", above=0, log=True)] = fitted("depth [m]")

    def contact(self, contact: Contact) -> Contact:
        def area(depth: Array, length: float) -> Array:
            rest = 1 + np.maximum(depth, 0) / self.reach / 10
            return contact.area(depth, length) / rest

        return replace(contact, area=area, half_space=False)


BOTH = np.append(DEPTH, DEPTH[-2::-1])


@pytest.mark.parametrize(
    ("names", "curve", "words"),
    [
        (["adhesion", "layer"], bead(), "on a half-space"),
        (["adhesion", "worn_tip"], bead(), ""),
        (["adhesion", Softening()], bead(), "on a half-space"),
        (["adhesion", effect("size", size_error=0.1), "sphere"], bead(), ""),
        (["adhesion", effect("size", size_error=0.1), "worn_tip"], bead(), ""),
        (["layer", "worn_tip"], bead(), "curve of this tip on a layer is not known"),
        (["drag", "layer"], bead(), "needs a contact radius"),
        (["drag", "worn_tip"], bead(), ""),
        (["cone"], bead(tip=body("cone", half_angle=1.2)), "the indenter is one"),
        (["worn_tip"], bead(tip=body("cone", half_angle=1.2)), "needs a round tip"),
        (["sphere"], bead(tip=body("flat_punch", radius=R)), "needs a round tip"),
        (["sphere"], bead(0.1 * DEPTH), "on a shallow curve"),
        (["sphere", "worn_tip"], bead(), "in one place"),
        (["cone", "tension"], bead(), ""),
        (["drift"], bead(), "on one pass it is a sloping baseline"),
        (["drift"], bead(BOTH), ""),
        (["power_law", "tension"], bead(), ""),
        (["power_law", "tension"], bead(BOTH), "no theory of unloading"),
        (["size"], bead(), "needs a deviation"),
        ([effect("spring", spring_error={"value": 0, "deviation": 0.1})], bead(), ""),
    ],
)
def test_excuses(names: Sequence[Any], curve: Curve, words: str) -> None:
    """Where an effect cannot act it says why, whatever bends the contact before it."""
    effects = tuple(effect(name) if isinstance(name, str) else name for name in names)
    excuse = Explanation(Solid(), effects).excuse([curve])
    assert words in excuse
    assert bool(words) == bool(excuse)


def test_quantities_are_fitted_held_or_weighed() -> None:
    """Left out, given, given with a deviation; each goes through files and refuses nonsense."""
    assert Tension().open.keys() == {"tension"}
    assert not Tension(tension="2 mN/m").open
    weighed = Tension(tension={"value": "2 mN/m", "deviation": "0.1 mN/m"})
    assert isinstance(weighed.tension, Weighed)
    assert weighed.tension.deviation == 1e-4
    assert weighed.open.keys() == {"tension"}
    again = Tension.model_validate_json(weighed.model_dump_json())
    assert isinstance(again.tension, Weighed)
    assert (again.tension, again.tension.deviation) == (2e-3, 1e-4)
    for wrong in ({"value": 1}, {"value": 1, "deviation": 0}, {"value": 1, "sigma": 1}, -1, "1 N"):
        with pytest.raises(pl.ConfigError, match="tension: "):
            Tension(tension=wrong)


class Push(Adds):
    """Force that a test breaks."""

    type: Literal["push"] = "push"
    push: Annotated[float, Fitted("N", at_least=0)] = fitted("force [N]")
    over: Annotated[float, Fitted("m", above=0, log=True)] = fitted("length [m]")

    def force(self, contact: Contact, curve: Curve, depth: Array) -> Array:
        return self.push * np.exp(np.minimum(depth, 0) / self.over)


class Soft(Yields):
    """Give that a test breaks."""

    type: Literal["soft"] = "soft"
    soft: Annotated[float, Fitted("m/N")] = fitted("compliance [m/N]")

    def give(self, force: Array) -> Array:
        return self.soft * force


def _writes(self: Any, contact: Any, curve: Any, depth: Array) -> Array:
    depth += 1e-9
    return 0 * depth


def _area(change: Callable[[Array, Array], Array]) -> Callable[..., Contact]:
    """Return the method of a contact whose area is changed, given the depths."""

    def contact(self: Any, contact: Contact) -> Contact:
        def area(depth: Array, length: float) -> Array:
            return change(contact.area(depth, length), depth)

        return replace(contact, area=area)

    return contact


Rng = np.random.default_rng(1)
ROWS = "returns_a_number_for_each_row"
BROKEN: list[tuple[type[Effect], str, dict[str, Any], str]] = [
    (Effect, "stands_in_one_place", {}, "Effect alone"),
    (Push, "acts_on_a_curve", {"excuse": lambda s, c, v, b: "is too late"}, "is too late"),
    (Push, "starts_lie_within_limits", {"starts": lambda s, z: [{"pus": 1.0}]}, "pus is not one"),
    (Push, "starts_lie_within_limits", {"limits": lambda s, z: {"over": (1.0, 2.0)}}, "outside 1"),
    (Push, "starts_lie_within_limits", {"starts": lambda s, z: []}, "yields nothing"),
    (Push, ROWS, {"force": lambda s, c, v, d: s.push}, "no array"),
    (Push, ROWS, {"force": _writes}, "read-only"),
    (Push, ROWS, {"force": lambda s, c, v, d: s.push * Rng.random(d.size)}, "second call"),
    (Push, ROWS, {"force": lambda s, c, v, d: s.push * d / d}, "not finite at 0"),
    (Push, ROWS, {"force": lambda s, c, v, d: s.push * d / d.std()}, "every second"),
    (
        Push,
        "without_its_cause_it_is_nothing",
        {"force": lambda s, c, v, d: 1e-9 + 0 * d + s.push},
        "even with push = ",
    ),
    (Push, "units_are_right", {"force": lambda s, c, v, d: s.push * np.exp(1e6 * d)}, "lengths 2"),
    (Softening, "depths_grow", {"contact": _area(lambda a, d: a * np.exp(-d / 1e-7))}, "forces at"),
    (Softening, "depths_grow", {"contact": _area(lambda a, d: a + 1e-14)}, "forces at"),
    (Soft, "depths_grow", {"give": lambda s, f: -100 * abs(s.soft) * f}, "from a depth of"),
    (
        Push,
        "acts_where_no_row_touches",
        {"force": lambda s, c, v, d: s.push * d / d[d > 0].max()},
        "zero-size array",
    ),
    (Push, "jumps_are_told", {"force": lambda s, c, v, d: s.push * (d > s.over / 10)}, "jumps by"),
    (Push, "what_it_says_is_valid", {"accuracy": lambda s, c, v, b: 2.0}, "accuracy() is not"),
]


@pytest.mark.parametrize(("base", "rule", "members", "words"), BROKEN)
def test_the_kit_refuses(
    base: type[Effect], rule: str, members: dict[str, Any], words: str
) -> None:
    """The message names the class, the rule, what is asked and what was found."""
    namespace = {"__doc__": "Broken.", "__module__": __name__, **members}
    if base is Effect:
        namespace |= {"type": "broken", "__annotations__": {"type": Literal["broken"]}}
    made: Any = type("Broken", (base,), namespace)
    setattr(sys.modules[__name__], "Broken", made)  # noqa: B010 - a pickle finds it by this name
    with pytest.raises(AssertionError) as caught:
        check_effect(made())
    assert f"Broken breaks the rule {rule}\nrequired: " in str(caught.value)
    assert words in str(caught.value).partition("violation: ")[2]


def test_a_fit_refuses_what_is_broken() -> None:
    """Before it computes, a stranger's effect that lies is named, with the rule and a remedy."""
    curve = bead(stiffness=0.05)

    class Liar(Push):
        """Force of a wrong shape."""

        def force(self, contact: Contact, curve: Curve, depth: Array) -> Array:
            return self.push * depth[:1]

    with pytest.raises(pl.PluginError, match="effect 'push': Liar breaks the rule returns_a_num"):
        answer([curve], [Tension()], [[Liar()]])
    assert answer([curve], [], [[Push()]]).verdict is Verdict.NO_SIGN


def test_what_fails_at_work_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """The note that the command line prints has the stranger's effect, its file and its line."""

    class Late(Push):
        """Force that fails on longer curves than those of the kit."""

        def force(self, contact: Contact, curve: Curve, depth: Array) -> Array:
            return super().force(contact, curve, depth if curve.span < 1.55e-6 else depth[10**9])

    entry = SimpleNamespace(component=Late, origin=SimpleNamespace(is_built_in=False))
    installed = SimpleNamespace(components={"effect": {"push": entry}}, own=frozenset())
    monkeypatch.setattr("pellicle_fit.strangers.registry", lambda: installed)
    with pytest.raises(IndexError) as caught:
        answer([bead(stiffness=0.05)], [], [[Late()]])
    (note,) = caught.value.__notes__
    assert note.startswith(f"effect 'push' failed ({__file__}, line ")


def test_each_rule_refuses_one() -> None:
    """No rule could be dropped without a test that fails; what is broken above is whole itself."""
    assert {rule for _, rule, *_ in BROKEN} == {
        rule.__name__ for rule in rules_of(testing.__name__)
    }
    for whole in (Push(), Soft(), Softening()):
        with pytest.raises(AssertionError, match="breaks the rule is_registered"):
            check_effect(whole)


def test_quantities_have_names_of_their_own() -> None:
    """No shipped effects but forms of one share a quantity's name, which fix and tables go by."""
    shipped = {entry.component for entry in pl.registry().components["effect"].values()}
    forms = {component for component in shipped if shipped & {*component.__mro__[1:]}}
    names = [name for component in shipped - forms for name in quantities(component)]
    assert len(names) == len(set(names))
