"""What fits show, and their record: bytes that are equal however it is started, the fit again."""

import csv
import hashlib
import json
import os
import re
from html import unescape
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from matplotlib import pyplot

import pellicle as pl
from pellicle_fit.population.fits import ManyFits
from pellicle_fit.population.judgement import judge
from pellicle_fit.record import Record
from pellicle_fit.report import tables
from pellicle_fit.report.contact_sheet import choose_curves, grid, sheets
from pellicle_fit.report.figures import charts, panels, save_figure
from pellicle_fit.report.likelihood_map import likelihood_map
from pellicle_fit.report.page import save_report
from pellicle_fit.report.paper_table import save_tables
from pellicle_fit.report.population import bars
from pellicle_fit.words.story import story, story_lines
from tests.command import Cli, call
from tests.pictures import drawn_width
from tests.plugins.fit.conftest import ends_of
from tests.plugins.fit.test_many import BEAD, MODULUS, RADIUS, curve
from tests.plugins.fit.test_population import estimate, row


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
    for words in (sentence, "Tension is needed", "an offset", "tension [mN/m]", "10 µm"):
        assert words in page
    assert page.count("data:image/svg+xml") == 2
    folded = re.findall(r'<details class="table">\s*<summary>(\w+)', page)
    assert folded == ["What", "The", "Correlations"]
    assert 'class="notice bad"' not in page
    assert sentence in unescape(single._repr_html_())
    monkeypatch.setitem(mpl.rcParams, "backend", "agg")
    assert len(single.plot().subfigs) == 2
    drawn, printed = save_figure(single, tmp_path / "fit", ("png", "pdf"))
    assert drawn.stat().st_size > 10_000
    assert printed.name == "fit.pdf"
    assert b"/Type3" not in printed.read_bytes()


@pytest.mark.slow
def test_json_holds_all_that_is_told(single: pl.Fit) -> None:
    """What a file keeps of a fit gives the sentences and tables of the fit."""
    kept = Record(json.loads(single.to_json()))
    assert story_lines(kept) == story_lines(single)
    for table in (tables.estimates, tables.explanations, tables.curves, tables.correlations):
        assert table(kept).records == table(single).records
    assert kept.estimates() == single.estimates()


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


def test_figure_of_both_passes() -> None:
    """It is over the indentation, with both passes told apart; without a tension it is alone."""
    depth = np.linspace(-1e-6, 3e-6, 100)
    bead: Any = pl.indenter("paraboloid", radius=RADIUS)
    force = MODULUS * bead.layer_force_curve(depth, 0.0, 8e-6, 0.5).force
    noise = 0.005 * force.max() * np.random.default_rng(1).standard_normal(200)
    position, force = np.append(depth, depth[::-1]) + 1e-6, np.append(force, force[::-1]) + noise
    options = BEAD | {"segment": "both", "poissons_ratio": 0.5, "rivals": ["layer"]}
    fit = pl.fit(position, force, **options)
    assert fit.answer.selected.types == {"layer"}
    ((chart,),) = charts(fit).values()
    data, *_, contact = chart.series
    np.testing.assert_allclose(data.x, position - fit.contact_point.value)
    assert [leg.direction for leg in data.legs] == ["approach", "retraction"]
    assert [one.legend for one in chart.series if one.legend] == [
        *("data", "tension", "fit: a thin layer", "contact point"),
    ]
    assert {*contact.x} == {0.0}


@pytest.mark.parametrize("stiffness", [None, 0.05])
def test_the_figure_subtracts_the_baseline(stiffness: float | None) -> None:
    """Force and indentation are those of the solid: an offset has bent no cantilever."""
    depth, force = curve(1)
    wrong = force + 0.3 * force.max()
    position = depth - 0.3 * force.max() / stiffness if stiffness else depth
    options: dict[str, Any] = {"baseline": "offset", "fix": {"tension": 0}, "rivals": ()}
    fit = pl.fit(position, wrong, **BEAD, **options, spring_constant=stiffness)
    ((chart,),) = charts(fit).values()
    data, fitted = chart.series[0], chart.series[1]
    before = depth < 0.7e-6
    assert abs(data.y[before].mean()) < 0.01 * force.max()
    assert abs(fitted.y[before]).max() < 1e-6 * force.max()
    np.testing.assert_allclose(np.ptp(data.x), np.ptp(depth), rtol=1e-9)
    assert abs(data.x - (depth - 1e-6)).max() < 0.3e-6
    assert chart.y[0].words == "force less its baseline"


