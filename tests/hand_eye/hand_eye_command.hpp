#pragma once
// The command `slom hand-eye` on files that a test writes.

#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibration/hand_eye_streams.hpp"
#include "support/paths.hpp"
#include "support/replaced.hpp"
#include "support/run_command.hpp"

namespace slom::testing {

/// Returns a stream as the text of a file.
inline std::string csvOf(const PoseStream& stream, bool has_times = true) {
  std::string text = has_times ? "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n" : "x_m,y_m,z_m,qx,qy,qz,qw\n";
  for (const auto& pose : stream.poses) {
    const auto& q = pose.pose.orient;
    if (has_times) text += fmt::format("{:.9f},", pose.t_s);
    text += fmt::format("{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f},{:.12f}\n", pose.pose.pos[0],
                        pose.pose.pos[1], pose.pose.pos[2], q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

/// Runs the command on hand.csv and camera.csv with these texts; `options` may name files of the folder by DIR/.
/// Messages are shown without the folder.
inline CommandResult runHandEye(const TemporaryFolder& folder, const std::string& hand,
                                const std::string& camera, std::vector<std::string> options = {}) {
  writeFile(folder / "hand.csv", hand);
  writeFile(folder / "camera.csv", camera);
  std::vector<std::string> words{commandPath().string(), "hand-eye", (folder / "hand.csv").string(),
                                 (folder / "camera.csv").string()};
  for (const std::string& option : options) words.push_back(replaced(option, "DIR", folder.path().string()));
  CommandResult result = runCommand(words);
  result.errors = replaced(result.errors, folder.path().string() + "/", "");
  result.output = replaced(result.output, folder.path().string() + "/", "");
  return result;
}

/// Expects that the command refuses the files with one sentence and writes nothing.
inline void expectRefused(const std::string& hand, const std::string& camera, const std::string& sentence,
                          std::vector<std::string> options = {}) {
  const TemporaryFolder folder;
  options.insert(options.end(), {"--json", "DIR/result.json"});
  const CommandResult result = runHandEye(folder, hand, camera, options);
  EXPECT_EQ(result.errors, "slom: " + sentence + "\n");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "result.json"));
}

}  // namespace slom::testing
