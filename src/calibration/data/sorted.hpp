// Views in the order of their image numbers, on which the fit and what is said of it rely.
#pragma once

#include <optional>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

void sortViews(CameraData& camera);

/// The caller's data where all views are sorted by image number, and a sorted copy of them otherwise.
class SortedDataset {
 public:
  /// `data` must live as long.
  explicit SortedDataset(const Dataset& data);
  SortedDataset(const SortedDataset&) = delete;
  SortedDataset& operator=(const SortedDataset&) = delete;

  const Dataset& operator*() const { return copy_ ? *copy_ : *data_; }
  /// The caller's camera, for one of the sorted data.
  const CameraData& ofCaller(const CameraData& camera) const;

 private:
  const Dataset* data_;
  std::optional<Dataset> copy_;
};

}  // namespace slom::calibration
