// SPDX-License-Identifier: GPL-3.0-or-later
//
// A small strip with small populations, for the tests of [sorting] and [pod].
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/run/run.h"
#include "tests/support/temporary_folder.h"

namespace glint::population_test {

inline constexpr const char* kScene = R"([part]
shape = "strip"
length_mm = 36
width_mm = 15
radius_along_mm = 400
radius_across_mm = 60
[camera]
width_px = 260
height_px = 110
object_pixel_mm = 0.15
working_distance_mm = 600
[sensor]
gain = 1.5
blur_px = 1.0
bits = 8
full_well_e = 20000
read_noise_e = 8
[scan]
positions = 24
[lighting.tunnel]
shape = "semicylinder"
radius_mm = 200
slot_mm = 0
blocks_view = false
length_mm = 1600
period_mm = 10
duty = 0.5
[inspection]
kernel_px = 41
polarity = "bright"
hole_compactness = 0.35
[defects.dent]
count = [1, 2]
height_um = [6, 10]
diameter_mm = [0.3, 1.5]
region = "box"
region_min_mm = [-14, -4, -10]
region_max_mm = [14, 4, 10]
facing_deg = 60
min_distance_mm = 2
[defects.scratch]
count = 1
height_um = 2
length_mm = [2, 5]
width_mm = 0.4
angle_deg = [60, 120]
region = "box"
region_min_mm = [-12, -3, -10]
region_max_mm = [12, 3, 10]
facing_deg = 60
min_distance_mm = 2
)";

inline constexpr const char* kSorting = R"([sorting]
parts = 12
flawless = 6
prototype_parts = 6
prototype_flawless = 3
imprinted_every = 4
[sorting.expert]
perfect_hole_mm = 0.8
acceptable_hole_mm = 1.2
perfect_scratch_mm = 1.0
[sorting.sources.pressed]
share = 2
groups = ["dent"]
[sorting.sources.scratched]
groups = ["dent", "scratch"]
[sorting.sources.clean]
groups = []
[prototypes.coarse]
title = "Stripes of 20 mm"
"lighting.tunnel.period_mm" = 20
)";

inline constexpr const char* kPod = R"([pod]
group = "dent"
height_um = [0.05, 5]
levels = 5
parts = 2
flawless = 4
prototype_flawless = 4
[prototypes.coarse]
"lighting.tunnel.period_mm" = 20
)";

/// A study file in a folder of its own.
class StudyText {
 public:
  explicit StudyText(const std::string& tables) { write_file(path(), kScene + tables); }

  std::filesystem::path path() const { return folder_ / "s.toml"; }

  Study load(const std::vector<KeyValue>& sets = {}) const { return load_study(path(), sets); }

  /// The message of what is refused, beginning with "s.toml"; empty when it is not.
  std::string refusal(const std::vector<KeyValue>& sets = {}) const {
    try {
      load(sets);
    } catch (const ConfigError& error) {
      const std::string message = error.what();
      const std::string file = path().string();
      return message.starts_with(file) ? "s.toml" + message.substr(file.size()) : message;
    }
    return "";
  }

 private:
  TemporaryFolder folder_;
};

inline nlohmann::ordered_json run_in(const std::filesystem::path& out,
                                     const Study& study,
                                     int threads = 2,
                                     const std::atomic<int>* interrupt = nullptr) {
  return run_study(study,
                   {.out = out,
                    .threads = threads,
                    .jobs = 1,
                    .progress = Progress::Style::kNone,
                    .log_file = {},
                    .interrupt = interrupt});
}

/// What a run leaves of its population: all of it is the same bytes for the same study.
inline std::string bytes_of(const std::filesystem::path& run) {
  std::string bytes = read_file(run / "result.json");
  for (const char* name : {"sorting.csv", "sorting_sizes.json", "pod.csv", "pod_curves.json"}) {
    if (std::filesystem::exists(run / name)) {
      bytes += read_file(run / name);
    }
  }
  return bytes;
}

}  // namespace glint::population_test