def test_pages_are_filled() -> None:
    """A page has at most 4 frames across and 7 down, of which few are empty."""
    for count in range(1, 29):
        down, across = grid(count)
        assert across <= 4
        assert down <= 7
        assert 0.75 * down * across <= count <= down * across
    assert (grid(1), grid(2), grid(28)) == ((1, 1), (2, 1), (7, 4))
    assert [len(sheets([row("a")] * count)) for count in (28, 29, 57)] == [1, 2, 3]


def test_sheet_of_very_many_curves() -> None:
    """It shows some, those that are not accepted in half of the room, and says so."""
    rows = [row(str(n)) for n in range(300)]
    for number, one in enumerate(rows):
        one.accepted = number % 4 > 0
    assert choose_curves(rows, 11) == (rows, "")
    some, words = choose_curves(rows, 2)
    assert [int(one.name) for one in some] == sorted({int(one.name) for one in some})
    assert sum(not one.accepted for one in some) == len(some) / 2 == 28
    assert words.startswith("; 56 of 300 curves: 28 of 75 that are not accepted")
    few, _ = choose_curves(rows[:160:4] + rows[1:101:4], 2)
    assert sum(one.accepted for one in few) == 25
    (caption, *_) = (text for text in panels(ManyFits(rows)) if "page 1 of 6" in text)
    assert caption.startswith("Some curves with their fits, page 1 of 6; 168 of 300 curves")


def test_long_lists_of_curves_are_shown_on_demand(tmp_path: Path) -> None:
    """A page begins with what was found, not with hundreds of reasons or of curves."""
    for count in (30, 31):
        rows = [row("a"), *(row(f"b{n}", None) for n in range(count))]
        for number, one in enumerate(rows[1:]):
            one.failure = f"no contact: {number} nN"
        page = save_report(ManyFits(rows), tmp_path / "fits.html", "fits").read_text("utf-8")
        assert f"<p>{count} of {count + 1} curves could not be fitted:" in page
        assert f"b{count - 1}: failed: no contact: {count - 1} nN" in page
        folded = f"<summary>{count} of {count + 1} curves could not be fitted.</summary>"
        assert (folded in page) == (count == 31)
    assert not tables.rows([row("a")] * 200).folded
    assert tables.rows([row("a")] * 201).folded


def test_table_for_a_paper(tmp_path: Path) -> None:
    """It has kPa and mN/m in all three formats; a value that cannot be quoted has its interval."""
    none = estimate(0.0, "N/m") | {"low": None, "high": None, "held": True}
    rows = [
        row("a_1|%.csv", 2e3, tension=estimate(3e-3, "N/m")),
        row("b.csv", 2e6, is_open=True, tension=estimate(3e-6, "N/m", (None, 1.1))),
        row("c.csv", 2.5, tension=none),
        row("d\nd.csv", None),
    ]
    judge(rows, [], None)
    files = save_tables(rows, tmp_path / "t")
    assert [file.name for file in files] == ["t.csv", "t.md", "t.tex"]
    head, *lines = csv.reader(files[0].read_text(encoding="utf-8").splitlines())
    assert head == ["curve", "verdict", "E* [kPa]", "95 % interval [kPa]", "tension [mN/m]",
                    "95 % interval [mN/m]", "n"]  # fmt: skip
    assert lines == [
        ["a_1|%.csv", "no sign of tension", "2.00", "1.80 to 2.20", "3.00", "2.70 to 3.30", "50"],
        ["b.csv", "no sign of tension", "", "> 1800", "", "< 0.0033", "50"],
        ["c.csv", "no sign of tension", "0.00250", "0.00225 to 0.00275", "", "", "50"],
        ["d d.csv", "not accepted: failed: no contact", "", "", "", "", ""],
    ]
    marked, typeset = (file.read_text(encoding="utf-8") for file in files[1:])
    assert "| a_1\\|%.csv | no sign of tension | 2.00 | 1.80 to 2.20 |" in marked
    assert "a\\_1$|$\\%.csv & no sign of tension & 2.00 & 1.80 to 2.20 &" in typeset
    assert "& $<$ 0.0033 & 50" in typeset
    assert marked.count("\n") == len(rows) + 2


