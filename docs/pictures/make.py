#!/usr/bin/python3
"""Writes report.png, the picture of the README: the top of the report page for data/opencv_stereo.

    docs/pictures/make.py SLOM

SLOM: the command. Needs Debian's chromium, chromium-driver, python3-selenium and python3-pil.
"""

import io
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

FOLDER = pathlib.Path(__file__).resolve().parent
ROOT = FOLDER.parent.parent
WIDTH, COLOURS = 1200, 192
TALL = 12000  # more than the page
GAP = 8  # round a figure


def report_page(slom, folder):
    """The page of the stereo camera, as a file."""
    page = pathlib.Path(folder) / "report.html"
    cameras = [f"--camera={name}={ROOT}/data/opencv_stereo/{name}_corners.csv" for name in ("left", "right")]
    subprocess.run([slom, "calibrate", "--quiet", *cameras, "--board-shape", "free", "--report", page], check=True)
    return page


def parts_of(page):
    """The page down to its list of contents, the figure of the boards in space, and the first two maps of projection uncertainty."""
    options = Options()
    for argument in ("--headless=new", "--no-sandbox", f"--window-size={WIDTH},{TALL}", "--hide-scrollbars"):
        options.add_argument(argument)
    with webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options) as browser:
        browser.get(page.as_uri())
        whole = Image.open(io.BytesIO(browser.get_screenshot_as_png())).convert("RGB")
        figures = [browser.find_elements("css selector", f"#{section} figure") for section in ("space", "projection")]
        bands = [(0, browser.find_element("css selector", "nav").rect["y"])]
        for rect in (figures[0][0].rect, figures[1][0].rect):
            bands.append((rect["y"] - GAP, rect["y"] + rect["height"] + GAP))
    return [whole.crop((0, round(top), WIDTH, round(bottom))) for top, bottom in bands]


def main():
    with tempfile.TemporaryDirectory() as folder:
        parts = parts_of(report_page(sys.argv[1], folder))
    picture = Image.new("RGB", (WIDTH, sum(part.height for part in parts)))
    y = 0
    for part in parts:
        picture.paste(part, (0, y))
        y += part.height
    picture.quantize(COLOURS).save(FOLDER / "report.png", optimize=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main()
