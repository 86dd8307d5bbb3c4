"""The explorer shows what `pellicle run` computes of the file that it saves, to this user only."""

from __future__ import annotations

import asyncio
import http.client
import queue
import threading
import time
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import numpy as np
import psutil
import pytest
from bokeh.document import Document
from bokeh.models.widgets import TextInput

import pellicle as pl
from pellicle.errors import ConfigError
from pellicle.units import Quantity
from pellicle_explore import solving
from pellicle_explore.controls import change_control, configuration_of, controls
from pellicle_explore.page import Explorer
from pellicle_explore.server import serve
from pellicle_explore.solving import Frame, solve_frame

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

SCRIPT = "/static/js/bokeh.min.js"
MODELS = "const models = [...(window.Bokeh?.documents[0]?._all_models ?? new Map()).values()];"
FIELDS = """const fields = {}; for (const model of models) if (model.type === "TextInput") {
  fields[model.title] = model; }"""

SAVE = """const press = node => { for (const element of node.querySelectorAll("*")) {
  if (element.shadowRoot) press(element.shadowRoot);
  if (element.tagName === "BUTTON" && element.textContent.includes("Save")) element.click(); } };
press(document);"""


@pytest.fixture(scope="module")
def start() -> pl.Run:
    """Return the run that the explorer begins with, on few cells."""
    path = Path(str(files("pellicle_explore").joinpath("start.toml")))
    return pl.Run.from_toml(path, ["grid.points=24"])


@contextmanager
def serving(fill: Callable[[Document], None]) -> Iterator[str]:
    """Serve a page in another thread; yield its address."""
    started: queue.Queue[tuple[str, Callable[[], object]]] = queue.Queue()

    async def run() -> None:
        loop, task = asyncio.get_running_loop(), asyncio.current_task()
        assert task is not None

        def stop() -> None:
            loop.call_soon_threadsafe(task.cancel)

        await serve(fill, lambda address: started.put((address, stop)))

    def work() -> None:
        with suppress(asyncio.CancelledError):
            asyncio.run(run())

    thread = threading.Thread(target=work)
    thread.start()
    address, stop = started.get(timeout=20)
    try:
        yield address
    finally:
        stop()
        thread.join(20)
    assert not thread.is_alive()


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """Return the address of a page without content."""
    with serving(lambda target: None) as running:
        yield running


def test_every_quantity_of_the_run_has_a_control(start: pl.Run) -> None:
    """Moduli, lengths, the tension and the largest depth can be changed; the grid cannot."""
    assert [control.path for control in controls(start)] == [
        "kernel.tension",
        "kernel.substrate.youngs_modulus",
        "kernel.substrate.poissons_ratio",
        "kernel.substrate.thickness",
        "indenter.radius",
        "loading.depth",
    ]
    for control in controls(start):
        position = control.position(control.value)
        assert control.position(0.0) < position < control.position(np.inf)
        assert control.value_at(position) == pytest.approx(control.value)


@pytest.mark.filterwarnings("ignore:.*too coarse for this contact")
def test_what_is_shown_is_what_a_run_of_the_file_gives(start: pl.Run, tmp_path: Path) -> None:
    """After some changes, force and pressure are those of the saved file, to the last digit."""
    import tomli_w

    given: dict[str, Any] = configuration_of(start)
    for control, text in zip(
        controls(start), ("7.31 mN/m", "2.2 kPa", "0.31", "17 um", "11 um", "1.3 um"), strict=True
    ):
        given, _ = change_control(given, control, text)
    frame = solve_frame(given)
    path = tmp_path / "explored.toml"
    path.write_text(tomli_w.dumps(given), encoding="utf-8")
    data = pl.run(path, progress=False, threads=1).dataset
    for name in ("depth", "force", "pressure", "displacement", "gap", "contact_area"):
        np.testing.assert_array_equal(frame.steps[name], data[name])
    assert data["depth"].values[-1] == 1.3e-6
    np.testing.assert_allclose(np.diff(data["depth"]), 1.3e-6 / 4)


def test_the_cut_goes_through_the_deepest_point(start: pl.Run) -> None:
    """The indenter lies on the surface where they touch, and above it elsewhere."""
    page = Page(start)
    page.rest()
    cut: Any = page.explorer._plots._cut.data
    line: Any = page.explorer._plots._line.data
    pressure = solve_frame(configuration_of(start)).steps["pressure"].values[-1].max()
    assert line["pressure"].max() == pytest.approx(pressure / 1e3)
    beneath = np.isfinite(cut["indenter"])
    assert np.all(cut["indenter"][beneath] >= cut["surface"][beneath])
    assert cut["indenter"][beneath].min() == pytest.approx(-2, rel=0.04)