def test_bars_and_units() -> None:
    """Marks of rejected curves are hollow; one curve gives no other unit to the table."""
    rows = [row(f"{k}", modulus) for k, modulus in enumerate((1e3, 1.1e3, 1.2e3, 5e6))]
    judge(rows, ["reduced_modulus < 1 MPa"], None)
    (chart,) = bars(rows)
    marks = {one.look.filled: one.x.tolist() for one in chart.series if one.look.marker == 0}
    assert marks == {True: [1, 2, 3], False: [4]}
    heads = [column.read()[0] for column in tables.rows(rows).columns]
    assert heads[:3] == ["curve", "verdict", "reduced modulus [kPa]"]
    assert tables.groups(rows).columns[1].values[0] == "reduced modulus [kPa]"


def test_the_map_weighs_the_calibration_as_the_headline_does() -> None:
    """The edge of 95 % of the pair reaches beyond the ends of either alone."""
    fit = pl.fit(*curve(1), **BEAD, rivals=(), uncertainty={"spring_constant": "10 %"})
    _, edge, _ = charts(fit)[[*charts(fit)][-1]][0].series
    for found, along in ((fit.reduced_modulus, edge.x), (fit.tension, edge.y)):
        low, high = ends_of(found)
        assert low < 0.85 * found.value
        assert along.min() < low < high < along.max()


def test_likelihood_map(single: pl.Fit) -> None:
    """On its edges Δχ² is that of searches over the rest, to some per cent."""
    (tensed,) = (one for one in single.answer.explanations if one.types == {"tension"})
    objective = tensed.objective
    edges = zip(likelihood_map(tensed, 1.0).series, (2.30, 5.99), strict=False)
    names = [slot.name for slot in objective.slots]
    k = [names.index(name) for name in ("reduced_modulus", "tension")]
    for edge, level in edges:
        for point in range(0, 200, 25):
            at = np.array(tensed.minimum.at)
            pair = edge.x[point], edge.y[point]
            at[k] = [objective.slots[i].coordinate(v) for i, v in zip(k, pair, strict=True)]
            rise = objective.minimise(at, k).chi_squared - tensed.minimum.chi_squared
            assert rise == pytest.approx(level, rel=0.12)


TOML = """
curves = ["Bead 1 µ.csv"]
poissons_ratio = 0.5
baseline = "offset"
model = ["tension"]
rivals = ["power_law", ["offset", "slope"]]
uncertainty = { sensitivity = "5 %" }
spring_constant = "0.1 N/m"
sensitivity = "50 nm/V"
columns = "Z = extension um, D = deflection V"
[indenter]
type = "sphere"
radius = "5 um"
"""
FILE = Path("Bead 1 µ.csv")
OPTIONS = (
    *("--indenter", "sphere", "--radius", "5 um", "--poissons-ratio", "0.5"),
    *("--baseline", "offset", "--spring-constant", "0.1 N/m", "--sensitivity", "50 nm/V"),
    *("--model", "tension", "--rivals", "power_law", "--rivals", "offset,slope"),
    *("--uncertainty", "sensitivity=5 %"),
    *("--columns", "D = deflection V,Z=extension um"),
)
ARGUMENTS: dict[str, Any] = {
    "indenter": "sphere",
    "radius": "5 um",
    "poissons_ratio": 0.5,
    "baseline": "offset",
    "model": ["tension"],
    "rivals": ["power_law", ("offset", "slope")],
    "uncertainty": {"sensitivity": 0.05},
    "spring_constant": "0.1 N/m",
    "sensitivity": "50 nm/V",
    "columns": {"Z": "extension um", "D": "deflection V"},
}


