"""What NumPy does with recorded numbers, as a table. Each expression gives the residuals and the derivatives that plain
numbers give, or the sentence of the second table. The seed varies and is printed; SLOM_SEED sets it."""

import copy
import functools
import math
import operator
import os
import pickle
import random
import time
import unittest
import warnings

import numpy as np

import slom

SEED = int(os.environ.get("SLOM_SEED", time.time_ns() % 1_000_000))

MASK = np.array([True, False, True, False])
TABLE = np.array([0.5, -1.0, 2.0, 0.25])
A = np.array([[2.0, 0.3, -0.1], [0.2, -1.5, 0.4], [0.1, 0.6, 1.8]])


def skew(v):
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def rodrigues(v: np.ndarray, point: np.ndarray) -> np.ndarray:
    angle = np.linalg.norm(v)
    K = skew(v / angle)
    return (np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K) @ point


def quaternion_product(a, b):
    (w, x, y, z), (s, t, u, v) = a, b
    return np.array(
        [w * s - x * t - y * u - z * v, w * t + x * s + y * v - z * u, w * u - x * v + y * s + z * t]
        + [w * v + x * u - y * t + z * s]
    )


def distorted(k, r):
    factor, power = 1.0, 1.0
    for coefficient in k:
        power *= r
        factor += coefficient * power
    return factor * r


def running_sum(x, p):
    position, out = np.zeros(2), []
    for step in range(3):
        position = position + np.array([np.cos(x[1] * step), np.sin(x[1] * step)]) * p[step]
        out.append(position)
    return np.stack(out)


def filled(x, p):
    out = np.zeros(3, dtype=object)
    out[0] = x[0]
    out[1:] += p[:2] * x[1]
    return out


def updated(x, p):
    y = x.copy()
    y += 1
    y[0] *= 2
    y[1:3] -= p[1:3]
    y **= 2
    return np.concatenate([x, y])


def scalar_updated(x, p):
    a = x[0]
    a += p[0]
    a *= 2
    return np.stack([x[0], a])


class Model:
    offset = 0.5

    def residual(self, x, p):
        return x * self.offset - p

    def __call__(self, x, p):
        return self.residual(x, p) ** 2


def smooth_table(t):
    y = TABLE[0]
    for i in range(1, 4):
        y = slom.where(t > i - 1.5, TABLE[i - 1] + (t - i + 1.5) * (TABLE[i] - TABLE[i - 1]), y)
    return y


