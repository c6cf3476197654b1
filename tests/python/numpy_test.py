"""What NumPy does with recorded numbers, as a table. Each expression gives the residuals and the derivatives that plain
numbers give, or the sentence of the second table. The seed varies and is printed; SLOM_SEED sets it."""

import copy
import functools
import math
import operator
import os
import pathlib
import pickle
import re
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


def written(function, *arguments):
    """Gives the function an array to write to, by place."""
    out = np.zeros(4, dtype=object)
    function(*arguments, out)
    return out


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
np.linalg.norm(x, ord=2) ; np.linalg.norm(Q * x[0], np.inf) ; np.linalg.norm(Q * x[:3], 1)
np.linalg.norm(Q + x[0], "fro")
np.linalg.norm([x[0], 1.0, p[2]]) ; np.linalg.norm(np.array([x[0], 1.0, p[2]])) ; np.linalg.norm(Q * x[0], -1, (1, 0))
np.linalg.norm(Q * x[0], axis=1, keepdims=True) ; np.linalg.norm(slom.array([[x[0], 0], [0, 1.0]]), axis=1)
np.cross(x[:3], p[:3]) ; np.cross(TABLE[:3], x[:3]) ; np.cross(Q, x[:3]) ; np.dot(x, p) ; np.dot(Q, x[:3])
np.dot(x, TABLE)
x.dot(TABLE) ; TABLE.dot(x) ; np.inner(x, p) ; np.inner(TABLE, x) ; np.outer(x, TABLE) ; np.outer(TABLE, x)
np.vdot(x, p) ; np.trace(A * x[0]) ; np.trace(np.outer(x, p)) ; x @ p ; TABLE @ x ; Q @ x[:3] ; A @ x[:3] ; x[:3] @ A
np.matmul(A, x[:3]) ; np.matmul(Q * x[0], A) ; np.tensordot(Q, x[:3], 1) ; np.kron(x[:2], TABLE[:2])
np.einsum("i,i->", x, p) ; np.einsum("i,i", x, TABLE) ; np.einsum("ij,j->i", Q, x[:3]) ; np.einsum("ij->ji", Q * x[0])
np.einsum("ii->i", np.outer(x, p)) ; np.einsum("ii", np.outer(x, p)) ; np.einsum("i,j->ij", x, p)
np.einsum("ij,jk,k->i", Q, A, x[:3], optimize=True) ; np.einsum("i,i,i", x, x, p) ; np.einsum("ji,j", Q, x[:2])
np.linalg.multi_dot([Q, A, x[:3]]) ; np.linalg.matrix_power(np.outer(x[:2], p[:2]) + np.eye(2) * x[2], 3)

np.sum(x) ; np.sum(Q * x[0], axis=0) ; x.sum() ; np.mean(x) ; np.mean(Q * x[0], axis=1) ; np.mean(x, dtype=float)
np.prod(x) ; np.cumsum(x) ; x.cumsum() ; np.cumprod(x) ; np.diff(x) ; np.diff(x, 2) ; np.add.reduce(x) ; np.var(x)
np.std(x)
np.add.accumulate(x) ; np.sum(x, where=MASK) ; np.sum([x[0], p[1]]) ; np.average(x, weights=TABLE**2) ; np.ptp(x)
np.max(x) ; np.min(x) ; x.max() ; np.amin(x) ; np.max(Q * x[0], axis=0) ; np.max(Q * x[0]) ; np.maximum.reduce(x)
np.maximum(x, p) ; np.maximum(x, 0) ; np.maximum(0.5, x[0]) ; np.minimum(TABLE, x) ; np.minimum(x[0], TABLE)
np.fmax(x, 0) ; np.fmin(x, p) ; np.maximum.accumulate(x) ; np.clip(x, -0.5, 0.5) ; np.clip(x[0], 0, 1)
x.clip(0, None)
np.clip(x, None, 0.5) ; np.clip(TABLE, x[0] - 1, x[0] + 1) ; np.maximum(x[0], x[1])
np.abs(x) ; abs(x) ; abs(x[0]) ; np.abs(x[0]) ; np.fabs(x) ; np.sign(x) * x ; np.sign(x[0]) ; np.copysign(x, p)
np.heaviside(x, 0.5) * x ; np.floor(3 * x) + x ; np.ceil(3 * x) + x ; np.trunc(3 * x) + x ; np.fix(3 * x)
math.floor(3 * x[0]) ; math.ceil(x[0])
math.trunc(3 * x[0]) ; np.trapz(x) if hasattr(np, "trapz") else np.trapezoid(x)

