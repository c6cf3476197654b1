// Corner files of other programs. Each image is a list of corners of a board that the file or the user describes.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slom/calibration/files.hpp"

namespace slom::calibration {

/// One image of such a file. The number is text, because time stamps may be longer than an image number.
struct GridImage {
  std::string digits;
  std::string name{};  ///< of its photograph; empty: unknown
  std::vector<Corner> corners{};
  std::string unused{};  ///< why the image has no corners; empty: it has some
};

struct GridFile {
  std::string file;
  std::vector<GridImage> images{};
  std::optional<ImageSize> image_size{};
  bool uses_board = false;  ///< whether the user's description of the board was needed
};

/// The format of a file, by its first words.
enum class FileFormat { table, vnlog, xml, yaml };
FileFormat formatOf(std::string_view text);

/// Read the formats other than a table. Throw DataError [slom.calibration.bad-file] for a malformed file. Throw
/// [slom.calibration.no-board] if neither the file nor `board` says where the corners lie.
GridFile readVnlog(const std::string& file, std::string_view text, const BoardOfFiles& board);
GridFile readFileStorage(const std::string& file, std::string text, FileFormat format,
                         const BoardOfFiles& board);

/// Returns the corners of a board, row by row. `columns` and `rows` are from the file if it states them.
std::vector<vec3> pointsOf(const BoardOfFiles& board, const std::string& file);

/// Sets the number of each image to a number in its file name, without folders and extension: the last one that
/// differs between all names.
void numberByNames(const std::string& file, std::vector<GridImage>& images);

}  // namespace slom::calibration
