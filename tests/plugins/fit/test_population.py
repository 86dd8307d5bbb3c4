"""Populations: which curves count, their groups, their files, and how they come to harm."""

import csv
import json
import re
import weakref
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import pellicle as pl
from pellicle.batch import lock_files
from pellicle.errors import StorageError
from pellicle_fit import many
from pellicle_fit.estimation.coordinates import MODULUS
from pellicle_fit.estimation.intervals import Estimate
from pellicle_fit.files.measurement import Measurement
from pellicle_fit.files.sources import Source
from pellicle_fit.many import fit_sources
from pellicle_fit.population.fits import QUARTILES, summary
from pellicle_fit.population.judgement import (
    Names,
    Rule,
    group_of,
    judge,
    outliers,
)
from pellicle_fit.population.row import Row
from pellicle_fit.report import tables
from pellicle_fit.report.contact_sheet import sheets
from pellicle_fit.report.population import distributions
from pellicle_fit.sealed_json import read_sealed, write_sealed
from pellicle_fit.words.names import quote_estimate, unit_of
from pellicle_fit.words.population import sentences_of_population
from tests.command import Cli, call
from tests.plugins.fit.test_many import BEAD, HERTZ, OPTIONS, curve, save

FIXED = (*OPTIONS, "--fix", "tension=0")


CLOSED = (0.9, 1.1)
ENDS = (CLOSED, (None, 1.1), (0.9, None), (None, None), (0.3, 4.0))
"""Ends of intervals over the value: closed, open below, above and to both sides, wide."""
Ends = tuple[float | None, float | None]


def estimate(value: float, unit: str = "Pa", ends: Ends = CLOSED) -> dict[str, Any]:
    """Return JSON data of an estimate."""
    low, high = (None if end is None else end * value for end in ends)
    return {"value": value, "low": low, "high": high, "unit": unit, "held": False}


def row(
    name: str,
    modulus: float | None = 1e3,
    *,
    is_open: bool = False,
    group: str = "",
    **others: dict[str, Any],
) -> Row:
    """Return the row of a curve; without a modulus it could not be fitted."""
    if modulus is None:
        return Row(name, group, failure="no contact")
    curve = {"points": 50, "noise": {"value": 1e-9, "unit": "N"}, "failed_checks": [], "data": {}}
    ends = (0.9, None) if is_open else CLOSED
    parameters = {"reduced_modulus": estimate(modulus, ends=ends), **others}
    numbers = {"r_squared": 0.99, "chi_squared": 50.0, "indentation": 1e-6, "largest_force": 1e-8}
    model = {"effects": [], "words": "no effect"}
    fit = {"parameters": parameters, "curves": [curve], "messages": [], "model": model}
    told = {"verdict": "no sign", "headline": "no sign of tension", "calibration": "as exact"}
    found = Row(name, group)
    found.keep(numbers | fit | parameters | told)
    return found


@pytest.mark.parametrize(
    ("rule", "holds"),
    [
        ("r_squared > 0.95", True),
        ("r_squared>=0.995", False),
        ("reduced_modulus < 1.1 kPa", True),
        ("0.5 kPa < reduced_modulus < 900 Pa", False),
        ("900 < reduced_modulus", True),
        ("1e-3 MPa >= reduced_modulus_low", True),
        ("reduced_modulus_high < 1 MPa", False),
        ("reduced_modulus_high != 1 MPa", False),
        ("chi_squared / points < 1.5", True),
        ("2 * reduced_modulus - reduced_modulus_low < 1.2 kPa", True),
        ("abs(log10(r_squared)) < 1", True),
        ("tension / reduced_modulus < 10 um", False),
    ],
)
def test_rules(rule: str, holds: bool) -> None:
    """A rule compares numbers and quantities; no rule holds of an open end or a missing number."""
    objection = Rule(rule).objection(row("a", is_open=True))
    assert (not objection) == holds
    assert holds or objection.endswith(f"against {rule}")