x % p ; x % 0.7 ; x[0] % 0.7 ; 5 % x[0] ; x // 0.7 + x ; x[0] // p[0] ; 5 // x[0] ; np.mod(x, 0.7)
np.remainder(TABLE, x)
np.fmod(3 * x, 0.7) ; np.fmod(TABLE, x) ; divmod(x[0], 0.7) ; np.divmod(x, 0.7) ; np.floor_divide(x, p) ; -x % -0.3
TABLE % x[0]
np.float64(5) % x[0] ; (x + np.pi) % (2 * np.pi) - np.pi
x**2 ; x**3 ; x**4 ; x**-1 ; x**-2 ; x**0 ; x**1 ; abs(x) ** 0.5 ; abs(x) ** 1.5 ; abs(x) ** -0.3 ; abs(x) ** p
abs(x[0]) ** x[1]
2**x ; 2.0 ** x[0] ; np.float64(2) ** x[0] ; TABLE**2 * x ; abs(TABLE) ** x ; abs(TABLE) ** x[0] ; x[0] ** 2
x[0] ** -3
x[0] ** np.int64(3) ; x ** np.array([1, 2, 3, 4]) ; np.power(x, 2) ; np.power(abs(x), p) ; np.power(2.0, x)
np.float_power(abs(x), 1.5)
pow(x[0], 2) ; np.square(x) ; np.square(x[0]) ; np.reciprocal(x) ; np.cbrt(x) ; np.cbrt(x[0]) ; np.deg2rad(x)
np.radians(x[0])
np.rad2deg(x) ; np.degrees(x) ; np.exp2(x) ; np.logaddexp(x, p) ; np.logaddexp(x[0], 1.0) ; np.logaddexp2(x, 0.3)
np.sinc(x)
np.sinc(x[0]) ; np.polyval([1.0, -2.0, 0.5], x) ; np.polyval(x, 0.7) ; np.polyval(x, TABLE) ; np.polyval([1, 2], x[0])
np.polynomial.polynomial.polyval(x, [1.0, -2.0, 0.5]) ; np.polynomial.polynomial.polyval(0.7, x) ; np.hypot(x, p)
np.hypot(x, 1.0) ; np.hypot(1.0, x) ; np.hypot(TABLE, x[0]) ; np.arctan2(x, p) ; np.arctan2(1.0, x) ; np.arctan2(x, 1)
np.arctan2(TABLE, x)
np.sqrt(x * x + 1) ; np.sin(x) ; np.sin(x[0]) ; np.cos(x) ; np.tan(x) ; np.arcsin(x / 9) ; np.arccos(x / 9)
np.arctan(x)
np.sinh(x) ; np.cosh(x) ; np.tanh(x) ; np.arcsinh(x) ; np.arccosh(x * x + 1.5) ; np.arctanh(x / 9) ; np.exp(x)
np.expm1(x)
np.log(x * x) ; np.log1p(x * x) ; np.log10(x * x) ; np.log2(x * x) ; np.sqrt(slom.array([x[0] ** 2, 4.0]))
np.positive(x)
np.convolve(x, [1.0, 2.0]) ; np.negative(x) ; np.absolute(x) ; np.conj(x) * p ; np.real(x)

np.linalg.det(A * x[0]) ; np.linalg.det(slom.array([[x[0], 1.0], [2.0, x[1]]]))
np.linalg.det(A + skew(x[:3]) + x[0] * 0)
np.linalg.inv(slom.array([[x[0] + 4, 1.0], [0.5, x[1] - 3]])) ; np.linalg.inv(A + 0.1 * slom.array(skew(x[:3])))
np.linalg.inv(np.eye(4) * 5 + 0.1 * np.outer(x, p)) @ p ; np.linalg.solve(A, x[:3])
np.linalg.solve(A + 0.1 * slom.array(skew(x[:3])), p[:3])

