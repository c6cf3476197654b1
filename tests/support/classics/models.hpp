/// Problems 1 to 27 of More, Garbow and Hillstrom, "Testing unconstrained optimization software", ACM TOMS 7,
/// 1981: residuals for any kind of number, starts, known minima of the sum of squares.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace slom::testing::classics {

struct Classic {
  int number = 0;
  const char* name = "";
  std::vector<double> start;
  int residuals = 0;
  std::vector<double> minima;  ///< minima of the RSS, with the local ones that the paper lists
};

inline const std::vector<Classic>& all() {
  static const std::vector<Classic> problems{
      {1, "Rosenbrock", {-1.2, 1}, 2, {0}},
      {2, "Freudenstein and Roth", {0.5, -2}, 2, {0, 48.9842536792400}},
      {3, "Powell badly scaled", {0, 1}, 2, {0}},
      {4, "Brown badly scaled", {1, 1}, 3, {0}},
      {5, "Beale", {1, 1}, 3, {0}},
      {6, "Jennrich and Sampson", {0.3, 0.4}, 10, {124.362182355615}},
      {7, "helical valley", {-1, 0, 0}, 3, {0}},
      {8, "Bard", {1, 1, 1}, 15, {8.21487730657897e-3, 17.4286933369301}},
      {9, "Gaussian", {0.4, 1, 0}, 15, {1.12793276961912e-8}},
      {10, "Meyer", {0.02, 4000, 250}, 16, {87.9458551709720}},
      {11, "Gulf", {5, 2.5, 0.15}, 10, {0}},
      {12, "Box", {0, 10, 20}, 10, {0}},
      {13, "Powell singular", {3, -1, 0, 1}, 4, {0}},
      {14, "Wood", {-3, -1, -3, -1}, 6, {0}},
      {15, "Kowalik and Osborne", {0.25, 0.39, 0.415, 0.39}, 11, {3.07505603849238e-4, 1.02734e-3}},
      {16, "Brown and Dennis", {25, 5, -5, -1}, 20, {85822.2016263563}},
      {17, "Osborne 1", {0.5, 1.5, -1, 0.01, 0.02}, 33, {5.46489469748e-5}},
      {18, "Biggs EXP6", {1, 2, 1, 1, 1, 1}, 13, {0, 5.65564992550e-3}},
      {19, "Osborne 2", {1.3, 0.65, 0.65, 0.7, 0.6, 3, 5, 7, 2, 4.5, 5.5}, 65, {4.01377362935478e-2}},
      {20, "Watson", {0, 0, 0, 0, 0, 0}, 31, {2.28767005355e-3}},
      {21, "extended Rosenbrock", {-1.2, 1, -1.2, 1, -1.2, 1, -1.2, 1, -1.2, 1}, 10, {0}},
      {22, "extended Powell singular", {3, -1, 0, 1, 3, -1, 0, 1, 3, -1, 0, 1}, 12, {0}},
      {23, "penalty I", {1, 2, 3, 4}, 5, {2.24997750088e-5}},
      {24, "penalty II", {0.5, 0.5, 0.5, 0.5}, 8, {9.37629327955e-6}},
      {25, "variably dimensioned", {0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0}, 12, {0}},
      {26, "trigonometric", {0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1}, 10, {0, 2.79506e-5}},
      {27, "Brown almost linear", {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5}, 10, {0, 1}}};
  return problems;
}

namespace data {
inline constexpr double bard[] = {0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39,
                                  0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39};
inline constexpr double gaussian[] = {0.0009, 0.0044, 0.0175, 0.0540, 0.1295, 0.2420, 0.3521, 0.3989,
                                      0.3521, 0.2420, 0.1295, 0.0540, 0.0175, 0.0044, 0.0009};
inline constexpr double meyer[] = {34780, 28610, 23650, 19630, 16370, 13720, 11540, 9744,
                                   8261,  7030,  6005,  5147,  4427,  3820,  3307,  2872};
inline constexpr double kowalik_y[] = {0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627,
                                       0.0456, 0.0342, 0.0323, 0.0235, 0.0246};
inline constexpr double kowalik_u[] = {4, 2, 1, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625};
inline constexpr double osborne_1[] = {0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818,
                                       0.784, 0.751, 0.718, 0.685, 0.658, 0.628, 0.603, 0.580, 0.558,
                                       0.538, 0.522, 0.506, 0.490, 0.478, 0.467, 0.457, 0.448, 0.438,
                                       0.431, 0.424, 0.420, 0.414, 0.411, 0.406};
inline constexpr double osborne_2[] = {
    1.366, 1.191, 1.112, 1.013, 0.991, 0.885, 0.831, 0.847, 0.786, 0.725, 0.746, 0.679, 0.608,
    0.655, 0.616, 0.606, 0.602, 0.626, 0.651, 0.724, 0.649, 0.649, 0.694, 0.644, 0.624, 0.661,
    0.612, 0.558, 0.533, 0.495, 0.500, 0.423, 0.395, 0.375, 0.372, 0.391, 0.396, 0.405, 0.428,
    0.429, 0.523, 0.562, 0.607, 0.653, 0.672, 0.708, 0.633, 0.668, 0.645, 0.632, 0.591, 0.559,
    0.597, 0.625, 0.739, 0.710, 0.729, 0.720, 0.636, 0.581, 0.428, 0.292, 0.162, 0.098, 0.054};
}  // namespace data

