// SPDX-License-Identifier: GPL-3.0-or-later
//
// libFuzzer target of the IES LM-63 reader: any bytes are refused with a place or give a table
// whose intensities and flux are numbers >= 0.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/error.h"
#include "simulator/light/area/ies_table.h"
#include "simulator/light/area/read_ies.h"

namespace {

void check_table(const glint::IesTable& table) {
  GLINT_CHECK(table.intensity.size() == table.vertical_rad.size() * table.horizontal_rad.size(),
              "a value for each pair of angles");
  const double flux = table.flux();
  GLINT_CHECK(std::isfinite(flux) && flux >= 0.0, "the flux is a number");
  for (const double z : {-1.0, -0.5, 0.0, 0.3, 1.0}) {
    const double r = std::sqrt(1.0 - z * z);
    for (int i = 0; i < 8; ++i) {
      const double value = table.at({r * std::cos(i), r * std::sin(i), z});
      GLINT_CHECK(value >= 0.0 && value <= table.highest() * (1.0 + 1e-12), "between its values");
    }
  }
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    check_table(glint::parse_ies({reinterpret_cast<const char*>(data), size}, "fuzz.ies"));
  } catch (const glint::ConfigError& error) {
    GLINT_CHECK(std::string_view(error.what()).starts_with("fuzz.ies:"), "says where");
  }
  return 0;
}
