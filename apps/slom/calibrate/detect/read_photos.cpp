#include "calibrate/detect/read_photos.hpp"

#include "calibrate/detect/detector.hpp"
#include "calibrate/detect/find_corners.hpp"
#include "calibrate/result_paths.hpp"
#include "printable.hpp"

namespace slom::app::calib {
namespace {

/// Throws if a result would replace a photograph.
void checkPaths(const CommandSettings& settings, const std::vector<CameraPhotos>& photos) {
  std::vector<NamedFile> inputs{{"--imu", settings.imu_file}};
  for (const ImuFile& imu : settings.imu_streams) inputs.push_back({"--imu-stream " + imu.name, imu.file});
  for (const CameraPhotos& camera : photos) {
    for (const Photo& photo : camera.photos) inputs.push_back({"--images " + camera.name, photo.file});
  }
  checkResultPaths(inputs, resultFiles(settings));
}

}  // namespace

std::vector<CameraData> readPhotos(const CommandSettings& settings, ImageNumbers& numbers) {
  requireDetector(*settings.board);
  const std::vector<CameraPhotos> photos = findPhotos(settings.cameras, &numbers);
  if (const std::string sentence = sentenceOf(numbers); !settings.quiet && !sentence.empty())
    say(sentence + "\n");
  const std::vector<std::string> files = cornerFiles(settings);
  checkPaths(settings, photos);
  requireWritable(files);
  std::vector<CameraData> cameras = findCorners(settings.cameras, photos, *settings.board, !settings.quiet);
  OutputFiles output;
  for (std::size_t c = 0; c < files.size(); ++c) output.add(files[c], printable(toCornerFile(cameras[c])));
  output.commit();
  return cameras;
}

}  // namespace slom::app::calib
