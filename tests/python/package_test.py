"""The package slom: the circle of the README, and what NumPy does with recorded numbers. Every measurement function is
also called with plain numbers: the residuals must be equal."""

import importlib.util
import math
import unittest

import numpy as np

import slom

POINTS = np.array([[3.9, 1.0], [3.1, 3.2], [1.0, 4.1], [-1.1, 3.0], [-2.0, 1.1], [-1.2, -1.1], [0.9, -2.0]])


class Circle(unittest.TestCase):
    def test_is_fitted_as_in_cpp(self):
        est = slom.Estimator()
        centre, radius = est.variable([0, 0], "centre"), est.variable(1.0, "radius")
        count = est.measure(lambda c, r, p: np.linalg.norm(p - c) - r, centre, radius, POINTS, sigma=0.1)
        fit = est.optimize()
        self.assertEqual(len(count), 7)
        self.assertTrue(fit.converged)
        np.testing.assert_allclose(centre.value, [0.9888952, 1.0114304], atol=1e-7)
        np.testing.assert_allclose(centre.std, [0.0547, 0.0551], atol=1e-4)
        self.assertAlmostEqual(radius.value, 2.9955496, places=7)
        self.assertAlmostEqual(radius.std, 0.0389, places=4)
        self.assertIn("exact", str(fit))


class Recording(unittest.TestCase):
    """Functions of a vector x of three numbers and a row p of three."""

    x = np.array([0.4, -1.3, 2.1])
    p = np.array([1.7, 0.6, -0.9])

    def check(self, f):
        est = slom.Estimator()
        x = est.variable(self.x, "x")
        est.measure(f, x, self.p[None, :])
        expected = np.atleast_1d(np.asarray(f(self.x, self.p), float)).ravel()
        np.testing.assert_allclose(est.residuals(), expected, rtol=1e-13, atol=1e-14)

    def test_signs(self):
        self.check(lambda x, p: p - x)
        self.check(lambda x, p: x - p)
        self.check(lambda x, p: np.array([1.0, 2.0, 3.0]) - x)
        self.check(lambda x, p: x[0] - np.array([1.0, 2.0, 3.0]))
        self.check(lambda x, p: np.array([1.0, 2.0, 3.0]) - x[0])
        self.check(lambda x, p: np.float64(2) - x[0])
        self.check(lambda x, p: 3 / x[1] - x[1] / 3)

    def test_arrays(self):
        def skew(v):
            return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])

        self.check(lambda x, p: skew(x) @ p)
        self.check(lambda x, p: skew(x).T.dot(p) - np.cross(x, p))
        self.check(lambda x, p: np.stack([x, p]))
        self.check(lambda x, p: np.concatenate([x[:2], p[1:]]))
        self.check(lambda x, p: np.sum(x * p))
        self.check(lambda x, p: x[np.array([True, False, True])])
        self.check(lambda x, p: [x[0], p[1] * x[2]])
        self.check(lambda x, p: np.einsum("i,i->", x, p))

    def test_functions(self):
        for name in ("sqrt", "sin", "cos", "tan", "arctan", "exp", "expm1", "tanh", "sinh", "cosh", "abs", "square"):
            f = getattr(np, name)
            self.check(lambda x, p: f(p * 0.3 + 1 + 0.1 * x * x))
        self.check(lambda x, p: np.log(x * x) + np.log1p(x * x) + np.arcsin(x / 9) + np.arccos(p * x / 9))
        self.check(lambda x, p: np.hypot(x, p))
        self.check(lambda x, p: np.arctan2(x, p))
        self.check(lambda x, p: np.linalg.norm(x - p))
        self.check(lambda x, p: x**2 + abs(x) ** 1.5 + 2.0 ** x)
        self.check(lambda x, p: slom.where(x > p, x, p))

    def test_captured_numbers(self):
        """Each lambda of a loop has its own number, by value and by name."""
        est = slom.Estimator()
        x = est.variable(0.0, "x")
        for k in range(3):
            est.measure(lambda x, k=k: x - k, x)
            est.measure(lambda x: x - 10 * k, x)
        np.testing.assert_allclose(sorted(-est.residuals()), [0, 0, 1, 2, 10, 20])

    def test_captured_numbers_share_a_tape(self):
        """Only the tape of the first lambda is made: that takes most of the time of a call."""
        est = slom.Estimator()
        x = est.variable([0.1, 0.2], "x")
        for k in range(300):
            number, vector = 3.5 + k, np.array([k + 0.25, -k - 0.75])
            est.measure(lambda x: np.sin(x * number) - vector * 1.5 + x[0] ** 3, x, trace=True)
        k = np.arange(300)[:, None]
        expected = np.sin([0.1, 0.2] * (3.5 + k)) - 1.5 * np.concatenate([k + 0.25, -k - 0.75], axis=1) + 0.001
        np.testing.assert_allclose(est.residuals(), expected.ravel(), rtol=1e-13)
        self.assertEqual(slom._slom._count_tapes(est), 1)

    def refused(self, f, *words):
        est = slom.Estimator()
        x = est.variable(self.x, "x")
        with self.assertRaises(slom.Error) as raised:
            est.measure(f, x, self.p[None, :], trace=True)
        for word in words:
            self.assertIn(word, str(raised.exception))

    def test_values_are_not_known(self):
        self.refused(lambda x, p: x if x[0] > 0 else -x, "branch")
        self.refused(lambda x, p: float(x[0]), "value", "slom.array")
        self.refused(lambda x, p: math.sin(x[0]), "value")
        self.refused(lambda x, p: "text", "str")
        self.refused(lambda x, p: None, "NoneType")


