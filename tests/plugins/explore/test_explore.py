"""The explorer shows what `pellicle run` computes of the file that it saves, to this user only."""

from __future__ import annotations

import http.client
import threading
import time
import tomllib
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import numpy as np
import psutil
import pytest
from bokeh.document import Document
from bokeh.models.widgets.inputs import Checkbox, TextInput
from bokeh.models.widgets.sliders import Slider

import pellicle as pl
from pellicle.errors import ConfigError
from pellicle_explore import solving
from pellicle_explore.controls import controls
from pellicle_explore.documents import changed, document, letting_go, sticking
from pellicle_explore.frames import Frame, preview, solved
from pellicle_explore.measured import Measured
from pellicle_explore.page import Explorer
from pellicle_explore.server import Server

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
def serving(server: Server) -> Iterator[Server]:
    """Run a server in another thread."""
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        yield server
    finally:
        server.stop()
        thread.join(20)
    assert not thread.is_alive()


@pytest.fixture(scope="module")
def server(start: pl.Run) -> Iterator[Server]:
    """Return a running server of the explorer."""
    position = np.linspace(-1e-6, 2e-6, 50)
    measured = Measured(position, 0.04 * np.maximum(position, 0.0) ** 1.5 * 1e3)
    with serving(Server(lambda target: Explorer(start, measured, target).show())) as running:
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
        assert control.low < control.value < control.high
        assert control.quantity(control.text(control.value)) == pytest.approx(control.value)


def test_the_document_is_the_run(start: pl.Run) -> None:
    """What the explorer begins with computes the same as the run."""
    assert pl.Run(**document(start)).identity == start.identity


@pytest.mark.filterwarnings("ignore:.*too coarse for this contact")
def test_what_is_shown_is_what_a_run_of_the_file_gives(start: pl.Run, tmp_path: Path) -> None:
    """After some changes, force and pressure are those of the saved file, to the last digit."""
    import tomli_w

    given: dict[str, Any] = document(start)
    for control, text in zip(
        controls(start), ("7.31 mN/m", "2.2 kPa", "0.31", "17 um", "11 um", "1.3 um"), strict=True
    ):
        given, _ = changed(given, control, text)
    frame = solved(given)
    path = tmp_path / "explored.toml"
    path.write_text(tomli_w.dumps(given), encoding="utf-8")
    data = pl.run(path, progress=False, threads=1).dataset
    np.testing.assert_array_equal(frame.depth, data["depth"])
    np.testing.assert_array_equal(frame.force, data["force"])
    np.testing.assert_array_equal([state.pressure for state in frame.states], data["pressure"])
    assert frame.contact_area == data["contact_area"].values[-1]
    assert data["depth"].values[-1] == 1.3e-6
    np.testing.assert_allclose(np.diff(data["depth"]), 1.3e-6 / 4)
    assert any(np.array_equal(frame.pressure, cut) for cut in data["pressure"].values[-1].T)
    # The indenter lies on the surface where they touch, and above it elsewhere.
    beneath = np.isfinite(frame.indenter)
    assert np.all(frame.indenter[beneath] >= frame.surface[beneath])
    assert frame.indenter[beneath].min() == pytest.approx(-1.3e-6, rel=0.04)


