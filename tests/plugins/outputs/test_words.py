"""Figures and pages speak in words and engineering units, never in keys of a run file."""

from __future__ import annotations

import json
import re
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.text import Text

import pellicle as pl
from pellicle.components import Axis
from pellicle.config.coordinates import Coordinate, tell_apart
from pellicle.results.wording import column_of
from pellicle.schema.model import walk
from pellicle.variables import VARIABLES
from pellicle_fit.curves.sources import SourceStream
from pellicle_fit.many import fit_sources
from pellicle_fit.report.page import save_report
from pellicle_plugins.outputs.base import axis_of
from tests.plugins.fit.conftest import skip_rivals
from tests.plugins.outputs.shared import bead

PAGES: list[dict[str, Any]] = [{"type": "figures"}, {"type": "html"}]
LAYER = bead(
    title="Layer under a skin",
    kernel={
        "type": "coated",
        "tension": "30 mN/m",
        "substrate": {
            "type": "bonded_layer",
            "reduced_modulus": "10 kPa",
            "poissons_ratio": 0.4,
            "thickness": "0.1 mm",
        },
    },
    loading={"depth": ["5 um", "10 um"], "stiffness": True},
    corrections=[{"type": "yastrebov"}],
    solver={"type": "active_set"},
    outputs=[
        *PAGES,
        {"type": "curves", "y": ["contact_area", "contact_area_yastrebov"]},
        {"type": "curves", "name": "ratio", "y": "mean_contact_pressure / kernel.tension ** 2"},
        {"type": "profiles", "by": "step"},
        {"type": "profiles", "name": "product", "y": "pressure * grid.size.0 / semi_major_axis"},
        {"type": "maps", "by": "step", "field": "gap"},
        {"type": "patches", "by": "step"},
        {"type": "distributions", "by": "step"},
        {"type": "spectrum", "by": "step"},
    ],
)
STUDY = LAYER | {
    "loading": {"depth": "10 um"},
    "outputs": [
        *PAGES,
        {"type": "profiles", "by": "kernel.substrate.thickness"},
        {"type": "maps", "by": "indenter"},
        {"type": "distributions", "by": "kernel.tension"},
    ],
    "study": {
        "vary": {
            "kernel.tension": ["0.9 N/m", "1.1 N/m"],
            "kernel.substrate.thickness": ["50 um", "0.1 mm"],
            "indenter": [
                {"type": "paraboloid", "radius": "1 mm"},
                {"type": "cone", "half_angle": "85 degree"},
            ],
        }
    },
}
STICKING = bead(
    grid={"points": 24, "size": "20 um"},
    indenter={"type": "paraboloid", "radius": "20 um"},
    interaction={"type": "linear", "work_of_adhesion": "0.5 mJ/m^2", "range": "0.3 um"},
    loading={"depth": {"start": "0.2 um", "stop": "0.6 um", "num": 3, "back": True}},
    outputs=PAGES,
)
RELAXING = bead(
    kernel={
        "type": "viscoelastic",
        "solid": {"type": "half_space", "reduced_modulus": "10 kPa"},
        "relaxation": [{"fraction": 0.5, "time": "1 s"}],
    },
    loading={
        "depth": [
            {"to": "10 um", "time": "1 s", "num": 2},
            {"amplitude": "1 um", "frequency": "1 Hz", "cycles": 1, "num": 8},
        ]
    },
    outputs=PAGES,
)
WORDS = {
    "layer": "step 2;gap [µm];contact area, Yastrebov correction;contact area [mm²]",
    "study": "surface tension 1.1 N/m;thickness of the substrate 50 µm;indenter cone;[mm²]",
    "sticking": "work of adhesion",
    "relaxing": "storage stiffness K′",
}
"""Words of figures or pages, with their units."""


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the list to which the texts of each figure are added as it is saved."""
    texts: list[str] = []

    def saved(self: Figure, *_: Any, **__: Any) -> None:
        # Ticks get their labels when they are drawn; layout and rendering take most of the time.
        self.set_layout_engine("none")
        self.draw_without_rendering()
        texts.extend(text.get_text() for text in self.findobj(Text))

    monkeypatch.setattr(Figure, "savefig", saved)
    return texts


def visible(page: str) -> list[str]:
    """Return what a reader of a page sees, in maps too, without code to be typed."""
    shown = []
    for data in re.findall(r'(?s)<script type="application/json"[^>]*>(.*?)</script>', page):
        data = json.loads(data)
        pictures = data.get("pictures", ())
        shown += [picture[key] for picture in pictures for key in ("caption", "description")]
        shown += [field["name"] for field in data.get("fields", ())]
        shown += [frame["label"] for frame in data.get("frames", ()) if "fields" in data]
    hidden = r"(?s)<(code|pre|style|script)\b.*?</\1>|<[^>]*>"
    return shown + unescape(re.sub(hidden, "\n", page)).splitlines()


def keys(texts: list[str], configuration: dict[str, Any]) -> set[str]:
    """Return the keys among texts: dotted paths of a run, and names with an underscore."""
    paths = {path for path, _, _ in walk(configuration) if "." in path}
    words = {*paths, *(name for name in VARIABLES if "_" in name), "contact_area_yastrebov"}
    snake = re.compile(r"(?<![\w/.-])[a-z]+(?:[_.][a-z0-9]+)*_[a-z0-9]+")
    named = {word for text in texts for word in words if re.search(rf"\b{re.escape(word)}\b", text)}
    # The provenance names entry points, such as kernel.half_space.
    entry_points = re.compile(r"^\w+\.\w+$")
    rest = {
        match[0] for text in texts if not entry_points.match(text) for match in snake.finditer(text)
    }
    return named | rest


# Cells of a quick test are wide for the zone; what is drawn is not less.
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
@pytest.mark.parametrize(
    ("name", "run"),
    [("layer", LAYER), ("study", STUDY), ("sticking", STICKING), ("relaxing", RELAXING)],
)
def test_no_figure_or_page_has_a_key(
    name: str, run: dict[str, Any], drawn: list[str], tmp_path: Path
) -> None:
    """Whatever is drawn of a run or a study, or written on its page, is in words with units."""
    (pl.run_study if "study" in run else pl.run)(run, directory=tmp_path, progress=False, threads=1)
    (page,) = tmp_path.glob("*.html")
    assert len(drawn) > 50
    drawn += visible(page.read_text(encoding="utf-8"))
    assert keys(drawn, run) == set()
    for word in WORDS[name].split(";"):
        assert any(word in text for text in drawn), word


@pytest.mark.slow
def test_fits_and_populations_are_in_words(
    drawn: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor have figures and pages of one curve, a pool and a population, nor what notebooks show."""
    sphere, random = pl.indenter("sphere", radius="5 um"), np.random.default_rng(2)
    depth = np.linspace(-0.5e-6, 1.5e-6, 120)
    curves = {}
    for name, modulus in (("a", 2e3), ("b", 3e3)):
        force = modulus * sphere.force_curve(depth, 3e-6).force  # type: ignore[attr-defined]
        curves[name] = depth, force + 0.01 * force.max() * random.standard_normal(depth.size)
    config = pl.FitConfig(indenter=sphere, poissons_ratio=0.5)
    one = pl.fit(*curves["a"], indenter=sphere, poissons_ratio=0.5)
    with monkeypatch.context() as patch:
        # The words of rivals are those of one curve.
        skip_rivals(patch)
        fits = fit_sources(config, SourceStream(config.files(curves)), None, progress=False)
        pool = pl.fit_pooled(curves, indenter=sphere, poissons_ratio=0.5, progress=False)
    for fit in (one, pool, fits):
        page = save_report(fit, tmp_path / "fit.html", "Beads").read_text(encoding="utf-8")
        drawn += [*visible(page), *visible(fit._repr_html_())]
    text = "\n".join(drawn)
    assert len(drawn) > 100
    assert "2 of 2 curves were fitted. Median: Young's modulus" in text
    assert "Fit of 2 curves" in text
    assert keys(drawn, {}) == set()


