// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes are either refused with a place or give a tree whose text reads back as itself.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/config/config.h"
#include "core/config/toml.h"
#include "core/error.h"

namespace {

void check_round_trip(std::string_view input) {
  const glint::ConfigNode tree = glint::parse_toml(input, "fuzz.toml");
  const std::string once = glint::to_toml(tree);
  // Tables move behind plain values in the first text, so stability is asked of the second.
  const std::string twice = glint::to_toml(glint::parse_toml(once, "once.toml"));
  const std::string thrice = glint::to_toml(glint::parse_toml(twice, "twice.toml"));
  GLINT_CHECK(once.size() == twice.size(), "no value is lost or changed");
  GLINT_CHECK(twice == thrice, "the text is stable");
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  try {
    check_round_trip(input);
  } catch (const glint::ConfigError& error) {
    // Only what the user wrote may be refused, never what to_toml wrote.
    GLINT_CHECK(std::string_view(error.what()).starts_with("fuzz.toml:"), "our own text is read");
  }
  return 0;
}
