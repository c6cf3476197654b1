#!/usr/bin/python3
"""Opens reports of slom calibrate in Chromium and looks at them: no errors, no requests, pictures in every figure, a view in space
that turns, light and dark, wide and narrow, on paper.

    browser_test.py SLOM DATA PICTURES

SLOM: the command; DATA: the project's data folder; PICTURES: a folder for screenshots, which are there to be looked at.
Exit code 77: skipped, because Chromium or Selenium is not there.
"""

import base64
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    print("skipped: needs Debian's python3-selenium")
    sys.exit(77)
if not (os.path.exists("/usr/bin/chromium") and os.path.exists("/usr/bin/chromedriver")):
    print("skipped: needs Debian's chromium and chromium-driver")
    sys.exit(77)

SLOM, DATA, PICTURES = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
SECTIONS = ["parameters", "fit", "residuals", "coverage", "space", "projection", "halves", "views", "correlations", "corners", "method"]
# Different colours in a canvas; one colour means that nothing was drawn.
COLOURS = """
const canvas = arguments[0], pen = canvas.getContext("2d");
const pixels = pen.getImageData(0, 0, canvas.width, canvas.height).data, seen = new Set();
for (let i = 0; i < pixels.length; i += 4 * 7) seen.add(pixels[i] << 24 | pixels[i + 1] << 16 | pixels[i + 2] << 8 | pixels[i + 3]);
return seen.size;"""


def report(folder, *options, code=0):
    """The page that slom calibrate writes with these options, as a file."""
    page = pathlib.Path(folder) / "report.html"
    ran = subprocess.run([SLOM, "calibrate", "--quiet", "--report", str(page), *options], capture_output=True, text=True)
    assert ran.returncode == code, ran.stderr
    return page


def corners(name, camera):
    return f"{camera}={DATA / name / (camera + '_corners.csv')}"


