// Corner files of other programs: images, each a list of corners of a board that the file or the user describes.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slom/calibration/files.hpp"

namespace slom::calibration {

/// One image of such a file. The number is text, as time stamps may be longer than an image number.
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
  bool uses_board = false;  ///< what the user said of the board
};

/// What a file holds, by its first words.
enum class FileFormat { table, vnlog, xml, yaml };
FileFormat formatOf(std::string_view text);

/// Read the formats other than a table. DataError [slom.calibration.bad-file] for a file that is not as it should be, [slom.calibration.no-board] for one
/// that does not say where its corners lie if `board` does not say it either.
GridFile readVnlog(const std::string& file, std::string_view text, const BoardOfFiles& board);
GridFile readFileStorage(const std::string& file, std::string text, FileFormat format,
                         const BoardOfFiles& board);

/// Returns where the corners of a board lie, row by row; `columns` and `rows` are those of the file, where it says them.
std::vector<vec3> pointsOf(const BoardOfFiles& board, const std::string& file);

/// Sets the number of each image to the one in its name: the last that differs in all names, of a file's name without folders and ending.
void numberByNames(const std::string& file, std::vector<GridImage>& images);

}  // namespace slom::calibration
