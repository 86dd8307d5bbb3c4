"""Fits with a bead that yields too: a sample's own modulus and tension."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Array
from pellicle_fit.contact.contact import Contact
from pellicle_fit.contact.soft_bead import SHARES, SoftBead
from pellicle_fit.simulated import bead as simulated_bead
from pellicle_fit.simulated.bead import soft_bead
from tests.plugins.fit.conftest import holds

RADIUS, SAMPLE, BEAD = 5e-6, 2e3, 5e3
SPHERE: Any = pl.indenter("sphere", radius=RADIUS)


def curve(modulus: float) -> tuple[Array, Array]:
    """Return position and force of Hertzian bodies of a combined modulus, with 0.3 % noise."""
    depth = np.linspace(-0.3e-6, 0.8e-6, 200)
    force = modulus * SPHERE.force_curve(depth, 0.0).force
    return depth, force + 0.003 * force.max() * np.random.default_rng(2).standard_normal(200)


def fit(**options: Any) -> pl.Fit:
    """Return the fit of a curve of both bodies without tension."""
    data = curve(1 / (1 / SAMPLE + 1 / BEAD))
    known = {"indenter": "sphere", "radius": RADIUS, "rivals": [], "model": []}
    return pl.fit(*data, **{**known, **options})


@pytest.mark.parametrize(
    "bead",
    [
        {"reduced_modulus": "5 kPa"},
        {"youngs_modulus": "3.75 kPa", "poissons_ratio": 0.5},
        {"youngs_modulus": "3.75 kPa"},
    ],
    ids=str,
)
def test_without_tensions_compliances_add(bead: dict[str, Any]) -> None:
    """What is told is the sample's own modulus; taken for rigid, both seem to be one soft solid."""
    told = fit(bead=bead, poissons_ratio=0.5)
    assert holds(told.reduced_modulus, SAMPLE)
    assert told.youngs_modulus is not None
    assert told.youngs_modulus.value == pytest.approx(0.75 * told.reduced_modulus.value)
    assert fit().reduced_modulus.value == pytest.approx(SAMPLE * BEAD / (SAMPLE + BEAD), rel=0.01)


def test_a_file_and_overrides_say_the_same(tmp_path: Path) -> None:
    """A bead is a table of a TOML file, and its fields options of the terminal."""
    file = tmp_path / "fit.toml"
    file.write_text('[indenter]\ntype = "sphere"\nradius = "5 um"\n[bead]\ntension = "1 mN/m"\n')
    config = pl.FitConfig.from_toml(file, ["bead.reduced_modulus=5 kPa"])
    assert config.bead == {"tension": "1 mN/m", "reduced_modulus": "5 kPa"}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"kernel": "half_space"}, "bead: a bead that yields is fitted on a half-space"),
        ({"thickness": "4 um", "poissons_ratio": 0.5}, "leave out thickness or bead"),
        ({"frequencies": ["10 Hz"]}, "leave out frequencies or bead"),
        ({"uncertainty": {"radius": 0.03}}, r"uncertainty\.radius: of a bead that yields"),
        ({"bead": {"youngs_modulus": 1e3}}, "bead.*poissons_ratio"),
        ({"bead": {"reduced_modulus": -1.0}}, r"bead\.reduced_modulus"),
        ({"bead": {"type": "coated"}}, r"bead\.type: is not a field of a bead"),
        ({"bead": {"reduced_modulus": 1e3, "tension": [1e-3, 2e-3]}}, r"bead\.tension"),
        (
            {"indenter": "quadric", "radius": None, "radius_x": 1e-6, "radius_y": 2e-6},
            "no body of revolution",
        ),
    ],
    ids=lambda part: "" if isinstance(part, str) else "+".join(part),
)
def test_what_is_not_exact_is_refused(options: dict[str, Any], message: str) -> None:
    """The field and the reason are named."""
    known: dict[str, Any] = {"bead": {"reduced_modulus": BEAD}}
    if "kernel" in options:
        options = {"kernel": {"type": "coated", "substrate": {"type": "half_space"}}}
    if options.get("indenter"):
        config = {k: v for k, v in options.items() if v is not None}
        with pytest.raises(pl.ConfigError, match=message):
            pl.fit(*curve(SAMPLE), model=[], rivals=[], **{**known, **config})
        return
    with pytest.raises(pl.ConfigError, match=message):
        fit(**{**known, **options})


