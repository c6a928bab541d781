// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/placement_text.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace glint::test {
namespace {

using Json = nlohmann::ordered_json;

TEST(PlacedPartText, IsPlaceSpreadNotesAndTheFileForScenes) {
  Json result = {{"base_from_part",
                  {{"translation_mm", {280, -120.5, 20}}, {"sigma_mm", 0.04}, {"sigma_deg", 0.1}}},
                 {"spread", {{"mm", 0.2}, {"deg", 0.05}}},
                 {"notes", {"one", "two"}}};
  EXPECT_EQ(placed_part_text(result, "base_from_part", "placed/placement.toml"),
            "base_from_part: 280.000 -120.500 20.000 mm +- 0.04 mm, 0.1 degrees\n"
            "placements differ by 0.2 mm, 0.05 degrees (standard deviation)\n"
            "note: one\nnote: two\npart for scenes: placed/placement.toml\n");
  result["base_from_part"]["sigma_mm"] = nullptr;
  result["spread"] = nullptr;
  result["notes"] = Json::array();
  EXPECT_EQ(placed_part_text(result, "base_from_part", "placement.toml"),
            "base_from_part: 280.000 -120.500 20.000 mm, how well known is not stated\n"
            "part for scenes: placement.toml\n");
}

}  // namespace
}  // namespace glint::test
