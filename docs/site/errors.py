"""Writes docs/errors.md: each id of an error with what its messages say, taken from the tests that trigger them.

    errors.py            prints the page
    errors.py --write    writes it
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/errors.md"
ID = r"(?:slom|mtk)(?:\.[a-z0-9]+(?:-[a-z0-9]+)*)+"
MOST_MESSAGES = 4  # of one id
BY_HAND = {  # whose tests compare the text in parts
    "slom.checkpoint": ("state: no checkpoint is there", "give the folder of --checkpoint of an earlier run"),
    "slom.needs-all": ("this analysis needs the whole problem, but each of the processes that fit it has a part",
                       "read the fitted values in a single process and analyse them there"),
    "slom.no-session": ("there is no slom::distributed::Session", "make one at the beginning of main()"),
    "slom.petsc": ("PETSc failed with code 55 (Out of memory)", "check its options (PETSC_OPTIONS) and the memory of the machine"),
    "slom.petsc-option": ("-slom_matrix fre: unknown form of the matrix", "give free or assembled"),
    "slom.no-unknowns": ("the covariance of variable pose 3: no measurement of this process depends on it", "ask in a process that has some"),
    "slom.not-asked": ("the covariance of variable pose 3: not computed", "pass it to the constructor"),
    "slom.io.bad-scene": ("scene.txt: point 1 has no observation, so nothing determines it", "add observations, or remove it"),
    "slom.io.no-parts": ("scene.txt.bz2: compressed by bzip2, so no part can be read without the rest", "decompress it"),
    "slom.io.no-vertices": ("map.g2o: the file has no vertices, which several processes need as start values",
                            "fit it in one process, or add vertices"),
    "slom.calibration.no-pose": ("left.csv: 3 images that camera right shares with camera left give no finite pose between the two",
                                 "look for corners and world points that are wrong"),
    "slom.calibration.no-motion": ("imu0.csv: the angular velocities and the turns of the cameras correlate by 0.21 at best, so their clocks cannot be "
                                   "compared",
                                   "give images and readings of the same motion, with quick turns about all axes"),
    "slom.calibration.no-start": ("left.csv: no start values were found at which the lens sees all corners",
                                  "look for corners that are far off, or leave them out by Settings::robust"),
    "slom.calibration.too-few-data": ("left.csv: the corners give 16 numbers for 21 unknowns of the model opencv5",
                                      "add images or corners, or choose a model with fewer parameters"),
    "slom.calibration.unconnected": ("right.csv:2: no common images connect camera right with camera left, not even through other cameras",
                                     "take images of the board with both at the same time, or calibrate them separately"),
    "slom.calibration.unknown-model": ("fish: the models are pinhole, opencv4, ...", ""),
    "slom.calibration.nothing-to-exclude": ("exclusion left.17: that camera has no image 17", "the nearest are 15, 16, 18"),
    "slom.bad-tape": ("the tape reads register 60000 in instruction 0, which has no value", "write it again with the program that made it"),
    "slom.traced-too-long": ("a traced measurement function needs more than 65535 numbers at once",
                             "split the measurement, or pass the function without slom::traced"),
    "slom.bad-kernels": ("the environment variable SLOM_KERNELS is \"neon\", which names no kernels",
                         "set it to avx512, avx2 or sse2, or unset it"),
    "slom.cannot-write": ("the plot could not be written to plots/decay.svg", "check that its folder exists and is writable"),
    "slom.free-gauge": ("the gauge is free, so there are no covariances. All 5 points can move together without changing any residual",
                        "fix enough of them, or add priors"),
    "slom.undetermined-start": ("the linear systems of chordal relaxation cannot be solved, because the weights of the edges differ too much",
                                "start along a spanning tree"),
    "slom.unmeasured-variable": ("no measurement depends on variable lonely, so nothing determines it",
                                 "add measurements or fix it with fix(id)"),
}
BY_HAND_PYTHON = {  # of the Python package
    "slom.ambiguous-rows": ("argument 3 of the measurement function has one dimension, so it is 2 rows of one number each, but a vector of 2 numbers "
                            "meets it there", "pass x[None] for one row with the vector x, or x[:, None] for 2 rows"),
    "slom.bad-argument": ("a key of a group is a NoneType", "pass integers or strings"),
    "slom.bad-operand": ("an SO3 is compared with a value of type float", "compare it with another SO3"),
    "slom.bad-residual": ("the measurement function returned None", "end it with `return` and the residual"),
    "slom.bad-value": ("the start value of x has a number that is not finite", "pass finite numbers"),
    "slom.cannot-read": ("the file problem.slom cannot be read", "check its name and permissions"),
    "slom.float-index": ("data are passed as floats, which are no indices",
                         "write int(k), or look up data before est.measure and pass the result"),
    "slom.in-use": ("the estimator is in the middle of another call, such as a fit, from another thread or from the function that calls this now",
                    "wait for its end, or use a copy made by est.clone()"),
    "slom.command-failed": ("slom graph ended by signal 9 and no message", "please report it"),
    "slom.no-command": ("the program slom is not at slom/bin/slom, because the package was built without it",
                        "install the libraries that docs/start/install.md lists for the command, and build the package again"),
    "slom.no-readers": ("town.g2o: this package was built without the readers of files", "install fmt, and build it with SLOM_BUILD_IO"),
    "slom.not-fitted": ("the curve is not fitted: iteration limit reached", "pass better start values p0"),
    "slom.not-picklable": ("an estimator cannot be pickled", "write it by est.save(file) and read it by slom.load(file), or copy it by est.clone()"),
    "slom.same-name": ("several fitted components are called x, but these values are found by name", "give each variable its own name"),
    "slom.too-large": ("the joint covariance of 59997 components is too large to compute",
                       "take x.covariance of variables and arrays of variables, or est.covariance([a, b]) of some"),
    "slom.traced-comparison": ("an SE3 of recorded numbers is compared by ==", "compare numbers of a - b by < or slom.where"),
    "slom.traced-differs": ("the measurement function model gives 1.0 where its recorded formula gives 2.0, so it depends on more than its arguments, "
                            "or branches", "pass all it depends on as arguments, and write slom.where in place of `if`"),
    "slom.wrong-jacobian": ("the function `jacobian` returns an array of shape (2, 3) for 1 residuals and 1 components of the variables",
                            "return the shape (1, 1), or a list with a block for each variable"),
    "slom.wrong-length": ("the measurement function returns 3 numbers for row 7 and 2 for row 0",
                          "return the same number for each row, or measure the rows in several calls"),
    "slom.wrong-shape": ("sigma has the shape (2,) for 3 rows with residuals of length 1", "pass a number, or one for each row (3,)"),
}
LITERAL = r'"(?:[^"\\\n]|\\.)*"'
LITERALS = re.compile(rf"{LITERAL}(?:\s*{LITERAL}|\s*\+\s*[a-z_]+\s*\+\s*{LITERAL})*")  # with names of variables between them
HEADINGS = [("mtk.", "Manifolds"), ("slom.calibration.", "Calibration"), ("slom.io.", "Files"), ("slom.", "Estimator")]
TEXT = """# Errors

