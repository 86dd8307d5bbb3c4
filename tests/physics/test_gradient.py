"""Derivatives of force and depth against central differences, within one set of contact cells."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from pydantic import Field

import pellicle as pl
from pellicle.arrays import Array
from pellicle.components.calls import solution_of
from pellicle.contact.equilibrium import equilibrium_of
from pellicle.runs.compose import compose
from pellicle.schema.model import get, replace_at
from tests.tables_of_runs import half_space, layer, pressing, relaxing

KERNELS: dict[str, dict[str, Any]] = {
    "half-space": {"type": "half_space", "reduced_modulus": 1e4},
    "membrane": {"type": "tensed_membrane", "youngs_modulus": 9e3, "poissons_ratio": 0.3},
    "bending": {"type": "bending_skin", "reduced_modulus": 1e4, "tension": 0.1, "bending": 1e-10},
    "surface": {
        "type": "gurtin_murdoch",
        "youngs_modulus": 9e3,
        "poissons_ratio": 0.3,
        "surface_stiffness": 2.0,
        "tension": 0.2,
    },
    "bonded": layer("bonded_layer", 1e-4, 0.4, youngs_modulus=1e4),
    "springs": {"type": "winkler", "foundation": 1e8},
    "layers": {
        "type": "layered",
        "layers": [
            {"youngs_modulus": 1e5, "poissons_ratio": 0.3, "thickness": 1e-5},
            {"reduced_modulus": 1e4, "poissons_ratio": 0.4, "thickness": 5e-5},
        ],
        "substrate": {"youngs_modulus": 3e4, "poissons_ratio": 0.4},
    },
    "skin on a layer": {
        "type": "coated",
        "tension": 0.1,
        "bending": 1e-11,
        "substrate": layer("frictionless_layer", 1e-4, 0.3, youngs_modulus=1e4),
    },
}
KERNELS["membrane"]["tension"] = 0.1
INDENTERS: list[dict[str, Any]] = [
    {"type": "paraboloid", "radius": 1e-3},
    {"type": "cone", "half_angle": 1.4, "tip_radius": 1e-4},
    {"type": "self_affine", "rms_height": 5e-6, "hurst": 0.8, "cutoff_wavelength": 1e-4, "seed": 3},
]
LOADINGS: list[dict[str, Any]] = [
    {"depth": [8e-6]},
    {"force": [2e-5]},
    {"base_displacement": [2e-5], "spring_constant": 1.0},
    {"mean_pressure": [150.0]},
]
# Twentieth parts of what a force changes by are lost in its rounding.
STEP = 1e-3


def configuration(
    kernel: Any, boundary: str, indenter: Any, loading: Any, **more: Any
) -> dict[str, Any]:
    """Return a run on few cells, solved nearly to rounding."""
    tables = pressing([24, 20], [4e-4, 3.6e-4], kernel, indenter, boundary=boundary, **loading)
    return {**tables, "solver": {"type": "active_set", "tolerance": 1e-12}, **more}


def solved(run: dict[str, Any]) -> Any:
    """Return the dataset of a run."""
    return pl.run(pl.Run(**run), progress=False).dataset


def numbers_of(kernel: dict[str, Any]) -> list[str]:
    """Return the paths of numbers that are not 0."""
    run = pl.Run(**configuration(kernel, "periodic", INDENTERS[0], LOADINGS[0]))
    paths = []
    for path, value, _ in pl.schema.model.walk({"kernel": run.kernel}):
        if isinstance(value, float) and value:
            paths.append(path)
    return paths


PATHS = [(name, path) for name, kernel in KERNELS.items() for path in numbers_of(kernel)]
pytestmark = [
    pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning"),
    pytest.mark.filterwarnings("ignore:the surface is not periodic"),
]


def difference(run: dict[str, Any], path: str, quantity: str, share: float) -> tuple[float, bool]:
    """Return a fourth-order central difference, and whether the contact stays the same."""
    value = get(pl.Run(**run), path)
    cells, values = [], []
    for factor in (-2, -1, 1, 2):
        data = solved(replace_at(run, path, value * (1 + factor * share)))
        assume(bool(data["converged"].all()))
        cells.append(data["contact"].values)
        values.append(data[quantity].item())
    same = all((one == cells[0]).all() for one in cells)
    return float(np.dot(values, [1, -8, 8, -1])) / (12 * share * value), same


@settings(deadline=None, max_examples=15, suppress_health_check=list(HealthCheck))
@given(
    which=st.sampled_from(PATHS),
    boundary=st.sampled_from(["free", "periodic"]),
    indenter=st.sampled_from(INDENTERS),
    loading=st.sampled_from(LOADINGS),
)
def test_by_numbers_of_the_kernel(
    which: tuple[str, str], boundary: str, indenter: Any, loading: Any
) -> None:
    """To 1e-6, for all kernels, boundaries and prescriptions, in SI and per unit."""
    (name, path) = which
    assume(not ("mean_pressure" in loading and boundary == "free"))
    run = configuration(KERNELS[name], boundary, indenter, loading)
    data = solved(run | {"gradient": [path]})
    assume(bool(data["converged"].all()) and 4 < int(data["contact"].sum()) < 300)
    for quantity in ("force", "depth"):
        expected, same = difference(run, path, quantity, 2e-4)
        assume(same)
        value = get(pl.Run(**run), path)
        found = data[f"{quantity}_by_{path.replace('.', '_')}"].item()
        # Numbers of which the force hardly depends are lost in its rounding.
        noise = 1e-8 * data[quantity].item() / value
        assert found == pytest.approx(expected, rel=1e-6, abs=noise)


@settings(deadline=None, max_examples=6, suppress_health_check=list(HealthCheck))
@given(
    name=st.sampled_from(sorted(KERNELS)),
    boundary=st.sampled_from(["free", "periodic"]),
    indenter=st.sampled_from(INDENTERS),
    loading=st.sampled_from(LOADINGS),
    sticks=st.sampled_from([None, "linear", "jkr"]),
)
def test_by_heights(
    name: str, boundary: str, indenter: Any, loading: Any, sticks: str | None
) -> None:
    """Cell by cell, to 1e-5 in the norm; with adhesion too, where cells off the contact count."""
    assume(not ("mean_pressure" in loading and boundary == "free"))
    more = {}
    if sticks:
        law = {"type": sticks, "work_of_adhesion": 5e-4}
        more["interaction"] = law | ({"range": 2e-6} if sticks == "linear" else {})
    run = pl.Run(
        **configuration(KERNELS[name], boundary, indenter, loading, gradient=["heights"], **more)
    )
    data = pl.run(run, progress=False).dataset
    assume(bool(data["converged"].all()) and 4 < int(data["contact"].sum()) < 200)
    setting = compose(run)
    target = run.indentation.loading.prescription.target(setting, run.indentation.loading.values[0])
    problem = setting.problem(target)  # type: ignore[arg-type]
    state = pl.State(
        data["pressure"].values[0],
        data["pressure" if not sticks else "wall_pressure"].values[0],
        data["depth"].item(),
    )
    step, reach = 2e-10, run.interaction.cutoff() if run.interaction else np.inf
    for quantity in ("force", "depth"):
        gradient = data[f"{quantity}_by_heights"].values[0]
        if not gradient.any():
            continue
        cells = np.argwhere(gradient)
        expected = np.zeros_like(gradient)
        for i, j in cells[np.linspace(0, len(cells) - 1, 8).astype(int)]:
            values = []
            for sign in (1, -1):
                profile = problem.profile.copy()
                profile[i, j] += sign * step
                moved = replace(problem, profile=profile)
                solution = solution_of(run.solver, moved, state, lambda *_: None)
                found = equilibrium_of(moved, solution)
                assume(found.residual <= 1e-10)
                assume(bool((found.contact == data["contact"].values[0]).all()))
                # A linear law bends where its range ends.
                assume(bool(((found.gap < reach) == (data["gap"].values[0] < reach)).all()))
                values.append(getattr(found, quantity))
            expected[i, j] = (values[0] - values[1]) / (2 * step)
        told = np.where(expected != 0, gradient, 0.0)
        error = np.linalg.norm(told - expected) / np.linalg.norm(expected)
        assert error < 1e-5


class Mine(pl.Isotropic):
    """A stranger's kernel known by its symbol alone."""

    type: Literal["mine"] = "mine"
    softness: Annotated[float, Field(description="G of springs [m/Pa]")] = 1e-8
    length: Annotated[float, Field(description="length beyond which they are coupled [m]")] = 3e-5

    def compliance(self, q: Array) -> Array:
        return self.softness / (1 + q * self.length)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_of_a_strangers_kernel(boundary: str) -> None:
    """Without a line of it: G is proportional to the softness, so the force to its inverse."""
    run = configuration(Mine(), boundary, INDENTERS[0], {"depth": [4e-6, 8e-6]})
    data = solved(run | {"gradient": ["kernel.softness", "kernel.length"]})
    by_softness = data["force_by_kernel_softness"] * Mine().softness
    np.testing.assert_allclose(by_softness, -data["force"], rtol=1e-9)
    assert data["force_by_kernel_softness"].attrs["units"] == "N"


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_the_library_gives_what_a_run_does(boundary: str) -> None:
    """Of a result that is solved, with the same units."""
    run = configuration(KERNELS["bonded"], boundary, INDENTERS[0], {"depth": [4e-6, 8e-6]})
    paths = ["kernel.youngs_modulus", "kernel.thickness", "indenter.radius", "heights"]
    result = pl.run(pl.Run(**run, gradient=paths), progress=False)
    again = pl.gradient(pl.run(pl.Run(**run), progress=False), by=paths)
    assert set(again) == {str(n) for n in result.dataset if "_by_" in str(n)}
    for name in again:
        np.testing.assert_allclose(again[name], result.dataset[name], rtol=1e-9, atol=1e-30)
        assert again[name].attrs == result.dataset[name].attrs
    assert again["force_by_indenter_radius"].attrs["units"] == "N/m"
    with pytest.raises(pl.ConfigError, match="no real number"):
        pl.gradient(result, by="kernel.tension")
    # All heights together are the depth.
    stiffness = pl.run(
        pl.Run(**replace_at(run, "loading", {"depth": [4e-6, 8e-6], "stiffness": True})),
        progress=False,
    ).dataset["stiffness"]
    np.testing.assert_allclose(again["force_by_heights"].sum(["x", "y"]), stiffness, rtol=1e-9)


