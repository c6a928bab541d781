// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/optimizer/quality/memory_growth.h"

#include <fstream>
#include <string>

#include "core/error.h"

namespace glint::quality {
namespace {

/// Of /proc/self/status: "VmHWM:   1234 kB".
double status_mb(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(field + ":")) {
      return std::stod(line.substr(field.size() + 1)) / 1024.0;
    }
  }
  throw Error("/proc/self/status does not tell " + field);
}

}  // namespace

MemoryGrowth::MemoryGrowth() {
  std::ofstream reset("/proc/self/clear_refs");
  if (!(reset << "5" << std::flush)) {  // makes the largest resident set the present one
    throw Error("/proc/self/clear_refs: cannot be written, so no growth of memory can be told");
  }
  start_mb_ = status_mb("VmRSS");
}

double MemoryGrowth::mb() const {
  return status_mb("VmHWM") - start_mb_;
}

}  // namespace glint::quality
