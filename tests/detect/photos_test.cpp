// Which photographs belong together, by their names.
#include "calibrate/detect/photos.hpp"

#include <gtest/gtest.h>

#include "error.hpp"
#include "support/temporary_folder.hpp"

namespace slom::app::calib {
namespace {

using slom::testing::TemporaryFolder;

struct Photos : ::testing::Test {
  TemporaryFolder folder;

  void make(const std::vector<std::string>& names) const {
    for (const std::string& name : names) slom::testing::writeFile(folder / name, "x");
  }
  /// Patterns are below the folder.
  CameraFile camera(const std::string& name, const std::vector<std::string>& patterns) const {
    CameraFile camera{name, "", {}};
    for (const std::string& pattern : patterns) camera.patterns.push_back((folder / pattern).string());
    return camera;
  }
  /// `1:left1.jpg 2:left2.jpg`, without the folder.
  std::string found(const CameraFile& camera) const {
    std::string text;
    const auto cameras = findPhotos({camera});
    for (const Photo& photo : cameras[0].photos)
      text += (text.empty() ? "" : " ") + std::to_string(photo.image) + ":" +
              std::filesystem::path(photo.file).filename().string();
    return text;
  }
  std::string refusal(const std::vector<CameraFile>& cameras) const {
    try {
      findPhotos(cameras);
    } catch (const UserError& error) {
      std::string text = error.what();
      for (std::size_t at; (at = text.find(folder.path().string() + "/")) != std::string::npos;)
        text.erase(at, folder.path().string().size() + 1);
      return text;
    }
    return "no error";
  }
};

TEST(NumberInName, IsTheLastOneBeforeTheExtension) {
  EXPECT_EQ(numberInName("left07.jpg"), "7");
  EXPECT_EQ(numberInName("run2/cam1_left_0012b.png"), "12");
  EXPECT_EQ(numberInName("10"), "10");
  EXPECT_EQ(numberInName("a000.jpg"), "0");
  EXPECT_EQ(numberInName("1403715273262142976.png"), "1403715273262142976");
  EXPECT_EQ(numberInName("run2/left.jp2"), "");
}

TEST_F(Photos, AreSortedByNumber) {
  make({"left10.jpg", "left2.jpg", "left001.jpg", "right1.jpg", "left3.d/x"});
  EXPECT_EQ(found(camera("left", {"left*"})), "1:left001.jpg 2:left2.jpg 10:left10.jpg");
}

TEST_F(Photos, MayBeListedOneByOneAndTwice) {
  make({"a1.jpg", "a2.jpg", "a[3].jpg"});
  EXPECT_EQ(found(camera("left", {"a1.jpg", "a?.jpg", "a[3].jpg"})), "1:a1.jpg 2:a2.jpg 3:a[3].jpg");
}

TEST_F(Photos, TimeStampsAreCountedOverAllCameras) {
  make({"l/1403715273262142976.png", "l/1403715273312143104.png", "r/1403715273312143104.png",
        "r/1403715273362142976.png"});
  const auto photos = findPhotos({camera("l", {"l/*.png"}), camera("r", {"r/*.png"})});
  EXPECT_EQ(photos[0].photos[0].image, 1);
  EXPECT_EQ(photos[0].photos[1].image, 2);
  EXPECT_EQ(photos[1].photos[0].image, 2);
  EXPECT_EQ(photos[1].photos[1].image, 3);
}

TEST_F(Photos, WithoutANumberAreLeftOut) {
  make({"left1.jpg", "left2.jpg", "board.jpg", "wall.jpg"});
  const auto photos = findPhotos({camera("left", {"*.jpg", "wall.jpg"})});
  EXPECT_EQ(photos[0].photos.size(), 2u);
  EXPECT_EQ(photos[0].unnumbered,
            (std::vector<std::string>{(folder / "board.jpg").string(), (folder / "wall.jpg").string()}));
}

TEST_F(Photos, FaultsAreNamed) {
  make({"left1.jpg", "left01.jpg", "other/left1.jpg", "plain.jpg"});
  EXPECT_EQ(refusal({camera("left", {"*.png"})}),
            "--images left=*.png: no file matches this; check the folder and the pattern, and quote it so "
            "that the shell leaves it alone");
  EXPECT_EQ(
      refusal({camera("left", {"plain.jpg"})}),
      "plain.jpg: no photograph of camera left has a number in its name to pair photographs taken at the "
      "same time; rename them, as in left07.jpg");
  EXPECT_EQ(refusal({camera("left", {"left01.jpg", "left1.jpg"})}),
            "left1.jpg: camera left already has image 1, left01.jpg; the last number in the name must "
            "distinguish its photographs");
  EXPECT_EQ(refusal({camera("left", {"left1.jpg"}), camera("right", {"left1.jpg"})}),
            "left1.jpg: camera left and camera right both have this photograph; correct the patterns");
}

}  // namespace
}  // namespace slom::app::calib
