// --max-seconds and Ctrl-C apply to the whole run. Finished results are written.
#include <chrono>
#include <csignal>
#include <random>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "calibrate/calibrate_command.hpp"
#include "calibrate/html/page.hpp"
#include "calibrate/library.hpp"
#include "calibrate/output/comparison_text.hpp"
#include "calibrate/output/json.hpp"
#include "calibrate/words_of_options.hpp"
#include "error.hpp"
#include "fitting/fit_limits.hpp"

namespace slom::app::calib {
namespace {

using nlohmann::json;
using slom::testing::readFile;
using slom::testing::writeFile;
using testing::RigOptions;
using testing::TemporaryFolder;

Dataset simulated(int images) {
  RigOptions options;
  options.images = images;
  std::mt19937_64 random(1);
  Dataset data = testing::simulateMeasurements(testing::simulateTruth(options, random), options, random);
  data.cameras.resize(1);
  data.imu.reset();
  return data;
}

Settings radial() {
  Settings settings;
  settings.model = Model("radial1");
  return settings;
}

Settings radial(const FitLimits& limits) {
  Settings settings = radial();
  settings.limits = limitsOf(limits);
  return settings;
}

constexpr double no_time = 1e-6;

TEST(Limits, WithoutAReasonToEndThereIsNone) {
  EXPECT_EQ(FitLimits::reasonToEnd(), "");
  const FitLimits limits(0);
  EXPECT_EQ(FitLimits::reasonToEnd(), "");
  EXPECT_NO_THROW(FitLimits::requireTime());
}

TEST(Limits, OfACalibrationNameWhatTheUserGave) {
  const FitLimits limits(0.0015);
  std::this_thread::sleep_for(std::chrono::milliseconds(3));
  const Result result = calibrate(simulated(6), radial(limits));
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.message, "time limit of 0.0015 s reached");
}

TEST(Limits, OfAComparison) {
  const FitLimits limits(no_time);
  const Comparison comparison =
      compareModels(simulated(6), radial(limits), {Model("radial1"), Model("opencv8")});
  EXPECT_EQ(comparison.cut_short, "time limit of 1e-06 s reached");
  ASSERT_EQ(comparison.trials.size(), 2u);
  for (const ModelTrial& trial : comparison.trials)
    EXPECT_EQ(trial.failure, "not tried to the end: time limit of 1e-06 s reached");
  EXPECT_FALSE(comparison.chosen);
  const std::string text = comparisonText(comparison);
  EXPECT_NE(text.find("* The comparison was cut short: time limit of 1e-06 s reached."), std::string::npos)
      << text;
  EXPECT_EQ(text.find("None of the models fits"), std::string::npos);
}

TEST(Limits, OfAnAssessment) {
  const Dataset data = simulated(6);
  Result result = calibrate(data, radial());
  ASSERT_TRUE(result.success());
  const FitLimits limits(no_time);
  result.quality = assess(data, radial(limits), result);
  EXPECT_EQ(result.quality->cut_short, "time limit of 1e-06 s reached");
  EXPECT_FALSE(result.quality->hasProjection());
  EXPECT_FALSE(result.quality->worst.empty()) << "residuals are there";
  const Verdict verdict = verdictOf(result);
  EXPECT_EQ(verdict.level, Verdict::Level::doubtful);
  EXPECT_EQ(verdict.doubts.front(), "the assessment was cut short: time limit of 1e-06 s reached");
  EXPECT_EQ(json::parse(toJson(result))["quality"]["cut_short"], "time limit of 1e-06 s reached");
  EXPECT_NE(toHtml(data, result).find("the assessment was cut short"), std::string::npos);
}

/// Wherever the time ends, there is a page and a JSON.
TEST(Limits, OfAnAssessmentAtAnyPlace) {
  const Dataset data = simulated(6);
  Result result = calibrate(data, radial());
  for (double seconds = 1e-4; result.quality = {}, seconds < 100; seconds *= 1.7) {
    const FitLimits limits(seconds);
    result.quality = assess(data, radial(limits), result);
    EXPECT_TRUE(json::accept(toJson(result)));
    EXPECT_FALSE(toHtml(data, result).empty());
    if (result.quality->cut_short.empty()) break;
    EXPECT_EQ(verdictOf(result).level, Verdict::Level::doubtful);
  }
  EXPECT_TRUE(result.quality && result.quality->cut_short.empty());
}

TEST(Limits, AnInterruptionEndsAllThatFollows) {
  const Dataset data = simulated(6);
  const FitLimits limits(0);
  ::raise(SIGINT);
  EXPECT_EQ(FitLimits::reasonToEnd(), "interrupted");
  EXPECT_EQ(compareModels(data, radial(limits), {Model("radial1")}).cut_short, "interrupted");
  EXPECT_EQ(calibrate(data, radial(limits)).message, "interrupted");
}

TEST(Limits, AnInterruptionThatIsIgnoredStaysSo) {
  ::signal(SIGINT, SIG_IGN);
  {
    const FitLimits limits(0);
    ::raise(SIGINT);
    EXPECT_EQ(FitLimits::reasonToEnd(), "");
  }
  EXPECT_EQ(::signal(SIGINT, SIG_DFL), SIG_IGN);
}

TEST(Limits, ASecondInterruptionEndsTheProgram) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const FitLimits limits(0);
    ::raise(SIGINT);
    ::raise(SIGINT);
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGINT);
}

