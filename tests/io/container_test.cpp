// Containers hold what the text files hold, bit by bit, and damage is found wherever it is.
#include <bit>
#include <fcntl.h>
#include <limits>
#include <random>
#include <unistd.h>

#include <gtest/gtest.h>

#include <slom/io/bal.hpp>
#include <slom/io/bal_part.hpp>
#include <slom/io/convert.hpp>
#include <slom/io/g2o.hpp>

#include "io/simulated_graph.hpp"
#include "support/message_of.hpp"
#include "support/replaced.hpp"
#include "support/temporary_folder.hpp"

namespace slom::io {
namespace {

using slom::testing::messageOf;
using slom::testing::readFile;
using slom::testing::replaced;
using slom::testing::TemporaryFolder;
using slom::testing::writeFile;

UnknownTags convert(const std::string& text, const std::string& to) {
  const int file = ::open(to.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const UnknownTags unknown = writeContainer(text, file, to);
  ::close(file);
  return unknown;
}

std::string textOf(const std::string& container) {
  std::string text;
  readAsText(Container(container), [&](std::string_view piece) { text += piece; });
  return text;
}

/// A scene with numbers of all sizes.
Scene anyScene() {
  std::mt19937_64 random(3);
  const auto number = [&random] {  // any finite number of a magnitude below 1e6
    for (;;) {
      const auto x = std::bit_cast<double>(random());
      if (std::abs(x) < 1e6) return x;
    }
  };
  Scene scene;
  for (int i = 0; i < 3; ++i) {
    Camera camera;
    camera.pose = {mtk::SO3<>::exp(testing::randomVector<3>(random, 1)),
                   mtk::vect<3>(number(), number(), number())};
    camera.lens = SnavelyIntrinsics<>(mtk::vect<3>(500 + i / 3., number(), number()));
    scene.cameras.push_back(camera);
  }
  for (int k = 0; k < 50; ++k) scene.points.emplace_back(number(), -number(), number());
  for (int k = 0; k < 150; ++k) scene.observations.push_back({k % 3, k / 3, k + 2, {number(), -0.0}});
  return scene;
}

TEST(Containers, OfGraphsKeepEveryBit) {
  const TemporaryFolder folder;
  const std::string text = (folder / "map.g2o").string(), binary = (folder / "map.slom").string();
  const auto compare = [&](const auto& graph) {
    using Pose = typename std::decay_t<decltype(graph)>::Pose;
    const std::string written = toG2o(graph);
    writeFile(text, written);
    EXPECT_TRUE(convert(text, binary).sentences().empty());
    EXPECT_TRUE(isContainer(binary));
    EXPECT_FALSE(isContainer(text));
    EXPECT_EQ(textOf(binary), written);
    const auto read = [](const std::string& file) {
      return toG2o(std::get<PoseGraph<Pose>>(readPoseGraph(file)));
    };
    EXPECT_EQ(read(binary), read(text));
  };
  compare(testing::simulateGraph<Pose2>(30, 0.1, 1));
  compare(testing::simulateGraph<Pose3>(30, 0.1, 2));
}

TEST(Containers, OfGraphsNameSkippedLinesAndKeepTheNumbersOfLines) {
  const TemporaryFolder folder;
  const std::string text = (folder / "map.g2o").string(), binary = (folder / "map.slom").string();
  writeFile(text,
            "# a comment\nVERTEX_SE2 7 1 2 0.5\nVERTEX_CAM 1\nFIX 7 8\nEDGE_SE2 7 8 4 5 0.25 1 0 0 1 0 1\n");
  EXPECT_EQ(convert(text, binary).sentences(),
            std::vector<std::string>{"skipped 1 line with the unknown tag VERTEX_CAM"});
  EXPECT_EQ(textOf(binary), "VERTEX_SE2 7 1 2 0.5\nFIX 7\nFIX 8\nEDGE_SE2 7 8 4 5 0.25 1 0 0 1 0 1\n");
  const std::string message = messageOf([&] { readPoseGraph(binary); });
  EXPECT_NE(message.find("map.slom:5: "), std::string::npos) << message;
}

TEST(Containers, OfScenesKeepEveryBit) {
  const TemporaryFolder folder;
  const std::string text = (folder / "scene.txt").string(), binary = (folder / "scene.slom").string();
  const std::string written = toBal(anyScene());
  writeFile(text, written);
  convert(text, binary);
  EXPECT_EQ(textOf(binary), written);
  const Scene from_text = readScene(text), from_binary = readScene(binary);
  ASSERT_EQ(from_binary.observations.size(), from_text.observations.size());
  for (std::size_t i = 0; i < from_text.observations.size(); ++i) {
    const Observation &a = from_text.observations[i], &b = from_binary.observations[i];
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a.pixel[0]), std::bit_cast<std::uint64_t>(b.pixel[0]));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a.pixel[1]), std::bit_cast<std::uint64_t>(b.pixel[1]));
    EXPECT_EQ(std::tuple(a.camera, a.point, a.line), std::tuple(b.camera, b.point, b.line));
  }
  EXPECT_EQ(from_binary.points, from_text.points);
  EXPECT_EQ(toBal(from_binary), toBal(from_text));  // with the cameras
}

