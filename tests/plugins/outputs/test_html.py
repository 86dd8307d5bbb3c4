"""The page of a run and of a study: what it says is what was computed, and a browser shows it."""

from __future__ import annotations

import base64
import itertools
import json
import re
import shlex
import tomllib
import warnings
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import pellicle as pl
from pellicle.runs import solve as solving
from pellicle_plugins.outputs.step_figures import cross_section
from tests.plugins.outputs.shared import bead
from tests.tables_of_runs import interrupt, self_affine

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

TITLE = '<script>alert("no")</script> µm & 接触 $x_{'
RUN = bead(
    title=TITLE,
    grid={"points": [24, 18], "size": ["0.4 mm", "0.3 mm"]},
    kernel={"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "0.1 N/m"},
    corrections=[{"type": "yastrebov"}],
    outputs=[{"type": "html"}],
)
VARY = {"indenter.radius": ["0.5 mm", "1 mm"]}


class Page(HTMLParser):
    """The tables of a page by their captions, its tags, and the texts inside of each tag."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.texts: dict[str, list[str]] = {}
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self._open: list[str] = []
        self._rows: list[list[list[str]]] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self._open.append(tag)
        if tag == "summary":
            self._rows.append([])
        if tag in ("summary", "tr"):
            self._rows[-1].append([])
        if tag in ("summary", "th", "td"):
            self._rows[-1][-1].append("")
        self.texts.setdefault(tag, []).append("")

    def handle_endtag(self, tag: str) -> None:
        while self._open.pop() != tag:
            pass

    def handle_data(self, data: str) -> None:
        if {"summary", "th", "td"} & set(self._open):
            self._rows[-1][-1][-1] += data
        if self._open:
            self.texts[self._open[-1]][-1] += data

    def table(self, caption: str) -> list[dict[str, str]]:
        """Return the rows of the table whose caption begins so, by the heads of the columns."""
        (rows,) = (rows for rows in self._rows if rows[0][0].startswith(caption))
        return [dict(zip(rows[1], row, strict=True)) for row in rows[2:]]

    def script(self, key: str) -> dict[str, Any]:
        """Return the data of the script with a key: fields of maps, pictures that follow them."""
        scripts = [json.loads(text) for text in self.texts["script"] if text.startswith("{")]
        (data,) = (script for script in scripts if key in script)
        return dict(data)

    @property
    def frames(self) -> list[dict[str, Any]]:
        """The maps of each step or run."""
        return list(self.script("fields")["frames"])

    @property
    def words(self) -> str:
        """All that is shown."""
        return " ".join(t for name, ts in self.texts.items() if name != "script" for t in ts)


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, xr.Dataset]:
    """Return the page of a run, and its result."""
    folder = tmp_path_factory.mktemp("run")
    result = pl.run(RUN, directory=folder, progress=False, threads=1)
    (path,) = folder.glob("*.html")
    return path, result.dataset


@pytest.fixture(scope="module")
def studied(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, xr.Dataset]:
    """Return the page of a study, and its table."""
    folder = tmp_path_factory.mktemp("study")
    study = {**RUN, "study": {"vary": VARY}}
    table = pl.run_study(study, folder, progress=False, threads=1)
    return folder / "study.html", table


def test_inputs_and_provenance(ran: tuple[Path, xr.Dataset]) -> None:
    """Values with units, versions, the identity and where components come from."""
    path, data = ran
    page = Page(path)
    inputs = {(row["of"], row["input"]): row["value"] for row in page.table("All inputs")}
    assert inputs["loading", "depth"] == "5, 10 µm"
    facts = {row["what"]: row["value"] for row in page.table("Versions, date")}
    shortened = {"identity": f"{data.attrs['identity'][:8]}…"}
    assert facts == {name: data.attrs[name] for name in ("versions", "date")} | shortened
    origins = {row["used as"]: row for row in page.table("Origin of the")}
    assert origins["kernel"]["entry point"] == "kernel.tensed_membrane"
    assert origins["kernel"]["version"] == pl.__version__


def test_it_can_be_reproduced(ran: tuple[Path, xr.Dataset]) -> None:
    """The TOML on the page is the same run."""
    path, data = ran
    toml, command = Page(path).texts["code"]
    assert pl.Run(**tomllib.loads(toml)).identity == data.attrs["identity"]
    words = ["pellicle", "run", f"{path.stem}.toml", "-o", path.parent.name]
    assert shlex.split(command) == words


def test_maps_are_the_fields(ran: tuple[Path, xr.Dataset]) -> None:
    """Each step has its map; the ends of the values are those of the result."""
    path, data = ran
    page_maps = Page(path).script("fields")
    assert [f["label"] for f in page_maps["frames"]] == ["1: depth 5 µm", "2: depth 10 µm"]
    for index, frame in enumerate(page_maps["frames"]):
        assert frame["shape"] == [24, 18]
        assert frame["size"] == pytest.approx([400, 300])
        assert frame["fields"][0]["high"] == pytest.approx(data["pressure"].values[index].max())
        assert frame["fields"][1]["high"] == pytest.approx(data["gap"].values[index].max() * 1e6)
    assert [field["unit"] for field in page_maps["fields"]] == ["Pa", "µm"]


def test_the_answer_comes_first(ran: tuple[Path, xr.Dataset]) -> None:
    """It is a sentence with the numbers of the last step; the maps precede the tables."""
    path, data = ran
    page = Page(path)
    answers = [frame["note"] for frame in page.frames]
    assert answers[1] in page.texts["p"][:3]
    for index, answer in enumerate(answers):
        step = data.isel(step=index)
        match = re.fullmatch(
            r"At depth (\S+) µm: force (\S+) µN, contact radius (\S+) µm\.", answer
        )
        assert match, answer
        names = ("depth", "force", "contact_radius")
        for text, name in zip(match.groups(), names, strict=True):
            assert float(text) == pytest.approx(step[name].item() * 1e6, rel=5.1e-3)
    tags = [tag for tag, _ in page.tags]
    assert tags.index("canvas") < tags.index("table")


def test_marks_are_on_the_curves(ran: tuple[Path, xr.Dataset]) -> None:
    """Each mapped step is marked where its marker is drawn, in both curves over the steps."""
    tags = Page(ran[0]).tags
    pictures = [i for i, (tag, attrs) in enumerate(tags) if (attrs.get("src") or "")[:4] == "data"]
    marked = 0
    for begin, end in itertools.pairwise([*pictures, len(tags)]):
        marks = [attrs for tag, attrs in tags[begin:end] if "data-mark" in attrs]
        svg = base64.b64decode((tags[begin][1]["src"] or "").partition(",")[2]).decode()
        width, height = map(float, re.findall(r'viewBox="0 0 (\S+) (\S+)"', svg)[0])
        drawn = [(float(x), float(y)) for x, y in re.findall(r'<use [^>]*x="(\S+)" y="(\S+)"', svg)]
        for attrs in marks:
            left, top = map(float, re.findall(r"([\d.]+)%", attrs["style"] or ""))
            at = (left / 100 * width, top / 100 * height)
            assert min(np.hypot(x - at[0], y - at[1]) for x, y in drawn) < 1.0
        marked += len(marks) >= 2
        numbers = [attrs["data-mark"] for attrs in marks]
        assert numbers.count("0") == numbers.count("1")
    assert marked == 2


def test_the_profile_is_that_of_each_mapped_step(ran: tuple[Path, xr.Dataset]) -> None:
    """Each frame of the maps has the profile of its step; that of the last is shown first."""
    profiles = Page(ran[0]).script("pictures")
    captions = [profiles["pictures"][number]["caption"] for number in profiles["frames"]]
    assert [caption.partition(", at ")[2] for caption in captions] == [
        "depth 5 µm.",
        "depth 10 µm.",
    ]
    assert len({picture["source"] for picture in profiles["pictures"]}) == 2


def test_a_rough_contact_has_no_ellipse(tmp_path: Path) -> None:
    """Contact in several parts is told by its fraction of a periodic domain, not by a radius."""
    rough = self_affine("2 um", 0.8, "60 um", roll_off_wavelength="200 um")
    grid = {**RUN["grid"], "boundary": "periodic"}
    page = page_of(tmp_path, grid=grid, indenter=rough, loading={"mean_pressure": "5 Pa"})
    (shape,) = page.table("Shape of the contact")
    assert int(shape["patches"]) > 1
    assert not [head for head in shape if "axis" in head or "radius" in head]
    assert "At mean pressure 5 Pa: force" in page.words
    assert re.search(r"contact fraction 0\.\d+\.", page.frames[0]["note"])


def test_the_cross_section_is_to_scale() -> None:
    """The indenter lies on the surface in contact, and has its own shape above it."""
    run = {name: value for name, value in RUN.items() if name != "outputs"}
    step = pl.run(run, progress=False).dataset.isel(step=-1)
    indenter, surface = cross_section(step).series
    assert -float(step["depth"]) <= surface.y.min() < 0
    shown = np.isfinite(indenter.y)
    assert (indenter.y[shown] >= surface.y[shown] - 1e-12).all()
    y = float(step["y"][int(step["displacement"].max("x").argmax("y"))])
    shape = (indenter.x[shown] ** 2 + y**2) / (2 * 1e-3) - float(step["depth"])
    np.testing.assert_allclose(indenter.y[shown], shape, atol=1e-12)


def test_study(studied: tuple[Path, xr.Dataset]) -> None:
    """Each run has its row, a link to its map, and its numbers; the TOML is the same study."""
    path, table = studied
    page = Page(path)
    rows = page.table("The last load step of each run")
    assert len(rows) == 2
    flat = [table.isel(indenter_radius=index, step=-1) for index in range(2)]
    for row, run in zip(rows, flat, strict=True):
        assert run["run"].item().startswith(row["file"].removesuffix("…"))
        assert (row["steps"], row["status"]) == ("2/2", "converged")
    links = [attrs["data-frame"] for tag, attrs in page.tags if "data-frame" in attrs]
    assert links == ["0", "1"]
    assert page.frames[1]["label"] == "radius 1 mm"
    assert "runs converged" in page.words
    again = pl.Study.from_mapping(tomllib.loads(page.texts["code"][0]))
    assert [f"{p.run.identity[:8]}…" for p in again.points] == [row["file"] for row in rows]


def page_of(folder: Path, **changes: Any) -> Page:
    """Return the page of a run that differs from the one above."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pl.ConvergenceWarning)
        pl.run({**RUN, "title": "odd", **changes}, directory=folder, progress=False, threads=1)
    return Page(folder / "odd.html")


def test_steps_that_did_not_converge_are_marked(tmp_path: Path) -> None:
    """In words, each with its reason."""
    hasty = {"type": "conjugate_gradient", "max_iterations": 2, "tolerance": 1e-12}
    page = page_of(tmp_path, solver=hasty)
    assert "2 of 2 load steps did not converge" in page.words
    assert "Steps 1 and 2 did not converge: step 1: the surface" in page.words
    assert [row["status"] for row in page.table("Results of each")] == ["NOT CONVERGED"] * 2
    assert [frame["label"] for frame in page.frames][1].endswith("NOT CONVERGED")


class Lost(pl.Solver):
    """Returns no numbers; registered nowhere."""

    type: str = "lost"

    def solve(self, problem: pl.Problem, start: Any, monitor: Any) -> pl.Solution:
        return pl.Solution(pl.State.of_pressure(np.full(problem.grid.shape, np.nan)), 1)


def test_values_that_are_not_numbers(tmp_path: Path) -> None:
    """NaN is said, and leaves the map empty; a component that nobody knows is listed too."""
    with np.errstate(all="ignore"):
        page = page_of(tmp_path, solver=Lost())
    assert "the pressure became NaN" in page.words
    (force,) = (v for k, v in page.table("Results of each")[0].items() if k.startswith("force"))
    assert force == "–"
    assert "nan" not in page.words.split()
    inputs = {(row["of"], row["input"]): row["value"] for row in page.table("All inputs")}
    assert inputs["solver", "type"] == "lost"


def test_interrupted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The page of the steps that are there says that they are not all."""
    interrupt(monkeypatch)
    with pytest.raises(KeyboardInterrupt):
        page_of(tmp_path)
    page = Page(tmp_path / "odd.html")
    assert "The run ended early: 1 of 2 load steps are finished." in page.words
    assert len(page.table("Results of each")) == 1


def test_what_is_left_out_or_coarser_is_said(tmp_path: Path) -> None:
    """Fewer maps than steps, and pixels that are not the cells."""
    loading = {"depth": {"start": "2 um", "stop": "10 um", "num": 5}}
    outputs = [{"type": "html", "points": 8, "frames": 2}]
    page = page_of(tmp_path, loading=loading, outputs=outputs)
    assert [frame["label"][0] for frame in page.frames] == ["3", "5"]
    assert "in 2 of 5 load steps, each in colours over its own range." in page.words
    assert "Each pixel is the mean over 3 × 3 cells." in page.words
    assert len(page.table("Results of each")) == 5


def test_study_with_failures(tmp_path: Path) -> None:
    """A run that does not converge is named with its reason, and keeps its row and map."""
    hasty = {"type": "conjugate_gradient", "max_iterations": 2, "tolerance": 1e-12}
    study = {**RUN, "solver": hasty, "study": {"vary": {"solver.max_iterations": [2, 1000]}}}
    with pytest.warns(pl.ConvergenceWarning):
        pl.run_study(study, tmp_path, progress=False, threads=1)
    page = Page(tmp_path / "study.html")
    assert "Of 2 runs 1 did not converge" in page.words
    assert re.search(r"iteration limit 2 \(file \w{8}…\): the surface", page.words)
    statuses = [row["status"] for row in page.table("The last load step")]
    assert statuses == ["NOT CONVERGED", "converged"]


def test_study_without_a_finished_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, recwarn: pytest.WarningsRecorder
) -> None:
    """The page has the reason, and no output draws anything or complains."""

    def fails(*_: Any) -> Any:
        raise ValueError("the disk is on fire")

    monkeypatch.setattr(solving, "solve_step", fails)
    outputs = [{"type": name} for name in ("html", "figures", "curves", "profiles", "maps")]
    study = {**RUN, "outputs": outputs, "study": {"vary": {"indenter.radius": ["1 mm", "2 mm"]}}}
    pl.run_study(study, tmp_path, progress=False, threads=1)
    assert [str(warning.message) for warning in recwarn] == ["of 2 runs 2 failed; see status"]
    written = sorted(path.name for path in tmp_path.glob("study*"))
    assert written == ["study.csv", "study.h5", "study.html"]
    assert "the disk is on fire" in Page(tmp_path / "study.html").words


def show(browser: Chrome, path: Path) -> None:
    """Open a page and wait for its maps."""
    browser.get("about:blank")
    # What other pages said is not of this one.
    browser.get_log("browser")  # type: ignore[no-untyped-call]
    browser.get(path.as_uri())
    drawn(browser)


def drawn(browser: Chrome) -> list[int]:
    """Return how many colours each map has inside its axes, once it is drawn."""
    return browser.execute_async_script(  # type: ignore[no-any-return]
        """
        const done = arguments[0], begun = Date.now();
        const look = (canvas) => {
          const { width, height } = canvas;
          const data = canvas.getContext("2d").getImageData(80, 40, width - 180, height - 90).data;
          const colours = new Set(new Uint32Array(data.buffer));
          return colours.size;
        };
        const wait = () => {
          const canvases = [...document.querySelectorAll("canvas")];
          const counts = canvases.map(look);
          if (Math.min(...counts) > 2 || Date.now() - begun > 15000) done(counts);
          else setTimeout(wait, 20);
        };
        wait();
        """
    )


def picture(browser: Chrome, number: int = 0) -> str:
    """Return a canvas as it is drawn now."""
    text: str = browser.execute_script(
        f"return document.querySelectorAll('canvas')[{number}].toDataURL()"
    )
    return text


def saved(browser: Chrome, ending: str, number: int = 0) -> list[int]:
    """Return the bytes of the file that a click on the button of a map saves."""
    content: list[int] = browser.execute_async_script(
        """
        const [ending, number, done] = arguments, address = URL.createObjectURL;
        URL.createObjectURL = (blob) => {
          URL.createObjectURL = address;
          blob.arrayBuffer().then((buffer) => done([...new Uint8Array(buffer)]));
          return "#";
        };
        document.querySelectorAll(`[data-save=${ending}]`)[number].click();
        """,
        ending,
        number,
    )
    return content


def test_browser_prints_no_empty_page(browser: Chrome, ran: tuple[Path, xr.Dataset]) -> None:
    """Each page has words on it, and the maps on the screen are as before."""
    show(browser, ran[0])
    before = [picture(browser, number) for number in range(2)]
    pdf = base64.b64decode(browser.print_page())
    pages = re.findall(rb"/Type /Page\n(.*?)endobj", pdf, re.DOTALL)
    assert len(pages) > 2
    assert all(b"/Font" in page for page in pages)
    assert [picture(browser, number) for number in range(2)] == before


def shown_marks(browser: Chrome) -> set[str]:
    """Return the steps whose marks are seen on the curves."""
    marks: list[str] = browser.execute_script(
        "return [...document.querySelectorAll('[data-mark]')]"
        ".filter((mark) => mark.offsetParent).map((mark) => mark.dataset.mark)"
    )
    return set(marks)


def errors(browser: Chrome) -> list[Any]:
    """Return what the console says, but for what it says of the looking in `drawn`."""
    entries: list[Any] = browser.get_log("browser")  # type: ignore[no-untyped-call]
    return [entry for entry in entries if "readback operations" not in entry["message"]]


def test_browser_shows_a_run(browser: Chrome, ran: tuple[Path, xr.Dataset]) -> None:
    """Maps are drawn; wheel, keys, mouse and steps change them; the values are the result's."""
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.wait import WebDriverWait

    path, data = ran
    show(browser, path)
    assert browser.title == TITLE
    assert min(drawn(browser)) > 10
    canvas, other = browser.find_elements(By.CSS_SELECTOR, "canvas")
    readout = browser.find_element(By.CSS_SELECTOR, "output")
    whole = [picture(browser, number) for number in range(2)]

    origin = ScrollOrigin.from_element(canvas)
    ActionChains(browser, duration=0).scroll_from_origin(origin, 0, -300).perform()
    ActionChains(browser, duration=0).move_to_element(canvas).perform()
    match = re.fullmatch(
        r"x = (\S+) µm, y = (\S+) µm: contact pressure (\S+) Pa, gap (\S+) µm", readout.text
    )
    assert match, readout.text
    x, y, pressure, gap = (float(text.replace("−", "-")) for text in match.groups())
    here = data.isel(step=1).sel(x=x * 1e-6, y=y * 1e-6, method="nearest")
    assert pressure == pytest.approx(here["pressure"].item(), rel=1e-3, abs=0.02)
    assert gap == pytest.approx(here["gap"].item() * 1e6, abs=2e-3)
    zoomed = [picture(browser, number) for number in range(2)]
    assert zoomed[0] != whole[0]
    assert zoomed[1] != whole[1]

    ActionChains(browser, duration=0).double_click(canvas).move_to_element(readout).perform()
    assert [picture(browser, number) for number in range(2)] == whole

    other.send_keys("+", Keys.ARROW_LEFT)
    assert picture(browser) != whole[0]
    assert "contact pressure" in readout.text
    other.send_keys("0")
    assert saved(browser, "png")[:4] == [0x89, 0x50, 0x4E, 0x47]
    table = pd.read_csv(BytesIO(bytes(saved(browser, "csv"))))
    assert list(table) == ["x [m]", "y [m]", "contact pressure [Pa]"]
    expected = data["pressure"].isel(step=1)
    pressure_range = expected.max().item()
    values = table["contact pressure [Pa]"].to_numpy().reshape(expected.shape)
    np.testing.assert_allclose(values, expected, atol=2e-5 * pressure_range)
    for axis in "xy":
        np.testing.assert_allclose(
            np.unique(table[f"{axis} [m]"]), expected[axis], rtol=1e-5, atol=1e-12
        )
    # The page shows gaps in µm.
    gaps, expected = pd.read_csv(BytesIO(bytes(saved(browser, "csv", 1)))), data["gap"].isel(step=1)
    values = gaps["gap [m]"].to_numpy().reshape(expected.shape)
    np.testing.assert_allclose(values, expected, atol=2e-5 * expected.max().item())
    select = browser.find_element(By.CSS_SELECTOR, "select")
    assert select.text.splitlines() == ["1: depth 5 µm", "2: depth 10 µm"]
    before = picture(browser)
    assert shown_marks(browser) == {"1"}
    select.send_keys(Keys.ARROW_UP)
    WebDriverWait(browser, 20).until(lambda _: picture(browser) != before)
    assert shown_marks(browser) == {"0"}
    assert browser.find_element(By.CSS_SELECTOR, ".note").text.startswith("At depth 5 µm: force")
    profile = browser.find_element(By.CSS_SELECTOR, "figure.follows")
    assert profile.text == "Pressure and gap along x, at depth 5 µm."
    of_first = profile.find_element(By.CSS_SELECTOR, "img").get_attribute("src")
    select.send_keys(Keys.ARROW_DOWN)
    WebDriverWait(browser, 20).until(lambda _: profile.text.endswith("at depth 10 µm."))
    assert profile.find_element(By.CSS_SELECTOR, "img").get_attribute("src") != of_first
    browser.find_element(By.CSS_SELECTOR, "input").click()
    assert errors(browser) == []


def test_browser_shows_a_study(browser: Chrome, studied: tuple[Path, xr.Dataset]) -> None:
    """A click on a run shows its map, one on a head sorts the table."""
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.wait import WebDriverWait

    path, table = studied
    show(browser, path)
    before = picture(browser)
    browser.find_element(By.CSS_SELECTOR, "a[data-frame='1']").click()
    WebDriverWait(browser, 20).until(lambda _: picture(browser) != before)
    select = browser.find_element(By.CSS_SELECTOR, "select")
    assert select.get_attribute("value") == "1"
    force = next(
        button
        for button in browser.find_elements(By.CSS_SELECTOR, "th button")
        if button.text.startswith("force")
    )
    last = table["force"].isel(step=-1).values.ravel()
    names = np.array(["1", "2"])
    for order in (np.argsort(last), np.argsort(-last)):
        browser.execute_script("arguments[0].click()", force)
        links = browser.find_elements(By.CSS_SELECTOR, "tbody a")
        assert [link.text for link in links] == list(names[order])
    assert errors(browser) == []