# Expressions of a variable x of 4 numbers, a row p of 4 numbers and a row Q of 2 x 3 numbers.
EQUAL = """
p - x ; x - p ; TABLE - x ; x - TABLE ; x[0] - TABLE ; TABLE - x[0] ; p[0] - x ; x - p[0] ; np.float64(2) - x[0]
x[0] - np.float64(2) ; np.float32(2) - x[0] ; x[0] - np.int64(2) ; 3 - x ; x - 3 ; -x ; +x ; np.array(2.0) - x[0]
x[0] + np.array([2.0]) ; x[0] * x[1] - p[2] / x[3] ; 3 / x ; x / 3 ; TABLE / x ; x / TABLE ; np.float64(3) / x[1]
np.subtract(TABLE, x) ; np.subtract(x[0], TABLE) ; np.true_divide(1, x) ; np.multiply.outer(x, TABLE)
[x[0], p[1] * x[2]] ; (x[0], [x[1], 2.0]) ; True + x[0] ; x[0] - True

slom.where(x > p, x, 0.0) ; slom.where(p >= x, x, p) ; slom.where(x[0] < 1, x, -x) ; slom.where(TABLE < x, x * x, 1)
slom.where(np.float64(0.3) < x[0], x[0], 2) ; slom.where(x[0] > np.float64(0.3), x[0], 2) ; slom.where(MASK, x, p)
slom.where(x == x, x, p) ; slom.where(x == p, x, p) ; slom.where(p != x, x, p) ; slom.where(x[0] == TABLE, 1, x)
slom.where(TABLE == x[0], 1, x) ; slom.where(np.float64(1) == x[0], x[0], 3 * x[0]) ; slom.where(x <= TABLE, x, 1)
np.where(x > 0, x, 3 * x) ; np.where(x[0] > 0, x[0], 0.0) ; np.where(x[0] > 0, x, p) ; np.where(MASK, x, 2.0)
np.where((x > 0) & (p > 0), x, p) ; np.where((x > 0) | (p < 0), x, p) ; np.where(~(x > 0), x, p)
np.where((x > 0) ^ (p > 0), x, p) ; np.where((x > 0) & MASK, x, p) ; np.where(MASK | (x > 0), x, p)
np.where(np.logical_and(x > 0, p > 0), x, p) ; np.where(np.logical_not(x > 0), x, p) ; np.where(True & (x > 0), x, p)
np.where((x > 0) == True, x, p) ; np.where((x > 0) == False, x, p) ; np.where((x > 0) != (p > 0), x, p)
np.where((x[0] > 0) == True, x, p) ; np.where(np.any(x > 1), x, p) ; np.where(np.all(x > -1), x, p)
np.where((x > 0).all(), x, p) ; np.where((x > 0).any(), x, p) ; np.where(np.all(x[0] > 0), x, p)
np.where((Q > 0).any(axis=0), x[:3], p[:3]) ; np.select([x > 1, x > 0], [x, 2 * x], 3 * x)
np.where(slom.array([x[0], 1.0]) > 0.5, x[:2], 0) ; np.where(np.logical_or.reduce(x > 1), x, p)
np.where(np.less(x, p), x, p) ; np.where(np.greater_equal(1.0, x), x, p) ; np.where(np.isscalar(x[0]), x, p)

skew(x[:3]) @ p[:3] ; skew(x[:3]).T.dot(p[:3]) - np.cross(x[:3], p[:3]) ; skew(x[:3]) @ A ; A @ skew(x[:3]) @ A.T
np.stack([x, p]) ; np.stack([x[0], x[1]]) ; np.stack([x[0], 1.0, 2]) ; np.stack([x, TABLE], axis=1)
np.vstack([x, p]) ; np.hstack([x, p[0], 1.0]) ; np.concatenate([x[:2], p[1:]]) ; np.concatenate([TABLE, x])
np.append(x, 1.0) ; np.append(TABLE, x[0]) ; np.column_stack([x, p]) ; np.dstack([x, p]) ; np.block([[x, p], [p, x]])
np.linalg.norm(x) ; np.linalg.norm(x - p) ; np.linalg.norm(Q * x[0], axis=0) ; np.linalg.norm(Q * x[0], axis=-1)
np.linalg.norm(x, 1) ; np.linalg.norm(x, np.inf) ; np.linalg.norm(x, -np.inf) ; np.linalg.norm(x, 3)
np.linalg.norm(x, ord=2) ; np.linalg.norm(Q * x[0], np.inf) ; np.linalg.norm(Q * x[:3], 1) ; np.linalg.norm(Q + x[0], "fro")
np.linalg.norm([x[0], 1.0, p[2]]) ; np.linalg.norm(np.array([x[0], 1.0, p[2]])) ; np.linalg.norm(Q * x[0], -1, (1, 0))
np.linalg.norm(Q * x[0], axis=1, keepdims=True) ; np.linalg.norm(slom.array([[x[0], 0], [0, 1.0]]), axis=1)
np.cross(x[:3], p[:3]) ; np.cross(TABLE[:3], x[:3]) ; np.cross(Q, x[:3]) ; np.dot(x, p) ; np.dot(Q, x[:3]) ; np.dot(x, TABLE)
x.dot(TABLE) ; TABLE.dot(x) ; np.inner(x, p) ; np.inner(TABLE, x) ; np.outer(x, TABLE) ; np.outer(TABLE, x)
np.vdot(x, p) ; np.trace(A * x[0]) ; np.trace(np.outer(x, p)) ; x @ p ; TABLE @ x ; Q @ x[:3] ; A @ x[:3] ; x[:3] @ A
np.matmul(A, x[:3]) ; np.matmul(Q * x[0], A) ; np.tensordot(Q, x[:3], 1) ; np.kron(x[:2], TABLE[:2])
np.einsum("i,i->", x, p) ; np.einsum("i,i", x, TABLE) ; np.einsum("ij,j->i", Q, x[:3]) ; np.einsum("ij->ji", Q * x[0])
np.einsum("ii->i", np.outer(x, p)) ; np.einsum("ii", np.outer(x, p)) ; np.einsum("i,j->ij", x, p)
np.einsum("ij,jk,k->i", Q, A, x[:3], optimize=True) ; np.einsum("i,i,i", x, x, p) ; np.einsum("ji,j", Q, x[:2])
np.linalg.multi_dot([Q, A, x[:3]]) ; np.linalg.matrix_power(np.outer(x[:2], p[:2]) + np.eye(2) * x[2], 3)

np.sum(x) ; np.sum(Q * x[0], axis=0) ; x.sum() ; np.mean(x) ; np.mean(Q * x[0], axis=1) ; np.mean(x, dtype=float)
np.prod(x) ; np.cumsum(x) ; x.cumsum() ; np.cumprod(x) ; np.diff(x) ; np.diff(x, 2) ; np.add.reduce(x) ; np.var(x) ; np.std(x)
np.add.accumulate(x) ; np.sum(x, where=MASK) ; np.sum([x[0], p[1]]) ; np.average(x, weights=TABLE**2) ; np.ptp(x)
np.max(x) ; np.min(x) ; x.max() ; np.amin(x) ; np.max(Q * x[0], axis=0) ; np.max(Q * x[0]) ; np.maximum.reduce(x)
np.maximum(x, p) ; np.maximum(x, 0) ; np.maximum(0.5, x[0]) ; np.minimum(TABLE, x) ; np.minimum(x[0], TABLE)
np.fmax(x, 0) ; np.fmin(x, p) ; np.maximum.accumulate(x) ; np.clip(x, -0.5, 0.5) ; np.clip(x[0], 0, 1) ; x.clip(0, None)
np.clip(x, None, 0.5) ; np.clip(TABLE, x[0] - 1, x[0] + 1) ; np.maximum(x[0], x[1])
np.abs(x) ; abs(x) ; abs(x[0]) ; np.abs(x[0]) ; np.fabs(x) ; np.sign(x) * x ; np.sign(x[0]) ; np.copysign(x, p)
np.heaviside(x, 0.5) * x ; np.floor(3 * x) + x ; np.ceil(3 * x) + x ; np.trunc(3 * x) + x ; np.fix(3 * x) ; math.floor(3 * x[0]) ; math.ceil(x[0])
math.trunc(3 * x[0]) ; np.trapz(x) if hasattr(np, "trapz") else np.trapezoid(x)

x % p ; x % 0.7 ; x[0] % 0.7 ; 5 % x[0] ; x // 0.7 + x ; x[0] // p[0] ; 5 // x[0] ; np.mod(x, 0.7) ; np.remainder(TABLE, x)
np.fmod(3 * x, 0.7) ; np.fmod(TABLE, x) ; divmod(x[0], 0.7) ; np.divmod(x, 0.7) ; np.floor_divide(x, p) ; -x % -0.3 ; TABLE % x[0]
np.float64(5) % x[0] ; (x + np.pi) % (2 * np.pi) - np.pi
x**2 ; x**3 ; x**4 ; x**-1 ; x**-2 ; x**0 ; x**1 ; abs(x) ** 0.5 ; abs(x) ** 1.5 ; abs(x) ** -0.3 ; abs(x) ** p ; abs(x[0]) ** x[1]
2**x ; 2.0 ** x[0] ; np.float64(2) ** x[0] ; TABLE**2 * x ; abs(TABLE) ** x ; abs(TABLE) ** x[0] ; x[0] ** 2 ; x[0] ** -3
x[0] ** np.int64(3) ; x ** np.array([1, 2, 3, 4]) ; np.power(x, 2) ; np.power(abs(x), p) ; np.power(2.0, x) ; np.float_power(abs(x), 1.5)
pow(x[0], 2) ; np.square(x) ; np.square(x[0]) ; np.reciprocal(x) ; np.cbrt(x) ; np.cbrt(x[0]) ; np.deg2rad(x) ; np.radians(x[0])
np.rad2deg(x) ; np.degrees(x) ; np.exp2(x) ; np.logaddexp(x, p) ; np.logaddexp(x[0], 1.0) ; np.logaddexp2(x, 0.3) ; np.sinc(x)
np.sinc(x[0]) ; np.polyval([1.0, -2.0, 0.5], x) ; np.polyval(x, 0.7) ; np.polyval(x, TABLE) ; np.polyval([1, 2], x[0])
np.polynomial.polynomial.polyval(x, [1.0, -2.0, 0.5]) ; np.polynomial.polynomial.polyval(0.7, x) ; np.hypot(x, p)
np.hypot(x, 1.0) ; np.hypot(1.0, x) ; np.hypot(TABLE, x[0]) ; np.arctan2(x, p) ; np.arctan2(1.0, x) ; np.arctan2(x, 1) ; np.arctan2(TABLE, x)
np.sqrt(x * x + 1) ; np.sin(x) ; np.sin(x[0]) ; np.cos(x) ; np.tan(x) ; np.arcsin(x / 9) ; np.arccos(x / 9) ; np.arctan(x)
np.sinh(x) ; np.cosh(x) ; np.tanh(x) ; np.arcsinh(x) ; np.arccosh(x * x + 1.5) ; np.arctanh(x / 9) ; np.exp(x) ; np.expm1(x)
np.log(x * x) ; np.log1p(x * x) ; np.log10(x * x) ; np.log2(x * x) ; np.sqrt(slom.array([x[0] ** 2, 4.0])) ; np.positive(x)
np.convolve(x, [1.0, 2.0]) ; np.negative(x) ; np.absolute(x) ; np.conj(x) * p ; np.real(x)

np.linalg.det(A * x[0]) ; np.linalg.det(slom.array([[x[0], 1.0], [2.0, x[1]]])) ; np.linalg.det(A + skew(x[:3]) + x[0] * 0)
np.linalg.inv(slom.array([[x[0] + 4, 1.0], [0.5, x[1] - 3]])) ; np.linalg.inv(A + 0.1 * slom.array(skew(x[:3])))
np.linalg.inv(np.eye(4) * 5 + 0.1 * np.outer(x, p)) @ p ; np.linalg.solve(A, x[:3]) ; np.linalg.solve(A + 0.1 * slom.array(skew(x[:3])), p[:3])

np.reshape(x, (2, 2)) @ p[:2] ; x.reshape(2, -1) ; np.transpose(Q * x[0]) ; (Q * x[0]).T ; np.ravel(Q * x[0]) ; np.atleast_1d(x[0]) * TABLE
np.atleast_2d(x) ; np.asarray(x) - TABLE ; np.asarray(x[0]) + 1 ; np.asarray([x[0], 1.0]) * 2 ; np.array([x[0], 2.0]) + p[:2]
np.array([x, p]) * 2 ; x[1:3] ; x[::-1] ; x[MASK] ; p[~MASK] * x[0] ; x[[0, 2]] ; x[np.array([3, 1])] ; x[-1] ; x[..., None] * TABLE
Q[1] * x[:3] ; Q[:, 0] * x[0] ; np.squeeze(x[None]) ; np.expand_dims(x, 0) ; np.tile(x, 2) ; np.repeat(x, 2) ; np.roll(x, 1) ; np.flip(x)
np.split(x, 2) ; np.zeros_like(x) + x ; np.ones_like(x) * x ; np.full_like(x, 2.0) - x ; np.full(3, x[0]) ; np.take(x, [1, 2])
np.diag(x) ; np.diag(np.outer(x, p)) ; np.insert(x, 1, 2.0) ; np.delete(x, 1) ; np.triu(np.outer(x, p)) ; np.broadcast_to(x[0], 3)
np.moveaxis(Q * x[0], 0, 1) ; np.shape(x)[0] * x[0] ; np.ndim(x[0]) + x[0] ; np.size(x) * x ; len(x) * x ; list(x) ; x.tolist()
x.astype(float) ; x.copy() ; np.copy(x) ; x.flatten() ; np.meshgrid(x[:2], p[:2])[0] ; np.vectorize(lambda a: a * a)(x)
np.apply_along_axis(lambda v: v * 2, 0, x) ; x.take([0]) ; np.array([a * 2 for a in x]) ; x.mean() - x.prod() ; copy.deepcopy(x) - p

sum([x[0], x[1], 2.0]) ; sum(x) ; [a - b for a, b in zip(x, p)] ; [operator.sub(TABLE[0], a) for a in x] ; functools.reduce(operator.mul, x)
filled(x, p) ; updated(x, p) ; scalar_updated(x, p) ; rodrigues(x[:3], p[:3]) ; rodrigues(p[:3], x[:3]) ; quaternion_product(x, p)
distorted(x, p[0]) ; distorted(TABLE, x[0]) ; running_sum(x, p) ; Model()(x, p) ; Model().residual(x, p) ; smooth_table(x[0])
functools.partial(distorted, TABLE)(x[1]) ; copy.copy(x[0]) * 2 ; copy.deepcopy(x[0]) * 2 ; copy.deepcopy(x) * 2
"""


