"""How fast the explorer follows: from the move of a slider to the next painted picture.

Starts `pellicle explore` and opens it in a Chromium without a window. Each drag moves one slider
and waits until the new curve is painted. Prints the median and the largest time, and the processor
time of the server for each drag. With ``--against``, the folder of another checkout, drags of the
two alternate, so that the load of the machine falls on both.

    python tests/benchmarks/explore.py --drags 200
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import psutil

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

CHECKOUT = Path(__file__).parents[2]
DRAG = """
const [share, done] = arguments;
const models = [...Bokeh.documents[0]._all_models.values()];
const slider = models.find(m => m.type === "Slider");
const curve = models.find(m => m.type === "ColumnDataSource" && "force" in m.data);
const started = performance.now();
const drawn = () => requestAnimationFrame(() => setTimeout(() => {
  curve.properties.data.change.disconnect(drawn);
  done(performance.now() - started);
}, 0));
curve.properties.data.change.connect(drawn);
slider.value = share;
"""
READY = """
const models = [...(window.Bokeh?.documents[0]?._all_models ?? new Map()).values()];
const curve = models.find(m => m.type === "ColumnDataSource" && "force" in m.data);
return curve?.data.force.length > 1;
"""


@contextlib.contextmanager
def served(
    checkout: Path, *options: str, log: Path | None = None, folder: Path | None = None
) -> Iterator[tuple[psutil.Process, str]]:
    """Run the explorer of a checkout in a folder; yield its process and address.

    Its messages go to a file ``log``, if one is given.
    """
    paths = os.pathsep.join(str(checkout / name) for name in ("framework", "plugins"))
    command = [sys.executable, "-m", "pellicle", "explore", "--no-browser", *options]
    environment = {**os.environ, "PYTHONPATH": paths, "PYTHONUNBUFFERED": "1"}
    with (
        open(log or os.devnull, "w", encoding="utf-8") as messages,
        subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=messages if log else None,
            text=True,
            env=environment,
            cwd=folder,
        ) as process,
    ):
        try:
            assert process.stdout is not None
            yield psutil.Process(process.pid), process.stdout.readline().strip()
        finally:
            process.terminate()


def opened(address: str, folder: str) -> Chrome:
    """Return a browser that shows the explorer."""
    from selenium.webdriver import Chrome, ChromeOptions, ChromeService
    from selenium.webdriver.support.ui import WebDriverWait

    options = ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    for switch in ("headless", "no-sandbox", "disable-gpu", "window-size=1280,900"):
        options.add_argument(f"--{switch}")
    options.add_argument(f"--user-data-dir={folder}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = Chrome(options=options, service=ChromeService("/usr/bin/chromedriver"))
    browser.set_script_timeout(60)
    browser.get(address)
    WebDriverWait(browser, 60).until(lambda _: browser.execute_script(READY))
    time.sleep(1)
    return browser


def used(process: psutil.Process) -> float:
    """Return the processor time of a process [s]."""
    times = process.cpu_times()
    return float(times.user + times.system)


def main() -> None:
    """Print the times."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--drags", type=int, default=200)
    parser.add_argument("--against", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    checkouts = [CHECKOUT, *([given.against] if given.against else [])]
    draw = random.Random(given.seed)
    rows: list[list[tuple[float, float]]] = [[] for _ in checkouts]
    with contextlib.ExitStack() as stack:
        pages = []
        for checkout in checkouts:
            process, address = stack.enter_context(served(checkout))
            browser = opened(address, stack.enter_context(tempfile.TemporaryDirectory()))
            stack.callback(browser.quit)
            pages.append((process, browser))
        value = np.log10(5e-3)
        for _ in range(given.drags):
            value = min(max(value + draw.choice([-3, -2, -1, 1, 2, 3]) * 0.01, -3.2), -1.4)
            for row, (process, browser) in zip(rows, pages, strict=True):
                before = used(process)
                painted = browser.execute_async_script(DRAG, value)
                row.append((painted, 1e3 * (used(process) - before)))
    print(f"load {os.getloadavg()[0]:.1f}")
    for checkout, row in zip(checkouts, rows, strict=True):
        painted, cpu = np.array(row).T
        print(
            f"{checkout}: new curve {np.median(painted):.0f} ms (most {painted.max():.0f}); "
            f"server {np.median(cpu):.0f} ms of processor time a drag"
        )
    if given.against:
        shares = np.median(np.array(rows[0]) / np.array(rows[1]), axis=0)
        print("ratio: new curve {:.2f}, server {:.2f}".format(*shares))


if __name__ == "__main__":
    main()