def measure(path: Path, seed: int = 0, length: float = 5e-6) -> None:
    """Write extension [um] and deflection [V] of a bead on 2 kPa under 5 mN/m, s = 5 µm.

    Without tension no rival of one is fitted, which takes most of the time.
    """
    depth = np.linspace(-0.4e-6, 1.5e-6, 80)
    sphere = pl.indenter("sphere", radius=5e-6)
    force = 2e3 * sphere.force_curve(depth, length).force  # type: ignore[attr-defined]
    force += 0.005 * force.max() * np.random.default_rng(seed).standard_normal(depth.size)
    rows = np.column_stack([(depth + force / 0.1) * 1e6, force / 0.1 / 50e-9])
    np.savetxt(path, rows, delimiter=",", header="Z,D", comments="", fmt="%.12g")


def timeless(text: str) -> str:
    """Return JSON without date and wall time, every other byte as it is."""
    return re.sub(r',\n *"(date|wall_time)": [^,\n]*', "", text)


@pytest.mark.slow
def test_three_ways_give_the_same_bytes(cli: Cli) -> None:
    """Configuration, options and Python leave the same JSON but for date and wall time."""
    measure(FILE)
    Path("bead.toml").write_text(TOML, encoding="utf-8")
    printed = cli("bead.toml", "--json").stdout
    assert '"date": "' in printed
    assert '"wall_time": ' in printed
    text = timeless(printed)
    assert text == timeless(cli(str(FILE), *OPTIONS, "-o", "out", "--json").stdout)
    assert text == timeless(pl.fit(FILE, **ARGUMENTS).to_json())
    assert text == timeless(Path("out/Bead 1 µ-fit.json").read_text(encoding="ascii"))
    # Arrays have the same numbers; only their origin differs.
    (curve,) = pl.read_curves(
        FILE, **{k: ARGUMENTS[k] for k in ("columns", "sensitivity")}, spring_constant="0.1 N/m"
    ).values()
    options = {k: v for k, v in ARGUMENTS.items() if k not in ("columns", "sensitivity")}
    arrays, other = pl.fit(curve.position, curve.force, **options).to_dict(), json.loads(text)
    for found in (arrays, other):
        for key in ("date", "wall_time", "configuration"):
            found.pop(key, None)
        for key in ("data", "name"):
            del found["curves"][0][key]
    assert arrays == other


@pytest.mark.slow
def test_record(cli: Cli) -> None:
    """JSON has file, hash, columns, calibration, segment, baseline, versions and options."""
    measure(FILE)
    content = json.loads(cli(str(FILE), *OPTIONS, "--rivals", "none", "--json").stdout)
    assert content["curves"][0]["data"] == {
        "file": str(FILE),
        "curve": None,
        "sha256": hashlib.sha256(FILE.read_bytes()).hexdigest(),
        "columns": {"extension": "Z [um]", "deflection": "D [V]"},
        "sensitivity": 50e-9,
        "library": None,
        "spring_constant": 0.1,
        "segment": "approach",
        "baseline": "offset",
        "poissons_ratio": 0.5,
    }
    assert content["versions"]["pellicle"] == pl.__version__
    assert content["versions"]["numpy"] == np.__version__
    assert "scipy" in content["versions"]
    assert pl.FitConfig(**content["configuration"]) == pl.FitConfig.merged(curves=FILE, **ARGUMENTS)


