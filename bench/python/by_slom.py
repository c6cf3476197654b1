"""The jobs of fits.py that SLoM does from Python."""
import time

import numpy as np
import slom

from problems import circle, path_of


def fitted(est, start, **options):
    """Fits, and returns the times of insertion since `start` and of the fit."""
    insertion = time.perf_counter() - start
    est.set_threads(1)
    start = time.perf_counter()
    fit = est.optimize(**options)
    wall = time.perf_counter() - start
    assert fit.kinds[0].derivatives == "exact"
    return {"insert": insertion, "begin": fit.trace[0].seconds, "first": fit.trace[1].seconds,
            "fit": fit.trace[-1].seconds, "seconds": fit.seconds, "wall": wall,
            "iterations": fit.iterations, "rss": fit.final_rss}


def graph(data, name):
    problem = slom.read_g2o(path_of(data, name))
    start = time.perf_counter()
    est = slom.Estimator()
    poses, edges = est.variables(problem.poses, "pose"), problem.edges
    poses[0].fix()
    est.measure(lambda a, b: a.inverse() * b, poses[edges.i], poses[edges.j], measured=edges.measured,
                information=edges.information_in_i)
    return fitted(est, start, deviation_tolerance=1e-4)  # the command's


def bundle(data, name, tolerance):
    problem = slom.read_bal(path_of(data, name))
    start = time.perf_counter()
    est = slom.Estimator()
    cameras = est.variables(problem.cameras, "camera")
    points = est.variables(problem.points, "point")
    est.measure(slom.BalCamera.project, cameras[problem.i], points[problem.j], measured=problem.pixels)
    est.use_algorithm("lm", memory=0.1)
    # The options are the command's.
    return fitted(est, start, decrease_tolerance=tolerance, deviation_tolerance=np.inf, max_iterations=100)


def circle_fit(points):
    est = slom.Estimator()
    centre, radius = est.variable([0.0, 0.0], "centre"), est.variable(1.0, "radius")
    start = time.perf_counter()
    est.measure(lambda c, r, p: np.linalg.norm(p - c) - r, centre, radius, points, sigma=0.1)
    return fitted(est, start)


def small():
    """Returns the time from the first `measure` of the process to the end of the first iteration."""
    result = circle_fit(circle(20))
    return {"seconds": result["insert"] + result["first"]}


def curve(n=1000000):
    """Inserts scalar measurements from arrays."""
    t = np.linspace(0, 4, n)
    y = 2.5 * np.exp(-1.3 * t) + 0.01 * np.random.default_rng(1).normal(size=n)
    est = slom.Estimator()
    a, b = est.variable(1.0, "a"), est.variable(1.0, "b")
    start = time.perf_counter()
    est.measure(lambda a, b, t: a * np.exp(-b * t), a, b, t, measured=y, sigma=0.01)
    return fitted(est, start)


def job(name, data):
    kind, _, what = name.partition(":")
    if kind == "small":
        return small()
    if kind == "million":
        return curve()
    if kind == "circle":
        return circle_fit(circle())
    if kind == "bundle":
        what, tolerance = what.split(",")
        return bundle(data, what, float(tolerance))
    return graph(data, what)
