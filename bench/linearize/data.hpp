/// Simulated variables and data of the three measurements: realistic values, a fixed seed, small enough for the L2
/// cache.
#pragma once

#include <vector>

#include "linearize/measurements.hpp"

namespace slom::bench {

inline constexpr int kMeasurements = 2048;  ///< measurements of each kind

struct BalData {
  struct Observation {
    int camera, point;
    mtk::vect<2> pixel;
  };
  std::vector<BalCamera> cameras;
  std::vector<mtk::vect<3>> points;
  std::vector<Observation> observations;  ///< point after point, as in the public files
};

struct PoseGraphData {
  struct Edge {
    int a, b;
    SE3 measured;  ///< pose of b seen from a
  };
  std::vector<SE3> poses;
  std::vector<Edge> edges;
};

struct StereoData {
  struct Corner {
    int view;
    mtk::vect<3> on_board;
    mtk::vect<4> pixels;  ///< left u, v, right u, v
  };
  StereoIntrinsics intrinsics;
  SE3 left2right;
  std::vector<SE3> board2left;  ///< pose of each view
  std::vector<Corner> corners;  ///< view after view
};

/// Simulates data. The values are not the best fit: residuals are a few pixels, centimetres and degrees.
BalData simulateBal();
PoseGraphData simulatePoseGraph();
StereoData simulateStereo();

}  // namespace slom::bench