def test_curves_are_in_the_units_of_their_axes(start: pl.Run) -> None:
    """Numbers that are drawn, in the unit beside the axis, are those of the run in SI."""
    page, (steps, _, cut, line, _) = Page(start), solve_frame(configuration_of(start))
    page.rest()
    plots: Any = page.explorer._plots
    for plot, source, *drawn in (
        (plots.profile, plots._cut, ("x", cut["x"], "m"), ("surface", -cut["displacement"], "m")),
        (plots.pressure, plots._line, ("x", line["x"], "m"), ("pressure", line["pressure"], "Pa")),
        (plots.force, plots._path, ("depth", steps["depth"], "m"), ("force", steps["force"], "N")),
    ):
        for axis, (name, values, si) in zip((plot.xaxis[0], plot.yaxis[0]), drawn, strict=True):
            unit = axis.axis_label.partition("[")[2].removesuffix("]")
            drawn_in_si = source.data[name] * Quantity(si)(f"1 {unit}")
            np.testing.assert_allclose(drawn_in_si, values, rtol=1e-9)


def test_drawing_leaves_the_warnings_of_the_process_alone(
    start: pl.Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another thread may be solving, and records its warnings in what all threads share."""

    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("warnings are caught while a frame is drawn")

    frame, page = solve_frame(configuration_of(start)), Page(start)
    page.rest()
    with monkeypatch.context() as during:
        during.setattr("warnings.catch_warnings", refuse)
        page.explorer._show(configuration_of(start), frame)
    assert page.explorer._result.text == frame.summary()


def test_a_run_writes_nothing(start: pl.Run, tmp_path: Path, monkeypatch: Any) -> None:
    """Outputs that the file names stay in what is saved, but the server does not write them."""
    monkeypatch.chdir(tmp_path)
    page = Page(pl.Run(**{**configuration_of(start), "outputs": [{"type": "csv"}]}))
    page.rest()
    assert not page.errors
    assert page.saved["outputs"] == [{"type": "csv"}]
    assert not list(tmp_path.iterdir())


class Page:
    """The page of an explorer without a browser; its callbacks are called one by one."""

    def __init__(self, run: pl.Run) -> None:
        self.document = Document()
        self.explorer = Explorer(run, self.document)

    def rest(self) -> None:
        """Call what the page is to call until nothing is left to be solved or shown."""
        end = time.monotonic() + 60
        while self.explorer._solving._is_working:
            assert time.monotonic() < end
            time.sleep(0.002)
            for entry in self.document.session_callbacks:
                entry.callback()

    def type(self, title: str, text: str) -> None:
        """Type a text into the field of a quantity."""
        self.field(title).value = text

    def field(self, title: str) -> TextInput:
        """Return the field of a quantity."""
        field = self.document.select_one({"type": TextInput, "title": title})
        assert isinstance(field, TextInput)
        return field

    @property
    def forces(self) -> list[float]:
        """The forces that are drawn."""
        forces: Any = self.explorer._plots._path.data["force"]
        return [*forces]

    @property
    def errors(self) -> list[str]:
        """The errors that are shown, above the plots and beside fields."""
        beside = [row._refusal.text for row in self.explorer._rows.values()]
        return list(filter(None, [self.explorer._message.text, *beside]))

    @property
    def saved(self) -> dict[str, Any]:
        """The content of the file that is saved."""
        return tomllib.loads(self.explorer._file.text)


@pytest.mark.parametrize(
    ("error", "messages"),
    [
        (ZeroDivisionError("by <nothing>"), ("ZeroDivisionError: by <nothing>", "coated")),
        (
            ConfigError("is not possible", "kernel.substrate.thickness"),
            ("kernel.substrate.thickness: is not possible",),
        ),
    ],
)
def test_a_run_that_fails_leaves_the_page_alive(
    start: pl.Run,
    error: Exception,
    messages: tuple[str, ...],
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """Its error is shown, a plugin's is logged, the curves stay, and the next change is solved."""
    page = Page(start)
    page.type("surface tension", "6 mN/m")
    page.rest()
    before = page.forces
    assert not page.errors

    def fails(*_: object) -> None:
        raise error

    with monkeypatch.context() as broken:
        broken.setattr(type(start.kernel), "symbol", fails)
        page.type("thickness", "1 nm")
        page.rest()
    (message,) = page.errors
    assert all(words in message for words in messages)
    assert all(part.render_as_text for part in (page.explorer._message, page.explorer._remarks))
    assert page.explorer._message.visible
    assert ("a component failed" in caplog.text) != isinstance(error, ConfigError)
    assert page.saved["kernel"]["tension"] == "6 mN/m"
    assert page.forces == before
    page.type("thickness", "20 um")
    page.rest()
    assert not page.errors
    assert not page.explorer._message.visible
    assert page.saved["kernel"]["substrate"]["thickness"] == "20 um"
    assert page.forces != before


def test_a_text_that_is_not_a_value_stays_refused(start: pl.Run) -> None:
    """Its message stays while other quantities change, since the file keeps the value before."""
    page = Page(start)
    page.type("surface tension", "5 mN")
    page.type("thickness", "25 um")
    page.rest()
    (message,) = page.errors
    assert "N/m" in message
    assert page.saved["kernel"]["tension"] == configuration_of(start)["kernel"]["tension"]
    assert page.saved["kernel"]["substrate"]["thickness"] == "25 um"
    page.type("surface tension", "8 mN/m")
    page.rest()
    assert not page.errors


@pytest.mark.parametrize("is_closed", [False, True])
def test_a_long_solve_is_cancelled(
    start: pl.Run, monkeypatch: pytest.MonkeyPatch, is_closed: bool
) -> None:
    """It ends once another run waits, which is then solved, or when the page is closed."""
    began, ended = threading.Event(), threading.Event()

    def endless(configuration: Any, check: Callable[[], None]) -> Frame:
        began.set()
        try:
            while True:
                check()
                time.sleep(0.001)
        finally:
            ended.set()

    monkeypatch.setattr(solving, "_LONGEST_WAIT", 0.0)
    with monkeypatch.context() as slow:
        slow.setattr(solving, "solve_frame", endless)
        page = Page(start)
        assert began.wait(20)
    if is_closed:
        page.explorer._solving._close(None)
        ended.wait(20)
        time.sleep(0.05)
        assert not page.document.session_callbacks
    else:
        page.type("surface tension", "6 mN/m")
        page.rest()
        assert not page.errors
        assert page.saved["kernel"]["tension"] == "6 mN/m"


def test_a_load_of_nothing_is_refused(start: pl.Run) -> None:
    """Load steps keep their proportion, which 0 would take from them; a tiny one is solved."""
    page = Page(start)
    page.type("largest depth", "0 m")
    assert "above 0" in page.errors[0]
    page.type("largest depth", "1 nm")
    page.rest()
    assert max(page.forces) == 0


def test_slider_and_field_follow_each_other(start: pl.Run) -> None:
    """A slider sets four digits; what is typed stays as it is, and moves the slider."""
    page = Page(start)
    slider = page.explorer._rows["kernel.tension"]._slider
    slider.value = np.log10(5e-3) + 0.1
    assert page.field("surface tension").value == "6.295 mN/m"
    assert slider.value == np.log10(5e-3) + 0.1
    page.type("surface tension", "7.654321 mN/m")
    assert page.field("surface tension").value == "7.654321 mN/m"
    assert slider.value == pytest.approx(np.log10(7.654321e-3))
    page.type("surface tension", "7 N/m")
    assert slider.value == slider.end
    page.type("surface tension", "7 mN/m")
    page.rest()
    assert page.saved["kernel"]["tension"] == "7 mN/m"


def answer(address: str, path: str, **headers: str) -> http.client.HTTPResponse:
    """Return the response of the server at an address to a request."""
    connection = http.client.HTTPConnection(urlsplit(address).netloc, timeout=20)
    connection.request("GET", path, headers=headers)
    response = connection.getresponse()
    response.read()
    connection.close()
    return response


def test_nobody_enters_without_the_token_or_by_another_name(address: str) -> None:
    """Pages, scripts and the websocket are refused to whoever lacks the token or names the host."""
    parts = urlsplit(address)
    token = parts.path
    assert parts.hostname == "127.0.0.1"
    assert len(token) > 40
    wrong = token[:-1] + ("A" if token[-1] != "A" else "B")
    for path in ("", "/", "/ws", SCRIPT):
        for stranger in (path, f"/{path}", f"{wrong}{path}", f"/static{token}{path}", token[:-1]):
            assert answer(address, stranger or "/").status == 404, stranger
    for path in ("", "/", SCRIPT):
        assert answer(address, f"{token}{path}").status == 200, path
        for name in ("localhost", "example.org", "[::1]", "127.0.0.1.example.org"):
            host = f"{name}:{parts.port}"
            assert answer(address, f"{token}{path}", Host=host).status == 404, host


@pytest.mark.parametrize(
    "origin",
    [
        *("http://example.org", "null", "http://127.0.0.1", "http://localhost:{}"),
        "http://127.0.0.1.a.org:{}",
    ],
)
def test_pages_of_strangers_get_no_websocket(address: str, origin: str) -> None:
    """Even with the token: another port of this machine counts as the same site."""
    parts = urlsplit(address)
    handshake = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
        "Sec-WebSocket-Protocol": "bokeh, e30",
    }
    stranger = {**handshake, "Origin": origin.format(parts.port)}
    assert answer(address, f"{parts.path}/ws", **stranger).status == 403
    own = {**handshake, "Origin": f"http://{parts.netloc}"}
    assert answer(address, "/ws", **own).status == 404