def test_a_search_keeps_the_force_that_it_found() -> None:
    """Where it tells the depth; the depth, where it tells the force."""
    run = configuration(KERNELS["membrane"], "free", INDENTERS[0], {"contact_area": [1.2e-8]})
    found = solved(run | {"gradient": ["kernel.tension"]})
    name = "kernel_tension"
    for prescribed, told in (("force", "depth"), ("depth", "force")):
        other = run | {"loading": {prescribed: found[prescribed].values.tolist()}}
        expected = solved(other | {"gradient": ["kernel.tension"]})
        assert expected[f"{prescribed}_by_{name}"].item() == 0
        assert found[f"{told}_by_{name}"].item() == pytest.approx(
            expected[f"{told}_by_{name}"].item(), rel=1e-8
        )


def test_full_contact_moves_as_a_whole() -> None:
    """On a periodic domain: the mean plane is where it was, whatever the solid."""
    run = configuration(KERNELS["membrane"], "periodic", INDENTERS[2], {"mean_pressure": [1e5]})
    data = solved(run | {"gradient": ["kernel.tension", "heights", "indenter.rms_height"]})
    assert data["contact"].values.all()
    assert abs(data["depth_by_kernel_tension"].item()) < 1e-15
    np.testing.assert_allclose(data["depth_by_heights"], -1 / 480, rtol=1e-12)
    by_height = data["depth_by_indenter_rms_height"].item() * 5e-6
    assert by_height == pytest.approx(data["depth"].item(), rel=1e-9)