TEST(Containers, AreReadInPartsByOffsets) {
  const TemporaryFolder folder;
  const std::string text = (folder / "scene.txt").string(), binary = (folder / "scene.slom").string();
  writeFile(text, toBal(anyScene()));
  convert(text, binary);
  const Container container(binary);
  const BalPart whole = readBalPart(container, 0, 1);
  for (const int parts : {2, 7, 200}) {
    std::vector<std::uint64_t> sums(container.sections().size(), 0);
    std::size_t observations = 0, points = 0;
    for (int p = 0; p < parts; ++p) {
      const BalPart part = readBalPart(container, p, parts);
      for (const BalObservation& seen : part.observations)
        EXPECT_EQ(seen.number, whole.observations[observations++].number);
      for (const BalNumber& number : part.points) EXPECT_EQ(number.value, whole.points[points++].value);
      for (std::size_t s = 0; s < sums.size(); ++s)
        sums[s] += container.sum(container.sections()[s], rangeOf(container.sections()[s], p, parts));
    }
    EXPECT_EQ(observations, whole.observations.size());
    EXPECT_EQ(points, whole.points.size());
    for (std::size_t s = 0; s < sums.size(); ++s) container.requireSum(container.sections()[s], sums[s]);
  }
}

TEST(Containers, ThatAreDamagedAreRefused) {
  const TemporaryFolder folder;
  const std::string text = (folder / "scene.txt").string(), binary = (folder / "scene.slom").string();
  writeFile(text, toBal(anyScene()));
  convert(text, binary);
  const std::string good = readFile(binary);
  const auto refusal = [&](const std::string& content) {
    writeFile(binary, content);
    return replaced(messageOf([&] { readScene(binary); }), folder.path().string() + "/", "");
  };
  for (std::size_t at = 8; at < good.size(); at += at < 260 ? 1 : 501) {
    for (const int bit : {0, 6}) {
      std::string bad = good;
      bad[at] = char(bad[at] ^ (1 << bit));
      EXPECT_NE(refusal(bad).find("scene.slom: the container "), std::string::npos)
          << at << ": " << refusal(bad);
    }
  }
  std::string data = good;
  data[good.size() - 3] ^= 4;
  EXPECT_EQ(
      refusal(data),
      "[slom.io.damaged] scene.slom: the container is damaged in its section point; convert the text file again");
  for (const std::size_t size : {8, 40, 60, 300, int(good.size()) - 1}) {
    EXPECT_NE(refusal(good.substr(0, size)).find("[slom.io.damaged] scene.slom: the container ends "),
              std::string::npos)
        << size;
  }
  EXPECT_EQ(refusal(good.substr(0, 300)), "[slom.io.damaged] scene.slom: the container ends after 300 of " +
                                              std::to_string(good.size()) +
                                              " bytes; convert the text file again");
  EXPECT_EQ(
      refusal(good + "more"),
      "[slom.io.damaged] scene.slom: the container is damaged in its head; convert the text file again");
}

TEST(Containers, OfOthersAreRefused) {
  const TemporaryFolder folder;
  const std::string text = (folder / "map.g2o").string(), binary = (folder / "map.slom").string();
  writeFile(text, toG2o(testing::simulateGraph<Pose2>(5, 0.1, 1)));
  convert(text, binary);
  const std::string good = readFile(binary);
  const auto refusal = [&](const std::string& content) {
    writeFile(binary, content);
    return replaced(messageOf([&] { readPoseGraph(binary); }), folder.path().string() + "/", "");
  };
  std::string newer = good;
  newer[16] = 2;
  EXPECT_EQ(
      refusal(newer),
      "[slom.io.other-container] map.slom: the container has version 2 of the format, but this slom reads "
      "version 1; convert the text file again");
  std::string swapped = good;
  std::reverse(swapped.begin() + 8, swapped.begin() + 16);
  EXPECT_EQ(
      refusal(swapped),
      "[slom.io.other-container] map.slom: the container has numbers in the byte order of another kind of "
      "machine; convert the text file on this one");
  writeFile(binary, good);
  EXPECT_EQ(replaced(messageOf([&] { readScene(binary); }), folder.path().string() + "/", ""),
            "[slom.io.other-container] map.slom: the container has a pose graph; fit it by slom graph");
}

TEST(Containers, AreNotMadeOfTextsThatNobodyCanRead) {
  const TemporaryFolder folder;
  const std::string text = (folder / "scene.txt").string(), binary = (folder / "scene.slom").string();
  const auto refusal = [&](const std::string& content) {
    writeFile(text, content);
    return replaced(messageOf([&] { convert(text, binary); }), folder.path().string() + "/", "");
  };
  EXPECT_EQ(refusal(""),
            "[slom.io.empty-file] scene.txt: the file is empty; give a pose graph or a bundle adjustment");
  EXPECT_EQ(refusal("1 1 1\n0 0 x 2\n"),
            "[slom.io.bad-line] scene.txt:2: u of observation 0 is \"x\"; write a finite number there");
  EXPECT_EQ(refusal("1 1 1\n0 0 1 2\n0 0 0\n"),
            "[slom.io.bad-line] scene.txt:3: the file ends before the last point is complete: the first line "
            "announces 1 camera, 1 point and 1 observation; complete the file, or correct the first line");
  EXPECT_EQ(
      refusal("# Notes\nnothing of a map\n"),
      "[slom.io.no-edges] scene.txt: no line has a known tag; give a pose graph of g2o or TORO, or a bundle "
      "adjustment of BAL");
  EXPECT_EQ(refusal("EDGE_SE2 1 2 x\n"),
            "[slom.io.bad-line] scene.txt:1: word 3 after EDGE_SE2 is \"x\"; write a finite number there");
}

TEST(Containers, ThatCannotBeWrittenAreNamed) {
  const TemporaryFolder folder;
  const std::string text = (folder / "scene.txt").string();
  writeFile(text, toBal(anyScene()));
  const int full = ::open("/dev/full", O_WRONLY);
  ASSERT_GE(full, 0);
  EXPECT_EQ(
      messageOf([&] { writeContainer(text, full, "scene.slomb"); }),
      "[slom.io.cannot-write] scene.slomb: cannot be written (No space left on device); check the space on its "
      "disk");
  ::close(full);
}

}  // namespace
}  // namespace slom::io