def test_lists(tmp_path: Path) -> None:
    """Lists name curves by the end of their path or their label; typing errors show."""
    listed = tmp_path / "rejected.txt"
    listed.write_text("# a comment\na.csv, a bubble\nmap.h5:1\nold/b.csv\nzz.csv\n")
    rows = [row(n) for n in ("day/a.csv", "day/aa.csv", "map.h5:1", "map.h5:11", "x/old/b.csv")]
    notes = judge(rows, [], Names(listed))
    assert [r.accepted for r in rows] == [False, True, False, True, False]
    assert rows[0].reason == "in rejected.txt: a bubble"
    assert any("'zz.csv', which is none of the curves" in note for note in notes)
    with pytest.raises(StorageError, match="cannot be read as a list"):
        Names(tmp_path / "none.txt")


@pytest.mark.parametrize(
    ("pattern", "file", "group"),
    [
        ("{group}_*.csv", "day/control_01.csv", "control"),
        ("{group}_*.csv", "day\\drug_a_01.csv", "drug"),
        ("{group}/*", "data/day 1/a.csv", "day 1"),
        ("cell[1]{group}.csv", "cell[1]x.csv", "x"),
        ("{group}_*.csv", "day/control.csv", ""),
        ("{group}_{group}.csv", "a_b.csv", "a"),
        ("column", "any", "a/b"),
    ],
)
def test_groups(pattern: str, file: str, group: str) -> None:
    """A group is part of a file name, or the text of a column with whatever is in it."""
    assert group_of(pattern, file, "a/b") == group


def test_outliers_are_kept() -> None:
    """A modulus far from the median of its group is named, and counts all the same."""
    spread = np.exp(0.1 * np.random.default_rng(1).standard_normal(20))
    rows = [row(f"{k}", 1e3 * s, group="soft/1") for k, s in enumerate(spread)]
    rows += [row(f"s{k}", 1e5 * s, group="stiff") for k, s in enumerate(spread)]
    rows[3] = row("3", 1e5, group="soft/1")
    judge(rows, [], None)
    assert [r.name for r in rows if r.outlier] == ["3"]
    assert rows[3].accepted
    assert sentences_of_population(rows)[-2].endswith("counted: 3")
    parts = {part["group"]: part for part in summary(rows)}
    assert (parts["soft/1"]["n"], parts["soft/1"]["outliers"], parts["all"]["n"]) == (20, 1, 40)
    soft = [r.fit.estimates()["reduced_modulus"].value for r in rows[:20]]
    assert parts["soft/1"]["median"] == np.median(soft)
    assert parts["soft/1"]["upper_quartile"] == np.quantile(soft, 0.75)
    # Equal moduli have no deviation to compare with, and four have no majority.
    assert not outliers([row("a")] * 9 + [row("b", 2e3)])
    assert not outliers([row("a", v) for v in (1e3, 1.01e3, 0.99e3, 1e6)])


