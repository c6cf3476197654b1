"""The Python of pages in docs/coming_from prints what the pages say, and what this library finds: pages_test.py

A page whose library is not there is skipped; exit code 77: all of them are.
"""
import contextlib
import importlib.util
import io
import os
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIBRARIES = ["scipy", "mrcal"]
if not any(importlib.util.find_spec(name) for name in LIBRARIES):
    print("skipped: needs Debian's python3-scipy or python3-mrcal")
    sys.exit(77)


def page(name):
    return (ROOT / "docs" / name).read_text(encoding="utf-8")


def printed_by(name):
    """What the programs of a page print, and what it says that they do."""
    programs, said = (re.findall(rf"```{language}\n(.*?)```", page(name), re.DOTALL) for language in ("python", "text"))
    printed, names = io.StringIO(), {}
    os.chdir(ROOT)
    with contextlib.redirect_stdout(printed):
        for program in programs:
            exec(program, names)
    return printed.getvalue(), "".join(said)


class Pages(unittest.TestCase):
    @unittest.skipUnless(importlib.util.find_spec("scipy"), "needs Debian's python3-scipy")
    def test_scipy(self):
        printed, said = printed_by("coming_from/scipy.md")
        self.assertEqual(printed, said)
        diameter = (ROOT / "examples/circle_fit/expected.txt").read_text(encoding="utf-8").splitlines()[-1]
        self.assertEqual(printed.splitlines()[0], diameter)
        self.assertEqual(len(printed.splitlines()), 3)

    @unittest.skipUnless(importlib.util.find_spec("mrcal"), "needs Debian's python3-mrcal")
    def test_mrcal(self):
        printed, said = printed_by("coming_from/mrcal.md")
        self.assertEqual(printed, said)
        found = [line.split() for line in printed.splitlines()]
        self.assertEqual([words[0] for words in found], ["fx", "fy", "cx", "cy"])
        for name, value in found:
            self.assertRegex(page("start/first_calibration.md"), rf"\n  {name} +{value} \+-")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
