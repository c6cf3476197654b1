// Views sorted by image number, as the fit and its diagnostics require.
#pragma once

#include <optional>

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

void sortViews(CameraData& camera);

/// The caller's data if all views are sorted by image number, otherwise a sorted copy of them.
class SortedDataset {
 public:
  /// Takes the data. `data` must outlive this object.
  explicit SortedDataset(const Dataset& data);
  SortedDataset(const SortedDataset&) = delete;
  SortedDataset& operator=(const SortedDataset&) = delete;

  const Dataset& operator*() const { return copy_ ? *copy_ : *data_; }
  /// Returns the caller's camera for a camera of the sorted data.
  const CameraData& ofCaller(const CameraData& camera) const;

 private:
  const Dataset* data_;
  std::optional<Dataset> copy_;
};

}  // namespace slom::calibration