@pytest.mark.parametrize(
    "path", ["/etc/passwd", "/static/../server/server.py", "/static/%2e%2e/server/server.py"]
)
def test_no_file_of_the_machine_is_served(address: str, path: str) -> None:
    """Below the token there are the scripts of bokeh alone."""
    assert answer(address, urlsplit(address).path + path).status in (403, 404)


def test_only_this_machine_reaches_it(address: str) -> None:
    """It listens on the loopback address alone."""
    (connection,) = (
        c
        for c in psutil.Process().net_connections("tcp")
        if c.status == "LISTEN" and c.laddr.port == urlsplit(address).port
    )
    assert connection.laddr.ip == "127.0.0.1"


@pytest.fixture
def explorer(start: pl.Run) -> Iterator[str]:
    """Return the address of a running explorer."""

    def fill(document: Document) -> None:
        Explorer(start, document)

    with serving(fill) as running:
        yield running


@pytest.mark.slow
def test_sliders_change_the_curves(
    explorer: str,
    browser: Chrome,
    start: pl.Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A drag brings the numbers of the changed run; a bad value is said beside its field.

    The file is saved where the browser saves, and nothing is written where the server runs. A page
    to which the browser goes back begins anew.
    """
    from selenium.webdriver.support.ui import WebDriverWait

    def wait_for(script: str) -> Any:
        return WebDriverWait(browser, 30).until(
            lambda _: browser.execute_script(f"{MODELS} {FIELDS} {script}")
        )

    work, downloads = tmp_path / "work", tmp_path / "downloads"
    work.mkdir()
    monkeypatch.chdir(work)
    behavior = {"behavior": "allow", "downloadPath": str(downloads)}
    browser.execute_cdp_cmd("Browser.setDownloadBehavior", behavior)
    force = "models.find(m => m.data?.force?.length === 4)?.data.force"
    browser.get(explorer)
    wait_for(f"return {force}")
    for share in (0.02, 0.05, 0.1):
        browser.execute_script(
            f"{MODELS} const slider = models.find(m => m.type === 'Slider');"
            f"slider.value = Math.log10(5e-3) + {share};"
        )
    value = wait_for(
        "return fields['surface tension'].value === '6.295 mN/m' && fields['surface tension'].value"
    )
    given, _ = change_control(configuration_of(start), next(controls(start)), value)
    expected = solve_frame(given).steps["force"].values
    text = 'models.find(m => m.type === "PreText").text'
    saved = wait_for(f"return {text}.includes('6.295 mN/m') && {text}")
    assert tomllib.loads(saved) == given
    browser.execute_script(SAVE)
    WebDriverWait(browser, 30).until(lambda _: (downloads / "explored.toml").exists())
    assert tomllib.loads((downloads / "explored.toml").read_text("utf-8")) == given
    assert not list(work.iterdir())
    drawn = wait_for(f"return Array.from({force})")
    np.testing.assert_allclose(np.array(drawn) / drawn[-1], expected / expected[-1], rtol=1e-12)
    browser.execute_script(f"{MODELS} {FIELDS} fields['surface tension'].value = '5 mN'")
    message = wait_for(
        "return models.find(m => m.type === 'Div' && m.visible && m.text.includes('5 mN'))?.text"
    )
    assert "N/m" in message
    entries: list[Any] = browser.get_log("browser")  # type: ignore[no-untyped-call]
    assert not [entry for entry in entries if entry["level"] == "SEVERE"]
    browser.execute_script("window.isOld = true")
    browser.get("about:blank")
    browser.back()
    wait_for(f"return !window.isOld && {force}")
    browser.execute_script(f"{MODELS} {FIELDS} fields['surface tension'].value = '7 mN/m'")
    wait_for(f"return {text}.includes('7 mN/m')")
