/// Consistency of a filter along a run: whether its errors are as large as its covariance states.
///
///     slom::InnovationReport<3> gps;                      // one for each kind of measurement, of 3 numbers
///     gps.add(filter.update(position, z, noise));
///     std::puts(gps.sentence().c_str());
///
/// If model and noise are right, the whitened innovations are independent and N(0, I). Then
///   NIS           has the mean 1 for each number
///   mean          is 0
///   correlation   of neighbours is 0
/// and so has NEES, the same for errors against a known truth (NeesReport), the mean 1 for each number. The sign of
/// the correlation shows which noise is wrong: it is positive if the gain is too small, and negative if the gain is
/// too large. A larger noise of the motion increases the gain, a larger noise of the measurement reduces it.
///   source  Mehra, "On the identification of variances and adaptive Kalman filtering", 1970; Bar-Shalom, Li, Kirubarajan,
///           "Estimation with applications to tracking and navigation", 2001, section 5.4
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "slom/filter/filter_base.hpp"

namespace slom {

namespace detail {

/// Returns the x that a chi-square variable with many degrees of freedom exceeds where a normal one exceeds `normal`.
///   source  Wilson and Hilferty, "The distribution of chi-square", 1931
inline double chiSquareQuantile(double dof, double normal) {
  const double s = 2 / (9 * dof), cube = 1 - s + normal * std::sqrt(s);
  return dof * cube * cube * cube;
}
inline std::string formatted(const char* format, double a, double b = 0, double c = 0) {
  char text[200];
  std::snprintf(text, sizeof text, format, a, b, c);
  return text;
}

/// The mean of chi-square variables for each degree of freedom, with the band that holds it 95 % of the time.
class ChiSquareMean {
 public:
  void add(double square, double dof) {
    sum_ += square;
    dof_ += dof;
  }
  double dof() const { return dof_; }
  double mean() const { return sum_ / dof_; }
  double lower() const { return chiSquareQuantile(dof_, -1.96) / dof_; }
  double upper() const { return chiSquareQuantile(dof_, 1.96) / dof_; }

 private:
  double sum_ = 0, dof_ = 0;
};

}  // namespace detail

/// NEES of a filter in simulations, or where the truth is known.
class NeesReport {
 public:
  /// Adds a NEES with its degrees of freedom; `filter.nees(truth)` and `filter.DOF`. Errors of one run are correlated: add
  /// one of each run.
  void add(double nees, int dof) {
    nees_.add(nees, dof);
    ++count_;
  }
  /// Returns the mean NEES for each number.
  double mean() const { return nees_.mean(); }
  /// Returns the lower end of the band that holds the mean 95 % of the time.
  double lower() const { return nees_.lower(); }
  /// Returns the upper end of this band.
  double upper() const { return nees_.upper(); }
  /// Returns one sentence with the verdict.
  std::string sentence() const {
    if (count_ == 0) return "no errors were added";
    if (nees_.dof() < 20)
      return "too few errors for a report: add those of more runs, for 20 numbers or more";
    if (mean() - mean() != 0) return "an error has no NEES, because the covariance is singular; leave it out";
    const std::string numbers =
        std::to_string(count_) +
        detail::formatted(" errors: NEES %.2f for each number (95 %% band %.2f to %.2f): ", mean(), lower(),
                          upper());
    return numbers +
           (mean() > upper()
                ? "errors are larger than the covariance says; state larger noise of the measurements or of "
                  "the motion, or look for an error that lasts"
            : mean() < lower()
                ? "errors are smaller than the covariance says; state smaller noise of the measurements or of "
                  "the motion"
                : "the covariance fits the errors");
  }

 private:
  detail::ChiSquareMean nees_;
  int count_ = 0;
};

/// Innovations of one kind of measurement, of M numbers. Keeps each NIS, for the plot. Add every update: those that a gate
/// rejected are counted, compared with the number that the gate rejects if the model holds, and left out of the other
/// numbers.
template <int M>
class InnovationReport {
 public:
  using Vector = mtk::vect<M>;

