// SPDX-License-Identifier: GPL-3.0-or-later
//
// libFuzzer target of the readers of YAML and of tables of n and k: any bytes are refused with a
// place or give rising wavelengths, whose values stay between those of their rows.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/error.h"
#include "simulator/material/nk_table.h"

namespace {

void check_table(const glint::NkTable& table) {
  GLINT_CHECK(std::ranges::is_sorted(table.wavelength_nm), "wavelengths rise");
  for (const double nm : table.wavelength_nm) {
    const glint::RefractiveIndex index = table.at(nm);
    GLINT_CHECK(index.n <= std::ranges::max(table.n) && index.n >= std::ranges::min(table.n),
                "n lies between its rows");
    GLINT_CHECK(index.k <= std::ranges::max(table.k) && index.k >= std::ranges::min(table.k),
                "k lies between its rows");
  }
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    check_table(glint::parse_nk({reinterpret_cast<const char*>(data), size}, "fuzz.yml"));
  } catch (const glint::ConfigError& error) {
    GLINT_CHECK(std::string_view(error.what()).starts_with("fuzz.yml:"), "says where");
  }
  return 0;
}
