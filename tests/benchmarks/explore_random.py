"""Random use of the explorer by two visitors at once: errors, and the memory of the server.

Drags sliders, types values and nonsense, lets the contact stick and come off, shifts the measured
curve, saves, reloads, closes pages and opens others. Now and then it waits until the page is at
rest, and compares the force that is shown with that of `pellicle run` of the text that is saved.
Prints errors of the browser and of the server, the times until the page was at rest, and the memory
of the server each minute.

    python tests/benchmarks/explore_random.py --minutes 10 --seed 1
"""

from __future__ import annotations

import argparse
import contextlib
import random
import tempfile
import time
import tomllib
import warnings
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import explore
import numpy as np

import pellicle as pl

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

MODELS = "const all = [...(window.Bokeh?.documents[0]?._all_models ?? new Map()).values()];"
COUNT = MODELS + "return all.filter(m => m.type === arguments[0]).length"
SET = (
    MODELS
    + """
const model = all.filter(m => m.type === arguments[0])[arguments[1]];
if (model && !model.disabled) model[arguments[2]] = arguments[3] ?? model.start +
  arguments[4] * (model.end - model.start);
"""
)
SHOWN = (
    MODELS
    + """
const curves = all.filter(m => m.type === "ColumnDataSource" && "force" in m.data);
const path = curves.find(m => m.data.force.length < 40);
return [all.find(m => m.type === "PreText")?.text ?? "", Array.from(path?.data.force ?? [])];
"""
)
BUTTONS = """
const buttons = [];
const walk = node => {
  for (const element of node.querySelectorAll("*")) {
    if (element.shadowRoot) walk(element.shadowRoot);
    if (element.tagName === "BUTTON" && element.textContent.includes("Save")) buttons.push(element);
  }
};
walk(document);
return buttons;
"""
NONSENSE = (
    *("", "5", "-1 um", "nan", "inf", "1e400", "much", "5 mN", "<b>1</b>", "1 um; 2 um", "0 m"),
    *("1e-300 m", "1e300 Pa", "3 kPa", "7 mN/m", "0.6", "0.5", "0.4999", "20 um", "1 nm", "1 km"),
    *("2 um", "0.1 um", "${x}", "../../x", "'; --", "µµ", "1 mJ/m^2", "1 J/m^2", "\x00", "9" * 400),
)


