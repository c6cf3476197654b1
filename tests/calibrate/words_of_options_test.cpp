// Errors of the library, which name no option, as the command says them.
#include "calibrate/words_of_options.hpp"

#include <gtest/gtest.h>

namespace slom::app::calib {
namespace {

TEST(WordsOfOptions, NameWhatTheCommandCanDoAboutTooFewData) {
  const DataError error("slom.calibration.too-few-data",
                        {.place = "left.csv",
                         .fault = "the corners give 16 numbers for 21 unknowns of the model opencv5",
                         .remedy = "add images or corners, or choose a model with fewer parameters"});
  EXPECT_EQ(error.sentence(),
            "left.csv: the corners give 16 numbers for 21 unknowns of the model opencv5; add images or "
            "corners, or choose a model with fewer parameters");
  CommandSettings settings;
  EXPECT_EQ(inWordsOfOptions(settings, error),
            "left.csv:2: the corners give 16 numbers for 21 unknowns of the model opencv5; add images or "
            "corners, or choose a model with fewer parameters by --intrinsics");
  settings.board.emplace();
  EXPECT_EQ(inWordsOfOptions(settings, error),
            "left.csv: the corners give 16 numbers for 21 unknowns of the model opencv5; add images or "
            "corners, or choose a model with fewer parameters by --intrinsics")
      << "photographs have no lines";
}

TEST(WordsOfOptions, NameTheOptionsThatFixWhatTheReadingsLeaveOpen) {
  DataError::Parts parts{
      .place = "imu.csv:2", .fault = "6 valid readings", .remedy = "add readings at other tilts"};
  const auto said = [&](std::vector<std::vector<std::string>> worth_fixing) {
    parts.worth_fixing = std::move(worth_fixing);
    return inWordsOfOptions({}, DataError("slom.calibration.imu-open", parts));
  };
  const std::string beginning = "imu.csv:2: 6 valid readings; add readings at other tilts";
  EXPECT_EQ(said({}), beginning);
  EXPECT_EQ(said({{"gravity"}}), beginning + ", or pass --fix gravity=9.81");
  EXPECT_EQ(said({{"gravity"}, {"acc_bias"}}),
            beginning + ", or pass --fix gravity=9.81, or pass --fix acc_bias");
  EXPECT_EQ(said({{"gravity", "acc_bias"}}), beginning + ", or pass --fix gravity=9.81 --fix acc_bias");
  EXPECT_EQ(DataError("slom.calibration.imu-open", parts).sentence(),
            beginning + ", or fix gravity and acc_bias");
}

TEST(WordsOfOptions, NameTheColumnOfReadingsWithoutAnImage) {
  const DataError error("slom.calibration.imu-images",
                        {.place = "imu.csv:5",
                         .fault = "there are no corners of image 7 in any camera",
                         .remedy = "correct the number, or leave the reading out"});
  EXPECT_EQ(
      inWordsOfOptions({}, error),
      "imu.csv:5: there are no corners of image 7 in any camera; correct the number, or set valid to 0");
}

TEST(WordsOfOptions, AreThoseOfTheLibraryElsewhere) {
  EXPECT_EQ(inWordsOfOptions({}, DataError("slom.calibration.no-pose", "a sentence; a remedy")),
            "a sentence; a remedy");
}

}  // namespace
}  // namespace slom::app::calib
