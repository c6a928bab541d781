// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/round_pictures.h"

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace glint::calibrate_cell_detail {
namespace {

bool has_ended(const std::string& acquired_json) {
  const TemporaryFolder folder;
  write_file(folder / "acquired.json", acquired_json);
  return ended_round(folder.path()).has_value();
}

// With a lamp that was forgotten all pictures are rejected: the same command takes them anew.
TEST(EndedRound, HasAtLeastOneAcceptedPicture) {
  EXPECT_TRUE(has_ended(R"({"status": "complete", "counts": {"wanted": 9, "accepted": 9}})"));
  EXPECT_TRUE(has_ended(R"({"status": "partial", "counts": {"wanted": 9, "accepted": 7}})"));
  EXPECT_FALSE(has_ended(R"({"status": "partial", "counts": {"wanted": 9, "accepted": 0}})"));
  EXPECT_FALSE(has_ended(R"({"status": "stopped", "counts": {"wanted": 9, "accepted": 3}})"));
  EXPECT_FALSE(has_ended("{"));
}

}  // namespace
}  // namespace glint::calibrate_cell_detail