@unittest.skipUnless(importlib.util.find_spec("scipy"), "needs SciPy")
class SciPy(unittest.TestCase):
    def test_special_functions(self):
        from scipy import special

        anywhere = np.array([0.0, 0.3, -2.0, 5.0, -30.0, 30.0])
        within = np.array([0.1, 0.5, 0.9, 1e-9, 0.999, 0.2])
        for name, at in [("erf", anywhere), ("erfc", anywhere), ("expit", anywhere), ("ndtr", anywhere), ("logit", within)]:
            with self.subTest(function=name):
                f = getattr(special, name)
                est = slom.Estimator()
                x = est.variable(at, "x")
                m = est.measure(lambda x: f(x), x, trace=True)
                np.testing.assert_allclose(m.residuals[0], f(at), rtol=1e-13)
                self.assertTrue(est.check_derivatives().ok)
        est = slom.Estimator()
        x = est.variable(np.array([0.0, 2.0]), "x")
        m = est.measure(lambda x: [*special.xlogy(x, x + 3), special.xlogy(x[0], x[0])], x, trace=True)
        np.testing.assert_allclose(m.residuals[0], [0, 2 * np.log(5), 0], rtol=1e-13)

    def test_rotations(self):
        from scipy.spatial.transform import Rotation

        v = np.array([0.1, -0.2, 0.3])
        np.testing.assert_allclose(slom.SO3(Rotation.from_rotvec(v)).log(), v, rtol=1e-14)


class BadInput(unittest.TestCase):
    def test_one_sentence_each(self):
        est = slom.Estimator()
        x = est.variable(0.0, "x")
        for arguments, words in [
            ((x, np.array([1.0, math.nan])), "not finite"),
            ((x, np.array([1.0, "a"], object)), "objects"),
            ((x, [1.0, 2.0], [1.0, 2.0, 3.0]), "rows"),
        ]:
            with self.assertRaises(slom.Error) as raised:
                est.measure(lambda x, *p: x, *arguments)
            self.assertIn(words, str(raised.exception))
        with self.assertRaises(slom.Error):
            est.variable([1.0, math.inf])
        self.assertEqual(est.residuals().size, 0)


if __name__ == "__main__":
    unittest.main()
