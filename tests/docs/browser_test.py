#!/usr/bin/python3
"""Opens the built site in Chromium: no errors, nothing loaded from elsewhere, no page wider than the window, search, dark, keyboard.

    browser_test.py HTML PICTURES

HTML: folder that scripts/docs wrote; PICTURES: a folder for screenshots, which are there to be looked at. Exit code 77: skipped.
"""
import json
import os
import pathlib
import sys
import tempfile
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
