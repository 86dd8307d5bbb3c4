"""The explorer shows what `pellicle run` computes of the file that it saves, to this user only."""

from __future__ import annotations

import http.client
import threading
import tomllib
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import numpy as np
import pytest

import pellicle as pl
from pellicle.errors import ConfigError
from pellicle.explore.controls import changed, controls, document, letting_go, sticking
from pellicle.explore.frames import solved
from pellicle.explore.page import Explorer, Measured
from pellicle.explore.server import Server

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

MODELS = "const models = [...(window.Bokeh?.documents[0]?._all_models ?? new Map()).values()];"
FIELDS = """const fields = {}; for (const model of models) if (model.type === "TextInput") {
  fields[model.title] = model; }"""


@pytest.fixture(scope="module")
def start() -> pl.Run:
    """Return the run that the explorer begins with, on few cells."""
    path = Path(str(files("pellicle.explore").joinpath("start.toml")))
    return pl.Run.from_toml(path, ["grid.points=24"])


@pytest.fixture(scope="module")
def server(start: pl.Run) -> Iterator[Server]:
    """Return a server of the explorer that runs in another thread."""
    position = np.linspace(-1e-6, 2e-6, 50)
    measured = Measured(position, 0.04 * np.maximum(position, 0.0) ** 1.5 * 1e3)
    served = Server(lambda target: Explorer(start, measured, target).show())
    thread = threading.Thread(target=served.run)
    thread.start()
    yield served
    served.stop()
    thread.join(20)
    assert not thread.is_alive()


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
        given = changed(given, control, text)
    frame = solved(given)
    path = tmp_path / "explored.toml"
    path.write_text(tomli_w.dumps(given), encoding="utf-8")
    data = pl.run(path, progress=False, threads=1).dataset
    np.testing.assert_array_equal(frame.steps["force"], data["force"])
    np.testing.assert_array_equal(frame.steps["pressure"], data["pressure"])
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
    assert frame.steps["force"].min() < 0
    assert frame.step == 3
    assert [c.path for c in controls(pl.Run(**stuck))][-2:] == [
        "interaction.work_of_adhesion",
        "loading.depth",
    ]
    assert letting_go(stuck) == given


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
    return connection.getresponse()


def test_nobody_enters_without_the_token_or_by_another_name(server: Server) -> None:
    """Pages, scripts and the websocket are refused to whoever lacks the token or names the host."""
    parts = urlsplit(server.address)
    entrance = f"/?{parts.query}"
    assert parts.hostname == "127.0.0.1"
    for path in ("/", "/ws", "/static/js/bokeh.min.js", "/?token=", f"/{parts.query}"):
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
    assert answer(server, "/", Cookie=known).status == 200
    assert answer(server, "/", Cookie=known, Host="example.org").status == 403


def test_a_port_that_is_taken_is_said(server: Server) -> None:
    """The message names the port, and what to give."""
    port = urlsplit(server.address).port
    with pytest.raises(ConfigError, match=f"port {port} .* give another, or 0"):
        Server(lambda target: None, port or 0)


def test_sliders_change_the_curves(server: Server, browser: Chrome, start: pl.Run) -> None:
    """A drag brings the numbers of the changed run; a bad value is said beside its field."""
    from selenium.webdriver.support.ui import WebDriverWait

    def wait_for(script: str) -> Any:
        return WebDriverWait(browser, 30).until(
            lambda _: browser.execute_script(f"{MODELS} {FIELDS} {script}")
        )

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
    value = wait_for("return fields['tension'].value === '6.295 mN/m' && fields['tension'].value")
    given = changed(document(start), controls(start)[0], value)
    expected = solved(given).steps["force"].values
    text = 'models.find(m => m.type === "PreText").text'
    saved = wait_for(f"return {text}.includes('6.295 mN/m') && {text}")
    assert tomllib.loads(saved) == given
    drawn = wait_for(f"return Array.from({force})")
    np.testing.assert_allclose(np.array(drawn) / drawn[-1], expected / expected[-1], rtol=1e-12)
    browser.execute_script(f"{MODELS} {FIELDS} fields['tension'].value = '5 mN'")
    message = wait_for(
        "return models.find(m => m.type === 'Div' && m.visible && m.text.includes('5 mN'))?.text"
    )
    assert "N/m" in message
    entries: list[Any] = browser.get_log("browser")  # type: ignore[no-untyped-call]
    assert not [entry for entry in entries if entry["level"] == "SEVERE"]
