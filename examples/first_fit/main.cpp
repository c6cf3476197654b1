// Locates a tag. Six anchors at known places measure their distances to the tag; one of the distances is wrong.
//
//   example_first_fit             prints the results of the page docs/start/first_fit.md
//   example_first_fit --picture   prints the picture of that page as SVG
#include <iostream>

#include "picture.hpp"

int main(int argc, char**) {
  const std::vector<Reading> readings{{"south-west", {0, 0}, 5.19}, {"south-east", {8, 0}, 6.31},
                                      {"north-east", {8, 6}, 5.18}, {"north-west", {0, 6}, 4.53},
                                      {"north", {4, 7}, 3.04},      {"south", {4, -1}, 5.11}};

  slom::Estimator est;
  auto tag = est.insertRV(Eigen::Vector2d(4, 3), "tag");
  const auto distance = [](const auto& position, const auto& anchor) { return (position - anchor).norm(); };
  for (const Reading& r : readings) {
    est.insertMeasurement(distance, tag, r.anchor, slom::measured(r.distance), slom::StandardDeviation(0.05),
                          slom::named("distance"));
  }
  const slom::Summary summary = est.optimize();
  const slom::OutlierReport outliers = slom::outliers(est);

  slom::Estimator robust;
  auto tag_again = robust.insertRV(Eigen::Vector2d(4, 3), "tag");
  for (const Reading& r : readings) {
    robust.insertMeasurement(distance, tag_again, r.anchor, slom::measured(r.distance),
                             slom::StandardDeviation(0.05), slom::Tukey(4.685), slom::named("distance"));
  }
  slom::Options options;
  options.graduated_non_convexity = true;
  const slom::Summary robust_summary = robust.optimize(options);

  if (argc > 1) {
    std::cout << picture(readings, *tag, *tag_again, robust.covariance(tag_again));
    return 0;
  }
  std::cout << summary << "\n" << outliers << "\n" << robust_summary;
}
