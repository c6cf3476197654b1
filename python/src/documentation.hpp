// Docstrings with examples. tests/python/doctest_test.py runs the examples, with `slom` and NumPy as `np` at hand.
#pragma once

namespace slom::python::doc {

inline constexpr const char* kEstimator =
    R"(Variables, measurements, and the fit of the variables to the measurements.

>>> est = slom.Estimator()
>>> length = est.variable(1.0, "length")
>>> readings = est.measure(lambda x: x, length, measured=np.array([2.1, 1.9, 2.0]), sigma=0.1)
>>> fit = est.optimize()
>>> fit.converged
True
>>> print(f"{length.value:.2f} +- {length.std:.2f}")
2.00 +- 0.06)";

inline constexpr const char* kVariable =
    R"(Adds a variable and returns it.

value     start value: a number, an array of any shape, SO2, SO3, S2, SE2, SE3, or an instance of a class decorated with
          slom.manifold; other values raise slom.Error
name      label in reports and messages
optimize  False: the fit keeps the start value

>>> est = slom.Estimator()
>>> est.variable([0, 0], "centre")
centre = array([0., 0.])
>>> est.variable(slom.SE2(1, 2, 0.5), "robot").components
['robot.pos.x', 'robot.pos.y', 'robot.orient.angle'])";

inline constexpr const char* kVariables =
    R"(Adds a variable for each row of an array (rows, ...), entry of a list, or row of slom.Rows. Returns a VariableArray.

Their names are name[0], name[1] ... Index arrays select variables for the rows of a measurement.

>>> est = slom.Estimator()
>>> heights = est.variables(np.zeros(3), "height")
>>> heights[0].fix()
>>> i, j = np.array([0, 1, 2]), np.array([1, 2, 0])
>>> steps = est.measure(lambda a, b: b - a, heights[i], heights[j], measured=np.array([1.0, 2.0, -3.3]), sigma=0.1)
>>> fit = est.optimize()
>>> print(heights.value.round(3))
[0.  1.1 3.2])";

inline constexpr const char* kMeasure =
    R"(Adds a measurement for each row of the arguments: variables, arrays of variables, and data.

function     gets the variables and data in this order; returns the residual, or a prediction of `measured`
measured     what the function predicts, one a row
sigma        standard deviation: a number, one for each row, one for each component, or (rows, components)
covariance   matrix (components, components), or one for each row
information  its inverse, likewise
loss         a robust loss, such as slom.Huber(1.345)
group        keys of groups that share errors, one a row; a dict for several dimensions
name         label in reports
trace        True: raise if the function cannot be recorded. False: call it for each measurement.
jacobian     for a function that cannot be recorded: takes the same arguments; returns the derivatives of the residual by
             the components of the variables in their tangent spaces, (m, n), or a list with a block for each variable.
             check_derivatives compares them with differences

>>> est = slom.Estimator()
>>> place = est.variable([0.5, 0.5], "place")
>>> beacons = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]])
>>> ranges = est.measure(
...     lambda p, beacon: np.linalg.norm(p - beacon), place, beacons, measured=np.array([2.5, 2.5, 2.5]), sigma=0.1)
>>> len(ranges)
3
>>> fit = est.optimize()
>>> print(place.value.round(3))
[2.  1.5])";

inline constexpr const char* kPrior =
    R"(Adds prior knowledge of a variable: a measurement of its value. Returns the measurement.

value                              a value of the variable's type, or of the component at `path`
sigma, covariance, information     as in measure, in the tangent space of the variable
path                               a component such as "pos.z"; without it the whole variable

>>> est = slom.Estimator()
>>> pose = est.variable(slom.SE3(), "pose")
>>> known = est.prior(pose, slom.SE3([1, 2, 3]), sigma=0.1)
>>> height = est.prior(pose, 3.3, sigma=0.1, path="pos.z")
>>> fit = est.optimize()
>>> print(pose.value.pos.round(3))
[1.   2.   3.15])";

