// Times in files: their unit, and their exact value.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace slom::calibration {

/// The unit of a time: 10^digits ns.
enum class TimeUnit { ns = 0, us = 3, ms = 6, s = 9 };

/// Returns the unit that the name of a column of times states: t_us, timestamp_us, time [us]. Returns nothing if the name
/// has no unit, or names no time.
std::optional<TimeUnit> timeUnitIn(std::string_view column);

/// Returns a time as whole nanoseconds, cut after them. The decimal mark may be a comma. Returns nothing if the text is
/// no number, or out of range.
std::optional<std::int64_t> nanosecondsIn(std::string_view text, TimeUnit unit);

}  // namespace slom::calibration
