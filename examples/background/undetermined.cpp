// Unknowns that the measurements do not determine: a gauge, and directions that are nearly free.
#include <cmath>
#include <vector>

#include <slom/slom.hpp>

#include "pages.hpp"
#include "plot.hpp"
#include "text.hpp"

namespace {

const auto distance = [](const auto& a, const auto& b) { return (a - b).norm(); };

/// Four posts, all distances between them measured with a tape.
struct Posts {
  slom::Estimator est;
  std::vector<slom::VarID<Vec2>> posts;
  Posts() {
    const Points start{{0, 0}, {6, 0.5}, {5, 4}, {1, 3.5}};
    for (std::size_t i = 0; i < start.size(); ++i)
      posts.push_back(est.insertRV(start[i], "post " + std::to_string(i + 1)));
    for (std::size_t i = 0; i < start.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        est.insertMeasurement(distance, posts[i], posts[j],
                              slom::measured(std::round(100 * (start[i] - start[j]).norm()) / 100),
                              slom::StandardDeviation(0.01), slom::named("distance"));
      }
    }
  }
};

/// A boat with its distances from two lighthouses that are `spacing` apart, 10 km away.
struct Boat {
  slom::Estimator est;
  slom::VarID<Vec2> boat = est.insertRV(Vec2(0, 0), "boat");
  std::vector<Vec2> lighthouses;
  explicit Boat(double spacing) : lighthouses{{10, spacing / 2}, {10, -spacing / 2}} {
    for (const Vec2& lighthouse : lighthouses) {
      est.insertMeasurement(distance, boat, lighthouse, slom::measured(lighthouse.norm()),
                            slom::StandardDeviation(0.05), slom::named("distance"));
    }
    est.optimize();
  }
};

void printUndetermined(std::ostream& os) {
  Posts free;
  os << slom::diagnose(free.est) << "\n";
  Posts fixed;
  fixed.est.fix(fixed.posts[0]);
  fixed.est.fix(fixed.posts[1], "y");
  fixed.est.optimize();
  Posts inner;
  inner.est.setFreeGauge(slom::FreeGauge::inner_constraints);
  inner.est.changeAlgorithm(slom::LevenbergMarquardt());
  inner.est.optimize();
  os << "standard deviations [m]      post 1: x       y   post 3: x       y   post 1 to 3\n";
  const auto row = [&](const char* name, const Posts& p) {
    const Eigen::VectorXd first = p.est.standardDeviation(p.posts[0]),
                          third = p.est.standardDeviation(p.posts[2]);
    const auto between = p.est.propagate(distance, p.posts[0], p.posts[2]);
    os << format("%-26s  %9.4f  %6.4f  %9.4f  %6.4f  %12.4f\n", name, first[0], first[1], third[0], third[1],
                 between.standardDeviation()[0]);
  };
  row("post 1 and 2.y fixed", fixed);
  row("inner constraints", inner);
  os << "\nlighthouses apart   boat: x       y   [km]\n";
  for (const double spacing : {16.0, 4.0, 1.0, 0.25}) {
    const Boat boat(spacing);
    const Eigen::VectorXd sigma = boat.est.standardDeviation(boat.boat);
    os << format("%14.2f  %11.3f  %6.3f\n", spacing, sigma[0], sigma[1]);
  }
}

void drawPosts(Plot& plot) {
  plot.diagram({15, 30, 340, 320, -3, 9, -3, 8.3}, "the same distances");
  const Posts at_rest;
  const auto draw = [&](double angle, const Vec2& shift, const char* colour) {
    const mtk::trafo<mtk::SO2<>> T{mtk::SO2<>(angle), mtk::vect<2>(shift)};
    Points places;
    for (const auto& post : at_rest.posts) places.emplace_back(T * *post);
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) plot.curve({places[i], places[j]}, colour, 1);
    }
    for (const Vec2& p : places) plot.dot(p, colour, 5);
  };
  draw(0, Vec2(0, 0), kBlue);
  draw(0.5, Vec2(2.0, 1.2), kGreen);
  draw(-0.25, Vec2(-1.5, -0.5), kGrey);
}

void drawBoats(Plot& plot) {
  plot.diagram({385, 30, 340, 320, -2, 12, -6.6, 6.6}, "distances from two lighthouses");
  const std::vector<std::pair<double, const char*>> cases{{8.0, kBlue}, {1.0, kRed}};
  for (const auto& [spacing, colour] : cases) {
    const Boat boat(spacing);
    for (const Vec2& lighthouse : boat.lighthouses) {
      plot.curve({lighthouse, *boat.boat}, colour, 1);
      plot.dot(lighthouse, colour, 6);
    }
    plot.ellipse(*boat.boat, boat.est.covariance(boat.boat), 5.991 * 9, colour);
  }
  plot.dot({0, 0}, kBlack, 5);
  plot.text({0, 0}, "boat", kBlack, -14, 5, "end");
  plot.text({10, 4}, "far apart", kBlue, 0, -12, "middle");
  plot.text({10, 0.5}, "side by side", kRed, 0, -12, "middle");
}

std::string drawUndetermined() {
  Plot plot(740, 370);
  drawPosts(plot);
  drawBoats(plot);
  return plot.svg();
}

}  // namespace

const Page kUndetermined{"undetermined", &printUndetermined, &drawUndetermined};
