"""The command slom: its options, its run, its errors."""

import difflib
import functools
import numbers
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np

from ._error import Error

PROGRAM = Path(__file__).with_name("bin") / "slom"


class UnknownOption(Error, TypeError):
    """A keyword that is no option of the command."""


class Option:
    """An option as the help text shows it: its name, what its value is, whether it may be repeated."""

    def __init__(self, name, kind):
        self.name = name
        self.is_repeated = kind.endswith(" ...")
        self.is_flag = kind == ""
        self.may_lack_value = self.is_flag or kind.startswith("{") or name == "compare"
        self.between = "x" if "WxH" in kind or name == "board" else ","  # numbers


def main():
    """Runs the command in place of this process: what the console script does."""
    program = _program()
    os.execv(program, ["slom", *sys.argv[1:]])


def run(command, files, options):
    """Runs a subcommand with files and options, among which is json. Returns the exit code and what it says. Ctrl-C ends
    it. Raises its complaints about options and data."""
    arguments = [_program(), command, *map(_path, files), *arguments_of(command, options)]
    before = state(options["json"])
    pipe, text = subprocess.PIPE, {"encoding": "utf-8", "errors": "replace"}
    process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=pipe, stderr=pipe, **text)
    try:
        report, complaints = process.communicate()
    except BaseException:
        process.kill()
        process.communicate()
        raise
    if process.returncode == 2 or state(options["json"]) == before:
        raise _error(command, process.returncode, complaints)
    return process.returncode, report + complaints


def state(file):
    """Returns what differs after a file was written."""
    try:
        found = os.stat(file)
        return found.st_ino, found.st_mtime_ns
    except OSError:
        return None


def arguments_of(command, options):
    """Returns the words of keyword arguments."""
    known = _options(command)
    flags, values = [], []
    for keyword, value in options.items():
        option = known.get(keyword)
        if option is None:
            near = difflib.get_close_matches(keyword, known)
            instead = f"pass {' or '.join(near)}" if near else f"pass one of {', '.join(known)}"
            raise UnknownOption(f"[slom.bad-option] slom.{command} has no argument {keyword}; {instead}", keyword)
        if value is None or value is False:
            continue
        if value is True:
            if not option.may_lack_value:
                raise Error(f"[slom.bad-option] {keyword} is True, but it needs a value; pass the value", keyword)
            flags.append(f"--{option.name}")
        elif option.is_flag:
            raise Error(f"[slom.bad-option] {keyword} is {value!r}; pass True or False", keyword)
        else:
            values += [f"--{option.name}={text}" for text in _texts(option, value)]
    return flags + values


def _texts(option, value):
    """Returns the text of a value, or those of an option that is repeated."""
    if isinstance(value, dict):
        return [text for name, own in value.items() for text in _named(option, name, own)]
    if option.is_repeated and isinstance(value, (list, tuple)):
        return [_text(option, one) for one in value]
    return [_text(option, value)]


def _named(option, name, value):
    """Returns NAME=VALUE; for a list of texts one of each."""
    if value is None or value is True:
        return [str(name)]
    is_list = isinstance(value, (list, tuple)) and not all(isinstance(x, numbers.Real) for x in value)
    return [f"{name}={_text(option, one)}" for one in (value if is_list else [value])]


def _text(option, value):
    if isinstance(value, (list, tuple, np.ndarray)):
        return option.between.join(_text(option, one) for one in value)
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    return os.fspath(value)


def _path(file):
    """Returns the name of a file that is no option."""
    name = os.fspath(file)
    return f"./{name}" if name.startswith("-") else name


@functools.lru_cache(maxsize=None)
def _options(command):
    """Returns the options of a subcommand by keyword: those of its help text."""
    program = _program()
    help_text = subprocess.run([program, command, "--help"], capture_output=True, text=True).stdout
    if "--help-all" in help_text:
        help_text = subprocess.run([program, command, "--help-all"], capture_output=True, text=True).stdout
    found = re.findall(r"^  --([a-z][a-z-]*)(?: (?! )|(?={))?((?:\S| (?! ))*)", help_text, re.M)
    options = {name.replace("-", "_"): Option(name, kind.strip()) for name, kind in found if name != "help-all"}
    return options


def _program():
    if not PROGRAM.exists():
        raise Error(
            f"[slom.no-command] the program slom is not at {PROGRAM}, because the package was built without it; install "
            "the libraries that docs/start/install.md lists for the command, and build the package again",
            str(PROGRAM),
        )
    return str(PROGRAM)


def _error(command, code, report):
    complaints = [line[len("slom: ") :] for line in report.splitlines() if line.startswith("slom: ")]
    if not complaints:
        how = f"by signal {-code}" if code < 0 else f"with exit code {code}"
        return Error(f"[slom.command-failed] slom {command} ended {how} and no message; please report it", command)
    sentence = complaints[-1]
    subject, colon, _ = sentence.partition(": ")
    if subject.startswith("--"):
        return Error(f"[slom.bad-option] {sentence}", subject.split(" ")[0])
    is_place = colon and (" " not in subject or os.path.exists(re.sub(r":\d+$", "", subject)))
    kind = "bad-input" if code == 2 else "command-failed"
    return Error(f"[slom.{kind}] {sentence}", subject if is_place else "")
