"""The scripts of examples/python print what examples/python/expected says, letter by letter.

A changed output that is right: examples_test.py --update writes the expected files.
"""

import os
import re
import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "examples/python"
# Public data that an example reads: a folder of $SLOM_SHARED_DATA.
DATA = {"range_slam": "range_slam"}
UPDATE = "--update" in sys.argv


def arguments(name):
    """The arguments of an example, or None if its data are not there."""
    if name not in DATA:
        return []
    folder = Path(os.environ.get("SLOM_SHARED_DATA", "")) / DATA[name]
    return [str(folder)] if "SLOM_SHARED_DATA" in os.environ and folder.is_dir() else None


def numbers(text):
    return re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", text)


class Examples(unittest.TestCase):
    def test_all_print_what_is_expected(self):
        scripts = sorted(FOLDER.glob("*.py"))
        self.assertGreaterEqual(len(scripts), 6)
        for script in scripts:
            with self.subTest(example=script.stem):
                given = arguments(script.stem)
                if given is None:
                    self.skipTest(f"without the data {DATA[script.stem]}")
                run = subprocess.run([sys.executable, "-W", "error", script, *given], capture_output=True, text=True)
                self.assertEqual(run.returncode, 0, run.stderr)
                expected = FOLDER / f"expected/{script.stem}.txt"
                if UPDATE:
                    expected.write_text(run.stdout)
                self.assertEqual(run.stdout, expected.read_text())

    def test_expected_files_have_a_script(self):
        for expected in (FOLDER / "expected").iterdir():
            self.assertTrue((FOLDER / f"{expected.stem}.py").is_file(), expected)

    def test_page_shows_them(self):
        """docs/python_examples.md names each script, and its blocks of output are parts of expected files."""
        page = (ROOT / "docs/python_examples.md").read_text()
        expected = [file.read_text() for file in (FOLDER / "expected").iterdir()]
        for script in FOLDER.glob("*.py"):
            self.assertIn(f"(../examples/python/{script.name})", page)
        blocks = re.findall(r"^```text\n(.*?)^```", page, re.M | re.S)
        self.assertGreaterEqual(len(blocks), 6)
        for block in blocks:
            self.assertTrue(any(block in text for text in expected), block)

    def test_are_short(self):
        for script in FOLDER.glob("*.py"):
            self.assertLessEqual(len(script.read_text().splitlines()), 120, script.name)

    def test_the_same_in_cpp(self):
        """The circle and the stereo camera are fitted by C++ programs, too."""
        report = (ROOT / "examples/circle_fit/expected.txt").read_text()
        parameters = re.search(r"  centre\.x.*?  radius[^\n]*\n", report, re.S).group()
        self.assertIn(parameters, (FOLDER / "expected/circle.txt").read_text())
        cpp = (ROOT / "examples/stereo_imu_calibration/expected.txt").read_text()
        own = numbers((FOLDER / "expected/stereo_imu_calibration.txt").read_text())
        intrinsics, *_ = cpp.split("\n")
        cameras = numbers(intrinsics)[:18]
        gravity, bias = (numbers(re.search(rf"{name} (.*)", cpp).group(1)) for name in ("Gravity", "Bias"))
        std = numbers(re.search("deviations of (.*)", cpp).group(1))
        for number in [*cameras, *gravity, *bias, *std]:
            self.assertIn(number, own)


if __name__ == "__main__":
    unittest.main(argv=[a for a in sys.argv if a != "--update"])
