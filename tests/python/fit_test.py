"""Whole fits from Python: types of variables, noise, losses, groups, analyses, functions that cannot be recorded."""

import copy
import os
import pathlib
import pickle
import signal
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np

import slom

SEED = int(time.time()) % 100000
print("seed", SEED)


def rotation(rng, size=1.0):
    return slom.SO3.exp(size * rng.normal(size=3))


def pose(rng):
    return slom.SE3(rng.normal(size=3), rotation(rng))


@slom.manifold
class Camera:
    pose: slom.SE3
    focal_length: float
    distortion: np.ndarray


class Manifolds(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(SEED)

    def test_operators_agree_with_matrices(self):
        for _ in range(20):
            a, b, p = pose(self.rng), pose(self.rng), self.rng.normal(size=3)
            np.testing.assert_allclose((a * b).matrix(), a.matrix() @ b.matrix(), atol=1e-14)
            np.testing.assert_allclose((a @ b.inverse()).matrix(), a.matrix() @ np.linalg.inv(b.matrix()), atol=1e-13)
            np.testing.assert_allclose(a * p, a.matrix()[:3, :3] @ p + a.pos, atol=1e-14)
            points = self.rng.normal(size=(4, 5, 3))
            np.testing.assert_allclose(a * points, points @ a.orient.matrix().T + a.pos, atol=1e-13)
            np.testing.assert_allclose((b.boxplus(a.boxminus(b))).matrix(), a.matrix(), atol=1e-13)
            np.testing.assert_allclose((b + (a - b)).matrix(), a.matrix(), atol=1e-13)
            plane = slom.SE2(1.0, 2.0, 0.3)
            np.testing.assert_allclose(slom.SE2(plane.matrix()).matrix(), plane.matrix(), atol=1e-15)
            np.testing.assert_allclose(slom.SO3(a.orient.matrix()).matrix(), a.orient.matrix(), atol=1e-14)
            np.testing.assert_allclose((slom.SE3(orient=a.orient) * slom.SE3(a.pos)).pos, a.orient * a.pos, atol=1e-14)

    def test_hard_points(self):
        for angle in (0.0, 1e-300, 1e-9, np.pi, np.pi - 1e-9):
            v = angle * np.array([0.6, 0.0, 0.8])
            np.testing.assert_allclose(slom.SO3.exp(v).log(), v, atol=1e-15 + 1e-7 * (angle > 3))
        self.assertEqual((slom.S2([0, 0, -1]) - slom.S2([0, 0, 1]))[0], np.pi)
        with self.assertRaisesRegex(slom.Error, "no-rotation"):
            slom.SO3(0, 0, 0, 0)
        with self.assertRaisesRegex(slom.Error, "points of 3 numbers"):
            slom.SO3() * [1.0, 2.0]
        with self.assertRaisesRegex(slom.Error, "pass the quaternion"):
            slom.SO3("text", 2)

    def test_equality_is_that_of_values(self):
        for x in (slom.SO2(0.3), rotation(self.rng), slom.S2(1, 2, 3), slom.SE2(1, 2, 0.3), pose(self.rng)):
            self.assertTrue(x == copy.copy(x))
            self.assertFalse(x == x + np.full(np.size(x - x), 1e-9))
            self.assertFalse(x == "text")
            self.assertTrue(x != 3.0)
        est = slom.Estimator()
        all = est.variables(np.zeros((3, 2)), "x")
        self.assertTrue(all[1] == all[1] and all[1] != all[2] and all[1] in [all[0], all[1]])
        self.assertEqual(len({all[0], all[0], all[1]}), 2)
        with self.assertRaisesRegex(slom.Error, "compared by =="):
            est.measure(lambda T: 1.0 if T == slom.SE3() else 2.0, est.variable(slom.SE3(), "T"), trace=True)

    def test_own_manifolds_have_perturbations(self):
        camera = Camera(pose(self.rng), 500.0, self.rng.normal(size=2))
        d = 0.3 * self.rng.normal(size=9)  # rotations below pi: boxminus returns the shortest
        moved = camera + d
        np.testing.assert_allclose(moved - camera, d, atol=1e-12)
        np.testing.assert_allclose(camera.boxplus(d) - moved, 0, atol=1e-15)
        with self.assertRaisesRegex(slom.Error, "needs 9 numbers"):
            camera + d[:8]
        rows = pickle.loads(pickle.dumps(slom.Rows([camera, moved])))
        np.testing.assert_allclose(rows[1] - moved, 0, atol=1e-12)
        np.testing.assert_allclose((rows - rows[0])[1], d, atol=1e-12)

    def test_values_are_copied_and_pickled(self):
        for x in (slom.SO2(0.3), rotation(self.rng), slom.S2(1, 2, 3), slom.SE2(1, 2, 0.3), pose(self.rng)):
            for y in (copy.deepcopy(x), pickle.loads(pickle.dumps(x))):
                np.testing.assert_allclose(x - y, 0, atol=1e-15)

    def functions(self):
        """Start values and functions of them: operators of all types, and their hard points."""
        rng = self.rng
        a, b, p, R = pose(rng), pose(rng), rng.normal(size=3), rotation(rng)
        camera = Camera(pose(rng), 500.0, rng.normal(size=2))
        opposite = slom.SO3.exp([np.pi, 0, 0])
        return [
            ((a, b), lambda a, b: (a.inverse() * b).boxminus(slom.SE3(p, R))),
            ((a, b), lambda a, b: [a.orient.log(), (a * b * p), (a.orient * b).pos]),
            ((a, p), lambda a, p: a.inverse() * p),
            ((a,), lambda a: slom.SE3(a.pos, a.orient) - b),
            ((R, p), lambda R, p: R * slom.SO3.exp(p) * slom.S2(0, 0, 1) - slom.S2(0.1, 0.2, 0.3)),
            ((R, R), lambda R, S: R.boxminus(S)),
            ((opposite,), lambda R: R.matrix()),
            ((slom.S2(1, 2, 3), R), lambda d, R: R * d.vector),
            ((slom.SE2(1, 2, 3.1), slom.SE2(0, 1, -3.1)), lambda a, b: (a.inverse() * b) - slom.SE2(1, 1, 0.1)),
            ((slom.SO2(3.0), 2.0), lambda R, t: [(R + t).angle, R * np.array([t, 1.0])]),
            ((camera,), lambda c: c.focal_length * (c.pose * p)[:2] + c.distortion),
            ((rng.normal(size=30), rng.normal(size=(2, 3))), lambda x, m: m @ x[:3] + x[27:29]),
        ]

    def test_recorded_functions_give_values_and_derivatives_of_plain_ones(self):
        for i, (values, f) in enumerate(self.functions()):
            with self.subTest(function=i, seed=SEED):
                est = slom.Estimator()
                variables = [est.variable(x) for x in values]
                recorded = est.measure(f, *variables, trace=True)
                plain = est.measure(f, *variables, trace=False)
                np.testing.assert_allclose(recorded.residuals, plain.residuals, atol=1e-13)
                self.assertTrue(est.check_derivatives().ok, est.check_derivatives())


class Fits(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(SEED)

    def bundle(self):
        """Cameras that see points: returns the estimator, both arrays of variables, and the true points."""
        truth, eyes = self.rng.normal(size=(20, 3)), [pose(self.rng) for _ in range(3)]
        i, j = np.repeat(np.arange(3), 20), np.tile(np.arange(20), 3)
        seen = np.array([eyes[k] * truth[m] for k, m in zip(i, j)])
        est = slom.Estimator()
        cameras = est.variables([eye + 0.05 * self.rng.normal(size=6) for eye in eyes], "camera")
        points = est.variables(truth + 0.1 * self.rng.normal(size=truth.shape), "point")
        cameras[0].value = eyes[0]
        cameras[0].fix()
        est.measure(lambda c, p: c * p, cameras[i], points[j], measured=seen, sigma=0.01, name="sighting")
        return est, cameras, points, truth

    def test_variables_by_row(self):
        est, cameras, points, truth = self.bundle()
        fit = est.optimize()
        self.assertTrue(fit.converged, fit)
        np.testing.assert_allclose(points.value, truth, atol=1e-7)
        self.assertEqual(points.std.shape, (20, 3))
        np.testing.assert_allclose(points.std[4], points[4].std, rtol=1e-9)
        self.assertEqual(cameras.value.pos.shape, (3, 3))
        self.assertIn("camera[1]", repr(cameras[1]))
        self.assertEqual(len(cameras[np.array([True, False, True])]), 2)
        copied = est.clone()
        copied.own(points[0]).value = [9.0, 9, 9]
        np.testing.assert_allclose(points[0].value, truth[0], atol=1e-7)

    def test_marginalised_variables_leave_what_they_know(self):
        est, cameras, points, _ = self.bundle()
        est.optimize()
        before = cameras[1].covariance
        est.marginalize(points)
        np.testing.assert_allclose(cameras[1].covariance, before, rtol=1e-6, atol=1e-14)
        window = slom.FixedLag(variables=1)
        window.add(cameras[1])
        window.add(cameras[2])
        self.assertEqual(window.forget(est), 1)
        self.assertEqual(len(window), 1)

    def line(self, **options):
        x = np.linspace(0, 1, 12)
        est = slom.Estimator()
        a, b = est.variable(0.0, "a"), est.variable(0.0, "b")
        measurements = est.measure(lambda a, b, x: a + b * x, a, b, x, measured=2 + 3 * x + 0.1 * np.cos(9 * x), **options)
        est.optimize()
        A = np.stack([np.ones_like(x), x], axis=1)
        return est, a, b, measurements, A

    def test_noise_is_that_of_weighted_least_squares(self):
        sigma = self.rng.uniform(0.1, 1, size=12)
        for options, W in [
            ({"sigma": 0.5}, np.eye(12) / 0.25),
            ({"sigma": sigma}, np.diag(sigma**-2)),
            ({"sigma": sigma[:, None]}, np.diag(sigma**-2)),
            ({"covariance": sigma}, np.diag(1 / sigma)),
            ({"information": sigma[:, None, None]}, np.diag(sigma)),
        ]:
            est, a, b, _, A = self.line(**options)
            np.testing.assert_allclose(est.covariance([a, b]), np.linalg.inv(A.T @ W @ A), rtol=1e-10)
            y = 2 + 3 * A[:, 1] + 0.1 * np.cos(9 * A[:, 1])
            np.testing.assert_allclose([a.value, b.value], np.linalg.solve(A.T @ W @ A, A.T @ W @ y), rtol=1e-10)
        C = np.array([[2.0, 0.5], [0.5, 1.0]])
        est = slom.Estimator()
        x = est.variable([0.0, 0.0], "x")
        est.measure(lambda x: x, x, measured=np.ones((3, 2)), covariance=C)
        np.testing.assert_allclose(x.covariance, C / 3, rtol=1e-12)
        est.prior(x, 1.0, 0.1, path="y")
        self.assertLess(x.std[1], 0.1)
        with self.assertRaisesRegex(slom.Error, "pass one of x, y"):
            est.prior(x, 1.0, 0.1, path="z")

    def test_clustered_covariance_is_the_sandwich(self):
        keys = np.repeat(np.arange(4), 3)
        est, a, b, measurements, A = self.line(sigma=0.5, group=keys)
        bread = np.linalg.inv(A.T @ A)
        scores = [A[keys == k].T @ measurements.residuals[keys == k, 0] for k in range(4)]
        meat = sum(np.outer(s, s) for s in scores)
        clustered = est.clustered(correction="cr0")
        expected = bread @ meat @ bread
        np.testing.assert_allclose(clustered.covariance(a)[0, 0], expected[0, 0], rtol=1e-9)
        self.assertEqual(len(clustered.groups), 4)
        est, a, b, _, _ = self.line(group={"day": keys, "tool": [str(k) for k in keys % 2]})
        self.assertEqual(len(est.clustered(by="day").groups), 4)

    def test_analyses(self):
        est, a, b, measurements, _ = self.line(sigma=0.1, loss=slom.Huber(1.345))
        interval = est.profile(a)
        self.assertLess(interval.lower, a.value)
        self.assertEqual(len(est.intervals().rows), 2)
        self.assertTrue(est.diagnose().is_determined)
        self.assertTrue(est.preflight().ok)
        self.assertEqual(est.outliers().suspects, 0)
        self.assertTrue(np.all(measurements.weights <= 1))
        self.assertEqual(measurements.names[0], "function #1")
        product = est.propagate(lambda a, b: a * b, a, b)
        J = np.array([b.value, a.value])
        self.assertAlmostEqual(product.value, a.value * b.value)
        np.testing.assert_allclose(product.covariance, [[J @ est.covariance([a, b]) @ J]], rtol=1e-12)
        a.bound(-1.0, 1.0) if a.value < 1 else a.bound(0.0, 10.0)
        measurements[3].remove()
        fit = est.optimize()
        self.assertEqual(fit.measurements, 11)
        self.assertEqual([p.name for p in fit.parameters], ["a", "b"])
        np.testing.assert_allclose(fit.covariance, est.covariance([a, b]))
        self.assertIn("<table>", fit._repr_html_())
        measurements[:3].remove()
        self.assertTrue(np.all(np.isnan(measurements[:4].residuals)))
        self.assertTrue(np.all(np.isfinite(measurements[4:].whitened_residuals)))
        self.assertEqual(measurements.residuals.shape, (12, 1))
        measurements[:3].remove()  # once more, without harm
        self.assertTrue(np.array_equal(measurements[:3].residuals, np.full((3, 1), np.nan), equal_nan=True))
        self.assertIn("8 measurements", repr(measurements))
        self.assertTrue(est.update().converged)

    def test_a_saved_problem_is_the_same(self):
        est, cameras, points, _ = self.bundle()
        camera = est.variable(Camera(pose(self.rng), 500.0, np.array([0.1, 0.2])), "lens")
        est.prior(camera, Camera(pose(self.rng), 510.0, np.array([0.1, 0.2])), 0.3)
        camera.fix("focal_length")
        with tempfile.TemporaryDirectory() as folder:
            est.save(pathlib.Path(folder) / "problem.slom")
            loaded, variables = slom.load(f"{folder}/problem.slom")
            np.testing.assert_allclose(loaded.residuals(), est.residuals(), rtol=1e-12, atol=1e-13)
            self.assertEqual(list(variables), ["camera", "point", "lens"])
            self.assertEqual(variables["lens"].value.focal_length, 500.0)
            np.testing.assert_allclose(variables["camera"][1].value - cameras[1].value, 0, atol=1e-15)
            self.assertEqual(loaded.optimize().converged, est.optimize().converged)
            np.testing.assert_allclose(variables["lens"].value.pose - camera.value.pose, 0, atol=1e-9)
            np.testing.assert_allclose(variables["point"].value, points.value, atol=1e-9)
            with self.assertRaisesRegex(slom.Error, "cannot be read"):
                slom.load(f"{folder}/nothing")

    def test_a_failed_insertion_leaves_nothing(self):
        est = slom.Estimator()
        x = est.variable(0.0, "x")
        with self.assertRaises(slom.Error):
            est.measure(lambda x, z: x - z, x, np.ones(3), sigma=[1.0, 1.0, -1.0])
        with self.assertRaises(slom.Error):
            est.measure(lambda x, z: x - z, x, np.ones(3), group=[1, 2])
        self.assertEqual(est.residuals().size, 0)

    def test_a_loaded_problem_has_arrays_where_names_are_complete(self):
        est = slom.Estimator()
        for name in ("p[0]", "p[1]", "q[1]", "same", "same", "r[0]", "r[x]", "p"):
            est.variable(1.0, name)
        est.variable([1.0, 2], "r[1]")  # of another type
        with tempfile.TemporaryDirectory() as folder:
            est.save(f"{folder}/problem.slom")
            _, variables = slom.load(f"{folder}/problem.slom")
        self.assertEqual(list(variables), ["p", "q[1]", "same", "same (2)", "r[0]", "r[x]", "p (2)", "r[1]"])
        self.assertEqual(len(variables["p"]), 2)

    def test_covariance_of_two_is_the_cross_block(self):
        est, cameras, points, _ = self.bundle()
        est.optimize()
        joint = est.covariance([cameras[1], points[2], points[5]])
        self.assertEqual(joint.shape, (12, 12))
        np.testing.assert_allclose(est.covariance(cameras[1], points[2]), joint[:6, 6:9], rtol=1e-9, atol=1e-20)
        np.testing.assert_allclose(est.covariance(cameras[1], points[[2, 5]]), joint[:6, 6:], rtol=1e-9, atol=1e-20)
        np.testing.assert_allclose(est.covariance(points[2]), points[2].covariance, rtol=1e-9)
        np.testing.assert_allclose(points.covariance[5], joint[9:, 9:], rtol=1e-6)

    def test_propagate_takes_data_and_functions_that_branch(self):
        est, cameras, points, _ = self.bundle()
        est.optimize()
        frame, factor = pose(self.rng), 2.5
        moved = est.propagate(lambda T, p, k: k * (T * p), frame, points[2], factor)
        np.testing.assert_allclose(moved.value, factor * (frame * points[2].value), rtol=1e-12)
        R = factor * frame.orient.matrix()
        np.testing.assert_allclose(moved.covariance, R @ points[2].covariance @ R.T, rtol=1e-9)
        self.assertIn("±", repr(moved))
        with self.assertWarns(slom.SlowFunctionWarning):
            branching = est.propagate(lambda T, p: T * p if p[0] > -1e9 else p, cameras[1], points[2])
        recorded = est.propagate(lambda T, p: T * p, cameras[1], points[2])
        np.testing.assert_allclose(branching.covariance, recorded.covariance, rtol=1e-6, atol=1e-14)
        with self.assertRaisesRegex(slom.Error, "one by one"):
            est.propagate(lambda p: p, points)

    def test_values_are_copies_that_cannot_be_written(self):
        est = slom.Estimator()
        x, all = est.variable([1.0, 2.0], "x"), est.variables(np.zeros((3, 2)), "y")
        camera = est.variable(Camera(pose(self.rng), 500.0, np.zeros(2)), "camera")
        for value in (x.value, all.value, camera.value.distortion):
            with self.assertRaises(ValueError):
                value[0] = 5.0
        x.value = x.value + 1
        np.testing.assert_array_equal(x.value, [2.0, 3.0])
        with self.assertRaises(AttributeError):
            est.sigmas = "estimated"
        with self.assertRaisesRegex(slom.Error, "one dimension"):
            all[[[0, 1]]]

    def test_arrays_of_variables_are_bounded_and_fixed_by_path(self):
        est = slom.Estimator()
        x = est.variables(np.zeros((3, 2)), "x")
        est.measure(lambda x: x - 5.0, x)
        x.bound(upper=1.0, path="y")
        x[:1].fix("x")
        self.assertTrue(est.optimize().converged)
        np.testing.assert_allclose(x.value, [[0, 1], [5, 1], [5, 1]])

    def test_rows_have_the_operators_of_their_values(self):
        a, b = [pose(self.rng) for _ in range(4)], [pose(self.rng) for _ in range(4)]
        p, points = self.rng.normal(size=3), self.rng.normal(size=(4, 3))
        rows, others = slom.Rows(a), slom.Rows(b)
        for i in range(4):
            for got, expected in [
                ((rows * others)[i], a[i] * b[i]),
                ((rows.inverse() @ b[0])[i], a[i].inverse() * b[0]),
                ((b[0] * rows)[i], b[0] * a[i]),
            ]:
                np.testing.assert_allclose(got - expected, 0, atol=1e-14)
            np.testing.assert_allclose((rows - others)[i], a[i] - b[i], atol=1e-14)
            np.testing.assert_allclose((rows * points)[i], a[i] * points[i], atol=1e-14)
            np.testing.assert_allclose((rows * p)[i], a[i] * p, atol=1e-14)
        np.testing.assert_allclose(rows.orient.coefficients[2], a[2].orient.coefficients, atol=1e-15)
        np.testing.assert_allclose(slom.Rows([slom.SE2(1, 2, 0.5)]).orient.angle, [0.5])
        with self.assertRaisesRegex(AttributeError, "no member angles"):
            rows.orient.angles
        with self.assertRaisesRegex(slom.Error, "same number of rows"):
            rows * slom.Rows(b[:3])

    def test_the_worst_measurement_is_removed(self):
        est, a, b, measurements, _ = self.line(sigma=0.01)
        before = est.residuals().size
        worst = est.outliers().ranking[0]
        est.remove(worst)
        self.assertEqual(est.residuals().size, before - 1)
        self.assertEqual(np.isnan(measurements.residuals).sum(), 1)

    def test_clustered_covariance_of_several_variables(self):
        keys = np.repeat(np.arange(4), 3)
        est, a, b, _, A = self.line(sigma=0.5, group=keys)
        clustered = est.clustered()
        joint = clustered.covariance([a, b])
        np.testing.assert_allclose(np.diag(joint), [clustered.covariance(a)[0, 0], clustered.covariance(b)[0, 0]])
        band = est.propagate(lambda a, b, x: a + b * x, a, b, 0.3, covariance=joint)
        np.testing.assert_allclose(band.std**2, [1, 0.3] @ joint @ [1, 0.3])

        def kept():
            return self.line(sigma=0.5, group=keys)[0].clustered()

        self.assertEqual(len(kept().groups), 4)

    def test_residuals_by_name(self):
        est = slom.Estimator()
        x = est.variable(1.0, "x")
        for k in range(3):  # two formulas of one name, and another name between
            est.measure(lambda x: x + 10.5 * k, x, name="a")
            est.measure(lambda x: [x * x, -x], x, name="b")
            est.measure(lambda x: x * x + 20.5 * k, x, name="a")
        np.testing.assert_allclose(sorted(est.residuals("a")), [1, 1, 11.5, 21.5, 22, 42])
        np.testing.assert_allclose(sorted(est.residuals("b")), [-1, -1, -1, 1, 1, 1])
        with self.assertRaisesRegex(slom.Error, "pass one of a, b"):
            est.residuals("c")

    def test_errors_have_parts(self):
        est = slom.Estimator()
        x = est.variable(0.0, "x")
        with self.assertRaises(slom.Error) as raised:
            est.measure(lambda x, z: x - z, x, np.ones(3), sigma=np.ones(2))
        error = raised.exception
        self.assertEqual((error.id, error.subject), ("slom.wrong-shape", "sigma"))
        self.assertTrue(str(error).endswith(error.remedy))
        for value in ("text", [[1], [2, 3]], np.nan, None, object()):
            with self.assertRaises(slom.Error):
                est.variable(value)
        with self.assertRaisesRegex(slom.Error, "different lengths"):
            est.variable([[1], [2, 3]])
        with self.assertRaisesRegex(slom.Error, "masked entries"):
            est.measure(lambda x, z: x - z, x, np.ma.masked_equal([1.0, -9.0], -9.0))
        with self.assertRaisesRegex(slom.Error, "in place of a variable"):
            est.covariance(3.0)
        with self.assertRaisesRegex(slom.Error, "one of"):
            est.use_algorithm("simplex")


class OneAtATime(unittest.TestCase):
    """A fit runs without the interpreter's lock. Nothing else may change the estimator meanwhile."""

    def setUp(self):
        self.est = slom.Estimator()
        self.x, self.y = self.est.variable(1.0, "x"), self.est.variable(2.0, "y")

    def test_a_measurement_function_cannot_change_its_estimator(self):
        for change in (
            lambda: self.est.remove(self.y),
            lambda: self.est.measure(lambda x: x, self.x),
            lambda: self.est.optimize(),
            lambda: self.x.fix(),
            lambda: self.est.covariance(self.x),
            lambda: self.measurements.remove(),
            lambda: self.est.variable(1.0),
            lambda: setattr(self.x, "value", 3.0),
        ):
            self.setUp()
            armed = []

            def f(x):
                if armed:
                    change()
                return x - 1.5

            self.measurements = self.est.measure(f, self.x, trace=False)
            armed.append(True)
            self.y.fix()
            with self.assertRaisesRegex(slom.Error, "middle of another call"):
                self.est.optimize()
            armed.clear()
            self.assertTrue(self.est.optimize().converged)
            self.assertAlmostEqual(self.x.value, 1.5)

    def test_threads_share_an_estimator_in_turn(self):
        x = self.est.variable(np.zeros(2), "z")
        self.y.fix()
        self.est.measure(lambda x: x, self.x)
        self.est.measure(lambda x, z: np.exp(x) - z, x, np.ones((2000, 2)), trace=False)
        results = []

        def fit():
            try:
                results.append(self.est.optimize().converged)
            except slom.Error as error:
                results.append(error.id == "slom.in-use")

        threads = [threading.Thread(target=fit) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(results, [True] * 4)

    def test_an_observer_reads_values(self):
        seen = []
        self.y.fix()
        self.est.measure(lambda x: np.exp(x) - 2, self.x)
        self.est.optimize(observer=lambda record: seen.append(self.x.value))
        self.assertGreater(len(seen), 2)


class OwnDerivatives(unittest.TestCase):
    def setUp(self):
        rng = np.random.default_rng(SEED)
        self.est = slom.Estimator()
        self.T, self.p = self.est.variable(pose(rng), "T"), self.est.variable(rng.normal(size=3), "p")
        self.seen = rng.normal(size=(5, 3))

    @staticmethod
    def derivatives(T, p):
        R = T.orient.matrix()
        x, y, z = p
        return np.eye(3), -R @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]), R

    def test_are_used(self):
        def jacobian(T, p):
            a, b, c = self.derivatives(T, p)
            return [np.hstack([a, b]), c]

        self.est.measure(lambda T, p: T * p, self.T, self.p, measured=self.seen, jacobian=jacobian, name="seen")
        check = self.est.check_derivatives()
        self.assertTrue(check.ok, check)
        exact = slom.Estimator()
        T, p = exact.variable(self.T.value, "T"), exact.variable(self.p.value, "p")
        exact.measure(lambda T, p: T * p, T, p, measured=self.seen)
        for est, pose in ((self.est, self.T), (exact, T)):
            pose.fix("orient")
            est.prior(pose, pose.value.pos, 0.1, path="pos")
        fit = self.est.optimize()
        self.assertTrue(fit.converged, fit)
        self.assertIn("given", str(fit))
        exact.optimize()
        np.testing.assert_allclose(self.p.value, p.value, atol=1e-12)
        np.testing.assert_allclose(self.est.clone().covariance(self.p), exact.covariance(p), rtol=1e-9)

    def test_wrong_ones_are_named(self):
        self.est.measure(lambda T, p: T * p, self.T, self.p, jacobian=lambda T, p: np.ones((3, 9)), name="wrong")
        self.assertFalse(self.est.check_derivatives().ok)
        est = slom.Estimator()
        x = est.variable(1.0, "x")
        est.measure(lambda x: x * x, x, jacobian=lambda x: np.ones((2, 3)))
        with self.assertRaisesRegex(slom.Error, r"return the shape \(1, 1\)"):
            est.optimize()
        with self.assertRaisesRegex(slom.Error, "drop one of them"):
            est.measure(lambda x: x, x, jacobian=lambda x: 1.0, trace=True)


class Ambiguity(unittest.TestCase):
    """Arrays whose meaning cannot be told from their shapes."""

    def setUp(self):
        self.est = slom.Estimator()
        self.c, self.r = self.est.variable([0.0, 0.0], "c"), self.est.variable(1.0, "r")

    def test_a_point_is_not_two_rows(self):
        circle = lambda c, r, p: np.linalg.norm(p - c) - r
        with self.assertRaisesRegex(slom.Error, r"x\[None\] for one row with the vector x"):
            self.est.measure(circle, self.c, self.r, [3.0, 4.0])
        self.assertEqual(len(self.est.measure(circle, self.c, self.r, np.array([3.0, 4.0])[None])), 1)
        self.assertEqual(len(self.est.measure(circle, self.c, self.r, np.array([3.0, 4.0, 5.0]))), 3)
        self.assertEqual(len(self.est.measure(lambda c, t: c[0] + c[1] * t, self.c, [3.0, 4.0])), 2)
        self.assertEqual(len(self.est.measure(lambda c, t: c[0] + c[1] * t, self.c, [3.0, 4.0], measured=[1.0, 2.0])), 2)
        track = self.est.measure(lambda c, t: c * t, self.c, np.array([3.0, 4.0])[:, None], measured=np.ones((2, 2)))
        self.assertEqual(track.residuals.shape, (2, 2))

    def test_sigma_of_as_many_rows_as_components(self):
        points = np.array([[3.0, 4.0], [5.0, 6.0]])
        add = lambda sigma, points=points: self.est.measure(lambda c, p: p - c, self.c, points, sigma=sigma)
        with self.assertRaisesRegex(slom.Error, r"x\[None\] for one entry for each component"):
            add([0.1, 0.2])
        np.testing.assert_allclose(add([[0.1, 0.2]]).whitened_residuals, points / [[0.1, 0.2]])
        np.testing.assert_allclose(add([[0.1], [0.2]]).whitened_residuals, points / [[0.1], [0.2]])
        three = np.ones((3, 2))
        np.testing.assert_allclose(add([0.1, 0.2, 0.5], three).whitened_residuals, three / [[0.1], [0.2], [0.5]])
        np.testing.assert_allclose(add([0.1, 0.2], three).whitened_residuals, three / [[0.1, 0.2]])

    def test_what_is_no_residual(self):
        for f, words in [(lambda c: None, "returned None"), (lambda c: "text", "is a str"), (lambda c: {}, "is a dict")]:
            with self.assertRaisesRegex(slom.Error, words):
                self.est.measure(f, self.c)
        for options, words in [
            ({"sigma": "0.1"}, "sigma is a str"),
            ({"group": [None]}, "a key of a group is a NoneType"),
            ({"loss": "huber"}, "loss is a str; pass a loss such as slom.Huber"),
            ({"loss": slom.Huber(-1)}, "pass a positive finite number"),
        ]:
            with self.assertRaisesRegex(slom.Error, words):
                self.est.measure(lambda c: c, self.c, **options)
        with self.assertRaisesRegex(slom.Error, "is a ndarray; pass the measurement function first"):
            self.est.measure(np.ones(3), lambda c: c, self.c)
        self.assertEqual(self.est.residuals().size, 0)
        with self.assertRaisesRegex(slom.Error, "0 or more"):
            self.est.optimize(max_iterations=-1)
        with self.assertRaisesRegex(slom.Error, "last row"):
            slom.SE2(np.ones((3, 3)))
        fit = self.est.optimize()
        self.assertFalse(fit.converged)
        self.assertIn("no measurement depends on", fit.message)


class Unrecorded(unittest.TestCase):
    """Functions that cannot be recorded, or whose formula would be another function."""

    def setUp(self):
        self.est = slom.Estimator()
        self.x = self.est.variable(1.0, "x")

    def warned(self, f, words, *data):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            self.est.measure(f, self.x, *data, sigma=0.1)
        self.assertEqual(len(caught), 1)
        self.assertIs(caught[0].category, slom.SlowFunctionWarning)
        self.assertIn(words, str(caught[0].message))
        fit = self.est.optimize()
        self.assertTrue(fit.converged, fit)
        self.assertIn("numeric", str(fit))

    def test_a_branch_is_called_as_it_is(self):
        self.warned(lambda x, z: x * x - z if x > 0 else -x - z, "slom.where", np.array([1.9, 2.0, 2.1]))
        self.assertAlmostEqual(self.x.value, np.sqrt(2.0), places=6)

    def test_a_hidden_branch_is_seen(self):
        def f(x, z):
            return (x - z) if isinstance(x, float) else (x + z)

        self.warned(f, "depends on more than its arguments", np.array([1.9, 2.0, 2.1]))
        self.assertAlmostEqual(self.x.value, 2.0, places=6)

    def test_an_error_that_the_function_swallows_is_seen(self):
        def f(x, z):
            try:
                k = int(z)
            except Exception:
                k = 0
            return x - 1 - k

        data = np.zeros(1001)
        data[537:547] = 5
        self.warned(f, "int() needs the value", data)
        self.assertAlmostEqual(self.x.value, 1 + 50 / 1001)

    def test_data_are_floats(self):
        table = [1.0, 2.0, 3.0]
        for f in (lambda x, k: table[k] * x, lambda x, k: np.array(table)[k] * x, lambda x, k: sum(range(k)) * x):
            with warnings.catch_warnings(), self.assertRaisesRegex(slom.Error, r"write int\(k\)"):
                warnings.simplefilter("ignore")
                self.est.measure(f, self.x, np.array([0, 1, 2]))
        self.warned(lambda x, k: table[int(k)] * x - 2, "int() needs the value", np.array([0, 1, 2]))

    def test_interrupts_while_recording_pass(self):
        def f(x):
            if not isinstance(x, float):
                raise KeyboardInterrupt
            return x

        with self.assertRaises(KeyboardInterrupt):
            self.est.measure(f, self.x)

    def test_mistakes_of_the_function_are_the_users(self):
        def f(x, z):
            raise ZeroDivisionError("mine")

        with self.assertRaisesRegex(ZeroDivisionError, "mine"):
            self.est.measure(f, self.x, np.ones(2))
        with self.assertRaisesRegex(slom.Error, "returns 2 numbers for row 1 and 1 for row 0"):
            self.est.measure(
                lambda x, z: x - z if isinstance(z, slom.Number) or z < 2 else [x, x], self.x, np.array([1.0, 2.0])
            )
        self.assertEqual(self.est.residuals().size, 0)

    def test_an_exception_within_a_fit_names_the_measurement(self):
        def f(x):
            if x < 0.9:
                raise ZeroDivisionError("mine")
            return x * x

        self.est.measure(f, self.x, trace=False, name="own")
        with self.assertRaisesRegex(slom.Error, "own #1 threw an exception .ZeroDivisionError: mine. at x =") as raised:
            self.est.optimize()
        self.assertIsInstance(raised.exception.__cause__, ZeroDivisionError)

    def test_many_threads_call_python(self):
        self.est.set_threads(4)
        self.est.measure(lambda x, z: x - z, self.x, np.linspace(0, 1, 3000), trace=False)
        self.assertTrue(self.est.optimize().converged)
        self.assertAlmostEqual(self.x.value, 0.5, places=9)


class Control(unittest.TestCase):
    def slow(self):
        est = slom.Estimator()
        x = est.variable(1.0, "x")

        def f(x):
            time.sleep(0.01)
            return np.exp(-x)

        est.measure(f, x, trace=False)
        return est, x

    def test_ctrl_c_ends_a_fit_with_the_best_values(self):
        est, x = self.slow()
        timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            est.optimize(max_iterations=10000, gradient_tolerance=0, decrease_tolerance=0, step_tolerance=0)
        self.assertGreater(x.value, 1.0)

    def test_an_observer_may_end_a_fit(self):
        est, x = self.slow()
        seen = []

        def observe(record):
            seen.append(record.rss)
            return len(seen) < 3

        fit = est.optimize(observer=observe)
        self.assertEqual(len(seen), 3)
        self.assertFalse(fit.converged)

    def test_estimators_fit_in_several_threads(self):
        results = []

        def fit(k):
            est = slom.Estimator()
            x = est.variable(0.0, "x")
            est.measure(lambda x, z: x - z - k, x, np.arange(1000.0))
            est.optimize()
            results.append(x.value - k)

        threads = [threading.Thread(target=fit, args=(k,)) for k in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        np.testing.assert_allclose(results, 499.5)


class CurveFit(unittest.TestCase):
    def setUp(self):
        rng = np.random.default_rng(SEED)
        self.x = np.linspace(0, 4, 50)
        self.y = self.f(self.x, 2.5, 1.3, 0.5) + 0.2 * rng.normal(size=50)

    @staticmethod
    def f(x, a, b, c):
        return a * np.exp(-b * x) + c

    def test_unpacks_as_in_scipy(self):
        popt, pcov = slom.curve_fit(self.f, self.x, self.y)
        A = np.stack([np.exp(-popt[1] * self.x), -popt[0] * self.x * np.exp(-popt[1] * self.x), np.ones(50)], axis=1)
        r = self.f(self.x, *popt) - self.y
        np.testing.assert_allclose(A.T @ r, 0, atol=1e-7)
        np.testing.assert_allclose(pcov, np.linalg.inv(A.T @ A) * (r @ r) / 47, rtol=1e-6)
        _, absolute = slom.curve_fit(self.f, self.x, self.y, sigma=np.full(50, 0.3), absolute_sigma=True)
        np.testing.assert_allclose(absolute, np.linalg.inv(A.T @ A) * 0.09, rtol=1e-6)
        _, joint = slom.curve_fit(self.f, self.x, self.y, sigma=0.09 * np.eye(50), absolute_sigma=True)
        np.testing.assert_allclose(joint, absolute, rtol=1e-6)

    def test_has_names_and_intervals(self):
        fit = slom.curve_fit(self.f, self.x, self.y, bounds=([0, 0, -1], [10, 10, 10]))
        self.assertEqual(fit.names, ["a", "b", "c"])
        self.assertEqual(slom.curve_fit(lambda x, a, b=2.0: a * x + b, self.x, self.y).names, ["a", "b"])
        self.assertLess(fit.profile("b").lower, fit["b"].value)
        self.assertEqual(len(fit.intervals().rows), 3)
        np.testing.assert_allclose(fit.predict(self.x), self.f(self.x, *fit.popt))
        with self.assertRaisesRegex(KeyError, "the parameters are a, b, c"):
            fit["d"]

    def test_arguments_of_scipy(self):
        class Bounds:
            lb, ub = [0, 0, -1], [10, 10, 10]

        fit = slom.curve_fit(self.f, self.x, self.y, bounds=Bounds, method="trf", jac="2-point", maxfev=1000)
        popt, pcov, info, message, ier = slom.curve_fit(self.f, self.x, self.y, full_output=True)
        np.testing.assert_allclose(fit.popt, popt, rtol=1e-6)
        curve = slom.curve_fit(self.f, self.x, self.y)
        self.assertTrue(curve[0] is curve.popt and curve[1] is curve.pcov and len(curve) == 2 and len(curve[:1]) == 1)
        np.testing.assert_allclose(info["fvec"], self.f(self.x, *popt) - self.y)
        self.assertEqual(ier, 1)
        np.testing.assert_allclose(slom.curve_fit(self.f, self.x, self.y, ftol=1e-3).popt, popt, rtol=1e-2)
        for options, words in [
            ({"foo": 1}, "foo is no option"),
            ({"p0": [1, np.nan, 1]}, "not finite"),
            ({"p0": ["a", "b", "c"]}, "no array of numbers"),
            ({"p0": [1, 1, 1], "bounds": (2, 3)}, "outside of its bound"),
            ({"bounds": ([3, 3, 3], [0, 0, 0])}, "the lower below the upper"),
            ({"bounds": [(0, 5), (0, 5), (0, 5)]}, "bounds are not two lists"),
            ({"bounds": ([0], [1, 2])}, "bounds are not two lists"),
            ({"bounds": (0,)}, "bounds are not two lists"),
            ({"names": ["A"]}, "a name of its own for each"),
            ({"names": ["A", "A", "B"]}, "a name of its own for each"),
        ]:
            with self.subTest(options=options), self.assertRaisesRegex(ValueError, words):
                slom.curve_fit(self.f, self.x, self.y, **options)
        with self.assertRaisesRegex(ValueError, "there are no data"):
            slom.curve_fit(self.f, [], [])
        with self.assertRaisesRegex(RuntimeError, "drop a parameter"):
            slom.curve_fit(lambda x, a, b: a + b, self.x, self.y)
        by_number = np.vectorize(lambda x, a, b: a * x + b)
        self.assertEqual(slom.curve_fit(by_number, self.x, self.y, p0=[1, 1]).names, ["a", "b"])
        with self.assertWarnsRegex(UserWarning, "as many parameters as data"):
            _, pcov = slom.curve_fit(lambda x, a, b: a + b * x, [0.0, 1.0], [1.0, 3.0])
        self.assertTrue(np.all(np.isinf(pcov)))

    def test_exact_data_from_the_solution(self):
        rng = np.random.default_rng(SEED)
        for _ in range(50):
            p = rng.uniform(0.5, 2, size=3)
            for f in (self.f, lambda x, a, b, c: a * x * x + b * x + c):
                np.testing.assert_allclose(slom.curve_fit(f, self.x, f(self.x, *p), p0=p).popt, p, rtol=1e-9)

    def test_coupled_models_are_recorded_in_linear_time(self):
        """It took minutes, which the limit of products now forbids."""
        x = np.linspace(0.05, 3, 1000)
        scaled = lambda x, a, b: a * np.exp(-b * x) / np.max(np.exp(-b * x))
        curve = slom.curve_fit(scaled, x, scaled(x, 2.0, 0.8), [1.5, 0.5])
        np.testing.assert_allclose(curve.popt, [2.0, 0.8], rtol=1e-9)

    def test_starts_that_determine_nothing(self):
        logistic = lambda x, low, high, middle, slope: low + (high - low) / (1 + (x / middle) ** -slope)
        x = np.linspace(0.1, 5, 30)
        curve = slom.curve_fit(logistic, x, logistic(x, 0.2, 3.2, 1.2, 1.7))
        np.testing.assert_allclose(curve.popt, [0.2, 3.2, 1.2, 1.7], rtol=1e-8)

    def test_functions_that_make_arrays_like_x(self):
        def steps(x, a, b):
            y = np.zeros_like(x)
            y[x > 2] = 1.0
            return a * y + b

        popt, _ = slom.curve_fit(steps, self.x, self.y)
        self.assertAlmostEqual(popt[1], self.y[self.x <= 2].mean(), places=9)

    def test_functions_of_all_of_x(self):
        g = lambda x, a, b: np.cumsum(a * x) + b
        popt, _ = slom.curve_fit(g, self.x, self.y)
        A = np.stack([np.cumsum(self.x), np.ones(50)], axis=1)
        np.testing.assert_allclose(popt, np.linalg.lstsq(A, self.y, rcond=None)[0], rtol=1e-8)
        popt, _ = slom.curve_fit(lambda x, a, b: a * x[0] + b * x[1], np.stack([self.x, self.x**2]), self.y)
        A = np.stack([self.x, self.x**2], axis=1)
        np.testing.assert_allclose(popt, np.linalg.lstsq(A, self.y, rcond=None)[0], rtol=1e-8)

    def test_bad_input(self):
        with self.assertRaisesRegex(slom.Error, "one value of ydata"):
            slom.curve_fit(self.f, self.x, self.y[:3])
        with self.assertRaisesRegex(slom.Error, "start values for 3 parameters"):
            slom.curve_fit(self.f, self.x, self.y, p0=[1, 2])
        with self.assertRaisesRegex(slom.Error, "not finite in row 7"):
            slom.curve_fit(self.f, self.x, np.where(np.arange(50) == 7, np.nan, self.y))
        with self.assertRaises(RuntimeError):
            slom.curve_fit(self.f, self.x, self.y, max_iterations=1)
        self.assertEqual(slom.curve_fit(self.f, self.x, np.where(np.arange(50) == 7, np.nan, self.y), nan_policy="omit").fit.measurements, 49)


if __name__ == "__main__":
    unittest.main()