def test_the_walk_finds_keys() -> None:
    """A key among the texts is found, so that the tests above can fail."""
    texts = ["kernel.tension = 1 N/m", "mean_pressure [Pa]", "surface tension 30 mN/m", "force [N]"]
    assert keys(texts, LAYER) == {"kernel.tension", "mean_pressure"}


def coordinate(values: list[float], unit: str, name: str = "odd.thing") -> xr.DataArray:
    """Return the coordinate of a study."""
    return xr.Dataset(coords={name: (name, values, {"units": unit})})[name]


@pytest.mark.parametrize(
    ("values", "unit", "texts"),
    [
        ([0.9e-6, 1.1e-6], "m", ["thing 0.9 µm", "thing 1.1 µm"]),
        ([1.00001, 1.00002], "N", ["thing 1.00001 N", "thing 1.00002 N"]),
        ([0.0, 1e-30], "m", ["thing 0 m", "thing 1e-30 m"]),
        ([float("nan"), 1e-3], "N", ["thing –", "thing 1 mN"]),
        ([float("inf"), -2e-9], "N", ["thing ∞ nN", "thing -2 nN"]),
        ([2.0, 3.0], "1/m^0.5", ["thing 2 1/m^0.5", "thing 3 1/m^0.5"]),
        ([5.0, 6.0], "photons", ["thing 5 photons", "thing 6 photons"]),
        ([0.25, 0.5], "", ["thing 0.25", "thing 0.5"]),
        ([-1e-3, 0.0], "rad", ["thing -0.0573°", "thing 0°"]),
        ([1e-9, 2e-6], "m2", ["thing 0.001 mm²", "thing 2 mm²"]),
    ],
)
def test_values_of_an_axis(values: list[float], unit: str, texts: list[str]) -> None:
    """All values of an axis are in one unit, with digits that tell them apart."""
    axis = coordinate(values, unit)
    how = column_of(axis)
    assert [how.text(value) for value in values] == texts