@settings(max_examples=100, deadline=None, derandomize=True)
@given(
    st.lists(
        st.tuples(
            st.floats(1e2, 1e5),
            st.sampled_from(ENDS),
            st.floats(1e-4, 1e-2),
            st.sampled_from((*ENDS, "none")),
            st.sampled_from(("soft", "stiff", "")),
            st.sampled_from(("accepted", "accepted", "rejected", "failed")),
        ),
        min_size=1,
        max_size=30,
    )
)
def test_statistics_are_of_all_accepted_curves(curves: list[tuple[Any, ...]]) -> None:
    """No end of an interval chooses curves: quartiles and histograms are those of all values.

    A curve without a tension, such as one that something else describes better, has one of 0.
    """
    rows, table = list[Row](), list[dict[str, Any]]()
    for k, (modulus, ends, tension, of_tension, group, state) in enumerate(curves):
        bare = of_tension == "none"
        skin = estimate(tension, "N/m", CLOSED if bare else of_tension)
        skin |= {"value": 0.0, "low": None, "high": None, "held": True} if bare else {}
        rows.append(row(f"{k}", None if state == "failed" else modulus, group=group, tension=skin))
        if state != "failed":
            rows[-1].fit.data["r_squared"] = 0.9 if state == "rejected" else 0.99
            rows[-1].fit.estimates()[MODULUS] = Estimate(**estimate(modulus, ends=ends))
        if state == "accepted":
            known = {MODULUS: modulus, "tension": skin["value"], "bare": bare}
            is_open = {MODULUS: ends != CLOSED, "tension": of_tension != CLOSED}
            table.append({"group": group or "no group", "values": known, "open": is_open})
    judge(rows, ["r_squared > 0.95"], None)
    has_skin = not all(line["values"]["bare"] for line in table)
    names = [MODULUS, *["tension"] * has_skin] if table else []
    groups = {line["group"] for line in table} if len({r.group for r in rows}) > 1 else set()
    parts = {(part["group"], part["parameter"]): part for part in summary(rows)}
    assert parts.keys() == set(product([*groups, *["all"] * bool(table)], names))
    for (group, name), part in parts.items():
        mine = [line for line in table if group in ("all", line["group"])]
        values = [line["values"][name] for line in mine]
        assert (part["n"], part["open"]) == (len(mine), sum(line["open"][name] for line in mine))
        quartiles = np.quantile(values, [0, 0.25, 0.5, 0.75, 1])
        assert [part[q] for q in QUARTILES] == pytest.approx(quartiles, rel=1e-12)
    for name, chart in zip(names, distributions(rows), strict=True):
        *stacks, median = chart.series
        assert median.x == pytest.approx([parts["all", name]["median"]] * 2)
        # A bin begins, and ends, with a step of the outline.
        assert stacks[0].y[1::2].sum() == len(table)


def test_of_explanations_that_share_no_value_the_chosen_one_counts() -> None:
    """Not quoted, so open, it obeys rules and counts; no sign of a tension is said once."""
    rows = [row(f"{k}", 1e3 + k, tension=estimate(1e-3, "N/m", (None, 2.0))) for k in range(3)]
    for one in rows:
        told = one.fit.data["parameters"][MODULUS] | {"value": None}
        own = {"if_present": {"tension": {}}, "common_errors": {MODULUS: {"radius": 0.0}}}
        one.keep(one.fit.data | own | {MODULUS: told})
        assert np.isnan(one.fit.values()[MODULUS])
    judge(rows, ["reduced_modulus > 1 kPa"], None)
    assert [one.accepted for one in rows] == [False, True, True]
    parts = {part["parameter"]: part for part in summary(rows)}
    assert parts[MODULUS]["median"] == 1001.5
    assert (parts[MODULUS]["open"], parts[MODULUS].get("common_error")) == (2, None)
    assert parts["tension"]["no_sign"] == parts["tension"]["n"] == 2
    (column,) = (c for c in tables.groups(rows).columns if c.words == "median")
    assert column.values[1] == "no sign"


def test_a_value_is_quoted_where_its_interval_determines_it() -> None:
    """A given one is told as such; a wide interval has its ends alone."""
    unit = unit_of([5e-3], "N/m")
    for (low, high), held, text in (
        ((4.8e-3, 5.2e-3), False, "5.00 (4.80 to 5.20)"),
        ((5e-3, 5e-3), True, "5 (fixed)"),
        ((2e-3, 9e-3), False, "2 to 9"),
        ((None, 9e-3), False, "< 9"),
        ((None, None), False, "not determined"),
    ):
        assert quote_estimate(Estimate(5e-3, low, high, "N/m", held), unit, 3) == text


def test_nothing_is_left() -> None:
    """That no curve is accepted is said; statistics and figures then have nothing to show."""
    rows = [row("a"), row("b", None)]
    notes = judge(rows, ["r_squared > 1"], None)
    assert notes == ["none of 2 curves was accepted"]
    assert rows[1].reason == "failed: no contact"
    assert summary(rows) == []
    assert len(sheets(rows)) == 1
    assert len(sheets(rows * 30)) == 3


