"""The Python programs of the pages and of README run, each page as one program, in a folder with the data of the
repository. A comment `# 1.5` after a print is what it prints."""

import contextlib
import io
import os
import re
import tempfile
import unittest
from pathlib import Path

from slom import _command

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("python*.md"))]


def program(page):
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(), re.M | re.S)
    return "\n".join(blocks)


class Pages(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        os.symlink(ROOT / "data", "data")

    def test_programs_run_and_print_what_they_say(self):
        for page in PAGES:
            if page.stem == "python_command" and not _command.PROGRAM.exists():
                continue  # the package was built without the command
            with self.subTest(page=page.name):
                code, output = program(page), io.StringIO()
                with contextlib.redirect_stdout(output):
                    exec(compile(code, page.name, "exec"), {"__name__": page.stem})
                for said in re.findall(r"^print\(.*\)  # (.*)$", code, re.M):
                    self.assertIn(said, output.getvalue())
        self.assertGreater(len(PAGES), 2)


if __name__ == "__main__":
    unittest.main()
