"""What a notebook shows of runs, studies and results."""

import re
from html import unescape

import pytest
import xarray as xr
from matplotlib.figure import Figure

import pellicle as pl
from tests import tables_of_runs

TITLE = "<b>Bead</b> & tip"
RUN = tables_of_runs.RUN | {
    "title": TITLE,
    "grid": {"points": [24, 18], "size": ["0.4 mm", "0.3 mm"]},
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
    """Texts are escaped; of many steps the first and the last are shown."""
    html = result._repr_html_()
    assert TITLE not in html
    assert "http" not in html.partition("<details>")[0]
    for part in (TITLE, "All 2 load steps converged.", "depth [µm]"):
        assert part in unescape(words(html))
    many = xr.concat([result.dataset.isel(step=[0])] * 20, "step")
    assert words(pl.Result(many)._repr_html_()).count("converged") == 1 + 12


def test_a_plot_is_upright(result: pl.Result) -> None:
    """X runs to the right: a domain wider than high gives a picture wider than high."""
    axes = Figure().subplots()
    mesh = result.plot("gap", step=1, ax=axes)
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
    for missing in (0, 3):
        with pytest.raises(
            pl.ConfigError, match=rf"step: {missing} is not the number of a load step"
        ):
            result.plot("gap", step=missing)


def test_a_run_and_a_study_show_their_values() -> None:
    """Values stand with their unit and meaning; a study names what varies and counts its runs."""
    study = pl.Study(run=RUN, vary={"kernel.tension": ["1 mN/m", "2 mN/m", "3 mN/m"]})
    for shown, texts in (
        (pl.Run(**RUN), ("paraboloid on tensed membrane", "surface tension", "1 N/m")),
        (study, ("3 runs", "surface tension", "kernel.tension")),
    ):
        assert all(text in words(shown._repr_html_()) for text in texts)