def test_a_first_jump_of_a_solid_that_relaxes() -> None:
    """Is elastic; more steps are refused."""
    solid = relaxing(half_space(1e4), 0.5, 1.0)
    kernel = {"type": "coated", "tension": 0.1, "substrate": solid}
    run = configuration(kernel, "free", INDENTERS[0], {"depth": [8e-6], "time": [0.0]})
    paths = ["kernel.tension", "kernel.substrate.solid.reduced_modulus"]
    data = solved(run | {"gradient": paths})
    same = KERNELS["membrane"] | {"reduced_modulus": 1e4}
    elastic = {k: v for k, v in same.items() if k not in ("youngs_modulus", "poissons_ratio")}
    expected = solved(
        configuration(
            elastic,
            "free",
            INDENTERS[0],
            {"depth": [8e-6]},
            gradient=["kernel.tension", "kernel.reduced_modulus"],
        )
    )
    for ours, theirs in zip(paths, ("kernel.tension", "kernel.reduced_modulus"), strict=True):
        assert data[f"force_by_{ours.replace('.', '_')}"].item() == pytest.approx(
            expected[f"force_by_{theirs.replace('.', '_')}"].item(), rel=1e-6
        )
    with pytest.raises(pl.ConfigError, match="first step that is a jump"):
        pl.Run(**run | {"loading": {"depth": [8e-6] * 2, "time": [0, 1]}, "gradient": paths})


