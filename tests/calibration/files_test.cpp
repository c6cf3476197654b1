// Files of corners and readings: written files are read again, to the last bit; several files of a camera; faults in a
// file.
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "calibration/rig_in_memory.hpp"
#include "support/message_of.hpp"
#include "support/temporary_folder.hpp"

namespace slom::calibration {
namespace {

using slom::testing::messageOf;
using slom::testing::TemporaryFolder;
using testing::rigInMemory;

constexpr const char* header = "image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\n";

std::string written(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  const std::string file = (folder / name).string();
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

void expectSameViews(const CameraData& a, const CameraData& b) {
  ASSERT_EQ(a.views.size(), b.views.size());
  for (std::size_t v = 0; v < a.views.size(); ++v) {
    EXPECT_EQ(a.views[v].image, b.views[v].image);
    EXPECT_EQ(a.views[v].photo, b.views[v].photo);
    ASSERT_EQ(a.views[v].corners.size(), b.views[v].corners.size());
    for (std::size_t i = 0; i < a.views[v].corners.size(); ++i) {
      const Corner &x = a.views[v].corners[i], &y = b.views[v].corners[i];
      EXPECT_EQ(x.number, y.number);
      EXPECT_TRUE(x.world == y.world && x.pixel == y.pixel)
          << "corner " << x.number << " of image " << a.views[v].image;
    }
  }
}

TEST(CornerFiles, WhatWasWrittenIsRead) {
  const TemporaryFolder folder;
  CameraData camera = rigInMemory().cameras[0];
  camera.views[1].photo = "left 01.jpg";
  const CameraData again = readCorners("left", written(folder, "left.csv", toCornerFile(camera)));
  EXPECT_EQ(again.name, "left");
  ASSERT_TRUE(again.image_size);
  EXPECT_EQ(again.image_size->width, 640);
  EXPECT_EQ(again.image_size->height, 480);
  expectSameViews(camera, again);
  EXPECT_EQ(toCornerFile(again), toCornerFile(camera));
}

TEST(CornerFiles, TimesStay) {
  const TemporaryFolder folder;
  CameraData camera = rigInMemory().cameras[0];
  for (View& view : camera.views) view.time_ns = 1404733405732800001 + 50'000'000ll * view.image;
  camera.views[1].photo = "1404733405782800001.png";
  const std::string text = toCornerFile(camera);
  EXPECT_NE(text.find("t_ns,corner,"), std::string::npos);
  const CameraData again = readCorners("left", written(folder, "left.csv", text));
  ASSERT_EQ(again.views.size(), camera.views.size());
  for (std::size_t v = 0; v < camera.views.size(); ++v) {
    EXPECT_EQ(again.views[v].time_ns, camera.views[v].time_ns);
    EXPECT_EQ(again.views[v].photo, camera.views[v].photo);
  }
}

TEST(CornerFiles, TimesInSecondsAreExact) {
  const TemporaryFolder folder;
  const auto timesOf = [&](const std::string& first, const std::string& second) {
    const std::string text =
        "t_s" + std::string(header).substr(5) + first + ",1,0,0,0,1,2\n" + second + ",1,0,0,0,1,2\n";
    std::vector<std::int64_t> times;
    for (const View& view : readCorners("left", written(folder, "left.csv", text)).views)
      times.push_back(*view.time_ns);
    return times;
  };
  EXPECT_EQ(timesOf("1403715273.262142976", "1403715273.3"),
            (std::vector<std::int64_t>{1403715273262142976, 1403715273300000000}));
  EXPECT_EQ(timesOf("0.05", "7"), (std::vector<std::int64_t>{50'000'000, 7'000'000'000}));
  EXPECT_EQ(messageOf([&] { timesOf("-1.5", "7"); }),
            "[slom.calibration.bad-file] " + (folder / "left.csv").string() +
                ":2: t_s is \"-1.5\"; write seconds there, as in 1403715273.262143");
}

TEST(CornerFiles, TheHeaderGivesTheUnitOfTimes) {
  const TemporaryFolder folder;
  const auto timeIn = [&](const std::string& column, const std::string& time) {
    const std::string text = column + std::string(header).substr(5) + time + ",1,0,0,0,1,2\n";
    return *readCorners("left", written(folder, "left.csv", text)).views.front().time_ns;
  };
  EXPECT_EQ(timeIn("t_us", "1403715273262142"), 1403715273262142000);
  EXPECT_EQ(timeIn("timestamp_us", "1403715273262142.976"), 1403715273262142976);
  EXPECT_EQ(timeIn("time [us]", "5"), 5'000);
  EXPECT_EQ(timeIn("t_ms", "1403715273262.142976"), 1403715273262142976);
  EXPECT_EQ(timeIn("Timestamp [ms]", "5"), 5'000'000);
  EXPECT_EQ(timeIn("timestamp [ns]", "1403715273262142976"), 1403715273262142976);
  EXPECT_EQ(messageOf([&] { timeIn("t_us", "soon"); }),
            "[slom.calibration.bad-file] " + (folder / "left.csv").string() +
                ":2: t_us is \"soon\"; write microseconds there, as in 1403715273262143");
  EXPECT_EQ(messageOf([&] { timeIn("t_ms", "-1"); }),
            "[slom.calibration.bad-file] " + (folder / "left.csv").string() +
                ":2: t_ms is \"-1\"; write milliseconds there, as in 1403715273262.143");
}

TEST(CornerFiles, TheBoardGivesPlacesThatAreMissing) {
  const TemporaryFolder folder;
  const std::string file = written(folder, "left.csv", "t_ns,corner,u_px,v_px\n0,2,1,2\n0,0,3,4\n");
  BoardOfFiles board{2, 2, 0.5};
  Dataset data = readRig({{"left", {file}}}, "", board);
  EXPECT_EQ(data.cameras[0].views[0].corners[0].world, vec3(0., 0.5, 0.));  // row by row
  board.numbered = {vec3(1., 2., 3.), vec3(0., 0., 0.), vec3(4., 5., 6.)};
  data = readRig({{"left", {file}}}, "", board);
  EXPECT_EQ(data.cameras[0].views[0].corners[0].world, vec3(4., 5., 6.));
  EXPECT_EQ(data.cameras[0].views[0].corners[1].world, vec3(1., 2., 3.));
  board.numbered.pop_back();
  EXPECT_EQ(messageOf([&] {
              readRig({{"left", {file}}}, "", board);
            }),
            "[slom.calibration.bad-file] " + file +
                ":2: the board has 2 corners and no corner 2; correct the number, or the size of the board");
  EXPECT_NE(messageOf([&] { readCorners("left", file); }).find("the file does not say"), std::string::npos);
}

TEST(CornerFiles, NamesOfPhotographsStayInTheirLine) {
  const TemporaryFolder folder;
  CameraData camera = rigInMemory().cameras[0];
  camera.views[0].photo = "left\n1,2,3.jpg";
  camera.unused.push_back({7, "left\r7.jpg", "shows no board"});
  const CameraData again = readCorners("left", written(folder, "left.csv", toCornerFile(camera)));
  EXPECT_EQ(again.views[0].photo, "left\\x0a1,2,3.jpg");
  EXPECT_EQ(again.cornerCount(), camera.cornerCount());
}

TEST(CornerFiles, PartsOfARecording) {
  const TemporaryFolder folder;
  const CameraData whole = rigInMemory().cameras[0];
  CameraData first = whole, second = whole;
  first.views.erase(first.views.begin(), first.views.begin() + 3);  // 3, 4, 5: files may come in any order
  second.views.erase(second.views.begin() + 3, second.views.end());
  const std::string a = written(folder, "a.csv", toCornerFile(first)),
                    b = written(folder, "b.csv", toCornerFile(second));
  const CameraData both = readCorners("left", std::vector<std::string>{a, b});
  expectSameViews(both, whole);
  EXPECT_EQ(both.file, a + " " + b);
  EXPECT_EQ(both.place(both.views[0], both.views[0].corners[0]), b + ":3");
  EXPECT_EQ(both.place(both.views[3], both.views[3].corners[0]), a + ":3");
}

TEST(CornerFiles, PartsThatDoNotFit) {
  const TemporaryFolder folder;
  const auto refusal = [](const std::vector<std::string>& files) {
    return messageOf([&] { readCorners("left", files); });
  };
  const std::string row = "1,1,0,0,0,10,20\n", a = written(folder, "a.csv", header + row),
                    b = written(folder, "b.csv", header + row),
                    small = written(folder, "small.csv",
                                    "# image_size_px: 320 x 240\n" + std::string(header) + "2,1,0,0,0,1,2\n"),
                    large = written(folder, "large.csv",
                                    "# image_size_px: 640 x 480\n" + std::string(header) + "3,1,0,0,0,1,2\n");
  EXPECT_EQ(refusal({}), "[slom.calibration.bad-file] camera left has no file of corners; give at least one");
  EXPECT_EQ(
      refusal({a, b}),
      "[slom.calibration.bad-file] " + b + ":2: image 1 of camera left is already in " + a +
          "; number images differently in all files and alike in all cameras, put the rows of one image into "
          "one file, or give the files as two cameras");
  EXPECT_EQ(refusal({a, small, large}),
            "[slom.calibration.bad-file] " + large +
                ": images have 640 x 480 pixels, but 320 x 240 in an earlier file; give files of only one "
                "camera");
}

/// The same table with other separators and ends of lines.
TEST(CornerFiles, SeparatorsAndEndsOfLinesDoNotMatter) {
  const TemporaryFolder folder;
  const std::string text = std::string("# image_size_px: 640 x 480\n") + header +
                           "0,0,0,0,0,100.5,200.25\n0,1,0.03,0,0,130.125,-2e-1\n\n3,1,0.03,0,0,1,2\n";
  const auto with = [&](char separator, const std::string& end, bool has_decimal_comma) {
    std::string other;
    for (const char c : text) {
      if (c == '\n') {
        other += end;
      } else {
        other += c == ',' ? separator : c == '.' && has_decimal_comma ? ',' : c;
      }
    }
    return readCorners("left", written(folder, "other.csv", other));
  };
  const CameraData plain = readCorners("left", written(folder, "plain.csv", text));
  ASSERT_EQ(plain.views.size(), 2u);
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    for (const char separator : {',', ';', '\t'}) {
      for (const bool has_decimal_comma : {false, true}) {
        if (separator == ',' && has_decimal_comma) continue;
        const CameraData other = with(separator, end, has_decimal_comma);
        expectSameViews(other, plain);
        ASSERT_TRUE(other.image_size.has_value());
        EXPECT_EQ(other.image_size->width, 640);
        EXPECT_EQ(other.views[1].corners[0].line, 6);
      }
    }
  }
}

TEST(CornerFiles, FaultsNameFileAndLine) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    return messageOf([&] { readCorners("left", written(folder, "left.csv", text)); });
  };
  const std::string place = "[slom.calibration.bad-file] " + (folder / "left.csv").string();
  EXPECT_EQ(
      refusal(""),
      place +
          ":1: the file is empty; its first line must be "
          "\"image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\", with one row for each measurement below");
  EXPECT_EQ(refusal(header + std::string("1,1,0,0,0,10,nan\n")),
            place + ":2: v_px is \"nan\"; write a finite number there, or remove the row");
  EXPECT_EQ(refusal(header + std::string("1,1,0,0,0,10,20\n\n1,1,0,0,0,10,20\n")),
            place + ":4: corner 1 of image 1 was listed in line 2 already; remove one of the two rows");
  EXPECT_EQ(messageOf([&] { readCorners("left", (folder / "lost.csv").string()); }),
            "[slom.io.cannot-read] " + (folder / "lost.csv").string() +
                ": cannot be read (No such file or directory); check the path");
}

TEST(ImuFiles, ReadingsThatAreValid) {
  const TemporaryFolder folder;
  const std::string imu_header = "image,ax_m_s2,ay_m_s2,az_m_s2,valid\n";
  const ImuData imu = readImu(written(folder, "imu.csv", imu_header + "3,0.5,-0.25,9.75,1\n4,x,y,z,0\n"));
  ASSERT_EQ(imu.readings.size(), 1u);
  EXPECT_EQ(imu.readings[0].image, 3);
  EXPECT_TRUE(imu.readings[0].acc == vec3(0.5, -0.25, 9.75));
  EXPECT_EQ(imu.place(0), (folder / "imu.csv").string() + ":2");
  EXPECT_EQ(messageOf([&] { readImu(written(folder, "none.csv", imu_header + "3,0,0,9.75,0\n")); }),
            "[slom.calibration.bad-file] " + (folder / "none.csv").string() +
                ":2: no row has valid = 1; drop --imu, or mark usable readings");
}

/// mrcal's corners; the command's tests read them in all formats.
TEST(ForeignCornerFiles, NeedTheirBoard) {
  const TemporaryFolder folder;
  std::string text = "# filename x y\n";
  for (int image = 1; image <= 2; ++image) {
    for (int k = 0; k < 9; ++k)
      text += "f" + std::to_string(image) + ".png " + std::to_string(100 + 30 * (k % 3) + image * k) + " " +
              std::to_string(90 + 30 * (k / 3)) + "\n";
  }
  const std::string vnl = written(folder, "corners.vnl", text);
  EXPECT_EQ(
      messageOf([&] { readCorners("left", vnl); }),
      "[slom.calibration.no-board] " + vnl +
          ": the file does not say how many corners the board has in a row, and how long a square is; state the columns, rows and "
          "side of a square in BoardOfFiles");
  const CameraData camera = readRig({{"left", {vnl}}}, "", BoardOfFiles{3, 3, 0.05}).cameras[0];
  ASSERT_EQ(camera.views.size(), 2u);
  EXPECT_EQ(camera.views[1].photo, "f2.png");
  EXPECT_TRUE(camera.views[1].corners[5].world == vec3(0.1, 0.05, 0.));
  EXPECT_EQ(camera.views[1].corners[5].line, 16);
  const std::string table = written(folder, "left.csv", toCornerFile(camera));
  expectSameViews(readCorners("left", table), camera);
  EXPECT_EQ(messageOf([&] {
              readRig({{"left", {table}}}, "", BoardOfFiles{3, 3, 0.05});
            }),
            "[slom.calibration.unused-board] " + table +
                ": the corner files already state where their corners lie; state no board");
  EXPECT_EQ(messageOf([&] { readKalibrTarget(written(folder, "t.yaml", "target_type: 'dots'\n")); }),
            "[slom.calibration.bad-file] " + (folder / "t.yaml").string() +
                ":1: target_type is \"dots\"; write checkerboard, circlegrid or aprilgrid");
  EXPECT_EQ(messageOf([&] {
              readKalibrTarget(written(folder, "t.yaml", "target_type: checkerboard\ntargetCols: 6.5\n"));
            }),
            "[slom.calibration.bad-file] " + (folder / "t.yaml").string() +
                ":2: targetCols is \"6.5\"; write a whole number from 1 to 1000");
}

}  // namespace
}  // namespace slom::calibration
