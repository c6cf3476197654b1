// Every mistake in a file, word for word.
#include "bundle/bundle_command.hpp"

namespace slom::app::bundle {
namespace {

using testing::command;
using testing::replaced;
using testing::TemporaryFolder;

void expectRefused(const std::string& content, const std::string& sentence) {
  command.expectRefused(content, sentence);
}

// Two cameras, three points, five observations on the lines 2 to 6; cameras from line 7 on, points on the
// last three.
const std::string counts = "2 3 5\n";
const std::string observations = "0 0 1 2\n0 1 3 4\n0 2 5 6\n1 0 7 8\n1 1 9 10\n";
const std::string camera = "0\n0\n0\n0\n0\n-5\n500\n0\n0\n";
const std::string points = "0 0 1\n0 1 0\n1 0 0\n";
const std::string announced = "the first line announces 2 cameras, 3 points and 5 observations";

std::string scene(const std::string& what = "", const std::string& by = "") {
  return counts + (what.empty() ? observations : replaced(observations, what, by)) + camera + camera + points;
}

TEST(BundleFaults, MissingFile) {
  const auto result = command.run({"no/such/scene.txt"});
  EXPECT_EQ(result.errors,
            "slom: no/such/scene.txt: cannot be read (No such file or directory); check the path\n");
  EXPECT_EQ(result.exit_code, 2);
}
TEST(BundleFaults, Folder) {
  const TemporaryFolder folder;
  EXPECT_EQ(command.run({folder.path().string()}).errors,
            "slom: " + folder.path().string() + ": cannot be read (Is a directory); check the path\n");
}
TEST(BundleFaults, EmptyFile) {
  for (const std::string content : {"", "\n \r\n"}) {
    expectRefused(
        content,
        "scene.txt: the file is empty; a BAL file begins with a line \"cameras points observations\"");
  }
}
TEST(BundleFaults, Counts) {
  const auto sentence = [](const std::string& what, const std::string& word) {
    return "scene.txt:1: the number of " + what + " is \"" + word +
           "\"; a BAL file begins with a line \"cameras points observations\" of whole numbers from 1 on";
  };
  for (const std::string bad : {"-2", "0", "1.5", "two", "99999999999"}) {
    expectRefused(bad + " 3 5\n", sentence("cameras", bad));
    expectRefused("2 " + bad + " 5\n", sentence("points", bad));
    expectRefused("2 3 " + bad + "\n", sentence("observations", bad));
  }
  expectRefused("image,corner\n", sentence("cameras", "image,corner"));
  for (const std::string line : {"2 3\n5\n", "2\n3 5\n", "2 3 5 7\n", "2"}) {
    expectRefused(
        line,
        "scene.txt:1: a BAL file begins with three numbers on a line, \"cameras points observations\"; "
        "correct this one");
  }
}
TEST(BundleFaults, TruncatedFile) {
  const auto ends = [](const std::string& content, const std::string& line, const std::string& where) {
    expectRefused(content, "scene.txt:" + line + ": the file ends before " + where + " is complete: " +
                               announced + "; complete the file, or correct the first line");
  };
  ends(counts, "1", "observation 0");
  ends(counts + observations.substr(0, 16), "3", "observation 2");
  ends(counts + observations, "6", "camera 0");
  ends(counts + observations + camera + camera.substr(0, 10) + "\n", "20", "camera 1");
  ends(counts + observations + camera + camera, "24", "point 0");
  ends(counts + observations + camera + camera + "0 0 1\n0 1", "26", "point 1");
  expectRefused(
      "2 2000000000 2000000000\n0 0 1 2\n",
      "scene.txt:2: the file ends before observation 1 is complete: the first line announces 2 "
      "cameras, 2000000000 points and 2000000000 observations; complete the file, or correct the first line");
}
TEST(BundleFaults, WrongNumberOfWordsInAnObservation) {
  const auto sentence = [](const std::string& here) {
    return "scene.txt:4: an observation has 4 numbers on a line, \"camera point u v\", but this line has " +
           here + "; " + announced;
  };
  expectRefused(scene("0 2 5 6", "0"), sentence("1"));
  expectRefused(scene("0 2 5 6", "0 2"), sentence("2"));
  expectRefused(scene("0 2 5 6", "0 2 5"), sentence("3"));
  expectRefused(scene("0 2 5 6", "0 2 5 6 7"), sentence("more than 4"));
  expectRefused(
      "2 3 6\n" + observations + camera + camera + points,
      "scene.txt:7: an observation has 4 numbers on a line, \"camera point u v\", but this line has 1; the "
      "first "
      "line announces 2 cameras, 3 points and 6 observations");
}
TEST(BundleFaults, NotANumber) {
  for (const std::string bad : {"nan", "inf", "-inf", "1e999", "1.5x", "--1", "0x10", "1,5", "word"}) {
    expectRefused(scene("0 2 5 6", "0 2 " + bad + " 6"),
                  "scene.txt:4: u of observation 2 is \"" + bad + "\"; write a finite number there");
    expectRefused(counts + observations + camera + replaced(camera, "500", bad) + points,
                  "scene.txt:22: f of camera 1 is \"" + bad + "\"; write a finite number there");
    expectRefused(counts + observations + camera + camera + replaced(points, "0 1 0", "0 1 " + bad),
                  "scene.txt:26: z of point 1 is \"" + bad + "\"; write a finite number there");
  }
  expectRefused(scene("0 2 5 6", "0 2 5 x"),
                "scene.txt:4: v of observation 2 is \"x\"; write a finite number there");
  const std::string endless(100, '7');
  expectRefused(scene("0 2 5 6", "0 2 5 x" + endless), "scene.txt:4: v of observation 2 is \"x" +
                                                           endless.substr(0, 36) +
                                                           "...\"; write a finite number there");
}
TEST(BundleFaults, FocalLengthsThatCannotBe) {
  for (const std::string bad : {"1e-16", "1e-5", "0", "-1e-5", "2e9", "-500", "-2e9"}) {
    expectRefused(counts + observations + camera + replaced(camera, "500", bad) + points,
                  "scene.txt:22: f of camera 1 is \"" + bad +
                      "\"; write a focal length from 0.001 to 1e+09 [px] there");
  }
}
TEST(BundleFaults, PixelsThatCannotBe) {
  expectRefused(
      scene("0 2 5 6", "0 2 1e155 6"),
      "scene.txt:4: u of observation 2 is \"1e155\"; write a number from -1e+06 to 1e+06 [px] there");
}
TEST(BundleFaults, EveryNumberOfACameraHasAName) {
  const char* const names[] = {
      "rotation x", "rotation y", "rotation z", "translation x", "translation y", "translation z",
      "f",          "k1",         "k2"};
  for (int k = 0; k < 9; ++k) {
    std::string broken;
    for (int i = 0; i < 9; ++i) broken += i == k ? "?\n" : "1\n";
    expectRefused(counts + observations + broken + camera + points,
                  "scene.txt:" + std::to_string(7 + k) + ": " + names[k] +
                      " of camera 0 is \"?\"; write a finite number there");
  }
}
TEST(BundleFaults, IndicesOutOfRange) {
  for (const std::string camera_index : {"2", "-1", "70"}) {
    expectRefused(scene("1 0 7 8", camera_index + " 0 7 8"),
                  "scene.txt:5: this observation is of camera " + camera_index +
                      ", but there are 2 cameras, with numbers from 0 to 1; correct it, or the first line");
  }
  expectRefused(
      scene("1 0 7 8", "1 3 7 8"),
      "scene.txt:5: this observation is of point 3, but there are 3 points, with numbers from 0 to 2; "
      "correct it, or the first line");
  expectRefused(
      "1 1 1\n0 1 1 1\n" + camera + "0 0 0\n",
      "scene.txt:2: this observation is of point 1, but there is 1 point, with number 0; correct it, or the "
      "first line");
  expectRefused(scene("1 0 7 8", "1.5 0 7 8"),
                "scene.txt:5: the camera of this observation is \"1.5\"; write a whole number there");
  expectRefused(scene("1 0 7 8", "1 x 7 8"),
                "scene.txt:5: the point of this observation is \"x\"; write a whole number there");
}
TEST(BundleFaults, TrailingGarbage) {
  expectRefused(scene() + "\n\n17 18\n",
                "scene.txt:30: \"17\" comes after the last point, where the file should end: " + announced +
                    "; correct the first line, or remove the rest");
}
TEST(BundleFaults, WithoutObservations) {
  expectRefused("3 3 5\n" + observations + camera + camera + camera + points,
                "scene.txt: 1 camera (number 2) has no observation, so nothing determines it; add "
                "observations, or "
                "remove it");
  expectRefused("2 5 5\n" + observations + camera + camera + points + points.substr(0, 12),
                "scene.txt: 2 points (numbers 3, 4) have no observation, so nothing determines them; add "
                "observations, or remove them");
  expectRefused("2 9 5\n" + observations + camera + camera + points + points + points,
                "scene.txt: 6 points (numbers 3, 4, 5, 6, 7, ...) have no observation, so nothing determines "
                "them; "
                "add observations, or remove them");
}
TEST(BundleFaults, PointsWithoutAnImage) {
  expectRefused(
      counts + observations + camera + camera + replaced(points, "0 1 0", "0 1 5"),
      "scene.txt:3: point 1 has no image in camera 0: the prediction is not a finite number; correct the "
      "point or the camera, or remove the observation");
}
TEST(BundleFaults, PointsWhoseSquaredDistanceIsNotFinite) {
  expectRefused(counts + observations + camera + camera + replaced(points, "0 1 0", "0 1e160 0"),
                "scene.txt:3: point 1 has no image in camera 0: the prediction is not a finite number; "
                "correct the point or the camera, or remove the observation");
}
TEST(BundleFaults, PointsThatOneCameraAloneSeesAreAWarning) {
  const TemporaryFolder folder;
  const auto raw = testing::simulated(3, 30, 0.1, 2);
  testing::RawScene start = testing::perturbed(raw, 0.001, 3);
  const auto drop = [&](int point) {
    std::erase_if(start.observations, [&](const auto& o) { return o.point == point && o.camera > 0; });
  };
  drop(7);
  EXPECT_NE(command.runIn(folder, testing::contentOf(start), {})
                .output.find(
                    "\n  warning: 1 point (number 7) is seen by only one camera: only damping holds it along "
                    "the ray, 1 free direction\n"),
            std::string::npos);
  drop(9);
  start.observations.push_back(start.observations.front());  // twice by the same camera
  const auto result = command.runIn(folder, testing::contentOf(start), {});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find(
                "\n  warning: 2 points (numbers 7, 9) are seen by only one camera: only damping holds "
                "them along the ray, 2 free directions\n"),
            std::string::npos)
      << result.output;
}

}  // namespace
}  // namespace slom::app::bundle
