// SPDX-License-Identifier: GPL-3.0-or-later
//
// Populations of rough parts under area lights, by path tracing.
#include <gtest/gtest.h>

#include "core/file.h"
#include "studies/population/sorting.h"
#include "tests/studies/population/population_support.h"

namespace glint {
namespace {

constexpr const char* kRough = R"([part]
shape = "strip"
length_mm = 24
width_mm = 12
radius_along_mm = 400
radius_across_mm = 60
[material]
type = "conductor"
reflectance = [0.8]
alpha = [0.2]
[camera]
width_px = 120
height_px = 64
object_pixel_mm = 0.15
working_distance_mm = 400
[sensor]
full_well_e = 20000
read_noise_e = 8
[render.paths]
samples = 16
[lighting.ring]
position_mm = [0, 0, 60]
inner_radius_mm = 60
outer_radius_mm = 75
radiance = [12]
[inspection]
threshold = "false_alarms"
[inspection.trials]
flawless = 12
[defects.dent]
count = [1, 2]
height_um = 40
diameter_mm = 1
region = "box"
region_min_mm = [-7, -3, -10]
region_max_mm = [7, 3, 10]
facing_deg = 60
min_distance_mm = 2
)";

constexpr const char* kRoughPod = R"([pod]
group = "dent"
height_um = [2, 80]
levels = 3
parts = 3
flawless = 4
prototype_flawless = 4
[prototypes.high]
"lighting.ring.position_mm" = [0, 0, 120]
)";

constexpr const char* kRoughSorting = R"([sorting]
parts = 6
flawless = 3
prototype_parts = 4
prototype_flawless = 3
[sorting.expert]
perfect_hole_mm = 0.8
acceptable_hole_mm = 1.2
[sorting.sources.dented]
groups = ["dent"]
[sorting.sources.clean]
groups = []
)";

nlohmann::ordered_json run_rough(const char* tables) {
  const TemporaryFolder folder;
  write_file(folder / "s.toml", std::string(kRough) + tables);
  return population_test::run_in(folder / "out", load_study(folder / "s.toml", {}));
}

TEST(RoughPopulation, HasACurveOfDetection) {
  const auto designs = run_rough(kRoughPod).at("pod").at("designs");
  ASSERT_EQ(designs.size(), 2U);
  for (const auto& [key, design] : designs.items()) {
    const auto& levels = design.at("levels");
    ASSERT_EQ(levels.size(), 3U) << key;  // 2, 12.6 and 80 um
    EXPECT_LT(levels[0].at("hits").get<int>(), levels[2].at("hits").get<int>()) << key;
  }
  EXPECT_EQ(designs.at("baseline").at("levels")[2].at("hits"),
            designs.at("baseline").at("levels")[2].at("defects"));
}

TEST(RoughPopulation, IsSorted) {
  const auto sorting = run_rough(kRoughSorting).at("sorting");
  EXPECT_EQ(sorting.at("designs").size(), 1U) << sorting.dump();
}

}  // namespace
}  // namespace glint
