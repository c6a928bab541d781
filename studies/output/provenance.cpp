// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/provenance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>
#include <nlohmann/json.hpp>

#include "core/thread_pool.h"
#include "simulator/geometry/bvh/bvh.h"

namespace glint {

std::string program_version() {
  return GLINT_VERSION;
}

std::string utc_text(std::chrono::system_clock::time_point moment) {
  const std::time_t whole = std::chrono::system_clock::to_time_t(moment);
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(whole));
}

std::string duration_words(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::llround(std::max(1.0, seconds)));
  if (whole < 60) {
    return fmt::format("{} s", whole);
  }
  return whole < 3600 ? fmt::format("{} min {} s", whole / 60, whole % 60)
                      : fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string moment_text(const std::string& started, double seconds) {
  return started + ", " + duration_words(seconds);
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
          {"libraries", GLINT_LIBRARIES},
          {"cores", hardware_threads()}};
}

std::string version_text() {
  const nlohmann::ordered_json all = provenance();
  const auto text = [&](const char* name) { return all[name].get<std::string>(); };
  return fmt::format("glint {}\ncompiler: {}\nmachine: {}, {}\nlibraries: {}\n",
                     text("version"),
                     text("compiler"),
                     text("machine"),
                     text("isa"),
                     text("libraries"));
}

}  // namespace glint
