#include "calibrate/result.hpp"

#include <algorithm>

namespace slom::app::calib {

std::vector<const ImageResult*> Result::worstImages(std::size_t count) const {
  std::vector<const ImageResult*> order;
  for (const ImageResult& image : images) order.push_back(&image);
  std::stable_sort(order.begin(), order.end(), [](const ImageResult* a, const ImageResult* b) {
    return a->chi2PerMeasurement() > b->chi2PerMeasurement();
  });
  order.resize(std::min(count, order.size()));
  return order;
}

}  // namespace slom::app::calib
