#include "calibrate/words_of_options.hpp"

namespace slom::app::calib {
namespace {

void replace(std::string& text, const std::string& part, const std::string& by) {
  if (const auto at = text.rfind(part); at != std::string::npos) text.replace(at, part.size(), by);
}

}  // namespace

std::string inWordsOfOptions(const CommandSettings& settings, const std::string& id, std::string sentence) {
  if (id == "slom.calibration.too-few-data") {
    // All of a file, whose rows begin below its header.
    if (!settings.board) replace(sentence, ": the corners give", ":2: the corners give");
    return sentence + " by --intrinsics";
  }
  if (id == "slom.calibration.imu-open") {
    replace(sentence, ", or fix gravity and acc_bias", ", or pass --fix gravity=9.81 --fix acc_bias");
    replace(sentence, ", or fix gravity", ", or pass --fix gravity=9.81");
    replace(sentence, ", or fix acc_bias", ", or pass --fix acc_bias");
  }
  if (id == "slom.calibration.imu-images") replace(sentence, "leave the reading out", "set valid to 0");
  return sentence;
}

Limits limitsOf(const FitLimits& limits) {
  return {limits.maxSeconds(), limits.start(), &FitLimits::wasInterrupted};
}

}  // namespace slom::app::calib