np.reshape(x, (2, 2)) @ p[:2] ; x.reshape(2, -1) ; np.transpose(Q * x[0]) ; (Q * x[0]).T ; np.ravel(Q * x[0])
np.atleast_1d(x[0]) * TABLE
np.atleast_2d(x) ; np.asarray(x) - TABLE ; np.asarray(x[0]) + 1 ; np.asarray([x[0], 1.0]) * 2
np.array([x[0], 2.0]) + p[:2]
np.array([x, p]) * 2 ; x[1:3] ; x[::-1] ; x[MASK] ; p[~MASK] * x[0] ; x[[0, 2]] ; x[np.array([3, 1])] ; x[-1]
x[..., None] * TABLE
Q[1] * x[:3] ; Q[:, 0] * x[0] ; np.squeeze(x[None]) ; np.expand_dims(x, 0) ; np.tile(x, 2) ; np.repeat(x, 2)
np.roll(x, 1) ; np.flip(x)
np.split(x, 2) ; np.zeros_like(x) + x ; np.ones_like(x) * x ; np.full_like(x, 2.0) - x ; np.full(3, x[0])
np.take(x, [1, 2])
np.diag(x) ; np.diag(np.outer(x, p)) ; np.insert(x, 1, 2.0) ; np.delete(x, 1) ; np.triu(np.outer(x, p))
np.broadcast_to(x[0], 3)
np.moveaxis(Q * x[0], 0, 1) ; np.shape(x)[0] * x[0] ; np.ndim(x[0]) + x[0] ; np.size(x) * x ; len(x) * x ; list(x)
x.tolist()
x.astype(float) ; x.copy() ; np.copy(x) ; x.flatten() ; np.meshgrid(x[:2], p[:2])[0]
np.vectorize(lambda a: a * a)(x)
np.apply_along_axis(lambda v: v * 2, 0, x) ; x.take([0]) ; np.array([a * 2 for a in x]) ; x.mean() - x.prod()
copy.deepcopy(x) - p

sum([x[0], x[1], 2.0]) ; sum(x) ; [a - b for a, b in zip(x, p)] ; [operator.sub(TABLE[0], a) for a in x]
functools.reduce(operator.mul, x)
filled(x, p) ; updated(x, p) ; scalar_updated(x, p) ; rodrigues(x[:3], p[:3]) ; rodrigues(p[:3], x[:3])
quaternion_product(x, p)
distorted(x, p[0]) ; distorted(TABLE, x[0]) ; running_sum(x, p) ; Model()(x, p) ; Model().residual(x, p)
smooth_table(x[0])
written(np.cumsum, x, 0, None) ; written(np.clip, x, 0, 1) ; written(np.add, x, p)
written(np.sum, np.outer(x, p), 0, None)
functools.partial(distorted, TABLE)(x[1]) ; copy.copy(x[0]) * 2 ; copy.deepcopy(x[0]) * 2 ; copy.deepcopy(x) * 2
"""

# Sentences, each with the expressions that raise it. NAME stands for the function of the expression.
REFUSED = """
[slom.traced-value] float() needs the value of a recorded number, which is not known yet; use np.sin for math.sin, \
slom.array or np.zeros(n, dtype=object) for an array of floats, and drop dtype=float
    float(x[0]) ; math.sin(x[0]) ; math.hypot(x[0], 1) ; math.erf(x[0]) ; np.float64(x[0]) ; np.array(x, dtype=float)
    np.asarray(x[0], float) ; np.asarray(x, float) ; operator.setitem(np.zeros(3), 0, x[0]) ; np.fromiter(x, float)
    operator.setitem(np.zeros(4), slice(None), x) ; np.full(3, x[0], dtype=float) ; np.array(list(x), float)
[slom.traced-value] int() needs the value of a recorded number, which is not known yet; use np.floor, or np.trunc, \
which rounds towards 0
    int(x[0]) ; int(p[0])
[slom.traced-value] bool() needs the value of a recorded number, which is not known yet; write slom.where(x != 0, a, b)
    bool(x[0]) ; x if x[0] else p ; not x[0] ; x[0] and x[1] ; x[0] or 1 ; any(x)
[slom.traced-value] round() needs the value of a recorded number, which is not known yet; use np.floor(x + 0.5)
    round(x[0]) ; round(x[0], 2)
[slom.traced-value] an index needs the value of a recorded number, which is not known yet; look up data before \
est.measure and pass the result as an argument
    range(x[0]) ; list(TABLE)[x[0]] ; [1, 2][p[0]] ; [1, 2] * x[0]
[slom.traced-index] an index or a mask depends on recorded numbers; write slom.where(condition, a, b), or select data \
before est.measure
    x[x > 0] ; p[x[0] > 0] ; x[x[0]] ; x[[x[0]]] ; Q[:, p[:3] > 0] ; operator.setitem(x, x > 0, 1.0)
