#!/usr/bin/python3
"""The rows of bench_honesty for SciPy's least_squares, with its default options and exact derivatives.

    bench/honesty/by_scipy.py MODULE [--fits N] [--set NAME]

MODULE is the shared library honesty_problems, which the preset `bench` builds: the same starts, the same check of each claim.
Needs Debian's python3-scipy.
"""

import argparse
import ctypes
import warnings

import numpy
from scipy.optimize import least_squares

SETS = ["published", "classics", "curves", "sigmoid", "decays"]


def load(path):
    module = ctypes.CDLL(path)
    module.honesty_open.restype = ctypes.c_void_p
    module.honesty_open.argtypes = [ctypes.c_int, ctypes.c_uint64]
    module.honesty_start.restype = ctypes.POINTER(ctypes.c_double)
    for name in ["close", "unknowns", "residuals", "start"]:
        getattr(module, "honesty_" + name).argtypes = [ctypes.c_void_p]
    numbers = numpy.ctypeslib.ndpointer(dtype=float, flags="C_CONTIGUOUS")
    module.honesty_evaluate.argtypes = module.honesty_jacobian.argtypes = [ctypes.c_void_p, numbers, numbers]
    module.honesty_is_false.argtypes = module.honesty_has_free_directions.argtypes = [ctypes.c_void_p, numbers]
    module.honesty_is_optimum.argtypes = module.honesty_is_saddle.argtypes = [ctypes.c_void_p, ctypes.c_double]
    return module


class Score:
    def __init__(self):
        self.fits = self.throws = self.claims = self.false = self.free = self.saddles = self.optima = self.evaluations = 0


def add(score, module, number_of_set, number, method):
    problem = module.honesty_open(number_of_set, number)
    n, m = module.honesty_unknowns(problem), module.honesty_residuals(problem)
    start = numpy.ctypeslib.as_array(module.honesty_start(problem), shape=(n,)).copy()

    def residuals(x):
        r = numpy.empty(m)
        module.honesty_evaluate(problem, numpy.ascontiguousarray(x), r)
        return r

    def jacobian(x):
        J = numpy.empty((m, n))
        module.honesty_jacobian(problem, numpy.ascontiguousarray(x), J)
        return J

    score.fits += 1
    try:
        result = least_squares(residuals, start, jac=jacobian, method=method)
        score.evaluations += result.nfev
        score.saddles += module.honesty_is_saddle(problem, 2 * result.cost)
        if result.success:  # stopped by one of its tests of convergence
            x = numpy.ascontiguousarray(result.x)
            score.claims += 1
            if module.honesty_is_false(problem, x):
                score.false += 1
            elif module.honesty_is_optimum(problem, 2 * result.cost):
                score.optima += 1
            elif module.honesty_has_free_directions(problem, x):
                score.free += 1
    except (ValueError, SystemError, numpy.linalg.LinAlgError):  # residuals or a Jacobian that are not finite
        score.throws += 1
    module.honesty_close(problem)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("module")
    parser.add_argument("--fits", type=int, default=1000, help="random starts of each set")
    parser.add_argument("--set", choices=SETS, help="of this set alone")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    numpy.seterr(all="ignore")
    module = load(arguments.module)
    columns = ["fits", "throws", "claims", "false", "free", "saddle", "optima"]
    print(f"{'starts':10} {'method':28} " + " ".join(f"{column:>8}" for column in columns) + f" {'calls':>10}")
    for method, name in [("trf", "SciPy, trf (default)"), ("lm", "SciPy, lm (MINPACK)")]:
        for number_of_set, name_of_set in enumerate(SETS):
            if arguments.set not in (None, name_of_set):
                continue
            score = Score()
            for number in range(module.honesty_published() if number_of_set == 0 else arguments.fits):
                add(score, module, number_of_set, number, method)
            counts = [score.fits, score.throws, score.claims, score.false, score.free, score.saddles, score.optima]
            print(f"{name_of_set:10} {name:28} " + " ".join(f"{n:8}" for n in counts) + f" {score.evaluations / score.fits:10.1f}",
                  flush=True)


if __name__ == "__main__":
    main()
