/// The models of NIST's nonlinear regression, y = f(x; b), as functions of any number type: double, dual numbers of
/// SLoM, Jets of Ceres. The names of the parameters are those of the files, from b1 = b[0] on.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

namespace slom::testing::nist {

/// x, or x1 and x2.
using Predictors = std::array<double, 2>;

enum class Model {
  bennett5,
  boxbod,
  chwirut,
  danwood,
  eckerle4,
  enso,
  gauss,
  kirby2,
  lanczos,
  mgh09,
  mgh10,
  mgh17,
  misra1b,
  misra1c,
  misra1d,
  nelson,
  rat42,
  rat43,
  roszman1,
  thurber
};

/// Returns the model of the data set with this name; none: no such data set.
inline std::optional<Model> modelOf(std::string_view name) {
  static constexpr std::pair<std::string_view, Model> all[] = {
      {"Bennett5", Model::bennett5}, {"BoxBOD", Model::boxbod},     {"Chwirut1", Model::chwirut},
      {"Chwirut2", Model::chwirut},  {"DanWood", Model::danwood},   {"ENSO", Model::enso},
      {"Eckerle4", Model::eckerle4}, {"Gauss1", Model::gauss},      {"Gauss2", Model::gauss},
      {"Gauss3", Model::gauss},      {"Hahn1", Model::thurber},     {"Kirby2", Model::kirby2},
      {"Lanczos1", Model::lanczos},  {"Lanczos2", Model::lanczos},  {"Lanczos3", Model::lanczos},
      {"MGH09", Model::mgh09},       {"MGH10", Model::mgh10},       {"MGH17", Model::mgh17},
      {"Misra1a", Model::boxbod},    {"Misra1b", Model::misra1b},   {"Misra1c", Model::misra1c},
      {"Misra1d", Model::misra1d},   {"Nelson", Model::nelson},     {"Rat42", Model::rat42},
      {"Rat43", Model::rat43},       {"Roszman1", Model::roszman1}, {"Thurber", Model::thurber}};
  for (const auto& [known, model] : all) {
    if (known == name) return model;
  }
  return std::nullopt;
}

inline bool predictsLogarithm(Model model) { return model == Model::nelson; }

/// Returns the model's prediction of y. `b` is any type with numbers b[0], b[1], ...
template <class Parameters>
auto predict(Model model, const Parameters& b, const Predictors& predictors) {
  using S = std::remove_cvref_t<decltype(b[0])>;
  using std::atan2, std::cos, std::exp, std::pow, std::sin;
  const double x = predictors[0];
  const auto square = [](const S& z) { return S(z * z); };
  const auto cycle = [&](const S& c, const S& s, const S& period) {
    const S angle = 2 * std::numbers::pi * x / period;
    return S(c * cos(angle) + s * sin(angle));
  };
  switch (model) {
    case Model::bennett5:
      return S(b[0] * pow(S(b[1] + x), S(-1.0 / b[2])));
    case Model::boxbod:
      return S(b[0] * (1.0 - exp(S(-b[1] * x))));
    case Model::chwirut:
      return S(exp(S(-b[0] * x)) / (b[1] + b[2] * x));
    case Model::danwood:
      return S(b[0] * pow(x, b[1]));
    case Model::eckerle4:
      return S(b[0] / b[1] * exp(S(-0.5 * square((x - b[2]) / b[1]))));
    case Model::enso:
      return S(b[0] + cycle(b[1], b[2], S(12.0)) + cycle(b[4], b[5], b[3]) + cycle(b[7], b[8], b[6]));
    case Model::gauss:
      return S(b[0] * exp(S(-b[1] * x)) + b[2] * exp(S(-square((x - b[3]) / b[4]))) +
               b[5] * exp(S(-square((x - b[6]) / b[7]))));
    case Model::kirby2:
      return S((b[0] + x * (b[1] + x * b[2])) / (1.0 + x * (b[3] + x * b[4])));
    case Model::lanczos:
      return S(b[0] * exp(S(-b[1] * x)) + b[2] * exp(S(-b[3] * x)) + b[4] * exp(S(-b[5] * x)));
    case Model::mgh09:
      return S(b[0] * x * (x + b[1]) / (x * (x + b[2]) + b[3]));
    case Model::mgh10:
      return S(b[0] * exp(S(b[1] / (x + b[2]))));
    case Model::mgh17:
      return S(b[0] + b[1] * exp(S(-x * b[3])) + b[2] * exp(S(-x * b[4])));
    case Model::misra1b:
      return S(b[0] * (1.0 - 1.0 / square(1.0 + b[1] * x / 2.0)));
    case Model::misra1c:
      return S(b[0] * (1.0 - pow(S(1.0 + 2.0 * b[1] * x), -0.5)));
    case Model::misra1d:
      return S(b[0] * b[1] * x / (1.0 + b[1] * x));
    case Model::nelson:
      return S(b[0] - b[1] * x * exp(S(-b[2] * predictors[1])));
    case Model::rat42:
      return S(b[0] / (1.0 + exp(S(b[1] - b[2] * x))));
    case Model::rat43:
      return S(b[0] / pow(S(1.0 + exp(S(b[1] - b[2] * x))), S(1.0 / b[3])));
    // The branch of the arc tangent that goes on smoothly where x = b4, as in the file that comes with Ceres: its b1 is
    // larger by 1 than that of NIST, all else is the same.
    case Model::roszman1:
      return S(b[0] - b[1] * x - atan2(b[2], S(x - b[3])) / std::numbers::pi);
    case Model::thurber:
      return S((b[0] + x * (b[1] + x * (b[2] + x * b[3]))) / (1.0 + x * (b[4] + x * (b[5] + x * b[6]))));
  }
  return S(std::nan(""));
}

}  // namespace slom::testing::nist
