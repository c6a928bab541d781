// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/units.h"

#include <array>

namespace glint {
namespace {

constexpr std::array<std::string_view, 11> kUnits = {
    "mm", "um", "nm", "px", "deg", "rad", "mrad", "s", "us", "e", "mm2"};

}  // namespace

std::string_view written_unit(std::string_view key) {
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
  if (unit == "deg") {
    return kRadPerDeg;
  }
  if (unit == "um") {
    return kMmPerUm;
  }
  if (unit == "mrad") {
    return 1e-3;
  }
  if (unit == "us") {
    return 1e-6;
  }
  return 1.0;
}

}  // namespace glint
