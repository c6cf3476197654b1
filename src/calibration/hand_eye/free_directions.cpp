#include "calibration/hand_eye/free_directions.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/hand_eye/turns.hpp"
#include "calibration/median.hpp"
#include "calibration/symmetric.hpp"

namespace slom::calibration {
namespace {

constexpr int interest = 8;  // X, shift, scale; then Y

/// The values after a step along an unknown, in the order X, shift, scale, Y.
HandEyeValues moved(HandEyeValues values, int unknown, double step) {
  if (unknown == 6) {
    values.shift += step;
  } else if (unknown == 7) {
    values.scale += step;
  } else {
    Eigen::Matrix<double, 6, 1> d = Eigen::Matrix<double, 6, 1>::Zero();
    d[unknown % 8] = step;
    (unknown < 6 ? values.hand_T_camera : values.base_T_target)
        .boxplus(mtk::vectview<const double, 6>(d.data()));
  }
  return values;
}

/// The whitened derivative of all residuals by an unknown, by differences over a step.
Eigen::VectorXd column(const Streams& streams, const HandEyeSettings& settings, const Items& items,
                       const HandEyeValues& values, const HandEyeNoise& noise, int unknown, double step) {
  const std::vector<Residual> a = residualsAt(streams, settings, items, moved(values, unknown, -step)),
                              b = residualsAt(streams, settings, items, moved(values, unknown, step));
  Eigen::VectorXd difference(6 * Eigen::Index(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Residual by_step = (b[i] - a[i]) / (2 * step);
    difference.segment<3>(6 * Eigen::Index(i)) = by_step.head<3>() / noise.translation();
    difference.segment<3>(6 * Eigen::Index(i) + 3) = by_step.tail<3>() / noise.rotation_rad();
  }
  return difference;
}

/// The information on X, shift and scale for each item, in units in which noise alone gives about 1. Y is eliminated.
Eigen::MatrixXd informationOf(const Streams& streams, const HandEyeSettings& settings, const Items& items,
                              const HandEyeValues& values, const HandEyeNoise& noise, const Direction& unit,
                              double window) {
  const int unknowns = settings.drifting ? interest : interest + 6;
  Eigen::MatrixXd J(6 * Eigen::Index(items.size()), unknowns);
  for (int k = 0; k < unknowns; ++k) {
    // The difference over a window of time keeps noise of the poses from looking like motion.
    const double step = k == 6 ? window : 1e-5 * (k == 7 ? unit[7] : 1);
    J.col(k) = column(streams, settings, items, values, noise, k, step);
    if (k < interest) J.col(k) *= unit[k];
  }
  if (!settings.estimate_offset || settings.pairs) J.col(6).setZero();
  if (!settings.estimate_scale) J.col(7).setZero();
  Eigen::MatrixXd H = J.transpose() * J / double(items.size());
  if (!settings.drifting) {
    const Eigen::MatrixXd YX = H.bottomLeftCorner(6, interest), YY = H.bottomRightCorner(6, 6);
    const SymmetricEigen eigen = eigenOf(YY);
    const double most = eigen.eigenvalues().maxCoeff();
    const Eigen::VectorXd inverse =
        eigen.eigenvalues().unaryExpr([&](double x) { return x > 1e-14 * most ? 1 / x : 0.0; });
    const Eigen::MatrixXd eliminated = YX.transpose() * composed(eigen.eigenvectors(), inverse) * YX;
    H = Eigen::MatrixXd(H.topLeftCorner(interest, interest) - eliminated);
  }
  return H;
}

struct UnknownKind {
  FreeDirection::Kind kind;
  int first, count;
};
constexpr UnknownKind unknown_kinds[] = {{FreeDirection::Kind::translation, 0, 3},
                                         {FreeDirection::Kind::rotation, 3, 3},
                                         {FreeDirection::Kind::time_offset, 6, 1},
                                         {FreeDirection::Kind::scale, 7, 1}};

/// A direction of a space, and the kind of unknown that it mostly moves.
struct NamedDirection {
  Direction direction;
  UnknownKind kind;
};

/// Returns an orthonormal basis of the space with columns V, each vector as much as possible within one kind.
std::vector<NamedDirection> namedBasis(const Eigen::MatrixXd& V) {
  struct Axis {
    double share;
    NamedDirection named;
  };
  std::vector<Axis> axes;
  for (const UnknownKind& kind : unknown_kinds) {
    const Eigen::MatrixXd part = V.middleRows(kind.first, kind.count);
    const SymmetricEigen eigen = eigenOf(part * part.transpose());
    for (int k = 0; k < kind.count; ++k) {
      Direction axis = Direction::Zero();
      axis.segment(kind.first, kind.count) = eigen.eigenvectors().col(k);
      axes.push_back({eigen.eigenvalues()[k], {axis, kind}});
    }
  }
  std::stable_sort(axes.begin(), axes.end(), [](const Axis& a, const Axis& b) { return a.share > b.share; });
  std::vector<NamedDirection> basis;
  for (const Axis& axis : axes) {
    if (Eigen::Index(basis.size()) == V.cols()) break;
    Direction inside = V * (V.transpose() * axis.named.direction);
    for (const NamedDirection& known : basis) inside -= known.direction * known.direction.dot(inside);
    constexpr double little = 0.1;  // mostly in the span of the others
    if (inside.norm() < little) continue;
    basis.push_back({inside.normalized(), axis.named.kind});
  }
  return basis;
}

/// The noise of each component of the poses of the interpolated stream.
struct PoseNoise {
  double rotation_rad = 0, translation = 0;  ///< translation in the unit of the camera's stream
};

/// Returns it from second differences, which see little of a smooth motion.
PoseNoise trackNoise(const Streams& streams, double scale) {
  const std::vector<Segment>& segments =
      (streams.interpolates_hand ? streams.hand : streams.camera).segments();
  std::vector<double> turns, moves;
  for (std::size_t i = 1; i < segments.size(); ++i) {
    turns.push_back((segments[i].turn - segments[i - 1].turn).norm());
    moves.push_back((segments[i].move - segments[i - 1].move).norm());
  }
  const double per_component = median_of_length * std::sqrt(6.0);
  const double unit = streams.interpolates_hand ? scale : 1;
  return {medianOf(std::move(turns)) / per_component, medianOf(std::move(moves)) / per_component / unit};
}

/// Returns the length of such an error in units of the noise of a residual.
double whitened(const PoseNoise& own, const HandEyeNoise& noise) {
  const double turn = own.rotation_rad / noise.rotation_rad(), move = own.translation / noise.translation();
  return std::max(std::sqrt(3 * (turn * turn + move * move)), 1e-6);
}

}  // namespace

Freedom freedomOf(const Streams& streams, const HandEyeSettings& settings, const Items& items,
                  const HandEyeValues& values, const HandEyeNoise& noise) {
  constexpr double buried = 5;       // a response is free below this multiple of that to noise
  constexpr double rounding = 1e-7;  // of the largest response
  const double window = std::max(0.1, 2 * std::max(streams.hand.step(), streams.camera.step()));
  Freedom freedom;
  freedom.held.unit.head<3>().setConstant(values.scale * noise.translation() / noise.rotation_rad());
  freedom.held.unit[6] = 2 * window / (std::sqrt(2.0) * whitened(trackNoise(streams, values.scale), noise));
  freedom.held.unit[7] = values.scale;
  const Eigen::MatrixXd information =
      informationOf(streams, settings, items, values, noise, freedom.held.unit, window);
  const double step = (streams.interpolates_hand ? streams.hand : streams.camera).step();
  freedom.motion_per_step = std::sqrt(std::max(information(6, 6), 0.0)) * step / (2 * window);
  const SymmetricEigen eigen = eigenOf(information);
  const Eigen::VectorXd response = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
  const double limit = std::max(buried, rounding * response.maxCoeff());
  const auto is_known = [&](Eigen::Index k) {  // fixed unknowns have no response
    const bool is_offset = std::abs(eigen.eigenvectors()(6, k)) > 0.999,
               is_scale = std::abs(eigen.eigenvectors()(7, k)) > 0.999;
    return (is_offset && (!settings.estimate_offset || settings.pairs)) ||
           (is_scale && !settings.estimate_scale);
  };
  std::vector<Eigen::Index> columns;
  freedom.least_response = response.maxCoeff();
  for (Eigen::Index k = 0; k < response.size(); ++k) {
    if (is_known(k)) continue;
    if (response[k] < limit)
      columns.push_back(k);
    else
      freedom.least_response = std::min(freedom.least_response, response[k]);
  }
  const Turns turns = turnsOf(streams, settings, items, values.shift);
  freedom.turns_deg = vec3(turns.deg);
  const Eigen::MatrixXd V = eigen.eigenvectors()(Eigen::all, columns);
  const std::vector<NamedDirection> basis = columns.empty() ? std::vector<NamedDirection>() : namedBasis(V);
  for (const NamedDirection& named : basis) {
    freedom.held.directions.push_back(named.direction);
    FreeDirection free{named.kind.kind, vec3(0., 0., 0.), ""};
    const Eigen::Vector3d axis = named.direction.segment<3>(std::min(named.kind.first, 3)).normalized();
    if (free.kind == FreeDirection::Kind::translation) free.axis = vec3(axis);
    if (free.kind == FreeDirection::Kind::rotation) free.axis = values.hand_T_camera.orient * axis;
    const auto same = std::count_if(basis.begin(), basis.end(), [&](const NamedDirection& other) {
      return other.kind.kind == named.kind.kind;
    });
    free.text = textOf(free, int(same), turns);
    freedom.directions.push_back(std::move(free));
  }
  return freedom;
}

}  // namespace slom::calibration