SEEDED = {"indenter": INDENTERS[2]}


@cache
def never() -> Any:
    """Return a solver that must not be reached."""

    class Never(pl.Solver):
        """No solver."""

        type: Literal["never"] = "never"

        def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
            raise AssertionError("solved")

    return Never()


@pytest.mark.parametrize(
    ("change", "path", "words"),
    [
        ({"indenter": {"type": "flat_punch", "radius": 1e-4}}, "indenter.radius", "flat end"),
        (SEEDED, "indenter.cutoff_wavelength", "in steps"),
        (
            SEEDED
            | {
                "grid": {"points": 24, "size": 4e-4, "boundary": "periodic"},
                "loading": {"mean_plane_depth": [-1e-6]},
            },
            "heights",
            "depends on the heights",
        ),
    ],
)
def test_what_turns_out_to_have_none_is_refused(
    change: dict[str, Any], path: str, words: str
) -> None:
    """Before anything is solved."""
    run = configuration(KERNELS["half-space"], "free", INDENTERS[0], LOADINGS[0])
    run = run | change | {"solver": never(), "gradient": [path]}
    with pytest.raises(pl.ConfigError, match=words) as caught:
        pl.run(pl.Run(**run), progress=False)
    assert "gradient" in caught.value.problems[0].field


def test_a_file_a_study_and_what_is_resumed(tmp_path: Path) -> None:
    """Columns and fields are those of any other variable."""
    text = """
    gradient = ["kernel.tension", "heights"]
    outputs = [{ type = "csv" }]
    [grid]
    points = 24
    size = "0.4 mm"
    [kernel]
    type = "tensed_membrane"
    reduced_modulus = "10 kPa"
    tension = "0.1 N/m"
    [indenter]
    type = "paraboloid"
    radius = "1 mm"
    [loading]
    depth = ["4 um", "8 um"]
    [study.vary]
    "indenter.radius" = ["1 mm", "2 mm"]
    [study.derived]
    share = "force_by_kernel_tension * kernel.tension / force"
    """
    path = tmp_path / "run.toml"
    path.write_text(text.partition("    [study.vary]")[0], encoding="utf-8")
    result = pl.run(path, directory=tmp_path / "out", progress=False)
    loaded = pl.load(tmp_path / "out" / "run.h5").dataset
    np.testing.assert_array_equal(loaded["force_by_heights"], result.dataset["force_by_heights"])
    assert "force_by_kernel_tension" in (tmp_path / "out" / "run.csv").read_text(encoding="utf-8")
    path.write_text(text, encoding="utf-8")
    table = pl.run_study(pl.Study.from_toml(path), directory=tmp_path / "study", progress=False)
    assert table["share"].shape == (2, 2)
    assert (table["share"] > 0).all()
    assert "force_by_heights" not in table
