"""The Python of docs/coming_from/scipy.md prints what the page says, which is what examples/circle_fit prints: scipy_test.py

Exit code 77: skipped, because SciPy is not there.
"""
import contextlib
import io
import pathlib
import re
import sys
import unittest

try:
    import scipy  # noqa: F401
except ImportError:
    print("skipped: needs Debian's python3-scipy")
    sys.exit(77)

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Page(unittest.TestCase):
    def test_prints_what_it_says(self):
        page = (ROOT / "docs/coming_from/scipy.md").read_text(encoding="utf-8")
        programs, said = (re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL) for language in ("python", "text"))
        self.assertEqual(len(programs), 2)
        printed, names = io.StringIO(), {}
        with contextlib.redirect_stdout(printed):
            for program in programs:
                exec(program, names)
        self.assertEqual(printed.getvalue(), "".join(said))
        diameter = (ROOT / "examples/circle_fit/expected.txt").read_text(encoding="utf-8").splitlines()[-1]
        self.assertEqual(printed.getvalue().splitlines()[0], diameter)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
