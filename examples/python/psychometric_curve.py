"""Fits a psychometric function: the probability of a correct answer as a function of the strength of a stimulus.

In each trial the observer chooses one of 2 answers. Without a stimulus half of the answers are correct (guess rate 0.5). Some
answers are wrong at any strength (lapse rate):

    P(x) = 0.5 + (0.5 - lapse) / (1 + exp(-(x - threshold) / spread))

The data are k correct answers of n trials at each strength x, with a binomial distribution. The residual is the signed root
of the deviance: of twice the difference of the log-likelihoods of the frequency k / n and of P. So least squares is maximum
likelihood, and the profile intervals are likelihood-ratio intervals. Standard deviations, and the chi-square of the fit, are
approximations for many trials.
"""

from typing import Any

import numpy as np

import slom

GUESS = 0.5
TRUE = {"threshold": 2.0, "spread": 0.4, "lapse": 0.03}


def probability(x: Any, threshold: Any, spread: Any, lapse: Any) -> Any:
    return GUESS + (1 - GUESS - lapse) / (1 + np.exp(-(x - threshold) / spread))


def log_likelihood(k: Any, n: Any, p: Any) -> Any:
    return k * np.log(p) + (n - k) * np.log(1 - p)


def deviance(threshold: Any, spread: Any, lapse: Any, x: Any, k: Any, n: Any, largest: Any) -> Any:
    """Returns the signed root of the deviance; `largest` is the log-likelihood of the frequency k / n."""
    p = probability(x, threshold, spread, lapse)
    near = (k / n - p) / np.sqrt(p * (1 - p) / n)  # the same to first order, and smooth at p = k / n
    root = np.sqrt(2 * (largest - log_likelihood(k, n, p)))
    return slom.where(abs(near) < 1e-3, near, np.sign(k / n - p) * root)


rng = np.random.default_rng(1)
strength = np.linspace(0.5, 4.5, 9)
trials = np.full(9, 60.0)
correct = rng.binomial(60, probability(strength, **TRUE)).astype(float)
print("strength", *strength)
print("correct ", *correct.astype(int), "of 60")

est = slom.Estimator()
threshold = est.variable(1.5, "threshold")
spread = est.variable(1.0, "spread")
lapse = est.variable(0.01, "lapse")
spread.bound(0.01, np.inf)
lapse.bound(0, 0.1)
frequency = np.clip(correct / trials, 1e-12, 1 - 1e-12)  # 0 log 0 = 0
largest = log_likelihood(correct, trials, frequency)
est.measure(deviance, threshold, spread, lapse, strength, correct, trials, largest, sigma=1.0)
fit = est.optimize()
print(f"converged: {fit.converged}, deviance {fit.final_rss:.2f} for {fit.redundancy} degrees of freedom\n")
print(est.intervals())
for x in (threshold, spread, lapse):
    interval = est.profile(x)
    inside = interval.lower <= TRUE[x.name] <= interval.upper
    print(f"{x.name}: true value {TRUE[x.name]} is {'inside' if inside else 'outside'}")

at_75 = est.propagate(lambda t, s, l: t - s * np.log((0.5 - l) / 0.25 - 1), threshold, spread, lapse)
print(f"75 % correct at {at_75.value:.2f} +- {at_75.std:.2f}")
