"""Messages of the library name functions of Python: words_test.py. Reads the catalogue of errors, which is made of the
sources and tests of C++."""

import pathlib
import re
import sys
import unittest

from slom._words import in_python

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs/site"))
import errors  # noqa: E402

CPP = re.compile(
    r"::|\b(VarID|AnyVarID|MeasID|insertRV|insertMeasurement|setSigma|setFreeGauge|changeAlgorithm|changeSolver"
    r"|GaussNewton|checkDerivatives|LevenbergMarquardt|DogLeg|BlockQR|DenseQR|RuntimeValue)\b"
)
# What Python has not, so that its users cannot meet the message.
NOT_IN_PYTHON = re.compile(
    r"slom\.calibration|SharedError|changeAlgorithm|changeSolver|ForwardingSolver|RuntimeValue|GaussianPrior over|DogLeg"
    r"|a measurement over a list|the measurement over a list|no-parameters|std::exception|refers to no "
)


class Words(unittest.TestCase):
    def test_no_message_names_cpp(self):
        count = 0
        for name, texts in errors.all_messages().items():
            for text in [texts] if isinstance(texts, str) else texts:
                said = f"[{name}] {text}"
                if NOT_IN_PYTHON.search(said):
                    continue
                count += 1
                self.assertIsNone(CPP.search(in_python(text)), in_python(text))
        self.assertGreater(count, 100)

    def test_examples(self):
        for cpp, python in [
            ("add measurements or fix it with fix(id)", "add measurements or fix it with x.fix()"),
            ("setSigma(slom::Sigma::estimated) takes it", 'est.sigma = "estimated" takes it'),
            ('there are day, as in {.by = {"day"}}', 'there are day, as in by="day"'),
            (
                "the VarID<vect<2>> refers to a variable that has been removed; keep the VarID that insertRV returned last",
                "the variable has been removed from its estimator; use one that est.variable returned",
            ),
            ("a text without such words (pose) of f(x)", "a text without such words (pose) of f(x)"),
        ]:
            self.assertEqual(in_python(cpp), python)


if __name__ == "__main__":
    unittest.main()