What a caller does wrong is an exception, `mtk::Error`, from which `slom::calibration::DataError` and `slom::initialize::Unreached` derive. Its
text is one sentence: `[id] fault; remedy`. The id is stable between versions, so that a program can branch on `error.id()`;
`error.subject()` names the variable, measurement, option or file, and `error.remedy()` is what stands after the last semicolon. After an
exception the estimator is as it was before the call; if a measurement function throws during a fit, the values are the best ones reached. What
goes wrong in a fit for numerical reasons is no exception, but a `stop_reason` and a
message of the summary.

The messages are those of the tests that trigger them; `docs/site/errors.py --write` writes this page. Names and numbers are examples.
"""


def unescaped(literal):
    return literal.replace('\\"', '"').replace("\\n", "\n").replace("\\\\", "\\")


def messages(source):
    """(id, sentence) of all messages that stand whole in a source."""
    for match in LITERALS.finditer(source):
        joined = re.sub(rf'"\s*\+\s*[a-z_]+\s*\+\s*"', "...", match.group(0))
        whole = unescaped("".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', joined)))
        found = re.match(rf"\[({ID})\] (.+)$", whole, re.DOTALL)
        is_whole = not re.match(r"\s*(\+|<<)", source[match.end():match.end() + 40])
        if found and is_whole and "\n" not in found.group(2) and not re.search(r"\\|\.\*|\{\}|[ (]$", found.group(2)):
            yield found.group(1), found.group(2)


def all_messages():
    """{id: its messages, those of the first tests first}"""
    found = {}
    for path in sorted((ROOT / "tests").rglob("*.cpp")):
        for name, sentence in messages(path.read_text(encoding="utf-8")):
            if sentence not in found.setdefault(name, []) and not name.startswith("slom.example"):
                found[name].append(sentence)
    return {name: sentences for name, sentences in found.items() if sentences}


def python_messages():
    """{id: its messages} of the tests of the Python package"""
    found = {}
    source = (ROOT / "tests/python/numpy_test.py").read_text(encoding="utf-8")
    for name, sentence in re.findall(rf"^\[({ID})\] ((?:.*\\\n)*.*)$", source, re.MULTILINE):
        found.setdefault(name, []).append(sentence.replace("\\\n", "").replace("NAME", "np.sort"))
    return found


def ids_of_python():
    """The ids of the Python package."""
    found = set()
    for path in (ROOT / "python").rglob("*.*"):
        if path.suffix in (".cpp", ".hpp", ".py"):
            source = path.read_text(encoding="utf-8")
            found.update(re.findall(rf'Error\(\s*"({ID})"', source) + re.findall(rf'"\[({ID})\] ', source))
    return found


def ids_of_sources():
    """The ids that stand whole in the sources of the libraries and of the command."""
    found = ids_of_python()
    for folder in ("include", "src", "apps"):
        for path in (ROOT / folder).rglob("*.[ch]pp"):
            found.update(re.findall(rf'"({ID})"', path.read_text(encoding="utf-8")))
    return found


def escaped(words):
    return re.sub(r"([\\|*_<>`\[\]])", r"\\\1", words)


def parts(sentence):
    fault, separator, remedy = sentence.rpartition("; ")
    return (fault, remedy) if separator else (sentence, "")


def entry(name, rows):
    text = f"\n### {name}\n\n| fault | remedy |\n| --- | --- |\n"
    return text + "".join(f"| {escaped(fault)} | {escaped(remedy)} |\n" for fault, remedy in rows)


def page():
    known = {name: [] for name in BY_HAND} | all_messages()
    text = TEXT
    listed = set()
    for prefix, heading in HEADINGS:
        names = sorted(name for name in known if name.startswith(prefix) and name not in listed)
        listed.update(names)
        text += f"\n## {heading}\n"
        for name in names:
            text += entry(name, [parts(sentence) for sentence in known[name][:MOST_MESSAGES]] or [BY_HAND[name]])
    python = BY_HAND_PYTHON | python_messages()
    text += "\n## Python\n\nThe errors of the [Python package](python.md). It raises those above as well.\n"
    for name in sorted(python.keys() - listed):
        text += entry(name, [python[name]] if name in BY_HAND_PYTHON else map(parts, python[name][:MOST_MESSAGES]))
    return text


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        PAGE.write_text(page(), encoding="utf-8")
    else:
        print(page(), end="")
