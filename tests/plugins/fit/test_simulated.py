"""Force curves without a master curve: planned, simulated, kept; those that lie are refused."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle import registry
from pellicle.arrays import Array
from pellicle.units import Quantity
from pellicle_fit.contact.contact import Contact
from pellicle_fit.contact.curve import Curve
from pellicle_fit.effects.layer import Layer
from pellicle_fit.effects.tension import Tension
from pellicle_fit.problem import problem
from pellicle_fit.selection.recipe import answer
from pellicle_fit.simulated import simulation
from pellicle_fit.simulated.equivalent import EquivalentBody
from pellicle_fit.simulated.interpolated import SimulatedCurve, tensed_depths
from pellicle_fit.simulated.simulation import plan, simulated_curve
from pellicle_fit.simulated.solid import solid
from pellicle_plugins.indenters.of_revolution import Sphere
from tests.plugins.fit.conftest import ends_of

LAYER = {"type": "bonded_layer", "thickness": "4 um"}
RADIUS = 2e-6


@pytest.fixture
def few_nodes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make studies of few runs."""
    monkeypatch.setattr(simulation, "_OCTAVES", 3)


@pytest.fixture(scope="module")
def exact_nodes() -> SimulatedCurve:
    """Return a curve through exact forces of a sphere, at the nodes of its plan."""
    sphere = pl.indenter("sphere", radius=RADIUS)
    assert isinstance(sphere, pl.HasForceCurve)
    depths, *_ = plan(sphere, solid("tensed_membrane"), 0.4 * RADIUS)
    body = EquivalentBody(depths, sphere.force_curve(depths, 0.0).force)
    forces = np.array(
        [
            [sphere.force_curve(np.array([depth]), s).force[0] for s in lengths]
            for depth, lengths in zip(
                tensed_depths(depths), SimulatedCurve(body).nodes[0], strict=True
            )
        ]
    )
    return SimulatedCurve(body, forces, 0.01, half_space=False)


@pytest.mark.parametrize("ratio", [0.0, 1e-3, 0.03, 0.5, 8.0])
def test_between_the_nodes(exact_nodes: SimulatedCurve, ratio: float) -> None:
    """Between exact nodes the curve of a sphere errs by some 1e-4."""
    exact = pl.indenter("sphere", radius=RADIUS)
    assert isinstance(exact, pl.HasForceCurve)
    depth = RADIUS * np.geomspace(0.01, 0.4, 50)
    here = exact_nodes.force_curve(depth, ratio * RADIUS).force
    assert here == pytest.approx(exact.force_curve(depth, ratio * RADIUS).force, rel=3e-4)


@pytest.mark.parametrize("ratio", [0.0, 1e-3, 0.5, 8.0])
def test_the_derivatives_are_those_of_the_force(exact_nodes: SimulatedCurve, ratio: float) -> None:
    """Central differences give the same, also beyond the nodes."""
    depth, s = RADIUS * np.geomspace(1e-3, 0.3, 9), ratio * RADIUS
    curve, step = exact_nodes.force_curve(depth, s), 1e-5
    deeper, shallower = (exact_nodes.force_curve(depth * (1 + x), s).force for x in (step, -step))
    assert curve.by_depth == pytest.approx((deeper - shallower) / (2 * step * depth), rel=1e-3)
    ds = step * (s + RADIUS)
    beside = [exact_nodes.force_curve(depth, s + x * ds).force for x in (1.0, 2.0)]
    rate = (4 * beside[0] - beside[1] - 3 * curve.force) / (2 * ds)
    assert curve.by_length == pytest.approx(rate, rel=2e-3)


@pytest.mark.parametrize("ratio", [1e-3, 0.3, 8.0])
@pytest.mark.parametrize("shape", ["sphere", "cone"])
def test_contacts_without_tension_tell_those_under_tension(shape: str, ratio: float) -> None:
    """Of a body of revolution no contact under tension needs to be simulated."""
    fields = {"radius": RADIUS} if shape == "sphere" else {"half_angle": "70 degree"}
    body, depth = pl.indenter(shape, **fields), RADIUS * np.geomspace(0.01, 0.4, 20)
    assert isinstance(body, pl.HasForceCurve)
    depths, *_ = plan(body, solid("tensed_membrane"), 0.4 * RADIUS)
    bare = SimulatedCurve(EquivalentBody(depths, body.force_curve(depths, 0.0).force))
    exact = body.force_curve(depth, ratio * RADIUS).force
    assert bare.force_curve(depth, ratio * RADIUS).force == pytest.approx(exact, rel=3e-4)


