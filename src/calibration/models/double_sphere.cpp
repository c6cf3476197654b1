// fx fy cx cy xi alpha: two unit spheres, their centres xi apart, and a pinhole shifted by alpha / (1 - alpha).
// Kalibr's ds.
//   pixel   u = fx x / w + cx, v = fy y / w + cy
//           w = alpha d2 + (1 - alpha) (xi d1 + z), d1 = |(x, y, z)|, d2 = |(x, y, xi d1 + z)|
//   domain  z > -w2 d1, beyond 90 degrees off the axis for most lenses; NaN elsewhere
//   source  Usenko, Demmel, Cremers, "The Double Sphere Camera Model", 3DV 2018
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "calibration/models/define.hpp"

namespace slom::calibration {

template <class S = double>
struct DoubleSphere : slom::detail::CentredLens<6, S> {
  static constexpr std::string_view model_name = "double_sphere";
  static constexpr std::array<std::string_view, 6> component_names{"fx", "fy", "cx", "cy", "xi", "alpha"};
  using slom::detail::CentredLens<6, S>::CentredLens;

  /// Returns several starts. Lenses with xi < 0 and with xi > 0 bend nearly alike, and a fit that starts on one side
  /// seldom finds the other.
  static std::array<DoubleSphere, 3> startsFromPinhole(const Pinhole& p) {
    const auto start = [&](double xi, double alpha) {
      return DoubleSphere(p.fx * (1 + xi), p.fy * (1 + xi), p.cx, p.cy, xi, alpha);
    };
    return {start(0, 0.5), start(-0.3, 0.6), start(0.3, 0.7)};
  }
  static constexpr StartLens start_lens = StartLens::equidistant;
  static constexpr bool is_compared = false;

  auto project(const auto& p) const {
    using mtk::select;
    using std::sqrt;
    const DoubleSphere& c = *this;
    const S x = S(p[0]), y = S(p[1]), z = S(p[2]), xi = c[4], alpha = c[5];
    const S r2 = x * x + y * y, d1 = sqrt(r2 + z * z), shifted = xi * d1 + z,
            d2 = sqrt(r2 + shifted * shifted);
    const S w1 = select(alpha > 0.5, S((1.0 - alpha) / alpha), S(alpha / (1.0 - alpha)));
    const S w2 = (w1 + xi) / sqrt(2.0 * w1 * xi + xi * xi + 1.0);
    const S outside = S(std::numeric_limits<double>::quiet_NaN());
    const S w = select(z + w2 * d1 > 0.0, S(alpha * d2 + (1.0 - alpha) * shifted), outside);
    return this->toPixels(x / w, y / w);
  }

  /// Returns the camera matrix of the pinhole that approximates the lens near the axis.
  Eigen::Matrix3d cameraMatrix() const {
    const double w = 1 + (*this)[4];
    return Pinhole{this->fx() / w, this->fy() / w, this->cx(), this->cy()}.matrix();
  }
  Eigen::VectorXd distortion() const { return this->template tail<2>(); }
  std::optional<ForeignLens> forOpencv() const { return {}; }
  std::optional<ForeignLens> forRos() const { return {}; }
  std::optional<ForeignLens> forKalibr() const {
    const DoubleSphere& c = *this;
    return ForeignLens{"ds", "none", {c[4], c[5], c[0], c[1], c[2], c[3]}};
  }
};

}  // namespace slom::calibration

SLOM_CALIBRATION_DEFINE_MODEL(double_sphere, DoubleSphere)