inline constexpr const char* kCovariance =
    R"(Returns the covariance of a variable, or of all variables of a list or VariableArray jointly, in the given order and in
their tangent spaces: an array (n, n) for n components. With `b`, the cross-covariance of `a` (rows) and `b` (columns). If the
measurements do not determine the variables, slom.Error says which.

>>> est = slom.Estimator()
>>> a, b = est.variable(0.0, "a"), est.variable(0.0, "b")
>>> start = est.prior(a, 1.0, sigma=0.1)
>>> step = est.measure(lambda a, b: b - a, a, b, measured=np.array([2.0]), sigma=0.2)
>>> fit = est.optimize()
>>> print(est.covariance([a, b]).round(3))
[[0.01 0.01]
 [0.01 0.05]]
>>> print(est.covariance(a, b).round(3))
[[0.01]])";

inline constexpr const char* kPropagate =
    R"(Returns f(variables and data ...) and its covariance to first order: a slom.Propagated with `value`, `std` and
`covariance`.

covariance  that of the variables, in place of the estimated one

>>> est = slom.Estimator()
>>> radius = est.variable(1.0, "radius")
>>> reading = est.prior(radius, 2.0, sigma=0.1)
>>> fit = est.optimize()
>>> area = est.propagate(lambda r: np.pi * r**2, radius)
>>> print(f"{area.value:.2f} +- {area.std:.2f}")
12.57 +- 1.26)";

inline constexpr const char* kProfile =
    R"(Returns the profile likelihood interval of a number, or of the component of a variable at `path`.

Its limits `lower` and `upper` are where the sum of squares, minimised over all other unknowns, exceeds the minimum by the
quantile of the chi-square distribution. The estimate is not symmetric between them if the model is not linear.

>>> est = slom.Estimator()
>>> rate = est.variable(1.0, "rate")
>>> t = np.array([1.0, 2.0, 3.0])
>>> y = np.array([0.6, 0.4, 0.2])
>>> decay = est.measure(lambda rate, t: np.exp(-rate * t), rate, t, measured=y, sigma=0.1)
>>> fit = est.optimize()
>>> interval = est.profile(rate)
>>> print(f"{interval.value:.2f}, from {interval.lower:.2f} to {interval.upper:.2f}")
0.50, from 0.35 to 0.70)";

inline constexpr const char* kIntervals =
    R"(Returns the intervals of all components as a table, with limits as those of profile.

>>> est = slom.Estimator()
>>> x = est.variable(0.0, "x")
>>> reading = est.prior(x, 2.0, sigma=0.1)
>>> fit = est.optimize()
>>> print(est.intervals())
95 % intervals
  parameter  value  standard deviation  lower  upper
  x          2.000                 0.1  1.804  2.196
<BLANKLINE>)";

inline constexpr const char* kOutliers =
    R"(Tests each measurement. Returns the number of suspects and the least probable measurements, the worst first.

significance  probability of a suspect among correct data
worst         number of measurements in the ranking

>>> est = slom.Estimator()
>>> x = est.variable(0.0, "x")
>>> m = est.measure(lambda x: x, x, measured=np.array([1.0, 1.1, 0.9, 1.0, 2.5]), sigma=0.1, name="reading")
>>> fit = est.optimize()
>>> report = est.outliers()
>>> report.suspects > 0, report.ranking[0].measurement
(True, 'reading #5'))";

inline constexpr const char* kClustered =
    R"(Returns covariances for errors that measurements share within groups.

by          dimensions of `group`, or arrays of variables; without it all dimensions
correction  of small numbers of groups: "cr0", "cr1", "cr2", "cr3", or "by_leverage"

>>> est = slom.Estimator()
>>> x = est.variable(0.0, "x")
>>> days = np.array([1, 1, 2, 2, 3, 3])
>>> y = np.array([1.1, 1.1, 0.9, 0.9, 1.0, 1.0])
>>> m = est.measure(lambda x: x, x, measured=y, sigma=0.05, group={"day": days})
>>> fit = est.optimize()
>>> print(f"{x.std:.3f}, with the errors of each day {est.clustered('day').std(x)[0]:.3f}")
0.020, with the errors of each day 0.058)";