@pytest.mark.slow
def test_record_of_many(cli: Cli) -> None:
    """The tables have the same of every curve, and the page has it too."""
    Path("beads").mkdir()
    for number in range(2):
        measure(Path(f"beads/{number}.csv"), number, length=0.0)
    options = [*OPTIONS, "--set", "rivals=[]"]
    cli("beads", *options, "-o", "out")
    with xr.open_dataset("out/fits.h5", engine="h5netcdf") as table:
        digests = [hashlib.sha256(Path(f"beads/{n}.csv").read_bytes()).hexdigest() for n in "01"]
        assert table["sha256"].values.tolist() == digests
        assert table["spring_constant"].values.tolist() == [0.1, 0.1]
        assert table["spring_constant"].attrs["units"] == "N/m"
        assert json.loads(table.attrs["configuration"])["indenter"]["radius"] == 5e-6
        assert f"pellicle {pl.__version__}" in table.attrs["versions"]
    with Path("out/fits.csv").open(encoding="utf-8", newline="") as file:
        row = next(csv.DictReader(file))
    assert row["file"] == os.path.join("beads", "0.csv")
    assert row["sensitivity [m/V]"] == "5e-08"
    assert row["columns"] == "extension = Z [um]; deflection = D [V]"
    configuration = json.loads(row["configuration"])
    assert configuration["baseline"] == "offset"
    # A list of all files in each row would grow as their number squared.
    assert "curves" not in configuration
    # Fits that are kept from an earlier call have the record of the files as they are now.
    Path("beads/0.csv").rename("beads/9.csv")
    cli("beads", *options, "-o", "out")
    rows = json.loads(Path("out/fits.json").read_text(encoding="utf-8"))["curves"]
    assert [row["curves"][0]["data"]["file"] for row in rows] == [
        str(Path("beads") / name) for name in ("1.csv", "9.csv")
    ]
    again = cli("out/fits.json", "--json").stdout
    assert [row["tension"] for row in json.loads(again)["curves"]] == [r["tension"] for r in rows]


@pytest.mark.slow
@pytest.mark.usefixtures("no_rivals")
def test_read_curves_and_draw_them(tmp_path: Path) -> None:
    """Curves are read by name, drawn, fitted; one that cannot be read is warned of."""
    measure(tmp_path / "a.csv")
    (tmp_path / "b.csv").write_text("position [um]\n1\n", encoding="utf-8")
    reading = {"columns": ARGUMENTS["columns"], "spring_constant": 0.1, "sensitivity": 50e-9}
    with pytest.warns(UserWarning, match=r"b\.csv: has 'position \[um\]'; missing"):
        curves = pl.read_curves(tmp_path, **reading)
    ((name, curve),) = curves.items()
    assert name == str(tmp_path / "a.csv")
    axes = curve.plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("position [µm]", "force [nN]")
    line = axes.get_lines()[0]
    assert line.get_ydata() == pytest.approx(curve.force * 1e9)
    figure = pl.fit(curve.position, curve.force, indenter="sphere", radius=5e-6).plot()
    figure.savefig(tmp_path / "fit.png")
    assert drawn_width(tmp_path / "fit.png") > 0.5
    pyplot.close("all")
    with pytest.raises(pl.ConfigError, match="missing: one column 'Z'"):
        pl.read_curves(tmp_path / "b.csv", **reading)


@pytest.mark.usefixtures("no_rivals")
@pytest.mark.parametrize(
    ("files", "name"), [([], f"{FILE.stem}-fit"), (["b.csv", "--pool"], "pool")]
)
def test_the_folder_of_one_fit_is_shown_and_drawn(cli: Cli, files: list[str], name: str) -> None:
    """It shows what was printed; a curve that has changed is not drawn as if it had not."""
    for file in ("b.csv", FILE):
        measure(Path(file))
    printed = cli(*files[:1], str(FILE), *files[1:], *OPTIONS, "-o", "out")
    told, _, written = printed.stdout.partition("wrote ")
    assert f"out/{name}.h5" in written

    assert call("show", "out").stdout == told
    assert " Pa (" in call("show", "out", "--si").stdout
    whole = Path(f"out/{name}.json").read_text(encoding="ascii")
    assert call("show", "out", "--json").stdout == whole
    call("plot", "out", "-o", "again", "--format", "svg")
    assert Path(f"again/{name}.svg").is_file()
    with FILE.open("a") as content:
        content.write("9,9\n")
    assert "has changed since it was fitted" in call("plot", "out", code=2).stderr