class Visitor:
    """A page in a browser, used at random."""

    def __init__(self, address: str, folder: Path, draw: random.Random) -> None:
        self.address, self.folder, self.draw = address, folder, draw
        self.used: Counter[str] = Counter()
        self.problems: list[str] = []
        self.rests: list[float] = []
        self.compared = self.saved = 0
        self.browser: Chrome = explore.opened(address, str(folder / "profile"))
        self.browser.execute_cdp_cmd(
            "Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(folder)}
        )

    def act(self) -> None:
        """Do one thing."""
        actions = {
            self.drag: 40,
            self.type: 25,
            self.stick: 4,
            self.save: 4,
            self.rest: 6,
            self.reload: 1,
            self.reopen: 1,
        }
        action = self.draw.choices(list(actions), list(actions.values()))[0]
        self.used[action.__name__] += 1
        action()
        self._collect()

    def drag(self) -> None:
        """Move a slider over some positions, as fast as a mouse."""
        count = self.browser.execute_script(COUNT, "Slider")
        if not count:
            return
        index, share = self.draw.randrange(count), self.draw.random()
        for _ in range(self.draw.randrange(1, 15)):
            share = min(max(share + self.draw.gauss(0, 0.03), 0.0), 1.0)
            self.browser.execute_script(SET, "Slider", index, "value", None, share)
            time.sleep(self.draw.choice([0.0, 0.016, 0.05]))

    def type(self) -> None:
        """Type a value, or nonsense, into a field."""
        count = self.browser.execute_script(COUNT, "TextInput")
        if count:
            text = self.draw.choice(NONSENSE)
            index = self.draw.randrange(count)
            self.browser.execute_script(SET, "TextInput", index, "value", text, 0)

    def stick(self) -> None:
        """Let the contact stick, or not."""
        self.browser.execute_script(SET, "Checkbox", 0, "active", self.draw.random() < 0.5, 0)

    def save(self) -> None:
        """Press the button that saves the run file."""
        for button in self.browser.execute_script(BUTTONS):
            self.browser.execute_script("arguments[0].click()", button)
            self.saved += 1

    def reload(self) -> None:
        """Reload the page, in the middle of whatever it does."""
        self.browser.refresh()
        self._wait()

    def reopen(self) -> None:
        """Close the page and open another, later."""
        self.browser.get("about:blank")
        time.sleep(self.draw.random() * 3)
        self.browser.get(self.address)
        self._wait()

    def _wait(self) -> None:
        started = time.monotonic()
        while not self.browser.execute_script(explore.READY):
            if time.monotonic() - started > 60:
                self.problems.append("the page did not open in 60 s")
                return
            time.sleep(0.2)

    def rest(self) -> None:
        """Wait until nothing changes for 3 s, and compare what is shown with the run itself."""
        started = changed = time.monotonic()
        shown: Any = [None, None]
        while time.monotonic() - changed < 3:
            now = self.browser.execute_script(SHOWN)
            if now != shown:
                shown, changed = now, time.monotonic()
            if time.monotonic() - started > 90:
                self.problems.append(f"not at rest after 90 s:\n{shown[0]}")
                return
            time.sleep(0.1)
        self.rests.append(changed - started)
        text, force = shown
        if not text or not force:
            return
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            expected = (
                pl.run(tomllib.loads(text), progress=False, threads=1).dataset["force"].values
            )
        self.compared += 1
        scale, largest = np.abs(expected).max() or 1.0, np.abs(force).max() or 1.0
        if len(force) != len(expected) or not np.allclose(
            np.array(force) / largest, expected / scale, rtol=1e-13, atol=1e-15
        ):
            self.problems.append(f"shown {force}, but {expected.tolist()} is the run of\n{text}")

    def _collect(self) -> None:
        entries: list[Any] = self.browser.get_log("browser")  # type: ignore[no-untyped-call]
        self.problems += [entry["message"] for entry in entries if entry["level"] == "SEVERE"]


def main() -> None:
    """Use the explorer for some minutes and print what went wrong."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    draw = random.Random(given.seed)
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True)))
        curve, log = folder / "bead.csv", folder / "server.log"
        position = np.linspace(-1e-6, 2e-6, 300)
        force = 0.04e-3 * np.maximum(position, 0) ** 1.5 * 1e6**0.5
        rows = np.column_stack([position, force])
        np.savetxt(curve, rows, delimiter=",", header="position [m],force [N]", comments="")
        work = folder / "work"
        work.mkdir()
        process, address = stack.enter_context(
            explore.served(explore.CHECKOUT, f"--curve={curve}", log=log, folder=work)
        )
        visitors = []
        for number in range(2):
            own = folder / f"visitor{number}"
            own.mkdir()
            visitor = Visitor(address, own, random.Random(draw.random()))
            stack.callback(visitor.browser.quit)
            visitors.append(visitor)
        started, minute = time.monotonic(), 0
        while (now := time.monotonic() - started) < 60 * given.minutes:
            if now >= 60 * minute:
                rss, threads = process.memory_info().rss / 1e6, process.num_threads()
                print(f"minute {minute}: {rss:.0f} MB, {threads} threads", flush=True)
                minute += 1
            draw.choice(visitors).act()
        rss, threads = process.memory_info().rss / 1e6, process.num_threads()
        print(f"end: {rss:.0f} MB, {threads} threads, alive {process.is_running()}")
        for visitor in visitors:
            files = sorted(path.name for path in visitor.folder.glob("*.toml"))
            print(
                dict(visitor.used), f"compared {visitor.compared}, saved {visitor.saved}", files[:3]
            )
            if visitor.rests:
                print(
                    f"at rest after {np.median(visitor.rests):.1f} s, most {max(visitor.rests):.1f}"
                )
            print("problems:", visitor.problems)
        print("written by the server:", sorted(map(str, work.rglob("*"))))
        print("server log:", log.read_text() or "empty")


if __name__ == "__main__":
    main()
