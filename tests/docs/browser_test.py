#!/usr/bin/python3
"""Opens the built site in Chromium: no errors, nothing loaded from elsewhere, no page wider than the window, readable code, search, dark, keyboard.

    browser_test.py HTML PICTURES

HTML: folder that scripts/docs wrote; PICTURES: a folder for screenshots, which are there to be looked at. Exit code 77: skipped.
"""
import functools
import http.server
import json
import os
import pathlib
import sys
import tempfile
import threading
import unittest

HTML, PICTURES = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
if not (HTML / "index.html").exists():
    print(f"skipped: no site in {HTML}; scripts/docs builds it")
    sys.exit(77)
try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import WebDriverWait
except ImportError:
    print("skipped: needs Debian's python3-selenium")
    sys.exit(77)
if not (os.path.exists("/usr/bin/chromium") and os.path.exists("/usr/bin/chromedriver")):
    print("skipped: needs Debian's chromium and chromium-driver")
    sys.exit(77)


# The smallest contrast of the texts of code blocks, and the text that has it; null on a page without code.
LEAST_CONTRAST = """
const linear = (c) => (c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
const numbers = (colour) => colour.match(/[\\d.]+/g).map(Number);
const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
const background = (e) => { const c = numbers(getComputedStyle(e).backgroundColor); return c.length < 4 || c[3] === 1 ? c : background(e.parentElement); };
let least = null;
for (const e of document.querySelectorAll('.highlight pre, .highlight pre span')) {
  if (![...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim())) continue;
  const [a, b] = [luminance(numbers(getComputedStyle(e).color)), luminance(background(e))];
  const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  if (!least || contrast < least[0]) least = [contrast, e.className + ': ' + e.textContent.slice(0, 40)];
}
return least;
"""

