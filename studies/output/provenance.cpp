// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/provenance.h"

#include <sys/utsname.h>
#include <nlohmann/json.hpp>

#include "core/thread_pool.h"
#include "simulator/geometry/bvh/bvh.h"

namespace glint {

std::string program_version() {
  return GLINT_VERSION;
}

nlohmann::ordered_json provenance() {
  utsname system = {};
  uname(&system);
#if defined(__clang__)
  const std::string compiler = "clang " __clang_version__;
#else
  const std::string compiler = "gcc " __VERSION__;
#endif
  return {{"version", program_version()},
          {"compiler", compiler},
          {"isa", embree_isa()},
          {"machine", std::string(system.sysname) + " " + system.machine},
          {"cores", hardware_threads()}};
}

}  // namespace glint