  /// Adds what an update returned. Measurements that were refused for other reasons are counted.
  template <class S>
  void add(const UpdateResult<S, M>& update) {
    if (update.status != FilterStatus::done && update.status != FilterStatus::gated) {
      ++refused_;
      return;
    }
    setGate(double(update.gate));
    rejections_expected_ += 1 - gate_;
    all_nis_.push_back(double(update.nis));
    if (update.status == FilterStatus::gated) {
      ++rejected_;
      ++rejected_last_;
      return;
    }
    rejected_last_ = 0;
    Vector w;
    for (int i = 0; i < M; ++i) w[i] = double(update.whitened[i]);
    nis_.add(w.squaredNorm(), M * mean_in_gate_);
    sum_ += w;
    if (used_++ > 0) {
      products_ += w.dot(last_);
      squares_ += w.squaredNorm();
      squares_before_ += last_.squaredNorm();
    }
    last_ = w;
  }

  /// Returns the number of innovations, with those that a gate rejected.
  int count() const { return int(all_nis_.size()); }
  /// Returns how many innovations a gate rejected.
  int rejected() const { return rejected_; }
  /// Returns the mean NIS for each number of the innovations that were used, divided by what is expected inside of the gate.
  double mean() const { return nis_.mean(); }
  /// Returns the lower end of the band that holds the mean 95 % of the time.
  double lower() const { return nis_.lower(); }
  /// Returns the upper end of this band.
  double upper() const { return nis_.upper(); }
  /// Returns the correlation of neighbouring innovations, 0 for white ones.
  double correlation() const {
    const double square = squares_ * squares_before_;
    return square > 0 ? products_ / std::sqrt(square) : 0;
  }
  /// Returns the mean of component i, divided by its standard deviation of 1 / sqrt(count).
  double meanInSigmas(int i) const { return sum_[i] / std::sqrt(double(used_)); }

  /// Returns one sentence with the numbers and what to change.
  std::string sentence() const {
    const bool has_few = used_ < kFewest;
    if (has_few && rejected_ > used_ && rejected_ >= kRejectedInARow) {
      return std::to_string(count()) + " innovations, " + std::to_string(rejected_) +
             " rejected by the gate: " + lost();
    }
    if (has_few) return "too few innovations for a report: 20 that are used are the least";
    std::string text = std::to_string(count()) +
                       detail::formatted(" innovations: NIS %.2f for each number (95 %% band %.2f to %.2f)",
                                         mean(), lower(), upper()) +
                       detail::formatted(", correlation of neighbours %.2f", correlation());
    if (rejected_ > 0) {
      text += ", " + std::to_string(rejected_) + " rejected by the gate" +
              detail::formatted(" where %.1f are expected", rejections_expected_);
    }
    if (refused_ > 0) text += ", " + std::to_string(refused_) + " refused";
    return text + ": " + verdict();
  }

  /// Returns an SVG picture of the NIS of each innovation, with its mean under the model and the level that 1 in 1000
  /// exceeds.
  std::string svg(const std::string& title = "NIS") const {
    const double level = detail::chiSquareQuantile(M, 3.09), top = 1.3 * level, width = 720, height = 240;
    const auto x = [&](double i) { return 40 + i / std::max(1, count() - 1) * (width - 60); };
    const auto y = [&](double nis) { return height - 30 - std::min(nis, top) / top * (height - 60); };
    std::string text =
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"720\" height=\"240\" font-family=\"sans-serif\" "
        "font-size=\"12\">\n<text x=\"40\" y=\"18\">" +
        title + ": " + detail::formatted("%.0f innovations of %.0f numbers", count(), M) + "</text>\n";
    for (const double line : {double(M), level}) {
      text +=
          detail::formatted("<path d=\"M40 %.1fH700\" stroke=\"#888\" stroke-dasharray=\"4 3\"/>\n", y(line));
      text += detail::formatted("<text x=\"2\" y=\"%.1f\">%.1f</text>\n", y(line) + 4, line);
    }
    for (int i = 0; i < count(); ++i) {
      const double nis = all_nis_[std::size_t(i)];
      text += detail::formatted("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"1.5\" fill=\"", x(i), y(nis)) +
              (nis > level ? "#c33" : "#36c") + "\"/>\n";
    }
    return text + "</svg>\n";
  }

