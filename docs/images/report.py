"""Draws ``report.png``: the page that the output ``html`` leaves, in Chromium.

Run it as ``python docs/images/report.py``; it needs chromium and chromium-driver.
"""

from __future__ import annotations

import shutil
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image
from selenium.webdriver import Chrome, ChromeOptions, ChromeService

import pellicle as pl

HERE = Path(__file__).parent
RUN = {
    "title": "Rough surface on a tensed skin",
    "grid": {"points": 256, "size": "1 mm", "boundary": "periodic"},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "10 mN/m"},
    "indenter": {
        "type": "self_affine",
        "rms_height": "10 um",
        "hurst": 0.7,
        "cutoff_wavelength": "60 um",
        "seed": 1,
    },
    "loading": {"mean_pressure": {"start": "50 Pa", "stop": "400 Pa", "num": 4}},
    "corrections": [{"type": "yastrebov"}],
    "outputs": [{"type": "html"}],
}


def main() -> None:
    """Solve, open the page and write the picture next to this file."""
    options = ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    with TemporaryDirectory() as folder:
        for switch in (
            "headless",
            "no-sandbox",
            "disable-gpu",
            "hide-scrollbars",
            "window-size=1180,1750",
        ):
            options.add_argument(f"--{switch}")
        options.add_argument(f"--user-data-dir={folder}/chromium")
        pl.run(RUN, directory=folder, progress=False)
        (page,) = Path(folder).glob("*.html")
        browser = Chrome(options=options, service=ChromeService(shutil.which("chromedriver")))
        try:
            browser.get(page.as_uri())
            browser.execute_async_script("setTimeout(arguments[0], 2000)")
            picture = Image.open(BytesIO(browser.get_screenshot_as_png()))
        finally:
            browser.quit()
    few = picture.convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(HERE / "report.png", optimize=True)


if __name__ == "__main__":
    main()