[slom.traced-branch] the measurement function branches on a recorded number; write slom.where(condition, a, b) for if, \
& | ~ for and or not, np.maximum for max, and slom.array([a, b]) for lists that NumPy compares
    x if x[0] > 0 else -x ; x[0] > 0 and x[1] > 0 ; x[0] > 0 or x[1] > 0 ; not x[0] > 0 ; max(x[0], x[1]) ; min(x)
    sorted(x) ; x if (x > 0).all() else p ; 0 < x[0] < 1 ; x[0] in [p[0], 1] ; np.array(x > 0, dtype=bool)
    x if p[0] > 0 else -x ; x if x[0] == 0 else p ; np.max([x[0], x[1]]) ; np.argmax([x[0], x[1]])
    np.array([x[0], x[1]]) == 3 ; np.array([x[0], x[1]]) != x[0:2].tolist() ; np.array([x[0], x[1]]) > 3
    np.array_equal(np.array(x), np.array(x)) ; np.sort(np.array([x[0], x[1]])) ; np.maximum(np.array([x[0], x[1]]), 0)
    np.sign(np.array([x[0], x[1]])) ; np.unique(np.array([x[0], x[1]])) ; np.clip(np.array([x[0], x[1]]), 0, 1)
[slom.traced-array] NumPy cannot compute this with objects, such as recorded numbers in an array made by np.array; \
make the array by slom.array
    np.isnan(np.array([x[0], x[1]])) ; np.linalg.inv(np.array([[x[0], 1], [2, x[1]]])) ; np.sqrt(np.array([x[0], 1.0]))
    np.logaddexp(np.array([x[0], x[1]]), 0) ; np.hypot(np.array([x[0], 1.0]), 2) ; np.exp(np.array([x[0], 1]))
    np.linalg.det([[x[0], 1], [2, x[1]]]) ; np.linalg.norm(np.array([[x[0], 0], [0, 1]]), axis=1)
[slom.traced-index] an index or a mask is no plain number; write slom.where(condition, a, b), or select data before \
est.measure
    TABLE[x[0]] ; TABLE[x] ; TABLE[p > 0]
[slom.traced-condition] arithmetic needs numbers, but got a condition; write slom.where(condition, 1.0, 0.0)
    (x > 0) * x ; (x[0] > 0) * x[0] ; x[0] * (x[0] > 0) ; np.sum(x > 0) ; 1 - (x[0] > 0) ; (x > 0) + (p > 0)
    float(x[0] > 0) ; -(x[0] > 0) ; (x > 0).astype(float) ; np.sin(x > 0) ; (x > 0).mean() ; (x > 0) * 1.0
[slom.traced-complex] recorded numbers are real; write the real and the imaginary part as numbers of their own
    complex(x[0]) ; 1j * x[0] ; x[0] * 1j ; x * 1j ; np.exp(1j * x)
[slom.traced-key] a recorded number has no hash, so dictionaries, sets and cached functions cannot hold it; keep it in \
a list or a variable
    {x[0]: 1} ; {x[0]} ; hash(x[0] > 0) ; functools.lru_cache(abs)(x[0])
[slom.traced-pickle] a recorded number exists during the call of the measurement function only and cannot be pickled; \
pickle the values of variables
    pickle.dumps(x[0]) ; pickle.dumps(x) ; pickle.dumps(x[0] > 0)
[slom.traced-out] np.add cannot store recorded numbers in an array of float64; make the array by \
np.zeros(n, dtype=object), or write a = a + b for a += b
    operator.iadd(np.zeros(4), x) ; operator.iadd(np.zeros(4), x[0]) ; np.add(x, p, out=np.zeros(4))
[slom.traced-entry] an array of recorded numbers has an entry of type NoneType; pass numbers, all rows of one length
    np.array([x[0], None]) + x[0] ; np.empty_like(x) + x
[slom.traced-result] a measurement function returned a value of type Condition; return a number, a NumPy array, or a \
list of such
    x[0] > 0 ; x > 0 ; [x[0], x[0] > 0]
[slom.traced-function] NAME does not take recorded numbers; sort and select data before est.measure; for recorded \
numbers, use np.maximum, np.minimum or slom.where
    np.sort(x) ; np.argsort(x) ; np.argmax(x) ; np.argmin(p) ; x.argmax() ; x.sort()
    np.median(x) ; np.percentile(x, 9) ; np.unique(x) ; np.partition(x, 1) ; np.quantile(x, 0.5) ; np.lexsort(x)
[slom.traced-function] NAME does not take recorded numbers; look up data before est.measure and pass the result as an \
argument
    np.searchsorted(TABLE, x[0]) ; np.digitize(x, TABLE) ; np.choose([0, 1, 0, 1], [x, p]) ; np.histogram(x)
