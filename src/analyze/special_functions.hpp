/// Special functions for the distributions of statistics.
#pragma once

namespace slom {

/// Returns the logarithm of the gamma function at a > 0.
double logGamma(double a);

/// Returns the continued fraction of the incomplete beta function: I_x(a, b) = x^a (1 - x)^b / (a B(a, b)) times it.
///   source   NIST Digital Library of Mathematical Functions, 8.17.22
double betaFraction(double a, double b, double x);

/// Returns the probability that F with p and q degrees of freedom exceeds f.
///   source   ibid., 8.17.1: I_x(q / 2, p / 2), x = q / (q + p f)
double fProbability(double f, double p, double q);

}  // namespace slom
