#include "calibration/data/result_of.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "calibration/data/point_key.hpp"

namespace slom::calibration {
namespace {

std::string differenceOfCameras(const Dataset& data, const Result& result) {
  if (data.cameras.size() != result.cameras.size()) {
    return fmt::format("the number of cameras is {} in the data and {} in the result", data.cameras.size(),
                       result.cameras.size());
  }
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    const CameraData& measured = data.cameras[c];
    const CameraResult& found = result.cameras[c];
    if (measured.name != found.name) {
      return fmt::format("cameras[{}] is called {} in the data, and {} in the result", c, measured.name,
                         found.name);
    }
    if (found.model != result.cameras.front().model) {
      return fmt::format("camera {} has the model {} in the result, and camera {} the model {}", found.name,
                         found.model, result.cameras.front().name, result.cameras.front().model);
    }
  }
  return "";
}

std::string differenceOfImages(const Dataset& data, const Result& result) {
  std::set<int> found;
  for (const ImageResult& image : result.images) found.insert(image.image);
  for (const CameraData& camera : data.cameras) {
    for (const View& view : camera.views) {
      if (!found.contains(view.image))
        return fmt::format("image {} of {} is not in the result", view.image, camera.name);
    }
  }
  const std::vector<int> measured = data.images();
  for (const int image : found) {
    if (!std::binary_search(measured.begin(), measured.end(), image))
      return fmt::format("image {} of the result is not in the data", image);
  }
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    if (data.cameras[c].cornerCount() != result.cameras[c].corners) {
      return fmt::format("the number of corners of camera {} is {} in the data and {} in the result",
                         data.cameras[c].name, data.cameras[c].cornerCount(), result.cameras[c].corners);
    }
  }
  return "";
}

std::string differenceOfImu(const Dataset& data, const Result& result) {
  if (data.imu.has_value() != result.imu.has_value())
    return fmt::format("there is an IMU only in the {}", data.imu ? "data" : "result");
  if (data.imu && data.imu->readings.size() != result.imu->readings) {
    return fmt::format("the number of IMU readings is {} in the data and {} in the result",
                       data.imu->readings.size(), result.imu->readings);
  }
  return "";
}

std::string differenceOfBoard(const Dataset& data, const Result& result) {
  if (!result.board) return "";
  std::set<PointKey> known;
  for (const MovedCorner& corner : result.board->corners) known.insert(keyOf(corner.world));
  for (const CameraData& camera : data.cameras) {
    for (const View& view : camera.views) {
      for (const Corner& corner : view.corners) {
        if (known.contains(keyOf(corner.world))) continue;
        return fmt::format("corner {} of image {} of {} is not on the board of the result", corner.number,
                           view.image, camera.name);
      }
    }
  }
  return "";
}

}  // namespace

std::string differenceOf(const Dataset& data, const Result& result) {
  std::string difference = differenceOfCameras(data, result);
  if (difference.empty()) difference = differenceOfImages(data, result);
  if (difference.empty()) difference = differenceOfImu(data, result);
  if (difference.empty()) difference = differenceOfBoard(data, result);
  return difference;
}

}  // namespace slom::calibration