def test_rows_of_many_curves_are_slim(tmp_path: Path) -> None:
    """Tables and figures lose nothing; what was compared stays in the file that a row names."""
    one = row("a", tension=estimate(1e-3, "N/m"))
    of_all = {"explanations": [{"words": f"effect {n}"} for n in range(1000)], "excused": []}
    one.keep(one.fit.data | of_all)
    one.kept = "curves/a.json"
    whole = one.fit
    one.pack()
    assert len(one._packed) < 1000
    assert one.fit.values() == whole.values()
    assert one.fit.data == {k: v for k, v in whole.data.items() if k not in of_all}
    path = write_sealed({"notes": ["{"]}, tmp_path / "fits.json", [one.to_dict()] * 3)
    assert len(json.loads(path.read_bytes())["curves"]) == 3
    assert path.read_text(encoding="ascii").count('\n{"curve": "a"') == 3
    again = read_sealed(path, Row.of_dict)
    assert [again.pop("notes"), *(one.to_dict() for one in again["curves"])] == [
        ["{"],
        *[one.to_dict()] * 3,
    ]
    path.write_bytes(path.read_bytes().replace(b'"a"', b'"b"', 1))
    with pytest.raises(StorageError, match="was changed since pellicle wrote it"):
        read_sealed(path, Row.of_dict)


def test_sources_know_how_many_there_are(tmp_path: Path) -> None:
    """Files that were not opened yet count as one curve each, so that the time left is told."""
    with h5py.File(tmp_path / "b.h5", "w") as file:
        for label in "xy":
            for name, values in zip(("position", "force"), curve(1), strict=True):
                file[f"{label}/{name}"] = values
                file[f"{label}/{name}"].attrs["units"] = "m" if name == "position" else "N"
    for name in "ac":
        save(tmp_path / f"{name}.csv", *curve(1))
    config = pl.FitConfig.merged(**BEAD, curves=[tmp_path])
    assert [source.total for source in config.sources()] == [3, 4, 4, 4]


@pytest.mark.slow
def test_files(cli: Cli, tmp_path: Path) -> None:
    """Tables, sheet, distributions and page have every curve, with its group and its judgement."""
    for name, seed, scale in (
        ("soft/$a_1", 1, 1),
        ("soft/$a_2", 2, 1),
        ("b_1", 3, 2),
        ("b_2", 4, 2),
    ):
        position, force = curve(seed)
        (tmp_path / "day" / name).parent.mkdir(parents=True, exist_ok=True)
        save(tmp_path / "day" / f"{name}.csv", position, scale * force)
    save(tmp_path / "day" / "c.csv", position, 0 * force)
    Path("bad.txt").write_text("b_2.csv, slipped\n")
    formats = "--format", "svg", "--format", "pdf"
    arguments = ("day/soft/*.csv", "day/*.csv", *FIXED, "-o", "out", "--quiet", *formats)
    rules = ("--set", "group_by={group}_*.csv", "--set", "rejected=bad.txt", "--report")
    result = cli(*arguments, *rules, "--set", "accept=reduced_modulus < 15 kPa", code=1)
    assert result.stdout == ""
    assert "1 fitted curve was rejected" in result.stderr
    with Path("out/fits.csv").open(encoding="utf-8", newline="") as file:
        table = {Path(line["curve"]).name: line for line in csv.DictReader(file)}
    assert [line["group"] for line in table.values()] == ["$a", "$a", "b", "b", ""]
    assert [line["accepted"] for line in table.values()] == ["True"] * 3 + ["False"] * 2
    assert table["b_2.csv"]["reason"] == "in bad.txt: slipped"
    assert "no contact" in table["c.csv"]["reason"]
    assert 0.99 < float(table["b_1.csv"]["r_squared"]) < 1
    assert float(table["b_1.csv"]["indentation [m]"]) == pytest.approx(3e-6, rel=0.1)
    with Path("out/fits-groups.csv").open(encoding="utf-8", newline="") as file:
        groups = [(line["group"], line["n"]) for line in csv.DictReader(file)]
    assert groups == [("$a", "2"), ("b", "1"), ("all", "3")]
    sheet = Path("out/fits-curves.pdf").read_bytes()
    assert sheet.startswith(b"%PDF")
    # Of the letters of a font of Type 3 beyond Latin-1, and of ligatures, no text can be copied.
    assert b"/Type3" not in sheet
    assert [Path(f"out/fits.{ending}").is_file() for ending in ("svg", "pdf", "png")] == [1, 1, 0]
    page = Path("out/fits.html").read_text(encoding="utf-8")
    for words in ("slipped", "quartiles", "Each curve with its fit"):
        assert words in page
    # The folder shows what was printed, and draws what was drawn.
    printed = cli(*arguments[:-5], *rules[:-1], "--set", "accept=reduced_modulus < 15 kPa", code=1)
    table_of = call("show", "out", code=1)
    assert table_of.stdout == printed.stdout.partition("4 of 5 fits")[0]
    assert table_of.stdout.count("\n") > 10
    call("plot", "out/fits.h5", "-o", "again", "--format", "svg")
    lines = (Path(folder, "fits.svg").read_text(encoding="utf-8") for folder in ("out", "again"))
    first, again = (re.findall(r' d="([^"]+)"', text) for text in lines)
    assert first == again != []
    assert Path("again/fits-curves.pdf").is_file()
    # Another choice costs no fit.
    notes = cli(*arguments, "--set", "accept=r_squared > 2", code=1).stderr
    assert "none of 5 curves was accepted" in notes
    content = json.loads(Path("out/fits.json").read_text(encoding="utf-8"))
    assert "r_squared is 0.99" in content["curves"][0]["reason"]
    assert content["configuration"]["accept"] == ["r_squared > 2"]
    assert len(list(Path("out/curves").glob("*.json"))) == 4


