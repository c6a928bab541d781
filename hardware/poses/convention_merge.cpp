// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/convention_merge.h"

#include <type_traits>

#include <fmt/format.h>

namespace glint {
namespace {

/// Calls visit(key, member) for each key.
template <class Visit>
void for_each_key(const Visit& visit) {
  visit("unit", &PoseConvention::unit);
  visit("direction", &PoseConvention::direction);
  visit("rotation", &PoseConvention::rotation);
  visit("angle", &PoseConvention::angle);
  visit("euler_order", &PoseConvention::euler_order);
  visit("flange_from_tcp", &PoseConvention::flange_from_tcp);
}

template <class Value>
bool is_said(const PoseConvention& convention, const char* key, Value PoseConvention::*member) {
  return convention.written.contains(key) || convention.*member != PoseConvention{}.*member;
}

/// "auto" in a file leaves the key to the others.
template <class Value>
bool is_open(const PoseConvention& convention, Value PoseConvention::*member) {
  if constexpr (std::is_enum_v<Value>) {
    return convention.*member == Value{};
  } else {
    return false;
  }
}

}  // namespace

PoseConvention overruled(PoseConvention known, const PoseConvention& said) {
  for_each_key([&](const char* key, auto member) {
    if (is_said(said, key, member)) {
      known.*member = said.*member;
      known.written.insert(key);
    }
  });
  return known;
}

void FileConventions::add(const PoseConvention& one, const std::string& file) {
  for_each_key([&](const char* key, auto member) {
    if (!is_said(one, key, member) || is_open(one, member)) {
      return;
    }
    const auto [first, is_new] = files_.try_emplace(key, file);
    if (!is_new && all_.*member != one.*member && !is_said(user_, key, member)) {
      throw ConfigError(
          fmt::format("{}: convention.{}: differs from that of {}; all poses of a robot are "
                      "written in one way, or --set convention.{}=... says it for all",
                      file,
                      key,
                      first->second,
                      key));
    }
    all_.*member = one.*member;
    all_.written.insert(key);
  });
}

}  // namespace glint
