"""NIST's problems of nonlinear regression, from both starts of each, against the certified values: 54 fits, with models
in plain Python."""

import os
import re
import unittest
from pathlib import Path

import numpy as np
from numpy import cos, exp, pi, sin

import slom

FOLDER = Path(os.environ.get("SLOM_SHARED_DATA", "")) / "nist"


def cycle(x, c, s, period):
    return c * cos(2 * pi * x / period) + s * sin(2 * pi * x / period)


def gauss(x, b):
    first, second = b[2] * exp(-(((x - b[3]) / b[4]) ** 2)), b[5] * exp(-(((x - b[6]) / b[7]) ** 2))
    return b[0] * exp(-b[1] * x) + first + second


def lanczos(x, b):
    return b[0] * exp(-b[1] * x) + b[2] * exp(-b[3] * x) + b[4] * exp(-b[5] * x)


def rational(x, b):
    return (b[0] + x * (b[1] + x * (b[2] + x * b[3]))) / (1 + x * (b[4] + x * (b[5] + x * b[6])))


MODELS = {
    "Bennett5": lambda x, b: b[0] * (b[1] + x) ** (-1 / b[2]),
    "BoxBOD": lambda x, b: b[0] * (1 - exp(-b[1] * x)),
    "Chwirut1": lambda x, b: exp(-b[0] * x) / (b[1] + b[2] * x),
    "Chwirut2": lambda x, b: exp(-b[0] * x) / (b[1] + b[2] * x),
    "DanWood": lambda x, b: b[0] * x ** b[1],
    "ENSO": lambda x, b: b[0] + cycle(x, b[1], b[2], 12) + cycle(x, b[4], b[5], b[3]) + cycle(x, b[7], b[8], b[6]),
    "Eckerle4": lambda x, b: b[0] / b[1] * exp(-0.5 * ((x - b[2]) / b[1]) ** 2),
    "Gauss1": gauss,
    "Gauss2": gauss,
    "Gauss3": gauss,
    "Hahn1": rational,
    "Kirby2": lambda x, b: (b[0] + x * (b[1] + x * b[2])) / (1 + x * (b[3] + x * b[4])),
    "Lanczos1": lanczos,
    "Lanczos2": lanczos,
    "Lanczos3": lanczos,
    "MGH09": lambda x, b: b[0] * x * (x + b[1]) / (x * (x + b[2]) + b[3]),
    "MGH10": lambda x, b: b[0] * exp(b[1] / (x + b[2])),
    "MGH17": lambda x, b: b[0] + b[1] * exp(-x * b[3]) + b[2] * exp(-x * b[4]),
    "Misra1a": lambda x, b: b[0] * (1 - exp(-b[1] * x)),
    "Misra1b": lambda x, b: b[0] * (1 - 1 / (1 + b[1] * x / 2) ** 2),
    "Misra1c": lambda x, b: b[0] * (1 - (1 + 2 * b[1] * x) ** -0.5),
    "Misra1d": lambda x, b: b[0] * b[1] * x / (1 + b[1] * x),
    "Nelson": lambda x, b: b[0] - b[1] * x[0] * exp(-b[2] * x[1]),
    "Rat42": lambda x, b: b[0] / (1 + exp(b[1] - b[2] * x)),
    "Rat43": lambda x, b: b[0] / (1 + exp(b[1] - b[2] * x)) ** (1 / b[3]),
    # The branch of the arc tangent that is smooth where x = b4, as in the file.
    "Roszman1": lambda x, b: b[0] - b[1] * x - np.arctan2(b[2], x - b[3]) / pi,
    "Thurber": rational,
}


class Problem:
    def __init__(self, name):
        text = (FOLDER / f"{name}.dat").read_text()
        table = re.findall(r"^\s*b\d+ =\s+(\S+)\s+(\S+)\s+(\S+)\s+(\S+)", text, re.M)
        numbers = np.array(table, float)
        self.starts, self.parameters, self.deviations = numbers[:, :2].T, numbers[:, 2], numbers[:, 3]
        self.rss = float(re.search(r"Sum of Squares:\s+(\S+)", text)[1])
        lines = text[text.rindex("Data:") :].splitlines()[1:]
        data = np.array([line.split() for line in lines if line.split()], float)
        self.y, self.x = data[:, 0], data[:, 1] if data.shape[1] == 2 else data[:, 1:]
        if name == "Nelson":
            self.y = np.log(self.y)


def digits(values, certified):
    return -np.log10(np.max(np.abs(values - certified) / np.abs(certified)) + 1e-16)


@unittest.skipUnless(FOLDER.is_dir(), "NIST's data are not here")
class Certified(unittest.TestCase):
    def test_values_and_deviations_from_both_starts(self):
        for name, model in MODELS.items():
            problem = Problem(name)
            for start in problem.starts:
                with self.subTest(problem=name, start=start):
                    est = slom.Estimator()
                    est.sigma = "estimated"
                    b = est.variable(start, "b")
                    est.measure(lambda b, x: model(x, b), b, problem.x, measured=problem.y, name=name, trace=True)
                    fit = est.optimize()
                    self.assertTrue(fit.converged, fit)
                    self.assertGreaterEqual(digits(b.value, problem.parameters), 8, fit)
                    exact = name == "Lanczos1"  # data of 14 digits: the residuals are rounding errors
                    self.assertGreaterEqual(digits(b.std, problem.deviations), 2 if exact else 6, fit)
                    self.assertGreaterEqual(digits(np.array([est.rss]), problem.rss), 2 if exact else 8, fit)
        self.assertEqual(len(MODELS), 27)


if __name__ == "__main__":
    unittest.main()