inline constexpr const char* kBound =
    R"(Keeps the components at a path, or all of them, between two limits. Without limits, removes the bound.

A value outside raises slom.Error. The covariance takes a component that ends at its bound as known.

>>> est = slom.Estimator()
>>> rate = est.variable(0.5, "rate")
>>> rate.bound(0, 1)
>>> reading = est.prior(rate, 1.2, sigma=0.1)
>>> fit = est.optimize()
>>> rate.value, fit.active_bounds
(1.0, ['rate is at its upper bound 1'])
>>> rate.bound(2, 3)
Traceback (most recent call last):
    ...
slom._error.Error: [slom.outside-bound] rate is 1, outside of its bound [2, 3]; give it a value inside, or another bound)";

inline constexpr const char* kFix =
    R"(Keeps the variable, or the components at a path such as "pos.z", at the current value.

>>> est = slom.Estimator()
>>> pose = est.variable(slom.SE3([0, 0, 1]), "pose")
>>> pose.fix("pos.z")
>>> known = est.prior(pose, slom.SE3([1, 2, 3]), sigma=0.1)
>>> fit = est.optimize()
>>> print(pose.value.pos.round(3))
[1. 2. 1.])";

inline constexpr const char* SO2 =
    R"(SO2(angle): a rotation in the plane [rad], counter-clockwise. SO2(): no rotation.

Its perturbation is the angle (1,) [rad].

>>> turn = slom.SO2(np.pi / 2)
>>> print((turn * np.array([1, 0])).round(3))
[0. 1.]
>>> print((turn * turn * turn).angle.__round__(4))
-1.5708)";

inline constexpr const char* SO3 =
    R"(SO3(w, x, y, z): a rotation in space of a quaternion, which is normalised. SO3(matrix) takes a matrix (3, 3),
SO3(rotation) a Rotation of SciPy, SO3.exp(vector) axis times angle [rad]. SO3(): no rotation.

Its perturbation is a rotation vector (3,) [rad], applied on the right: R + d = R * SO3.exp(d).

>>> turn = slom.SO3.exp([0, 0, np.pi / 2])
>>> print((turn * np.array([1, 0, 0])).round(3))
[0. 1. 0.]
>>> print(((turn * turn) - turn).round(4))
[0.     0.     1.5708])";

inline constexpr const char* S2 =
    R"(S2(vector) or S2(x, y, z): the direction of a vector of any positive length.

Its perturbation is the arcs (2,) [rad] along two axes.

>>> up = slom.S2([0, 0, 5])
>>> print(up.vector)
[0. 0. 1.]
>>> print((slom.S2([1, 0, 1]) - up).round(4))
[0.7854 0.    ])";

inline constexpr const char* SE2 =
    R"(SE2(x, y, angle), SE2(pos, orient) or SE2(matrix): a rigid motion in the plane, which moves p to orient * p + pos.

pos (2,), angle [rad], matrix (3, 3). Its perturbation is that of the position and the angle, (3,).

>>> robot = slom.SE2(1, 2, np.pi / 2)
>>> print(robot * np.array([[1, 0], [0, 1]]))
[[1. 3.]
 [0. 2.]]
>>> (robot.inverse() * slom.SE2(1, 3, np.pi / 2)).pos.round(3).tolist()
[1.0, 0.0])";

inline constexpr const char* SE3 =
    R"(SE3(pos, orient) or SE3(matrix): a rigid motion in space, which moves p to orient * p + pos. SE3(): no motion.

pos (3,), orient an SO3, matrix (4, 4). Its perturbation (6,) is that of the position, then a rotation vector [rad].