/// Writes the residuals of problem `number` at the n values x.
template <class T>
void residuals(int number, const T* x, int n, T* r) {
  using std::abs, std::atan, std::cos, std::exp, std::log, std::pow, std::sin, std::sqrt;
  const auto square = [](const T& a) { return T(a * a); };
  const auto rosenbrock = [&](const T* y, T* out) {
    out[0] = 10.0 * (y[1] - y[0] * y[0]);
    out[1] = 1.0 - y[0];
  };
  const auto powell = [&](const T* y, T* out) {
    out[0] = y[0] + 10.0 * y[1];
    out[1] = std::sqrt(5.0) * (y[2] - y[3]);
    out[2] = square(y[1] - 2.0 * y[2]);
    out[3] = std::sqrt(10.0) * square(y[0] - y[3]);
  };
  switch (number) {
    case 1:
      rosenbrock(x, r);
      break;
    case 2:
      r[0] = -13.0 + x[0] + ((5.0 - x[1]) * x[1] - 2.0) * x[1];
      r[1] = -29.0 + x[0] + ((x[1] + 1.0) * x[1] - 14.0) * x[1];
      break;
    case 3:
      r[0] = 1e4 * x[0] * x[1] - 1.0;
      r[1] = exp(-x[0]) + exp(-x[1]) - 1.0001;
      break;
    case 4:
      r[0] = x[0] - 1e6;
      r[1] = x[1] - 2e-6;
      r[2] = x[0] * x[1] - 2.0;
      break;
    case 5:
      r[0] = 1.5 - x[0] * (1.0 - x[1]);
      r[1] = 2.25 - x[0] * (1.0 - x[1] * x[1]);
      r[2] = 2.625 - x[0] * (1.0 - x[1] * x[1] * x[1]);
      break;
    case 6:
      for (int i = 1; i <= 10; ++i)
        r[i - 1] = 2.0 + 2.0 * i - (exp(double(i) * x[0]) + exp(double(i) * x[1]));
      break;
    case 7: {
      const T theta = atan(x[1] / x[0]) / (2 * M_PI) + (x[0] < 0.0 ? 0.5 : 0.0);
      r[0] = 10.0 * (x[2] - 10.0 * theta);
      r[1] = 10.0 * (sqrt(x[0] * x[0] + x[1] * x[1]) - 1.0);
      r[2] = x[2];
      break;
    }
    case 8:
      for (int i = 1; i <= 15; ++i) {
        const double u = i, v = 16 - i, w = std::min(u, v);
        r[i - 1] = data::bard[i - 1] - (x[0] + u / (v * x[1] + w * x[2]));
      }
      break;
    case 9:
      for (int i = 1; i <= 15; ++i)
        r[i - 1] = x[0] * exp(-0.5 * x[1] * square((8.0 - i) / 2.0 - x[2])) - data::gaussian[i - 1];
      break;
    case 10:
      for (int i = 1; i <= 16; ++i)
        r[i - 1] = x[0] * exp(x[1] / (45.0 + 5.0 * i + x[2])) - data::meyer[i - 1];
      break;
    case 11:
      for (int i = 1; i <= 10; ++i) {
        const double t = i / 100.0, y = 25 + std::pow(-50 * std::log(t), 2.0 / 3);
        r[i - 1] = exp(-pow(abs(y - x[1]), x[2]) / x[0]) - t;
      }
      break;
    case 12:
      for (int i = 1; i <= 10; ++i) {
        const double t = 0.1 * i;
        r[i - 1] = exp(-t * x[0]) - exp(-t * x[1]) - x[2] * (std::exp(-t) - std::exp(-10 * t));
      }
      break;
    case 13:
      powell(x, r);
      break;
    case 14:
      r[0] = 10.0 * (x[1] - x[0] * x[0]);
      r[1] = 1.0 - x[0];
      r[2] = std::sqrt(90.0) * (x[3] - x[2] * x[2]);
      r[3] = 1.0 - x[2];
      r[4] = std::sqrt(10.0) * (x[1] + x[3] - 2.0);
      r[5] = (x[1] - x[3]) / std::sqrt(10.0);
      break;
    case 15:
      for (int i = 0; i < 11; ++i) {
        const double u = data::kowalik_u[i];
        r[i] = data::kowalik_y[i] - x[0] * (u * u + u * x[1]) / (u * u + u * x[2] + x[3]);
      }
      break;
    case 16:
      for (int i = 1; i <= 20; ++i) {
        const double t = i / 5.0;
        r[i - 1] = square(x[0] + t * x[1] - std::exp(t)) + square(x[2] + x[3] * std::sin(t) - std::cos(t));
      }
      break;
    case 17:
      for (int i = 0; i < 33; ++i) {
        const double t = 10.0 * i;
        r[i] = data::osborne_1[i] - (x[0] + x[1] * exp(-t * x[3]) + x[2] * exp(-t * x[4]));
      }
      break;
    case 18:
      for (int i = 1; i <= 13; ++i) {
        const double t = 0.1 * i, y = std::exp(-t) - 5 * std::exp(-10 * t) + 3 * std::exp(-4 * t);
        r[i - 1] = x[2] * exp(-t * x[0]) - x[3] * exp(-t * x[1]) + x[5] * exp(-t * x[4]) - y;
      }
      break;
    case 19:
      for (int i = 0; i < 65; ++i) {
        const double t = i / 10.0;
        r[i] = data::osborne_2[i] -
               (x[0] * exp(-t * x[4]) + x[1] * exp(-x[5] * square(t - x[8])) +
                x[2] * exp(-x[6] * square(t - x[9])) + x[3] * exp(-x[7] * square(t - x[10])));
      }
      break;
    case 20:
      for (int i = 1; i <= 29; ++i) {
        const double t = i / 29.0;
        T slope = 0.0 * x[0], value = x[0];
        double power = 1;
        for (int j = 1; j < n; ++j) {
          slope = slope + j * power * x[j];
          power *= t;
          value = value + power * x[j];
        }
        r[i - 1] = slope - value * value - 1.0;
      }
      r[29] = x[0];
      r[30] = x[1] - x[0] * x[0] - 1.0;
      break;
    case 21:
      for (int i = 0; i < n; i += 2) rosenbrock(x + i, r + i);
      break;
    case 22:
      for (int i = 0; i < n; i += 4) powell(x + i, r + i);
      break;
    case 23: {
      T sum = x[0] * x[0] - 0.25;
      for (int i = 0; i < n; ++i) {
        r[i] = std::sqrt(1e-5) * (x[i] - 1.0);
        if (i > 0) sum = sum + x[i] * x[i];
      }
      r[n] = sum;
      break;
    }
    case 24: {
      const double a = std::sqrt(1e-5);
      r[0] = x[0] - 0.2;
      for (int i = 2; i <= n; ++i)
        r[i - 1] = a * (exp(x[i - 1] / 10.0) + exp(x[i - 2] / 10.0) -
                        (std::exp(i / 10.0) + std::exp((i - 1) / 10.0)));
      for (int i = n + 1; i < 2 * n; ++i) r[i - 1] = a * (exp(x[i - n] / 10.0) - std::exp(-0.1));
      T sum = double(n) * x[0] * x[0] - 1.0;
      for (int j = 2; j <= n; ++j) sum = sum + (n - j + 1.0) * x[j - 1] * x[j - 1];
      r[2 * n - 1] = sum;
      break;
    }
    case 25: {
      T sum = 0.0 * x[0];
      for (int j = 1; j <= n; ++j) {
        r[j - 1] = x[j - 1] - 1.0;
        sum = sum + double(j) * (x[j - 1] - 1.0);
      }
      r[n] = sum;
      r[n + 1] = sum * sum;
      break;
    }
    case 26: {
      T sum = double(n) - cos(x[0]);
      for (int j = 1; j < n; ++j) sum = sum - cos(x[j]);
      for (int i = 1; i <= n; ++i) r[i - 1] = sum + double(i) * (1.0 - cos(x[i - 1])) - sin(x[i - 1]);
      break;
    }
    case 27: {
      T sum = x[0] - (n + 1.0), product = x[0];
      for (int j = 1; j < n; ++j) {
        sum = sum + x[j];
        product = product * x[j];
      }
      for (int i = 0; i + 1 < n; ++i) r[i] = x[i] + sum;
      r[n - 1] = product - 1.0;
      break;
    }
    default:
      break;
  }
}

}  // namespace slom::testing::classics