[slom.traced-function] NAME does not take recorded numbers; interpolate data before est.measure, or write the pieces \
with slom.where
    np.interp(x[0], TABLE, TABLE) ; np.interp(p, TABLE, TABLE)
[slom.traced-function] NAME does not take recorded numbers; remove rows that are not finite before est.measure
    np.isnan(x) ; np.isfinite(x[0]) ; np.isinf(p) ; np.nan_to_num(x) ; np.nansum(x) ; np.nanmax(x)
[slom.traced-function] NAME does not take recorded numbers; write slom.where(condition, a, b)
    np.nonzero(x) ; np.count_nonzero(x) ; np.piecewise(x, [x > 0], [1, 2])
[slom.traced-function] NAME does not take recorded numbers; compare with == or <, and pass the condition to slom.where
    np.isclose(x, p) ; np.allclose(x, p) ; np.array_equal(x, p)
[slom.traced-function] NAME does not take recorded numbers; make the factors variables and return the defining \
equations as residuals
    np.linalg.svd(Q * x[0]) ; np.linalg.eigh(np.outer(x, x)) ; np.linalg.lstsq(Q * x[0], p[:2]) ; np.linalg.qr(Q * x[0])
    np.linalg.cholesky(np.outer(x, x)) ; np.linalg.pinv(Q * x[0])
[slom.traced-function] NAME of a matrix of shape 5 x 5 does not take recorded numbers; use up to 4 rows, or make the \
result a variable and return a @ x - b as the residual
    np.linalg.inv(np.eye(5) * x[0]) ; np.linalg.det(np.eye(5) * x[0]) ; np.linalg.solve(np.eye(5) * x[0], np.ones(5))
[slom.traced-function] NAME of this order does not take recorded numbers; use a number other than 0 or np.inf for \
vectors, and 'fro', 1 or np.inf for matrices
    np.linalg.norm(Q * x[0], 2) ; np.linalg.norm(x, 0) ; np.linalg.norm(Q * x[0], "nuc") ; np.linalg.norm(x, "fro")
[slom.traced-function] NAME does not take recorded numbers; use np.floor(x + 0.5)
    np.round(x) ; np.around(x, 2) ; np.rint(x) ; x.round()
[slom.traced-function] NAME does not take recorded numbers; use np.floor or np.trunc for integers, and drop other \
conversions
    x.astype(int) ; x.astype(np.float32)
[slom.traced-function] NAME does not take recorded numbers; write start + (stop - start) * np.linspace(0, 1, n)
    np.linspace(0, x[0], 3)
[slom.traced-function] NAME does not take recorded numbers; use np.trunc(x) and x - np.trunc(x)
    np.modf(x)
[slom.traced-function] NAME does not take recorded numbers; write x < 0
    np.signbit(x)
[slom.traced-function] NAME does not take recorded numbers; add 2 * np.pi * n with n from data, or return np.sin and \
np.cos of the angle
    np.unwrap(x)
[slom.traced-function] NAME of a condition alone does not take recorded numbers; write np.where(condition, a, b)
    np.where(x > 0)
[slom.traced-function] NAME does not take recorded numbers; use np.array and @
    np.matrix(A) * x[0]
[slom.traced-function] NAME with where= does not take recorded numbers; write slom.where(condition, a, b)
    np.add(x, p, where=MASK) ; np.add(x, p, where=x > 0)
[slom.traced-function] NAME does not take recorded numbers; write x[i] = ... for each index
    np.add.at(x, [0], 1)
[slom.traced-function] NAME with an ellipsis or lists of axes does not take recorded numbers; name all axes, as in \
np.einsum("ij,j->i", A, x)
    np.einsum("...i,i", Q, x[:3]) ; np.einsum(x, [0], p, [0])
[slom.traced-function] NAME does not take recorded numbers; write it with operators, slom.where and the functions of \
docs/python_functions.md
    np.gradient(x) ; np.ldexp(x, 2) ; np.frexp(x) ; np.nextafter(x, p) ; np.fft.fft(x) ; np.gcd(x, 2)
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
        est.measure(lambda x, p, Q: flat(f(x, p, Q)), variable, p[None], Q[None], trace=True)
        np.testing.assert_allclose(est.residuals(), plain(x), rtol=1e-13, atol=1e-13)
        both = slom.Estimator()
        variable = both.variable(x)
        both.measure(lambda x, p, Q: list(x) + [x[0] + r for r in flat(f(x.copy(), p, Q))], variable, p[None], Q[None], trace=True)
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