TEST(Limits, ThatCannotBeAreRefusedBeforeAFileIsRead) {
  for (const std::string value : {"-1", "nan", "-inf"}) {
    const std::string sentence = "slom: --max-seconds " + value + ": give a number from 0 on\n";
    const auto refused = testing::runCalibrate({"--camera", "left=missing.csv", "--max-seconds", value});
    EXPECT_EQ(refused.errors, sentence);
    EXPECT_EQ(refused.exit_code, 2);
    for (const std::string command : {"graph", "bundle", "replay"}) {
      const auto result = slom::testing::runCommand(
          {slom::testing::commandPath().string(), command, "missing", "--max-seconds", value});
      EXPECT_EQ(result.errors, sentence) << command;
      EXPECT_EQ(result.exit_code, 2) << command;
    }
  }
}

struct LongRun : ::testing::Test {
  LongRun() {
    writeFile(folder / "left.csv",
              "# image_size_px: 640 x 480\n" + testing::cornerFile(simulated(200).cameras[0]));
  }

  std::vector<std::string> options(std::vector<std::string> more) const {
    more.insert(more.begin(), {"--camera", "left=" + (folder / "left.csv").string(), "--json",
                               (folder / "r.json").string(), "--output", (folder / "r.yaml").string()});
    return more;
  }
  json result() const { return json::parse(readFile(folder / "r.json")); }

  TemporaryFolder folder;
};

TEST_F(LongRun, OfAComparisonEndsInTime) {
  const auto start = std::chrono::steady_clock::now();
  const auto run = testing::runCalibrate(options({"--compare", "--max-seconds", "0.1"}));
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 5);
  EXPECT_EQ(run.errors, "slom: the calibration failed: time limit of 0.1 s reached\n");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(result()["converged"], false);
  EXPECT_EQ(result()["comparison"]["cut_short"], "time limit of 0.1 s reached");
  EXPECT_FALSE(std::filesystem::exists(folder / "r.yaml"));
}

/// Runs the command and interrupts it after a while; returns how it ended.
int interrupted(std::vector<std::string> words, int milliseconds) {
  words.insert(words.begin(), {slom::testing::commandPath().string(), "calibrate"});
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGINT, SIG_DFL);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execv(arguments[0], arguments.data());
    ::_exit(4);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST_F(LongRun, IsWrittenWhenItIsInterrupted) {
  const auto words = options({"--compare", "--quiet", "--report", (folder / "r.html").string()});
  int status = interrupted(words, 40);
  for (int wait = 80; WIFSIGNALED(status) && wait < 10'000; wait *= 2)  // it was still reading
    status = interrupted(words, wait);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_EQ(result()["message"], "interrupted");
  EXPECT_EQ(result()["comparison"]["cut_short"], "interrupted");
  EXPECT_TRUE(std::filesystem::exists(folder / "r.html"));
}

}  // namespace
}  // namespace slom::app::calib
