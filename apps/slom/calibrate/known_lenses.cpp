#include "calibrate/known_lenses.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "calibrate/words_of_options.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

/// A lens for a camera, and the option that it comes from.
struct HeldLens {
  std::string camera;
  KnownLens lens;
  std::string option;
};

/// Returns the cameras' lenses in a file: of one camera, or of all in their order.
std::vector<HeldLens> lensesOf(const std::string& text, const CommandSettings& settings) {
  const std::string option = "--lenses " + text;
  const auto equals = text.find('=');
  const std::string name = equals == std::string::npos ? "" : text.substr(0, equals);
  const auto is_named = [&](const CameraFile& camera) { return camera.name == name; };
  const bool has_name = std::any_of(settings.cameras.begin(), settings.cameras.end(), is_named);
  std::error_code ignored;
  if (!name.empty() && !has_name && !std::filesystem::exists(text, ignored))
    throw UserError(fmt::format("{}: there is no camera {}; correct the name", option, name));
  const std::vector<KnownLens> lenses =
      inWordsOfOptions(settings, [&] { return readKnownLenses(has_name ? text.substr(equals + 1) : text); });
  const std::size_t wanted = has_name ? 1 : settings.cameras.size();
  if (lenses.size() != wanted)
    throw UserError(
        fmt::format("{}: the file has {} lens{} for {} camera{}; write NAME=FILE for the lens of one camera",
                    option, lenses.size(), lenses.size() == 1 ? "" : "es", wanted, wanted == 1 ? "" : "s"));
  std::vector<HeldLens> held;
  for (std::size_t c = 0; c < wanted; ++c)
    held.push_back({has_name ? name : settings.cameras[c].name, lenses[c], option});
  return held;
}

}  // namespace

void holdLenses(const std::vector<std::string>& texts, const std::string& intrinsics,
                CommandSettings& settings) {
  std::string model = intrinsics;
  for (const std::string& text : texts) {
    for (const HeldLens& held : lensesOf(text, settings)) {
      if (!model.empty() && model != held.lens.model)
        throw UserError(fmt::format(
            "{}: the lens of {} is of the model {}, not {}; all cameras need one model{}", held.option,
            held.camera, held.lens.model, model, intrinsics.empty() ? "" : ", so drop --intrinsics"));
      model = held.lens.model;
      for (const auto& [parameter, value] : held.lens.parameters)
        settings.lens_options.push_back({{held.camera, parameter, value, value}, held.option});
      if (held.lens.image_size) settings.image_sizes.emplace(held.camera, *held.lens.image_size);
    }
  }
  if (!texts.empty()) settings.model = Model(model);
}

}  // namespace slom::app::calib