def refusals():
    """Returns pairs of an expression and its sentence."""
    pairs, sentence = [], ""
    for line in REFUSED.strip().splitlines():
        if line.startswith("["):
            sentence = line
        else:
            for expression in table(line):
                name = expression.partition("(")[0]
                pairs.append((expression, sentence.replace("NAME", name)))
    return pairs


class Sentences(unittest.TestCase):
    def measure(self, f):
        est = slom.Estimator()
        x = est.variable([0.4, -1.3, 2.1, 0.7], "x")
        est.measure(f, x, TABLE[None], np.ones((1, 2, 3)), trace=True)
        return est.residuals()

    def test_each_word(self):
        for expression, sentence in refusals():
            with self.subTest(expression), warnings.catch_warnings():
                warnings.simplefilter("ignore")  # NumPy 1.24 turns an error of == into a warning
                with self.assertRaises(slom.Error) as raised:
                    self.measure(call(expression))
                self.assertEqual(str(raised.exception), sentence)

    def test_an_error_leaves_nothing_behind(self):
        with self.assertRaises(slom.Error):
            self.measure(lambda x, p, Q: x if x[0] > 0 else p)
        np.testing.assert_array_equal(self.measure(lambda x, p, Q: x), [0.4, -1.3, 2.1, 0.7])

    def test_numbers_of_another_call(self):
        kept = []
        self.measure(lambda x, p, Q: kept.append(x) or x)
        with self.assertRaises(slom.Error) as raised:
            self.measure(lambda x, p, Q: x + kept[0])
        self.assertEqual(
            str(raised.exception),
            "[slom.traced-elsewhere] a number of a traced measurement function is used outside of the call that made "
            "it; do not keep numbers from one call to the next",
        )


class Objects(unittest.TestCase):
    """What recorded numbers are besides numbers."""

    def test_texts(self):
        def f(x, p):
            self.assertEqual(f"{x:.3f} {x > 0} {x * 0 + 1.5:.2f}", "<recorded number> <recorded condition> 1.50")
            self.assertEqual(str(p), "[<recorded number> <recorded number>]")
            self.assertFalse(x == None or x == "a" or (x > 0) == None)  # noqa: E711
            return x

        est = slom.Estimator()
        est.measure(f, est.variable(1.0), np.ones((2, 2)), trace=True)

    def test_changes_stay_in_the_argument(self):
        def f(x, y):
            x += 1
            x[0] *= 2
            return np.concatenate([x, y])

        est = slom.Estimator()
        x = est.variable([1.0, 2.0])
        est.measure(f, x, x, trace=True)
        np.testing.assert_array_equal(est.residuals(), [4, 3, 1, 2])
        np.testing.assert_array_equal(x.value, [1, 2])

    def test_integers_divide_exactly(self):
        pairs = np.array([(a, b) for a in range(-60, 61) for b in (-49, -7, -3, 1, 3, 7, 10, 49)], float)
        for f in (operator.floordiv, operator.mod, np.fmod):
            est = slom.Estimator()
            est.measure(lambda x, p: f(p[0], p[1]) + x, est.variable(0.0), pairs)
            np.testing.assert_array_equal(est.residuals(), f(pairs[:, 0], pairs[:, 1]))

    def test_captured_objects_stay(self):
        table = np.array([1, 2.5], dtype=object)
        est = slom.Estimator()
        est.measure(lambda x: np.sin(table * x) + np.concatenate([table[:1], x[:1]]), est.variable([1.0, 2.0]))
        self.assertEqual([type(entry) for entry in table], [int, float])

    def test_plain_numbers_stay_plain(self):
        self.assertEqual(slom.array([1, 2.5]).dtype, float)
        self.assertEqual(slom.where(TABLE > 0, TABLE, 0).dtype, float)
        self.assertIsInstance(slom.where(True, 1.0, 2.0), float)


class Page(unittest.TestCase):
    def test_example(self):
        page = pathlib.Path(__file__).parents[2] / "docs/python_functions.md"
        expected = [0.1, 5, 5 + math.log(2)]
        names = {"print": lambda residuals: np.testing.assert_allclose(residuals, expected, rtol=1e-14)}
        (example,) = re.findall("```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
        exec(example, names)


if __name__ == "__main__":
    print(f"NumPy {np.__version__}, SLOM_SEED={SEED}")
    unittest.main()