def parallel_boards(folder):
    """All boards parallel to the image: the focal length is open."""
    file = pathlib.Path(folder) / "parallel.csv"
    rows = ["image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px"]
    for image in range(1, 5):
        for k in range(30):
            x, y = 0.05 * (k % 6), 0.05 * (k // 6)
            u, v = 100 + 20 * image + 600 * x / 0.8, 90 + 10 * image + 600 * y / 0.8
            rows.append(f"{image},{k + 1},{x},{y},0,{u},{v}")
    file.write_text("\n".join(rows) + "\n")
    return file


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        PICTURES.mkdir(parents=True, exist_ok=True)
        cls.folder = tempfile.mkdtemp()
        options = Options()
        options.binary_location = "/usr/bin/chromium"
        for argument in ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
                         "--disable-extensions", "--no-first-run", f"--user-data-dir={cls.folder}/profile"]:
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        cls.browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        cls.stereo = report(cls.folder, "--camera", corners("opencv_stereo", "left"), "--camera", corners("opencv_stereo", "right"))

    @classmethod
    def tearDownClass(cls):
        cls.browser.quit()
        shutil.rmtree(cls.folder, ignore_errors=True)

    def open(self, page, width=1280, height=900, scheme="light"):
        """As on a screen of this size and colour scheme."""
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                     {"width": width, "height": height, "deviceScaleFactor": 2 if width < 500 else 1, "mobile": width < 500})
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
        self.browser.get_log("browser"), self.browser.get_log("performance")
        self.browser.get(page.as_uri())
        self.settle()

    def settle(self):
        self.browser.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()))")

    def picture(self, name):
        size = self.browser.execute_cdp_cmd("Page.getLayoutMetrics", {})["cssContentSize"]
        shot = self.browser.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True, "clip": {**size, "scale": 1}})
        (PICTURES / f"{name}.png").write_bytes(base64.b64decode(shot["data"]))

    def expect_quiet(self, page):
        """No message of any kind, and nothing asked for but the page itself."""
        self.assertEqual(self.browser.get_log("browser"), [])
        events = [json.loads(entry["message"])["message"] for entry in self.browser.get_log("performance")]
        asked = {event["params"]["request"]["url"] for event in events if event["method"] == "Network.requestWillBeSent"}
        self.assertEqual({url for url in asked if not url.startswith("data:")} - {page.as_uri()}, set())

    def expect_drawn(self):
        canvases = self.browser.find_elements(By.TAG_NAME, "canvas")
        self.assertTrue(canvases)
        for canvas in canvases:
            self.assertGreater(self.browser.execute_script(COLOURS, canvas), 3, canvas.get_attribute("outerHTML"))

    def expect_no_sideways_scrolling(self):
        wide = self.browser.execute_script("return [document.documentElement.scrollWidth, innerWidth]")
        self.assertLessEqual(wide[0], wide[1])

    def expect_figures_to_hold_what_is_drawn(self):
        outside = """return [...document.querySelectorAll("figure canvas")].filter(canvas => !canvas.closest(".scroll") &&
            canvas.getBoundingClientRect().right > canvas.closest("figure").getBoundingClientRect().right + 1).length"""
        self.assertEqual(self.browser.execute_script(outside), 0)

    def test_all_sections_are_drawn_wide_and_narrow_light_and_dark(self):
        for width in [1280, 390]:
            for scheme in ["light", "dark"]:
                with self.subTest(width=width, scheme=scheme):
                    self.open(self.stereo, width=width, scheme=scheme)
                    self.assertEqual([s.get_attribute("id") for s in self.browser.find_elements(By.TAG_NAME, "section")], SECTIONS)
                    self.expect_quiet(self.stereo)
                    self.expect_drawn()
                    self.expect_no_sideways_scrolling()
                    self.expect_figures_to_hold_what_is_drawn()
                    for section in ["fit", "residuals", "coverage", "space", "projection", "halves", "correlations"]:
                        self.assertTrue(self.browser.find_elements(By.CSS_SELECTOR, f"#{section} canvas"), section)
                    background = self.browser.execute_script("return getComputedStyle(document.body).backgroundColor")
                    bright = sum(int(c) for c in background[4:-1].split(",")) > 384
                    self.assertEqual(bright, scheme == "light")
                    self.picture(f"stereo_{width}_{scheme}")

    def view(self):
        self.settle()
        return self.browser.execute_script("return document.querySelector('canvas.scene').toDataURL()")

    def test_the_view_in_space_turns(self):
        self.open(self.stereo)
        canvas = self.browser.find_element(By.CSS_SELECTOR, "canvas.scene")
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", canvas)
        home = self.view()
        ActionChains(self.browser).click_and_hold(canvas).move_by_offset(120, 40).release().perform()
        dragged = self.view()
        self.assertNotEqual(dragged, home)
        canvas.send_keys("0")
        self.assertEqual(self.view(), home)
        for key in [Keys.ARROW_LEFT, Keys.ARROW_RIGHT, Keys.ARROW_UP, Keys.ARROW_DOWN, "+", "-"]:
            with self.subTest(key=key):
                canvas.send_keys("0", key)
                self.assertNotEqual(self.view(), home)
        for button in self.browser.find_elements(By.CSS_SELECTOR, "#space button")[1:4]:
            canvas.send_keys("0")
            button.click()
            self.assertNotEqual(self.view(), home, button.text)
        touch = lambda kind, x: self.browser.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [] if x is None else [{"x": x, "y": at["y"] + 100}]})
        self.browser.find_elements(By.CSS_SELECTOR, "#space button")[0].click()
        at = self.browser.execute_script("const b = arguments[0].getBoundingClientRect(); return {x: b.x, y: b.y}", canvas)
        self.assertEqual(self.view(), home)
        touch("touchStart", at["x"] + 100), touch("touchMove", at["x"] + 180), touch("touchEnd", None)
        self.assertNotEqual(self.view(), home)

    def test_the_keyboard_reaches_everything(self):
        self.open(self.stereo)
        reached = set()
        body = self.browser.find_element(By.TAG_NAME, "body")
        body.send_keys(Keys.HOME)
        for _ in range(120):
            ActionChains(self.browser).send_keys(Keys.TAB).perform()
            active = self.browser.switch_to.active_element
            reached.add(active.tag_name + "." + (active.get_attribute("class") or ""))
        for wanted in ["a.skip", "a.", "summary.", "button.", "canvas.scene", "div.scroll"]:
            self.assertIn(wanted, reached)
        unnamed = self.browser.execute_script("return [...document.querySelectorAll('[role=img], canvas.scene')].filter(e => !e.getAttribute('aria-label')).length")
        self.assertEqual(unnamed, 0)

    def test_paper(self):
        self.open(self.stereo, scheme="dark")
        pdf = base64.b64decode(self.browser.execute_cdp_cmd("Page.printToPDF", {"printBackground": False})["data"])
        self.assertTrue(pdf.startswith(b"%PDF"))
        (PICTURES / "stereo.pdf").write_bytes(pdf)
        self.expect_quiet(self.stereo)

    def test_imu_and_one_camera(self):
        folder = tempfile.mkdtemp(dir=self.folder)
        name = "simulated_stereo_imu"
        page = report(folder, "--camera", corners(name, "left"), "--camera", corners(name, "right"), "--imu", str(DATA / name / "imu.csv"))
        self.open(page)
        self.assertIn("gravity", self.browser.find_element(By.ID, "parameters").text)
        self.expect_quiet(page), self.expect_drawn()
        self.picture("imu_1280_light")
        page = report(folder, "--camera", corners("opencv_stereo", "left"), "--intrinsics", "radial1")
        self.open(page, width=390)
        self.expect_quiet(page), self.expect_drawn(), self.expect_no_sideways_scrolling(), self.expect_figures_to_hold_what_is_drawn()
        self.picture("one_camera_390_light")

    def test_failed_fits_say_so_and_show_what_there_is(self):
        folder = tempfile.mkdtemp(dir=self.folder)
        for options, words in [(["--camera", f"left={parallel_boards(folder)}", "--intrinsics", "radial1"], "do not determine"),
                               (["--camera", corners("opencv_stereo", "left"), "--max-iterations", "1"], "did not converge")]:
            with self.subTest(words=words):
                page = report(folder, *options, code=1)
                self.open(page)
                self.assertIn(words, self.browser.find_element(By.ID, "verdict").text)
                self.assertEqual([s.get_attribute("id") for s in self.browser.find_elements(By.TAG_NAME, "section")],
                                 [s for s in SECTIONS if s not in ["projection", "halves", "views", "correlations"]])
                self.expect_quiet(page), self.expect_drawn()
                self.picture("failed_" + words.split()[-1])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
