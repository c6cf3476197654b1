"""The manual pages and the completion in bash have what the command's help has: manual_test.py COMMAND MANUAL.

MANUAL: folder of man_pages.py and completion.bash. The pages are rendered by groff where it is installed.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

COMMAND, MANUAL = sys.argv[1:3]
SUBCOMMANDS = ["bundle", "calibrate", "convert", "graph", "hand-eye", "replay", "simulate"]
DEVICES = ["stereo-imu", "stereo-imu-stream"]
COMMANDS = [[name] for name in SUBCOMMANDS] + [["simulate", device] for device in DEVICES]


def run(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True)


def help_of(words):
    """The help with all options."""
    usual = run(COMMAND, *words, "--help").stdout
    return run(COMMAND, *words, "--help-all").stdout if "\n  --help-all " in usual else usual


def options_of(words):
    return re.findall(r"^  (?:-h,)?(--[a-z-]+)", help_of(words), re.MULTILINE)


def completed(*words):
    """What bash offers for the last of these words."""
    script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _slom; printf "%s\\n" "${COMPREPLY[@]}"')
    return run("bash", "-c", script, "bash", os.path.join(MANUAL, "completion.bash"), COMMAND, *words).stdout.split()


class Manual(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        run(sys.executable, os.path.join(MANUAL, "man_pages.py"), COMMAND, "1.2.3", self.folder)

    def page(self, name):
        with open(os.path.join(self.folder, name + ".1"), encoding="utf-8") as file:
            return file.read()

    def test_there_is_a_page_for_each_subcommand(self):
        pages = {"slom.1", *("-".join(["slom", *words]) + ".1" for words in COMMANDS)}
        self.assertEqual(set(os.listdir(self.folder)), pages)

    def test_pages_have_all_options_and_texts(self):
        for words in COMMANDS:
            page = self.page("-".join(["slom", *words])).replace("\\-", "-").replace("\\&", "").replace("\\e", "\\")
            self.assertIn("slom 1.2.3", page)
            self.assertGreater(len(options_of(words)), 0)
            for option in options_of(words):
                self.assertRegex(page, r"(?m)^\.B (-h,)?" + option + r"\b")
            said = " ".join(page.split())
            for line in help_of(words).split("\n"):
                text = line[30:].strip() if line.startswith("  ") else ""
                self.assertIn(" ".join(text.split()), said)

    def test_help_fits_a_screen(self):
        for words in [[], *COMMANDS]:
            lines = run(COMMAND, *words, "--help").stdout.rstrip().split("\n")
            self.assertLessEqual(len(lines), 50, words)
            for line in lines + help_of(words).split("\n"):
                self.assertLessEqual(len(line), 100, line)

    def test_help_of_calibrate_shows_the_usual_options(self):
        usual = re.findall(r"^  (?:-h,)?(--[a-z-]+)", run(COMMAND, "calibrate", "--help").stdout, re.MULTILINE)
        self.assertIn("--camera", usual)
        self.assertNotIn("--sigma-board", usual)
        self.assertIn("--sigma-board", options_of(["calibrate"]))
        self.assertEqual(options_of(["calibrate"])[:len(usual)], usual)

    def test_pages_are_rendered_without_a_warning(self):
        if not shutil.which("groff"):
            self.skipTest("needs groff")
        for name in os.listdir(self.folder):
            result = run("groff", "-man", "-Tutf8", "-ww", os.path.join(self.folder, name))
            self.assertEqual(result.stderr, "", name)
            self.assertIn("DESCRIPTION", re.sub(r"\x1b\[[0-9;]*m|.\x08", "", result.stdout))

    def test_completion(self):
        self.assertEqual(completed(""), SUBCOMMANDS)
        self.assertEqual(completed("ca"), ["calibrate"])
        self.assertEqual(completed("simulate", ""), DEVICES)
        self.assertEqual(completed("graph", "map", "--al"), ["--algorithm"])
        for words in COMMANDS:
            self.assertEqual(completed(*words, "--"), options_of(words))
        for words in (["--algorithm", ""], ["--algorithm", "="]):
            self.assertEqual(completed("graph", *words), ["gn", "lm", "dogleg"])
        self.assertEqual(completed("graph", "--algorithm", "=", "l"), ["lm"])
        self.assertEqual(completed("calibrate", "--imu", MANUAL + "/man_p"), [MANUAL + "/man_pages.py"])
        self.assertEqual(completed("no-such-command", "--x"), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