def table(text):
    return [entry.strip() for line in text.splitlines() for entry in line.split(" ; ") if entry.strip()]


def flat(value):
    if isinstance(value, (list, tuple)):
        return [x for entry in value for x in flat(entry)]
    return list(np.ravel(value)) if isinstance(value, np.ndarray) else [value]


def call(expression):
    return eval("lambda x, p, Q: " + expression, globals())


def derivatives(f, x, h):
    steps = np.eye(x.size) * h
    return np.stack([(f(x + d) - f(x - d)) / (2 * h) for d in steps], axis=1)


class Expressions(unittest.TestCase):
    """Checks residuals, and derivatives by the covariance: the residuals (x, x_0 + f) have J^T J = I + sum of v v^T,
    v = e_0 + the gradient of an entry of f. Only -f - 2 x_0 has the same."""

    def check(self, expression, rng):
        f = call(expression)
        draw = lambda *shape: rng.choice([-1, 1], shape) * rng.uniform(0.2, 1.7, shape)
        for _ in range(20):  # until no corner of f is near
            x, p, Q = draw(4), draw(4), draw(2, 3)
            plain = lambda x: np.array([float(r) for r in flat(f(x.copy(), p.copy(), Q.copy()))])
            coarse, fine = derivatives(plain, x, 4e-4), derivatives(plain, x, 2e-4)
            if np.allclose(coarse, fine, rtol=1e-4, atol=1e-5):
                break
        else:
            self.fail("all points are near corners")
        est = slom.Estimator()
        variable = est.variable(x)
        est.measure(lambda x, p, Q: flat(f(x, p, Q)), variable, p[None], Q[None])
        np.testing.assert_allclose(est.residuals(), plain(x), rtol=1e-13, atol=1e-13)
        both = slom.Estimator()
        variable = both.variable(x)
        both.measure(lambda x, p, Q: list(x) + [x[0] + r for r in flat(f(x.copy(), p, Q))], variable, p[None], Q[None])
        v = (4 * fine - coarse) / 3 + np.eye(4)[0]
        np.testing.assert_allclose(np.linalg.inv(variable.covariance), np.eye(4) + v.T @ v, rtol=1e-6, atol=1e-6)

    def test_residuals_and_derivatives(self):
        rng = np.random.default_rng(SEED)
        failed = []
        for expression in table(EQUAL):
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore", DeprecationWarning)  # np.cross in 2-D, np.trapz
                    self.check(expression, rng)
            except Exception as error:
                failed.append(f"{expression}\n    {type(error).__name__}: {str(error).strip()[:600]}")
        self.assertFalse(failed, f"SLOM_SEED={SEED}, NumPy {np.__version__}:\n" + "\n".join(failed))


if __name__ == "__main__":
    print(f"NumPy {np.__version__}, SLOM_SEED={SEED}")
    unittest.main()