>>> world_T_camera = slom.SE3([0, 0, 2], slom.SO3.exp([0, 0, np.pi / 2]))
>>> print((world_T_camera * np.array([1, 0, 0.5])).round(3))
[0.  1.  2.5]
>>> print((world_T_camera * world_T_camera.inverse() - slom.SE3()).round(3) == 0)
[ True  True  True  True  True  True])";

inline constexpr const char* kRows =
    R"(Values of one type, such as SE3, one a row. Index arrays and masks select rows. Members are arrays or Rows themselves.

values  a list of values; with `like`, an array (rows, numbers of a value)
like    a type or value: slom.SE3 stores the position and the quaternion (x, y, z, w)

>>> poses = slom.Rows([slom.SE2(1, 2, 0.5), slom.SE2(3, 4, -0.5)])
>>> print(poses.pos)
[[1. 2.]
 [3. 4.]]
>>> poses[1]
SE2(pos=[3, 4], orient=SO2(-0.5))
>>> slom.Rows(poses.numbers, like=slom.SE2)[np.array([0, 0, 1])]
<3 rows of SE2>)";

inline constexpr const char* kLoad =
    R"(Reads a problem that Estimator.save or slom::Archive wrote. Returns the estimator and its variables by name;
those called x[0], x[1], ... are the VariableArray "x".

>>> import os, tempfile
>>> est = slom.Estimator()
>>> x = est.variable(0.0, "x")
>>> reading = est.prior(x, 2.0, sigma=0.1)
>>> with tempfile.TemporaryDirectory() as folder:
...     file = os.path.join(folder, "problem.slom")
...     est.save(file)
...     again, variables = slom.load(file)
>>> fit = again.optimize()
>>> print(round(variables["x"].value, 3))
2.0)";

inline constexpr const char* kFixedLag =
    R"(A window over the newest variables of an estimator. Older ones are marginalised: their measurements become a prior.

variables  number of variables that are kept
duration   time that variables are kept, in the unit of the times passed to add

>>> est, window = slom.Estimator(), slom.FixedLag(variables=3)
>>> x = [est.variable(0.0, "x0")]
>>> start = est.prior(x[0], 0.0, sigma=0.1)
>>> window.add(x[0])
>>> for k in range(1, 6):
...     x.append(est.variable(0.0, f"x{k}"))
...     step = est.measure(lambda a, b: b - a, x[k - 1], x[k], measured=np.array([1.0]), sigma=0.1)
...     window.add(x[k])
...     update = est.update()
...     forgotten = window.forget(est)
>>> len(window), round(x[5].value, 3)
(3, 5.0))";

inline constexpr const char* Huber =
    R"(Huber's loss: quadratic up to `scale` standard deviations, linear beyond. It bounds the influence of gross errors.

>>> est = slom.Estimator()
>>> x = est.variable(0.0, "x")
>>> y = np.array([1.0, 1.1, 0.9, 1.0, 9.0])
>>> m = est.measure(lambda x: x, x, measured=y, sigma=0.1, loss=slom.Huber(1.345))
>>> fit = est.optimize()
>>> print(f"{x.value:.2f}, weight of the last {m.weights[4]:.3f}")
1.03, weight of the last 0.017)";

inline constexpr const char* PseudoHuber =
    "Huber's loss with smooth derivatives; scale in standard deviations.";

inline constexpr const char* Cauchy =
    "Cauchy's loss: the influence of far residuals falls slowly; scale in standard deviations.";

inline constexpr const char* Tukey =
    "Tukey's biweight: residuals beyond `scale` standard deviations have no influence. Needs good start values.";

inline constexpr const char* GemanMcClure =
    "The loss of Geman and McClure: the influence of far residuals falls fast; scale in standard deviations. Needs good "
    "start values.";

inline constexpr const char* Barron =
    R"(Barron's general loss with scale c in standard deviations. The smaller the shape, the sooner residuals lose influence.

shape  2: least squares; 1: PseudoHuber(c); 0: Cauchy(sqrt(2) c); -2: GemanMcClure(2 c))";

}  // namespace slom::python::doc