def test_a_contact_that_sticks_is_pulled_off(start: pl.Run) -> None:
    """The path goes on above the surface, the force is negative there, and all can be undone."""
    given = document(start)
    stuck = sticking(given, "0.2 mJ/m^2")
    frame = solved(stuck)
    assert frame.force.min() < 0
    assert frame.step == 3
    assert [c.path for c in controls(pl.Run(**stuck))][-2:] == [
        "interaction.work_of_adhesion",
        "loading.depth",
    ]
    assert letting_go(stuck) == given
    assert preview(stuck, frame) is None


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("kernel.tension", "6 mN/m"),
        ("kernel.substrate.youngs_modulus", "30 kPa"),
        ("loading.depth", "2.1 um"),
        ("loading.depth", "0.2 um"),
        ("indenter.radius", "2.4 um"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*too coarse for this contact")
def test_a_preview_is_the_run_to_four_digits(start: pl.Run, path: str, text: str) -> None:
    """From the picture before, however far it is, also from a wider bead than there is now."""
    given = document(start)
    control = next(control for control in controls(start) if control.path == path)
    after, _ = changed(given, control, text)
    rough, exact = preview(after, solved(given)), solved(after)
    assert rough is not None
    assert rough.is_preview
    assert not exact.is_preview
    np.testing.assert_allclose(rough.force, exact.force, rtol=1e-4, atol=1e-4 * exact.force.max())
    np.testing.assert_allclose(rough.surface, exact.surface, atol=1e-3 * -exact.surface.min())
    np.testing.assert_allclose(rough.depth, exact.depth, rtol=1e-12)
    np.testing.assert_array_equal(rough.x, exact.x)


class Page:
    """The page of an explorer without a browser; its callbacks are called one by one."""

    def __init__(self, run: pl.Run) -> None:
        self.document = Document()
        self.explorer = Explorer(run, None, self.document)
        self.explorer.show()

    def step(self) -> None:
        """Wait for the run that is being solved, and call what is to be called then."""
        self.explorer._solving._thread.submit(lambda: None).result()
        for entry in self.document.session_callbacks:
            entry.callback()

    def rest(self) -> None:
        """Go on until nothing is left to be solved or shown."""
        self.step()
        while self.document.session_callbacks or self.explorer._solving._is_working:
            self.step()

    def type(self, title: str, text: str) -> None:
        """Type a text into the field of a quantity."""
        self.field(title).value = text

    def field(self, title: str) -> TextInput:
        """Return the field of a quantity."""
        field = self.document.select_one({"type": TextInput, "title": title})
        assert isinstance(field, TextInput)
        return field

    @property
    def frame(self) -> Frame:
        """What is shown."""
        assert self.explorer._solving.frame is not None
        return self.explorer._solving.frame

    @property
    def errors(self) -> list[str]:
        """The errors that are shown."""
        beside = [entry._error.text for entry in self.explorer._rows.values()]
        return list(filter(None, [self.explorer._message.text, *beside]))

    @property
    def saved(self) -> dict[str, Any]:
        """The content of the file that is saved."""
        return tomllib.loads(self.explorer._text.text)


def test_a_plugin_that_fails_leaves_the_page_alive(
    start: pl.Run, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Its error is shown and logged, the curves stay, and the next change is solved."""
    page = Page(start)
    page.rest()
    before = page.frame
    assert not page.errors

    def fails(*_: object) -> None:
        raise ZeroDivisionError("by <nothing>")

    with monkeypatch.context() as broken:
        broken.setattr(type(start.kernel), "compliance", fails)
        page.type("surface tension", "6 mN/m")
        page.rest()
    (message,) = page.errors
    assert "ZeroDivisionError: by &lt;nothing&gt;" in message
    assert "coated" in message
    assert "a component failed" in caplog.text
    assert page.frame is before
    page.type("surface tension", "7 mN/m")
    page.rest()
    assert not page.errors
    assert page.saved["kernel"]["tension"] == "7 mN/m"
    assert page.frame is not before


def test_a_text_that_is_not_a_value_stays_refused(start: pl.Run) -> None:
    """Its message stays while other quantities change, since the file keeps the value before."""
    page = Page(start)
    page.type("surface tension", "5 mN")
    page.type("thickness", "25 um")
    page.rest()
    (message,) = page.errors
    assert "N/m" in message
    assert page.saved["kernel"]["tension"] == document(start)["kernel"]["tension"]
    assert page.saved["kernel"]["substrate"]["thickness"] == "25 um"
    page.type("surface tension", "8 mN/m")
    page.rest()
    assert not page.errors


def test_an_impossible_change_leaves_the_run_before(
    start: pl.Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The picture of a drag that ends at an impossible run is finished: it is what is saved."""
    page = Page(start)
    page.rest()
    page.type("surface tension", "6 mN/m")
    page.step()
    assert page.frame.is_preview

    def refuses(*_: object) -> None:
        raise ConfigError("is not possible", "kernel.substrate.thickness")

    with monkeypatch.context() as impossible:
        impossible.setattr(type(start.kernel), "compliance", refuses)
        page.type("thickness", "1 nm")
        page.step()
    page.rest()
    assert page.errors == ["is not possible"]
    assert page.saved["kernel"]["tension"] == "6 mN/m"
    np.testing.assert_array_equal(page.frame.force, solved(page.saved).force)


@pytest.mark.parametrize("is_closed", [False, True])
def test_a_long_solve_is_abandoned(
    start: pl.Run, monkeypatch: pytest.MonkeyPatch, is_closed: bool
) -> None:
    """It ends once another run waits, which is then solved, or when the page is closed."""
    began = threading.Event()

    def endless(configuration: Any, check: Callable[[], None]) -> Frame:
        began.set()
        while True:
            check()
            time.sleep(0.001)

    monkeypatch.setattr(solving, "_LONGEST_WAIT", 0.0)
    with monkeypatch.context() as slow:
        slow.setattr(solving, "solved", endless)
        page = Page(start)
        assert began.wait(20)
    if is_closed:
        page.explorer._solving.close()
        page.explorer._solving._thread.shutdown(wait=True)
        assert not page.document.session_callbacks
    else:
        page.type("surface tension", "6 mN/m")
        page.rest()
        assert not page.errors
        assert page.saved["kernel"]["tension"] == "6 mN/m"


def test_two_pages_leave_the_warnings_in_order(start: pl.Run) -> None:
    """Runs of two pages that overlap do not restore the filters of each other."""
    before = list(warnings.filters)
    is_inside, is_done = threading.Event(), threading.Event()

    def enter_second() -> None:
        if other.ident is None:
            other.start()
            is_inside.wait(0.3)

    def stay_longer() -> None:
        is_inside.set()
        is_done.wait(0.3)

    other = threading.Thread(target=solved, args=(document(start), stay_longer))
    solved(document(start), enter_second)
    is_done.set()
    other.join(20)
    assert list(warnings.filters) == before


def test_a_load_of_nothing_is_refused(start: pl.Run) -> None:
    """Load steps keep their proportion, which 0 would take from them; a tiny one may stick."""
    page = Page(start)
    page.type("largest depth", "0 m")
    assert "above 0" in page.errors[0]
    page.type("largest depth", "1 nm")
    page.rest()
    assert page.frame.force.max() == 0
    switch = page.document.select_one({"type": Checkbox})
    assert isinstance(switch, Checkbox)
    switch.active = True
    page.rest()
    assert page.saved["interaction"]["work_of_adhesion"] == "1 mJ/m^2"


def test_rows_are_used_again(start: pl.Run) -> None:
    """Bokeh keeps every part that was on a page, so switches must not make new ones."""
    page = Page(start)
    page.rest()
    switch = page.document.select_one({"type": Checkbox})
    assert isinstance(switch, Checkbox)
    page.type("surface tension", "6.28318 mN/m")
    page.type("thickness", "5 Pa")
    rows = page.explorer._rows
    switch.active = True
    assert {"interaction.work_of_adhesion"} == page.explorer._rows.keys() - rows.keys()
    switch.active = False
    page.rest()
    assert page.explorer._rows == rows
    assert not page.errors
    assert page.saved["kernel"]["tension"] == "6.28318 mN/m"
    assert page.field("surface tension").value == "6.28318 mN/m"
    assert page.field("thickness").value == "30 µm"


def test_at_rest_the_picture_is_the_run_of_the_file(start: pl.Run) -> None:
    """A preview comes first, then the run itself; the slider follows what is typed."""
    page = Page(start)
    page.rest()
    frames: list[Frame] = []
    draw = page.explorer._plots.draw

    def record(frame: Frame, share: float) -> None:
        frames.append(frame)
        draw(frame, share)

    page.explorer._plots.draw = record  # type: ignore[method-assign]
    page.type("surface tension", "6 mN/m")
    page.rest()
    assert [frame.is_preview for frame in frames] == [True, False]
    np.testing.assert_array_equal(frames[1].force, solved(page.saved).force)
    sliders = [
        entry for entry in page.document.select({"type": Slider}) if isinstance(entry, Slider)
    ]
    assert np.log10(6e-3) in [pytest.approx(slider.value) for slider in sliders]


@pytest.mark.parametrize(
    ("text", "words"),
    [("5 mN", "N/m"), ("-1 mN/m", "≥ 0"), ("", "unit"), ("nan", "finite"), ("much", "number")],
)
def test_a_bad_value_names_its_control(start: pl.Run, text: str, words: str) -> None:
    """The error says what is allowed, at the path of the control."""
    tension = controls(start)[0]
    with pytest.raises(ConfigError, match=words) as caught:
        changed(document(start), tension, text)
    assert [problem.field for problem in caught.value.problems] == ["kernel.tension"]


def answer(server: Server, path: str, **headers: str) -> http.client.HTTPResponse:
    """Return the response of the server to a request."""
    connection = http.client.HTTPConnection(urlsplit(server.address).netloc, timeout=20)
    connection.request("GET", path, headers=headers)
    response = connection.getresponse()
    response.read()
    connection.close()
    return response


def test_nobody_enters_without_the_token_or_by_another_name(server: Server) -> None:
    """Pages, scripts and the websocket are refused to whoever lacks the token or names the host."""
    parts = urlsplit(server.address)
    entrance = f"/?{parts.query}"
    assert parts.hostname == "127.0.0.1"
    for path in ("/", "/ws", SCRIPT, "/?token=", f"/{parts.query}"):
        assert answer(server, path).status == 403, path
    wrong = parts.query[:-1] + ("A" if parts.query[-1] != "A" else "B")
    assert answer(server, f"/?{wrong}").status == 403
    for name in ("localhost", "example.org", "[::1]", "127.0.0.1.example.org"):
        assert answer(server, entrance, Host=f"{name}:{parts.port}").status == 403, name
    entered = answer(server, entrance)
    assert (entered.status, entered.getheader("Location")) == (302, "/")
    cookie = str(entered.getheader("Set-Cookie"))
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    known = cookie.partition(";")[0]
    for path in ("/", SCRIPT):
        assert answer(server, path, Cookie=known).status == 200
        assert answer(server, path, Cookie=known[:-1]).status == 403
        assert answer(server, path, Cookie=known, Host="example.org").status == 403
        assert answer(server, path, Cookie=known, Host="127.0.0.1").status == 403


def test_the_ticket_of_the_browser_serves_once() -> None:
    """It stands in the command that opens the browser, which other users of the machine can see."""
    with serving(Server(lambda target: None)) as server:
        parts = urlsplit(server.ticket_address)
        assert urlsplit(server.address).query.partition("=")[2] not in parts.query
        assert answer(server, "/?ticket=").status == 403
        entered = answer(server, f"/?{parts.query}")
        assert entered.status == 302
        known = str(entered.getheader("Set-Cookie")).partition(";")[0]
        assert answer(server, f"/?{parts.query}").status == 403
        assert answer(server, "/", Cookie=known).status == 200
        assert (
            answer(server, "/", Cookie=known.partition("=")[0] + "=" + parts.query[7:]).status
            == 403
        )


def test_browsers_do_not_keep_the_page(server: Server) -> None:
    """It has the secret of a session, which a page kept for the back button would hold open."""
    page = answer(server, "/", Cookie=cookie(server))
    assert page.getheader("Cache-Control") == "no-store"


def cookie(server: Server) -> str:
    """Return the cookie of a visitor with the token."""
    entered = answer(server, f"/?{urlsplit(server.address).query}")
    return str(entered.getheader("Set-Cookie")).partition(";")[0]


@pytest.mark.parametrize(
    "origin",
    [
        "http://example.org",
        "null",
        "http://127.0.0.1",
        "http://localhost:{}",
        "http://127.0.0.1.a.org:{}",
    ],
)
def test_pages_of_strangers_get_no_websocket(server: Server, origin: str) -> None:
    """Even with the cookie: another port of this machine counts as the same site."""
    address = urlsplit(server.address)
    handshake = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
        "Sec-WebSocket-Protocol": "bokeh, e30",
        "Cookie": cookie(server),
    }
    refused = answer(server, "/ws", **handshake, Origin=origin.format(address.port))
    assert refused.status == 403


@pytest.mark.parametrize(
    "path",
    [
        "/autoload.js?bokeh-autoload-element=a",
        "/metadata",
        "/etc/passwd",
        "/static/../server/server.py",
        "/static/%2e%2e/server/server.py",
        "/static//etc/passwd",
    ],
)
def test_nothing_else_is_served(server: Server, path: str) -> None:
    """No file of this machine, and no script by which a page of a stranger embeds this one."""
    assert answer(server, path, Cookie=cookie(server)).status == 403


def test_only_this_machine_reaches_it(server: Server) -> None:
    """It listens on the loopback address alone."""
    (connection,) = (
        c
        for c in psutil.Process().net_connections("tcp")
        if c.status == "LISTEN" and c.laddr.port == urlsplit(server.address).port
    )
    assert connection.laddr.ip == "127.0.0.1"


def test_a_port_that_is_taken_is_said(server: Server) -> None:
    """The message names the port, and what to give."""
    port = urlsplit(server.address).port
    with pytest.raises(ConfigError, match=f"port {port} .* give another, or 0"):
        Server(lambda target: None, port or 0)


def test_sliders_change_the_curves(
    server: Server,
    browser: Chrome,
    start: pl.Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A drag brings the numbers of the changed run; a bad value is said beside its field.

    The file is saved where the browser saves, and nothing is written where the server runs.
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
    force = 'models.find(m => m.type === "ColumnDataSource" && "force" in m.data).data.force'
    browser.get(server.address)
    wait_for(
        "const path = models.find(m => m.type === 'ColumnDataSource' && 'force' in m.data);"
        " return path?.data.force.length === 4"
    )
    assert urlsplit(browser.current_url).query == ""
    for share in (0.02, 0.05, 0.1):
        browser.execute_script(
            f"{MODELS} const slider = models.find(m => m.type === 'Slider');"
            f"slider.value = Math.log10(5e-3) + {share};"
        )
    value = wait_for(
        "return fields['surface tension'].value === '6.295 mN/m' && fields['surface tension'].value"
    )
    given, _ = changed(document(start), controls(start)[0], value)
    expected = solved(given).force
    text = 'models.find(m => m.type === "PreText").text'
    saved = wait_for(f"return {text}.includes('6.295 mN/m') && {text}")
    assert tomllib.loads(saved) == given
    browser.execute_script(SAVE)
    WebDriverWait(browser, 30).until(lambda _: (downloads / "explored.toml").exists())
    assert tomllib.loads((downloads / "explored.toml").read_text("utf-8")) == given
    assert not list(work.iterdir())
    drawn = wait_for(
        f"return !models.some(m => m.type === 'Div' && m.text.includes('≈')) && Array.from({force})"
    )
    np.testing.assert_allclose(np.array(drawn) / drawn[-1], expected / expected[-1], rtol=1e-12)
    browser.execute_script(f"{MODELS} {FIELDS} fields['surface tension'].value = '5 mN'")
    message = wait_for(
        "return models.find(m => m.type === 'Div' && m.visible && m.text.includes('5 mN'))?.text"
    )
    assert "N/m" in message
    entries: list[Any] = browser.get_log("browser")  # type: ignore[no-untyped-call]
    assert not [entry for entry in entries if entry["level"] == "SEVERE"]
