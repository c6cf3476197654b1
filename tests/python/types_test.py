"""The types of the package, by mypy: the examples pass with --strict, the stub of the module is complete, and the package agrees
with it. Exit code 77 if mypy is not installed."""

import ast
import importlib.util
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import slom

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = Path(slom.__file__).parent
if importlib.util.find_spec("mypy") is None:
    print("skipped: needs mypy in this environment of Python")
    sys.exit(77)


def arguments(function):
    """The names of the arguments that are passed by name, and the number of the others."""
    all = function.args
    return [a.arg for a in all.args + all.kwonlyargs], len(all.posonlyargs), all.vararg is not None


class Types(unittest.TestCase):
    def check(self, *arguments):
        with tempfile.TemporaryDirectory() as cache:
            run = subprocess.run(
                [sys.executable, "-m", "mypy", "--cache-dir", cache, "--no-error-summary", *map(str, arguments)],
                capture_output=True,
                text=True,
                env={**os.environ, "MYPYPATH": str(PACKAGE.parent)},
            )
        return run.stdout + run.stderr

    def test_examples_are_strict(self):
        self.assertEqual(self.check("--strict", "--follow-imports=silent", *sorted(ROOT.glob("examples/python/*.py"))), "")

    def test_stub_is_complete(self):
        self.assertEqual(self.check("--follow-imports=silent", PACKAGE / "_slom.pyi"), "")

    def test_stub_has_the_arguments_of_the_module(self):
        """python/stub_patterns.txt writes some signatures out. The module has all of them."""
        tree, seen = ast.parse((PACKAGE / "_slom.pyi").read_text()), 0
        for owner in [tree, *(node for node in tree.body if isinstance(node, ast.ClassDef))]:
            place = slom._slom if owner is tree else getattr(slom._slom, owner.name)
            for node in owner.body:
                signatures = getattr(getattr(place, getattr(node, "name", ""), None), "__nb_signature__", ())
                if not isinstance(node, ast.FunctionDef) or node.decorator_list or len(signatures) != 1:
                    continue
                if node.name.startswith("__"):
                    continue
                text = re.sub(r"= \\=?\d+", "= 0", signatures[0][0])
                text = re.sub(r"numpy\.ndarray\[[^]]*\]", "object", text)
                self.assertEqual(arguments(node), arguments(ast.parse(text + ": ...").body[0]), text)
                seen += 1
        self.assertGreater(seen, 50)

    def test_package_agrees_with_the_stub(self):
        self.assertEqual(self.check("--ignore-missing-imports", "-p", "slom"), "")

    def test_mistakes_are_found(self):
        program = """
import numpy as np
import slom
est = slom.Estimator()
x = est.variable(1.0, "x")
est.measure(lambda x: x, x, sigma=0.1, nam="x")
y: str = slom.SE3([1, 2, 3]).pos
slom.SE2(1, 2, 3) * slom.SE3()
reveal_type(slom.SE3() * slom.SE3())
reveal_type(slom.SO3() * np.zeros(3))
reveal_type(est.profile(x).lower)
reveal_type([x.name for x in est.variables([1.0])])
"""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "program.py"
            file.write_text(program)
            said = self.check("--strict", "--follow-imports=silent", file)
        for line, words in [
            (6, 'Unexpected keyword argument "nam"'),
            (7, "Incompatible types in assignment"),
            (8, "No overload variant"),
            (9, "slom._slom.SE3"),
            (10, "ndarray"),
            (11, "float"),
            (12, "list[str]"),
        ]:
            self.assertTrue(any(f"py:{line}: " in one and words in one for one in said.splitlines()), (words, said))


if __name__ == "__main__":
    unittest.main()