 private:
  static constexpr int kFewest = 20, kRejectedInARow = 10;
  static const char* lost() {
    return "most of the last measurements were rejected; the filter has lost the state or the sensor is disturbed: reset the "
           "filter, state larger noise of the motion, or widen the gate";
  }
  /// Sets what is expected of a gate: E(x | x < q) = M P(M + 2 degrees: x < q) / P(M: x < q), where P(M: x < q) = gate.
  void setGate(double probability) {
    if (probability == gate_) return;
    gate_ = probability;
    double low = 0, high = 1000 + 10 * M;
    for (int i = 0; i < 100; ++i) {
      const double middle = (low + high) / 2;
      (detail::chiSquareTail(middle, M) > 1 - gate_ ? low : high) = middle;
    }
    mean_in_gate_ = gate_ < 1 ? (1 - detail::chiSquareTail(low, M + 2)) / gate_ : 1;
  }
  bool hasOutliers() const {
    return rejected_ > rejections_expected_ + 3 * std::sqrt(rejections_expected_) + 1;
  }

  const char* verdict() const {
    if (rejected_last_ >= kRejectedInARow) return lost();
    double largest = 0;
    for (int i = 0; i < M; ++i) largest = std::max(largest, std::abs(meanInSigmas(i)));
    const double white = 1.96 / std::sqrt(double(used_) * M);
    // The mean of correlated or larger numbers varies more.
    const double r = std::min(0.99, std::max(0., correlation()));
    if (largest > 4 * std::sqrt((1 + r) / (1 - r) * std::max(1., mean())))
      return "the innovations have a mean; look for an offset of the sensor or of its place, and estimate it";
    const bool is_small_gain = correlation() > 2 * white, is_large_gain = correlation() < -2 * white;
    if (mean() > upper()) {
      if (is_small_gain) {
        return "innovations are larger than stated, and neighbours are alike; state larger noise of the motion, or "
               "estimate an error that lasts";
      }
      if (is_large_gain && rejected_ > 0) {
        return "innovations are larger than stated, also those inside of the gate, and neighbours are opposite; state "
               "larger noise of the measurement";
      }
      if (is_large_gain) {
        return "innovations are larger than stated, and neighbours are opposite; state larger noise of the measurement, or "
               "use a gate or a loss";
      }
      if (rejected_ > 0) {
        return "innovations are larger than stated, also those inside of the gate; state larger noise of the measurement "
               "and of the motion";
      }
      return "innovations are larger than stated; state larger noise of the measurement and of the motion, or use a gate or "
             "a loss";
    }
    if (mean() < lower()) {
      if (is_small_gain)
        return "innovations are smaller than stated, and neighbours are alike; state smaller noise of the measurement";
      if (is_large_gain)
        return "innovations are smaller than stated, and neighbours are opposite; state smaller noise of the motion";
      return "innovations are smaller than stated; state smaller noise of the measurement and of the motion";
    }
    if (is_small_gain) {
      return "innovations are as large as stated, but neighbours are alike; state smaller noise of the measurement and larger "
             "noise of the motion, or estimate an error that lasts";
    }
    if (is_large_gain) {
      return "innovations are as large as stated, but neighbours are opposite; state larger noise of the measurement and "
             "smaller noise of the motion";
    }
    if (hasOutliers()) {
      return "the measurements that were used fit the stated noise, so those that were rejected are outliers; leave the "
             "noise as it is";
    }
    return "the filter is consistent";
  }

  detail::ChiSquareMean nis_;
  std::vector<double> all_nis_;
  Vector sum_ = Vector(mtk::PlainVector<double, M>::Zero()), last_ = sum_;
  double products_ = 0, squares_ = 0, squares_before_ = 0;
  double gate_ = 1, mean_in_gate_ = 1;  // of the last update
  double rejections_expected_ = 0;
  int used_ = 0, rejected_ = 0, refused_ = 0;
  int rejected_last_ = 0;  // one after the other, up to the newest
};

}  // namespace slom