def test_group_by_column(tmp_path: Path) -> None:
    """A column of the table of files is a group, and may be a field of the indenter as well."""
    for radius in (5, 10):
        save(tmp_path / f"{radius}.csv", *curve(radius, radius=radius * 1e-6))
    listed = tmp_path / "list.csv"
    listed.write_text("file,radius [um],day\n5.csv,5,May/1\n10.csv,10,\n")
    common = {name: value for name, value in HERTZ.items() if name != "radius"}
    table = pl.fit_many(listed, group_by="Day", **common)
    assert table["group"].values.tolist() == ["May/1", ""]
    listed.write_text("file,radius [um]\n5.csv,5\n10.csv,10\n")
    table = pl.fit_many(listed, group_by="radius", **common)
    assert table["group"].values.tolist() == ["5 um", "10 um"]
    assert (table["status"] == "fitted").all()


@pytest.mark.slow
def test_curves_do_not_pile_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only a batch of curves is in memory at once, and the table is that of all at once."""
    curves: list[weakref.ref[NDArray[np.float64]]] = []
    most = 0

    def sources() -> Iterator[Source]:
        nonlocal most
        for seed in range(9):
            position, force = curve(seed)
            curves.append(weakref.ref(force))
            most = max(most, sum(force() is not None for force in curves))
            yield Source(str(seed), Measurement(position, force), {})
            del position, force

    config = pl.FitConfig.merged(**BEAD, rivals=(), fix={"tension": 0})
    whole = fit_sources(config, list(sources()), None, progress=False)
    assert most == 9
    monkeypatch.setattr(many, "_BATCH", 2)
    curves.clear()
    most = 0
    parts = fit_sources(config, sources(), None, progress=False)
    assert parts.to_dict() == whole.to_dict()
    assert all(row.sketch is not None for row in parts.rows)
    assert most <= 5


@pytest.mark.slow
def test_two_at_once(cli: Cli, tmp_path: Path) -> None:
    """A second process in the folder is refused in words, and nothing of the first is touched."""
    save(tmp_path / "day" / "a.csv", *curve(1))
    with lock_files(tmp_path / "out", "fits"):
        result = cli("day", *FIXED, "-o", "out", code=2)
    assert "is locked by another process" in result.stderr
    assert not Path("out/fits.csv").exists()
    # One curve alone is a population too.
    cli("day", *FIXED, "-o", "out")
    assert Path("out/fits-curves.pdf").is_file()
