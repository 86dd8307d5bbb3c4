"""What fits show: pages, figures, sentences and what a notebook displays."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

import pellicle as pl
from pellicle_fit.report.figures import panels, save_figure
from pellicle_fit.report.likelihood_map import _grid
from pellicle_fit.report.page import save_report
from pellicle_fit.words.story import story
from tests.plugins.fit.test_many import BEAD, MODULUS, curve


@pytest.fixture(scope="module")
def single() -> pl.Fit:
    """Return the fit of one curve with a tension, which meets an offset."""
    return pl.fit(*curve(1), **BEAD, rivals=["offset"], poissons_ratio=0.5)


@pytest.mark.slow
def test_page(single: pl.Fit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The page of a fit has its story, verdict, explanations and figures; so has a notebook."""
    sentence = story(single)[0]
    assert sentence.startswith("Young's modulus 3.7")
    sentence = sentence[1:]
    page = unescape(save_report(single, tmp_path / "fit.html", "bead").read_text(encoding="utf-8"))
    for words in (sentence, "Tension is needed", "an offset", "95 % of tension", "10 µm"):
        assert words in page
    assert page.count("data:image/svg+xml") == 2
    assert sentence in unescape(single._repr_html_())
    monkeypatch.setitem(mpl.rcParams, "backend", "agg")
    assert len(single.plot().subfigs) == 2
    assert save_figure(single, tmp_path / "fit.png").stat().st_size > 10_000


@pytest.mark.slow
def test_page_of_a_pool(tmp_path: Path) -> None:
    """The page of a pool says that curves of two gels do not agree; a Hertz fit has no map."""
    position, force = curve(1)
    curves = {"a": (position, force), "b": (position, 3 * force)}
    pool = pl.fit_pooled(curves, **BEAD, rivals=())
    page = save_report(pool, tmp_path / "pool.html", "gels").read_text(encoding="utf-8")
    assert re.search(r'notice bad">((?!</div>).)*do not agree', page, re.DOTALL)
    assert page.count("data:image/svg+xml") == 2
    hertz = pl.fit(position, force, **BEAD, rivals=(), fix={"tension": 0})
    assert len(panels(hertz)) == 1


def test_likelihood_map(single: pl.Fit) -> None:
    """Its Δχ² are those of searches over the rest, and rise around the best pair."""
    tensed = single.explained("tension")
    assert tensed is not None
    moduli, tensions, rises = _grid(tensed)
    assert moduli.min() < MODULUS < moduli.max()
    assert -1e-6 < rises.min() < 0.5
    objective, names = tensed.objective, [slot.name for slot in tensed.objective.slots]
    k = [names.index(name) for name in ("reduced_modulus", "tension")]
    for place in ((10, 4), (20, 15)):
        at = np.array(tensed.minimum.at)
        pair = moduli[place], tensions[place]
        at[k] = [objective.slots[i].coordinate(value) for i, value in zip(k, pair, strict=True)]
        rise = objective.minimise(at, k).chi_squared - tensed.minimum.chi_squared
        assert rises[place] == pytest.approx(rise, rel=0.02, abs=0.02)