# The number of columns of the widest code block, whose lines do not wrap, nor scroll.
COLUMNS = """
const pre = document.querySelector('.highlight pre'), style = getComputedStyle(pre);
const line = pre.appendChild(document.createElement('span'));
line.style.cssText = 'white-space: pre; position: absolute';
line.textContent = 'x'.repeat(100);
const columns = 100 * (pre.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight)) / line.getBoundingClientRect().width;
line.remove();
return columns;
"""


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        PICTURES.mkdir(parents=True, exist_ok=True)
        cls.folder = tempfile.TemporaryDirectory()
        options = Options()
        options.binary_location = "/usr/bin/chromium"
        for argument in ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars", "--no-first-run",
                         "--disable-extensions", f"--user-data-dir={cls.folder.name}/profile"]:
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        cls.browser = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))

    @classmethod
    def tearDownClass(cls):
        cls.browser.quit()
        cls.folder.cleanup()

    def window(self, width, height=900, dark=False):
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                     {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                     {"features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})

    def open(self, name):
        file, _, query = name.partition("?")
        self.browser.get((HTML / file).as_uri() + (f"?{query}" if query else ""))

    def js(self, code):
        return self.browser.execute_script(code)

    def keys(self, *keys):
        for key in keys:
            self.browser.switch_to.active_element.send_keys(key)

    def requests(self):
        messages = [json.loads(entry["message"])["message"] for entry in self.browser.get_log("performance")]
        return [m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"]

    def test_every_page_loads_without_an_error_and_fits_a_phone(self):
        self.window(390)
        self.browser.get_log("browser")
        self.requests()
        pages = [path for path in sorted(HTML.rglob("*.html")) if "_static" not in path.parts]
        self.assertGreater(len(pages), 20)
        for path in pages:
            self.browser.get(path.as_uri())
            width = self.js("return document.scrollingElement.scrollWidth")
            self.assertLessEqual(width, 390, path)
        self.assertEqual([entry["message"] for entry in self.browser.get_log("browser")], [])
        self.assertEqual([url for url in self.requests() if not url.startswith(("file:", "data:"))], [])

    def test_code_and_output_have_contrast(self):
        pages = [path for path in sorted(HTML.rglob("*.html")) if not {"_static", "files", "reference"} & set(path.parts)]
        pages.append(HTML / "reference/slom/estimator.html")
        seen = 0
        for dark in [False, True]:
            self.window(1280, dark=dark)
            for path in pages:
                self.browser.get(path.as_uri())
                least = self.js(LEAST_CONTRAST)
                if least:
                    self.assertGreaterEqual(least[0], 7, f"{path}, dark {dark}, {least[1]}")
                    seen += 1
        self.assertGreater(seen, 40)

    def test_code_of_124_columns_fits_a_window_of_1280_pixels(self):
        scrollbar = 15  # the widest lines of code of the pages, but for a few, have 124 columns
        for width in [1280 - scrollbar, 1280, 1540, 1600, 1920]:
            self.window(width)
            self.open("fitting.html")
            self.assertGreaterEqual(self.js(COLUMNS), 124, width)
            self.assertLessEqual(self.js("return document.scrollingElement.scrollWidth"), width)

    def test_no_width_makes_a_page_scroll_sideways(self):
        for width in [320, 600, 760, 900, 1060, 1090, 1200, 1300, 1500, 1700]:
            self.window(width)
            for name in ["calibrate.html", "reference/slom/estimator.html"]:
                self.open(name)
                self.assertLessEqual(self.js("return document.scrollingElement.scrollWidth"), width, name)

    def test_pictures(self):
        names = os.environ.get("SLOM_DOCS_PAGES", "index fitting conventions").split()
        for name in names:
            for width in [1280, 390]:
                for dark in [False, True]:
                    self.window(width, dark=dark)
                    self.open(f"{name}.html")
                    file = f"{name.replace('/', '_')}_{width}_{'dark' if dark else 'light'}.png"
                    self.browser.save_screenshot(str(PICTURES / file))

    def test_dark_and_light_differ(self):
        colours = []
        for dark in [False, True]:
            self.window(1280, dark=dark)
            self.open("index.html")
            colours.append(self.js("return getComputedStyle(document.body).backgroundColor"))
        self.assertNotEqual(colours[0], colours[1])
        self.js("document.querySelector('.theme-toggle-content .theme-toggle').click()")
        self.assertIn(self.js("return document.body.dataset.theme"), ["light", "dark"])
        self.js("localStorage.clear()")

    def test_search_finds_without_a_server(self):
        self.window(1280)
        self.open("search.html?q=covariance")
        WebDriverWait(self.browser, 10).until(lambda b: len(b.find_elements(By.CSS_SELECTOR, "ul.search li")) > 3)

    def check_excerpts(self, address):
        self.window(1280)
        self.browser.get(f"{address}/search.html?q=leverage")
        WebDriverWait(self.browser, 10).until(lambda b: "finished" in b.find_element(By.CSS_SELECTOR, ".search-summary").text)
        results = self.browser.find_elements(By.CSS_SELECTOR, "ul.search li")
        self.assertGreater(len(results), 3)
        for result in results:
            excerpt = result.find_element(By.CSS_SELECTOR, "p.context")
            self.assertIn("leverage", excerpt.text.lower())
            self.assertLess(len(excerpt.text), 500)
        heading = self.browser.find_element(By.CSS_SELECTOR, "ul.search p.context a").get_attribute("href")
        self.browser.get(heading)  # leads to the section
        self.assertTrue(self.js("return document.getElementById(decodeURIComponent(location.hash.slice(1))) !== null"))

    def test_results_of_the_search_have_excerpts(self):
        self.assertLess((HTML / "_static/excerpts_data.js").stat().st_size, 1_000_000)
        self.check_excerpts(HTML.as_uri())

    def test_results_have_excerpts_from_a_server_too(self):
        class Quiet(http.server.SimpleHTTPRequestHandler):
            def log_message(self, *words):
                pass
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=os.fspath(HTML)))
        self.addCleanup(server.server_close)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.shutdown)
        self.check_excerpts(f"http://127.0.0.1:{server.server_port}")

    def test_search_of_nothing_and_of_signs_does_not_fail(self):
        self.browser.get_log("browser")
        for query in ["", "the", "%28%2B%2B", "zzzzzz", "J%5ET+r"]:
            self.open(f"search.html?q={query}")
        self.assertEqual([entry["message"] for entry in self.browser.get_log("browser")], [])

    def test_keyboard(self):
        self.window(1280)
        self.open("index.html")
        self.keys("/")
        self.assertEqual(self.js("return document.activeElement.name"), "q")
        self.keys("Cholesky", Keys.ENTER)
        WebDriverWait(self.browser, 10).until(lambda b: "search.html" in b.current_url)
        self.open("index.html")
        seen = []
        for _ in range(40):
            self.keys(Keys.TAB)
            seen.append(self.js("return (document.activeElement.getAttribute('href') || document.activeElement.tagName)"))
        self.assertIn("fitting.html", seen)

    def test_menu_of_a_phone_opens_by_keyboard(self):
        self.window(390)
        self.open("index.html")
        for _ in range(10):
            self.keys(Keys.TAB)
            if self.js("return document.activeElement.getAttribute('for')") == "__navigation":
                break
        self.keys(Keys.ENTER)
        self.assertTrue(self.js("return document.querySelector('#__navigation').checked"))
        self.keys(Keys.ESCAPE)
        self.assertFalse(self.js("return document.querySelector('#__navigation').checked"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