def test_a_sample_does_not_relax_beside_it() -> None:
    """A relaxation of the sample alone is not weighed, and the reason is told."""
    time = np.linspace(0, 1, 200)
    told = fit(bead={"reduced_modulus": BEAD}, rivals=["power_law"], time=time)
    assert told.reduced_modulus.value == pytest.approx(SAMPLE, rel=0.02)
    assert "a bead that yields does not relax with the solid" in str(told.to_dict())


def pairs(forces: Array | None = None) -> SoftBead:
    """Return a bead under 3 mN/m with forces of springs in series, or others."""
    bead = SoftBead(SPHERE, BEAD, 6e-3 / BEAD)
    depths = np.array([5e-8, 2e-7, 8e-7])
    _, sample, _ = bead.nodes(depths)
    return replace(bead, depths=depths, forces=sample * (1 - SHARES) if forces is None else forces)


def test_where_one_body_is_rigid_the_other_alone_yields() -> None:
    """Whatever is simulated, the ends are exact."""
    depth, bead = np.linspace(1e-7, 7e-7, 5), pairs()
    assert bead.forces is not None
    odd = replace(bead, forces=bead.forces * np.array([0.9, 0.8, 0.9]))
    for one, other, length in ((1e-9, 1.0, 4e-7), (1e9, BEAD, bead.length)):
        contact = Contact.on_half_space(odd, 1.0, 8e-7).of_modulus(one)
        force = replace(contact, tension=one * 2e-7).force(depth)
        alone = (one if other == 1.0 else other) * SPHERE.force_curve(depth, length).force
        assert force == pytest.approx(alone, rel=1e-5)


def test_trials_are_rows() -> None:
    """Columns of moduli and tensions give the same as one by one."""
    contact = Contact.on_half_space(pairs(), 1.0, 8e-7)
    depth, moduli = np.linspace(-1e-7, 7e-7, 9), np.array([[500.0], [2e3], [9e3]])
    trials: Any = replace(contact.of_modulus(moduli), tension=moduli * 1e-6)  # type: ignore[arg-type]
    together = trials.force(depth)
    for row, (modulus,) in zip(together, moduli.tolist(), strict=True):
        alone = replace(contact.of_modulus(modulus), tension=modulus * 1e-6).force(depth)
        assert row == pytest.approx(alone, rel=1e-12)
    assert not together[:, depth <= 0].any()


@pytest.mark.slow
def test_pairs_with_skins(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two equal bodies are one of half the modulus and the tension; others are as in a run."""
    options: dict[str, Any] = {"skins": True, "cache": tmp_path, "grid_points": 32}
    for _ in range(2):
        bead = soft_bead(SPHERE, BEAD, 3e-3, 1e-6, **options)
        monkeypatch.setattr("pellicle_fit.simulated.simulation.run_study", None)
    depth = np.array([1e-7, 3e-7, 8e-7])
    contact = Contact.on_half_space(bead, 1.0, 1e-6)
    equal = replace(contact.of_modulus(BEAD), tension=3e-3).force(depth)
    half = BEAD / 2 * SPHERE.force_curve(depth, bead.length).force
    assert equal == pytest.approx(half, rel=3e-3)
    body = {"type": "tensed_membrane"}
    first, second = (
        body | {"reduced_modulus": modulus, "tension": tension}
        for modulus, tension in ((SAMPLE, 1e-3), (BEAD, 3e-3))
    )
    run = pl.Run(
        grid={"points": 64, "size": "5 um"},
        kernel={"type": "pair", "first": first, "second": second},
        indenter={"type": "sphere", "radius": RADIUS},
        loading={"depth": depth[2]},
    )
    other = replace(contact.of_modulus(SAMPLE), tension=1e-3).force(depth[2:])
    assert other == pytest.approx(pl.run(run, progress=False).dataset["force"].values, rel=5e-3)


def test_no_skin_needs_no_study(monkeypatch: pytest.MonkeyPatch) -> None:
    """Contacts are simulated only where a tension may be."""
    asked: list[bool] = []

    def bead(
        rigid: Any, modulus: float, tension: float, _: float, *, skins: bool, **__: Any
    ) -> Any:
        asked.append(skins)
        return SoftBead(rigid, modulus, 2 * tension / modulus)

    monkeypatch.setattr("pellicle_fit.problem.soft_bead", bead)
    known = {"reduced_modulus": BEAD}
    fit(bead=known)
    fit(bead=known, model=["tension"], fix={"tension": 0})
    fit(bead=known, model=["tension"])
    fit(bead=known | {"tension": 1e-3})
    assert asked == [False, False, True, True]
    assert simulated_bead.constants_of(known | {"tension": "1 mN/m"}, None) == (BEAD, 1e-3)
