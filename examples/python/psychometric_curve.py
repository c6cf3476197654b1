"""Fits a psychometric function: the probability of a correct answer as a function of the strength of a stimulus.

In each trial the observer chooses one of 2 answers. Without a stimulus half of the answers are correct (guess rate 0.5). Some
answers are wrong at any strength (lapse rate):

    P(x) = 0.5 + (0.5 - lapse) / (1 + exp(-(x - threshold) / spread))

The data are k correct answers of n trials at each strength x, with a binomial distribution. The residual is the signed root
of the deviance. Its sum of squares is twice the difference of the log-likelihoods of the data's own frequencies and of P. So
least squares is maximum likelihood, and the profile intervals are likelihood-ratio intervals. Standard deviations, and the
chi-square of the fit, are approximations for many trials.
"""

import numpy as np
from numpy.typing import NDArray

import slom

Vector = NDArray[np.float64]
GUESS = 0.5
TRUE = {"threshold": 2.0, "spread": 0.4, "lapse": 0.03}


def probability(x: float, threshold: float, spread: float, lapse: float) -> float:
    return GUESS + (1 - GUESS - lapse) / (1 + np.exp(-(x - threshold) / spread))


def entropy(k: Vector, n: int) -> Vector:
    """Returns k log(k/n) + (n - k) log(1 - k/n), with 0 log 0 = 0."""
    return sum(m * np.log(np.maximum(m, 1) / n) for m in (k, n - k))


def deviance_residual(threshold: float, spread: float, lapse: float, x: float, k: float, n: float, most: float) -> float:
    """Returns sign(k/n - P) sqrt(deviance); `most` is the logarithm of the likelihood of P = k/n."""
    p = probability(x, threshold, spread, lapse)
    deviance = 2 * (most - k * np.log(p) - (n - k) * np.log(1 - p))
    difference = k / n - p
    near = difference / np.sqrt(p * (1 - p) / n)  # to first order the same, and smooth at p = k/n
    return slom.where(abs(near) < 1e-3, near, np.sign(difference) * np.sqrt(deviance))


rng = np.random.default_rng(1)
TRIALS = 60
strength = np.linspace(0.5, 4.5, 9)
correct = rng.binomial(TRIALS, probability(strength, **TRUE)).astype(float)
print("strength", *strength)
print("correct ", *correct.astype(int), "of", TRIALS)

est = slom.Estimator()
threshold = est.variable(1.5, "threshold")
spread = est.variable(1.0, "spread")
lapse = est.variable(0.01, "lapse")
spread.bound(0.01, np.inf)
lapse.bound(0, 0.1)
trials, best = np.full(len(strength), float(TRIALS)), entropy(correct, TRIALS)
est.measure(deviance_residual, threshold, spread, lapse, strength, correct, trials, best, sigma=1.0, name="deviance")
fit = est.optimize()
print(f"converged: {fit.converged}, deviance {fit.final_rss:.2f} for {fit.redundancy} degrees of freedom\n")
print(est.intervals())
for x in (threshold, spread, lapse):
    interval = est.profile(x)
    inside = interval.lower <= TRUE[x.name] <= interval.upper
    print(f"{x.name}: true value {TRUE[x.name]} is {'inside' if inside else 'outside'}")

at_75 = est.propagate(lambda t, s, l: t - s * np.log((0.5 - l) / 0.25 - 1), threshold, spread, lapse)
print(f"75 % correct at {at_75.value:.2f} +- {at_75.std:.2f}")
