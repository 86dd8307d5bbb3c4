"""What a notebook shows of runs, studies and results."""

from __future__ import annotations

import re
from html import unescape
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.config.picture import draw_indenter

TITLE = "<b>Bead</b> & tip"
RUN: dict[str, Any] = {
    "title": TITLE,
    "grid": {"points": [24, 18], "size": ["0.4 mm", "0.3 mm"]},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "0.1 N/m"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": ["5 um", "10 um"]},
}


@pytest.fixture(scope="module")
def result() -> pl.Result:
    """Return a small result."""
    return pl.run(RUN, progress=False)


def words(html: str) -> str:
    """Return the text of HTML without its folded part and pictures."""
    return re.sub(r"<[^>]*>", " ", html.partition("<details>")[0])


def test_a_result_shows_numbers_and_how_it_ended(result: pl.Result) -> None:
    """Texts are escaped, numbers have units, missing and failed steps are counted."""
    html = result._repr_html_()
    assert TITLE not in html
    assert "http" not in html.partition("<details>")[0]
    for part in (TITLE, "2 steps, all converged", "10 µm"):
        assert part in unescape(words(html))
    marked = result.dataset.copy(deep=True).isel(step=[0])
    marked["converged"][0] = False
    assert "1 of 2 steps, 1 did not converge" in words(pl.Result(marked)._repr_html_())


def test_a_plot_is_upright(result: pl.Result) -> None:
    """X runs to the right: a domain wider than high gives a picture wider than high."""
    axes = Figure().subplots()
    mesh = result.plot("gap", step=0, ax=axes)
    assert axes.get_xlabel().startswith("x")
    assert mesh.get_array().shape == (18, 24)
    assert axes.get_aspect() == 1.0
    # Words and engineering units, as in all figures.
    gap = result.dataset["gap"].isel(step=0).max().item()
    assert mesh.get_array().max() == pytest.approx(gap * 1e6)
    assert "[µm]" in mesh.colorbar.ax.get_ylabel()
    assert re.fullmatch(r"depth .* µm", axes.get_title())
    with pytest.raises(pl.ConfigError, match="not a field; give one of pressure"):
        result.plot("force", ax=axes)


@pytest.mark.parametrize("step", [2, -3])
def test_a_plot_of_a_missing_step_is_refused(result: pl.Result, step: int) -> None:
    """An index beyond the two load steps gives a message with the range, not an IndexError."""
    with pytest.raises(pl.ConfigError, match=rf"step: {step} is not the index of one of 2 load"):
        result.plot("gap", step=step)


def test_a_run_and_a_study_show_their_values() -> None:
    """Values stand with their unit and meaning; a study names what varies and counts its runs."""
    text = words(pl.Run(**RUN)._repr_html_())
    assert "paraboloid on tensed membrane" in text
    assert "surface tension" in text
    assert "tensed_membrane" not in text
    assert "100 mN/m" in text
    study = pl.Study(run=RUN, vary={"kernel.tension": ["1 mN/m", "2 mN/m", "3 mN/m"]})
    text = words(study._repr_html_())
    assert "3 runs" in text
    assert "surface tension" in text
    assert "kernel.tension" in text


def test_indenters_are_drawn_to_their_true_profile() -> None:
    """The height of a cone grows with the distance, on a grid of fewer cells than a large run's."""
    axes, cone = Figure().subplots(), {"type": "cone", "half_angle": "45 degree"}
    grid = {"points": [1025, 1], "size": "0.4 mm"}
    draw_indenter(axes, pl.Run(**{**RUN, "grid": grid, "indenter": cone}))
    x, height = (np.asarray(values) for values in axes.lines[0].get_data())
    assert x.size == 512
    assert axes.get_ylabel() == "indenter [µm]"
    assert height == pytest.approx(np.abs(x))
