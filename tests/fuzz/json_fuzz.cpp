// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes are either refused with a place or give a tree whose values all have places.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/config/located_json.h"
#include "core/error.h"

namespace {

void check_places(const glint::ConfigNode& node) {
  GLINT_CHECK(node.place.line > 0 && node.place.column > 0, "every value has a place");
  for (const glint::ConfigNode& item : node.items) {
    check_places(item);
  }
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  try {
    check_places(glint::parse_located_json(input, "fuzz.json"));
  } catch (const glint::ConfigError& error) {
    GLINT_CHECK(std::string_view(error.what()).starts_with("fuzz.json:"), "errors have a place");
  }
  return 0;
}