def test_a_stranger_s_words() -> None:
    """A variable without words is named by its own name; with words, by those, also from a file."""
    plain = xr.DataArray([1e-6], dims="step", name="my_own_length", attrs={"units": "m"})
    assert column_of(plain).read()[0] == "my own length [µm]"
    titled = plain.assign_attrs(short_name="length of mine")
    assert column_of(titled).read()[0] == "length of mine [µm]"
    assert column_of(titled * 1.23456789).read(si=True) == ("length of mine [m]", ["1.23457e-06"])


def test_axes_of_equal_words_are_told_apart() -> None:
    """Two radii of a study name the table that they are in; other axes do not."""
    names = {"kernel.radius": "radius", "indenter.radius": "radius", "kernel.tension": "tension"}
    axes = {
        key: Coordinate(np.empty(1), {"long_name": words, "short_name": words})
        for key, words in names.items()
    }
    tell_apart(axes)
    assert [axis.attributes["short_name"] for axis in axes.values()] == [
        "radius of the kernel",
        "radius of the indenter",
        "tension",
    ]


def test_the_label_of_an_expression_has_no_wrong_unit() -> None:
    """A force over a modulus is not in newtons, though xarray keeps the unit of the force."""
    table = xr.Dataset(
        {"force": ("step", [1e-6, 2e-6], {"units": "N"})}, attrs={"configuration": "{}"}
    )
    assert axis_of("force", None, table) == Axis("force", "N")
    assert axis_of("force / 3", None, table) == Axis("force / 3", as_given=True)
    assert axis_of("force", "pull [N]", table) == Axis("pull [N]", as_given=True)