def test_the_studies_are_small(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A table takes 28 runs, where one of all depths and tensions on two grids took 154."""
    runs: list[pl.Run] = []

    def counted(study: pl.Study, *_: Any, **__: Any) -> xr.Dataset:
        body = pl.indenter("paraboloid", radius=RADIUS)
        assert isinstance(body, pl.HasForceCurve)
        forces, radii = [], []
        for point in study.points:
            run, (depth,) = point.run, point.run.indentation.loading.values
            length = 2 * run.kernel.tension  # type: ignore[attr-defined]
            contact = body.force_curve(np.array([depth]), length)
            forces.append(contact.force[0])
            radii.append(contact.by_depth[0] / 2)
            runs.append(run)
        Path(tmp_path / "force-curves").mkdir(exist_ok=True)
        return xr.Dataset({"force": ("run", forces), "contact_radius": ("run", radii)})

    monkeypatch.setattr(simulation, "run_study", counted)
    monkeypatch.setattr("shutil.rmtree", lambda _: None)
    body, half = pl.indenter("paraboloid", radius=RADIUS), solid("tensed_membrane")
    simulated_curve(body, half, 1e-7, cache=tmp_path)
    assert len(runs) == 28
    assert sum(run.grid.points == (32, 32) for run in runs) == 6


def test_a_stranger_s_kernel_needs_no_poissons_ratio(monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel with a modulus and a tension is enough, and any ratio serves Young's modulus."""

    class Graded(pl.Isotropic):
        """A solid that is softer at its surface, under a skin."""

        type: Literal["graded"] = "graded"
        reduced_modulus: Annotated[float, Quantity("Pa", above=0)]
        tension: Annotated[float, Quantity("N/m", at_least=0)]

        def compliance(self, q: Array) -> Array:
            softer = 2 / (self.reduced_modulus * q) * (1 + 1 / (1 + 1 / (1e-6 * q)))
            return np.asarray(1 / (1 / softer + self.tension * q**2))

    kernels = registry().components["kernel"]
    entry = replace(kernels["half_space"], component=Graded, type="graded")
    monkeypatch.setitem(kernels, "graded", entry)
    assert solid("graded").poissons_ratio is None
    assert solid("graded", 0.4).poissons_ratio == 0.4
    assert not solid("graded").is_half_space


def test_the_contact_knows_how_well_it_is_known(exact_nodes: SimulatedCurve) -> None:
    """Its error widens intervals; without a half-space there is no contact radius."""
    contact = Contact.on_half_space(exact_nodes, 1e3, RADIUS)
    assert (contact.error, contact.half_space) == (0.01, False)
    assert not contact.is_bare_indenter
    assert 0.4 * RADIUS <= contact.depth_limit < 0.8 * RADIUS


@pytest.mark.slow
@pytest.mark.usefixtures("few_nodes")
def test_quadric_is_simulated_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Curves of an independent run are recovered, and the study is then there."""
    fields: dict[str, Any] = {"radius_x": "3 um", "radius_y": "7 um"}
    modulus, tension = 3e3, 3e-3
    depths = np.linspace(0.1e-6, 0.6e-6, 8)
    run = pl.Run(
        grid={"points": 48, "size": ["4.2 um", "6.3 um"]},
        kernel={"type": "tensed_membrane", "reduced_modulus": modulus, "tension": tension},
        indenter={"type": "quadric", **fields},
        loading={"depth": depths.tolist()},
    )
    forces = pl.run(run, progress=False).dataset["force"].values
    depth = np.concatenate([np.linspace(-0.2e-6, -0.01e-6, 60), np.repeat(depths, 40)])
    force = np.concatenate([np.zeros(60), np.repeat(forces, 40)])
    force = force + 0.003 * force.max() * np.random.default_rng(3).standard_normal(force.size)

    for _ in range(2):
        body, half = pl.indenter("quadric", **fields), solid("tensed_membrane")
        simulated = simulated_curve(body, half, 0.8e-6, cache=tmp_path, grid_points=24)
        monkeypatch.setattr(simulation, "run_study", None)
    assert simulated.half_space
    assert 0 < simulated.accuracy < 0.1
    found = answer([Curve(depth, force, simulated)], [Tension()], [], fix={"contact_point": 0.0})
    for name, truth in (("reduced_modulus", modulus), ("tension", tension)):
        low, high = ends_of(found.over_tied(name))
        assert low <= truth <= high < 1.5 * low


def test_poissons_ratio_is_the_kernels() -> None:
    """One ratio is enough: the kernel's is used for Young's modulus, and the other way round."""
    skin = {"type": "coated", "substrate": LAYER}
    assert solid(skin, 0.3).kernel.substrate.poissons_ratio == 0.3  # type: ignore[attr-defined]
    own = {"type": "coated", "substrate": LAYER | {"poissons_ratio": 0.4}}
    assert solid(own).poissons_ratio == 0.4
    assert solid(own, 0.4).poissons_ratio == 0.4
    with pytest.raises(pl.ConfigError, match=r"kernel\.substrate\.poissons_ratio: is 0\.4, and "):
        solid(own, 0.5)
    assert solid("tensed_membrane", 0.2).poissons_ratio == 0.2


def test_a_force_curve_allows_no_other_solid(exact_nodes: SimulatedCurve) -> None:
    """It includes its own."""
    depth = np.linspace(0, 0.3 * RADIUS, 40)
    force = 1e3 * exact_nodes.force_curve(depth, 0.0).force
    with pytest.raises(pl.ConfigError, match="kernel: cannot be given with a force curve"):
        pl.fit(depth, force, indenter=exact_nodes, kernel="tensed_membrane")


def test_a_bonded_layer_is_an_effect(monkeypatch: pytest.MonkeyPatch) -> None:
    """Other shapes, negative ratios, and punches too wide for the table need a study."""
    monkeypatch.setattr("pellicle_fit.problem.simulated_curve", lambda body, *_, **settings: body)
    thick, depth = 4e-6, np.linspace(-1e-7, 3e-7, 40)

    def kept(ratio: float, indenter: str, **fields: Any) -> list[Any]:
        config = pl.FitConfig.merged(
            indenter=indenter, **fields, thickness=thick, poissons_ratio=ratio
        )
        curves = config.sources({"a": (depth, np.maximum(depth, 0) ** 1.5)})
        return problem(config, [*curves]).arguments["common"]  # type: ignore[no-any-return]

    assert kept(0.3, "sphere", radius=RADIUS) == [Layer(thickness=thick, poissons_ratio=0.3)]
    assert kept(0.3, "flat_punch", radius=9 * thick)
    assert not kept(0.3, "flat_punch", radius=11 * thick)
    assert not kept(0.3, "quadric", radius_x=RADIUS, radius_y=2 * RADIUS)
    assert not kept(-0.1, "sphere", radius=RADIUS)
    layer = LAYER | {"poissons_ratio": 0.3}
    assert not solid({"type": "coated", "substrate": layer}).is_half_space


def test_a_sharp_pyramid_is_known_and_a_rounded_one_simulated(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whether an indenter has a force curve its depth limit tells."""
    monkeypatch.setattr("pellicle_fit.problem.simulated_curve", lambda *_, **settings: "simulated")
    depth = np.linspace(-1e-7, 3e-7, 40)
    for tip_radius, is_known in ((None, True), ("20 nm", False)):
        config = pl.FitConfig.merged(
            indenter="pyramid", half_angle="70 degree", tip_radius=tip_radius
        )
        asked = problem(config, [*config.sources({"a": (depth, np.maximum(depth, 0) ** 2)})])
        assert isinstance(asked.curves[0].indenter, str) is not is_known


@pytest.mark.slow
def test_a_study_that_fails_is_no_force_curve(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its table says which runs and why, and it is not taken for whole by the next fit."""

    def hasty(*arguments: Any) -> Any:
        *nodes, study = plan(*arguments)
        return *nodes, study | {"solver": {"type": "active_set", "max_iterations": 1}}

    monkeypatch.setattr(simulation, "_OCTAVES", 1)
    monkeypatch.setattr(simulation, "plan", hasty)
    for _ in range(2):
        with pytest.raises(pl.ConvergenceError, match="of 3 runs 3 did not converge") as error:
            simulated_curve(
                pl.indenter("paraboloid", radius=1e-6),
                solid("tensed_membrane"),
                2e-7,
                cache=tmp_path,
                grid_points=16,
            )
    (folder,) = (tmp_path / "force-curves").iterdir()
    assert str(folder) in str(error.value)


def test_what_cannot_be_simulated(tmp_path: Path) -> None:
    """Rough surfaces have no size of their own."""
    body = pl.indenter("self_affine", rms_height=1e-6, hurst=0.8, cutoff_wavelength=1e-6)
    with pytest.raises(pl.ConfigError, match="no force curve of its own"):
        simulated_curve(body, solid("tensed_membrane"), 1e-6, cache=tmp_path)


DEPTH = np.linspace(-1e-6, 2e-6, 60)
FORCE = 1e4 * Sphere(radius=1e-5).force_curve(DEPTH, 1e-7).force


def liar(change: Callable[..., Any]) -> Any:
    """Return a sphere whose force curves are changed, given the depths."""

    class Bead(Sphere):
        """Sphere with other force curves."""

        type: Literal["liar"] = "liar"  # type: ignore[assignment]

        def force_curve(self, depth: Any, length: float) -> Any:
            return change(super().force_curve(depth, length), depth)

        def layer_force_curve(self, depth: Any, *solid: float) -> Any:
            return change(super().layer_force_curve(depth, *solid), depth)

    return Bead(radius=1e-5)


@pytest.mark.parametrize(
    "solid", [{}, {"thickness": 1e-5, "poissons_ratio": 0.5}], ids=["half-space", "layer"]
)
@pytest.mark.parametrize(
    "change",
    [
        lambda curve, depth: curve.force,
        lambda curve, depth: curve._replace(force=curve.force[:-1]),
        lambda curve, depth: curve._replace(force=curve.force + 0j),
        lambda curve, depth: curve._replace(force=np.nan * depth),
    ],
    ids=["bare", "short", "complex", "NaN"],
)
def test_a_force_curve_that_lies_is_refused(
    change: Callable[..., Any], solid: dict[str, Any]
) -> None:
    """No modulus is fitted by a force that is none."""
    with pytest.raises(pl.PluginError, match="indenter 'liar': its force curve is "):
        pl.fit(DEPTH, FORCE, indenter=liar(change), rivals=[], **solid)
