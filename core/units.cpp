// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/units.h"

#include <array>

namespace glint {
namespace {

constexpr std::array<std::string_view, 12> kUnits = {
    "mm", "um", "nm", "px", "deg", "rad", "mrad", "s", "ms", "us", "e", "mm2"};

/// Units that hold an underscore: per second.
constexpr std::array<std::string_view, 4> kSpeedUnits = {"mm_s", "mm_s2", "deg_s", "deg_s2"};

}  // namespace

std::string_view written_unit(std::string_view key) {
  for (const std::string_view unit : kSpeedUnits) {
    if (key.size() > unit.size() && key.ends_with(unit) &&
        key[key.size() - unit.size() - 1] == '_') {
      return key.substr(key.size() - unit.size());
    }
  }
  const auto underscore = key.rfind('_');
  if (underscore == std::string_view::npos) {
    return {};
  }
  const std::string_view suffix = key.substr(underscore + 1);
  for (const std::string_view unit : kUnits) {
    if (suffix == unit) {
      return unit;
    }
  }
  return {};
}

double internal_per_written(std::string_view key) {
  const std::string_view unit = written_unit(key);
  if (unit == "deg" || unit == "deg_s" || unit == "deg_s2") {
    return kRadPerDeg;
  }
  if (unit == "um") {
    return kMmPerUm;
  }
  if (unit == "mrad" || unit == "ms") {
    return 1e-3;
  }
  if (unit == "us") {
    return 1e-6;
  }
  return 1.0;
}

}  // namespace glint
